"""What Peil & Nahrath (2003) print, T1 to T15, with the tolerances that this study holds itself to."""

from rainwind.studies.targets_record import Statement

STATEMENTS = {
    s.id: s
    for s in (
        Statement(
            "T1",
            "below 8 m/s two equilibria: A, always a stable focus, and B, an unstable saddle",
            2,
            "equilibria",
            "4.1, 4.2",
        ),
        Statement(
            "T2",
            "fold at 8 m/s, four equilibria above it: C, a saddle, and D join; B < D < C < A in phi",
            8.0,
            "m/s",
            "4.1",
            0.05,
            "fold_speed",
        ),
        Statement(
            "T3",
            "D lies at 30 to 60 deg and falls as the wind grows; about 45 deg at 9 m/s",
            [45.0, 60.0, 30.0],
            "deg",
            "4.2, 4.3",
            2.0,
            "phi_D_at_9",
        ),
        Statement(
            "T4",
            "Hopf points of D near 8 and at 14.8 m/s at 0.2 % damping: unstable between, stable above",
            [8.0, 14.8],
            "m/s",
            "4.2",
            0.05,
            "hopf_speed",
        ),
        Statement(
            "T5",
            "one stable limit cycle at 8-10.7 and 12.7-14.8 m/s, two and an unstable one between",
            [10.7, 12.7],
            "m/s",
            "4.3",
            0.05,
            "cycle_folds",
        ),
        Statement(
            "T6",
            "mostly in-wind vibration at 8-10.7 m/s, mostly cross-wind at 12.7-14.8 m/s",
            "z > y, then y > z",
            "",
            "4.3",
        ),
        Statement(
            "T7",
            "at 9 m/s the rivulet swings 25 deg about 45 deg; reaching the cycle takes over 5 minutes",
            [25.0, 45.0],
            "deg",
            "4.3",
            3.0,
        ),
        Statement(
            "T8",
            "critical damping: no vibration above it; the onset of 8 m/s does not depend on damping",
            0.7,
            "%",
            "5",
            0.02,
            "critical_damping",
        ),
        Statement(
            "T9",
            "at low damping Neimark-Sacker bifurcations, period doubling, chaos",
            "found",
            "",
            "5",
        ),
        Statement(
            "T10",
            "more rivulet friction: wider range of wind speeds, lower critical damping, same onset",
            "wider, lower, same",
            "%",
            "5",
        ),
        Statement("T11", "the onset does not depend on the cable's frequency", "same", "m/s", "5", 0.05),
        Statement(
            "T12", "a lighter rivulet: lower onset, lower critical damping", "lower, lower", "m/s", "5"
        ),
        Statement(
            "T13",
            "2 degrees of freedom (y, phi): same onset, smaller unstable region than with 3",
            "same, smaller",
            "%",
            "5",
            fitted_key="two_dof_region",
        ),
        Statement(
            "T14",
            "Gu & Lu's coefficients (h 6 mm, m_R 0.08 kg/m, gamma 45 deg): same qualitative picture",
            "same picture",
            "",
            "5",
        ),
        Statement("T15", "amplitudes reach a multiple of the cable's diameter", "y or z > d", "", "1"),
    )
}
