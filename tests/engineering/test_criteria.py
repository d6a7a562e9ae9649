"""Scruton numbers and code checks against numbers worked by hand."""

from dataclasses import replace
from math import pi

import pytest

from rainwind.engineering.cable import Cable
from rainwind.engineering.criteria import (
    SCRUTON_NAMES,
    code_checks,
    galloping_speed,
    rule_damping,
    scruton_numbers,
    vortex_speed,
)
from rainwind.engineering.modes import cable_modes
from rainwind.engineering.sources import SOURCES
from rainwind.errors import InputError

AIR = 1.225
# the sample case of Peil & Nahrath (2003) as a stay of 1 Hz
PAPER = Cable("paper", 130.0, 0.1, 50.0, 50.0 * 260.0**2, pi / 4, 0.0, damping_ratios=(0.002,))
MODES = cable_modes(PAPER, 2)


def test_the_three_definitions_of_the_scruton_number() -> None:
    """50 x 0.002 / (1.225 x 0.01) = 8.163; twice that; and 2 m (2 pi xi) / (rho D²) = 4 pi times the first."""
    found = scruton_numbers(PAPER, 0.002, AIR)
    assert found["PTI"] == pytest.approx(8.1633, abs=1e-4)
    assert found["twice"] == pytest.approx(16.3265, abs=1e-4)
    assert found["Eurocode"] == pytest.approx(102.583, abs=1e-3)
    assert set(found) == set(SCRUTON_NAMES)


def test_the_damping_that_pti_asks_for() -> None:
    """10 x 1.225 x 0.01 / 50 = 0.245 %; a stay of 0.2 m and 100 kg/m needs 0.49 %, half of it with fillets."""
    assert rule_damping(PAPER, AIR) == pytest.approx(0.00245, rel=1e-12)
    thick = replace(PAPER, diameter=0.2, mass=100.0)
    assert rule_damping(thick, AIR) == pytest.approx(0.0049, rel=1e-12)
    assert rule_damping(replace(thick, surface="helical fillet"), AIR) == pytest.approx(0.00245, rel=1e-12)


def test_at_the_rules_damping_the_check_turns() -> None:
    need = rule_damping(PAPER, AIR)
    for factor, passes in ((1.001, True), (0.999, False)):
        (check,) = [c for c in code_checks(PAPER, MODES, [factor * need, 0.1], AIR) if c.rule == "PTI"]
        assert check.passes is passes
        assert "mode 1" in check.what
        assert check.value == pytest.approx(10 * factor)


def test_the_mode_with_the_least_damping_decides() -> None:
    (check,) = [c for c in code_checks(PAPER, MODES, [0.1, 0.001], AIR) if c.rule == "PTI"]
    assert "mode 2" in check.what
    assert not check.passes


def test_the_eurocode_asks_long_stays_for_half_a_per_cent() -> None:
    def damping(cable: Cable, xi: float):
        return [c for c in code_checks(cable, MODES, [xi, xi], AIR) if c.what.startswith("damping")]

    assert [c.passes for c in damping(PAPER, 0.0049) + damping(PAPER, 0.0051)] == [False, True]
    assert not damping(replace(PAPER, length=79.0), 0.001)


def test_amplitudes_at_15_m_s() -> None:
    """L/500 = 0.26 m; FHWA 0.5, 1 and 2 diameters of 0.1 m."""
    checks = [
        c for c in code_checks(PAPER, MODES, [0.01, 0.01], AIR, amplitude_at_15=0.15) if "amplitude" in c.what
    ]
    assert [(c.limit, c.passes) for c in checks] == [(0.26, True), (0.5, False), (1.0, False), (2.0, True)]


def test_frequencies_of_the_deck_are_kept_away_from() -> None:
    """Mode 1 at 1 Hz: a deck at 0.55 Hz has its double at 1.1 Hz, 9 % away; 0.55 itself is 82 % away."""
    checks = [
        c
        for c in code_checks(PAPER, MODES, [0.01, 0.01], AIR, deck_frequencies=[0.55])
        if "structure" in c.what
    ]
    assert [c.passes for c in checks] == [True, False]
    assert checks[1].value == pytest.approx(9.0, abs=0.5)


def test_galloping_and_vortices() -> None:
    """40 x 1 Hz x 0.1 m x sqrt(8.163) = 11.43 m/s; 1 Hz x 0.1 m / 0.2 = 0.5 m/s."""
    assert galloping_speed(PAPER, 1.0, 0.002, AIR) == pytest.approx(11.43, abs=0.01)
    assert vortex_speed(PAPER, 1.0) == pytest.approx(0.5)


def test_every_check_names_a_source() -> None:
    for check in code_checks(PAPER, MODES, [0.01, 0.01], AIR, amplitude_at_15=0.1, deck_frequencies=[0.3]):
        assert check.source in SOURCES


def test_bad_numbers_are_refused() -> None:
    with pytest.raises(InputError, match="one for each"):
        code_checks(PAPER, MODES, [0.01], AIR)
    with pytest.raises(InputError, match="density"):
        rule_damping(PAPER, 0.0)
    with pytest.raises(InputError, match="damping_ratio"):
        scruton_numbers(PAPER, -0.1, AIR)
