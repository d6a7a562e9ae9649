"""Against the single damper's equation, sourced maxima, limits in closed form, finite elements and a mirror."""

from math import atan, inf, pi, sqrt
from time import process_time

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from scipy.optimize import brentq

from rainwind.engineering.cable import Cable, Damper
from rainwind.engineering.dampers import damped_cable, damped_modes, damper_work, force, scaled_roots, stroke
from rainwind.engineering.modes import cable_modes
from rainwind.engineering.sag import lambda_squared
from rainwind.errors import InputError

from .finite_element_cable import beam_eigenvalues, string_eigenvalue

approx = pytest.approx
LENGTH, MASS, TENSION = 100.0, 60.0, 3e6
CABLE = Cable("S1", LENGTH, 0.16, MASS, TENSION, 0.5, 0.0, bending_stiffness=1e-3 * TENSION * LENGTH**2)
UNIT = sqrt(TENSION * MASS)
RATE = CABLE.wave_speed / LENGTH


def damper(place: float, eta: float, stiffness: float = inf, end: str = "lower") -> Damper:
    """Without dimensions: place over the length, c/sqrt(T m), k L/T."""
    return Damper(place * LENGTH, eta * UNIT, stiffness * TENSION / LENGTH, end)  # type: ignore[arg-type]


@pytest.mark.parametrize("eta", [0.01, 3.0, 10.0, 200.0])
def test_one_damper_obeys_its_equation(eta: float):
    for mode in damped_modes(CABLE, 6, [damper(0.03, eta)]):
        s = mode.eigenvalue / RATE
        assert 1 / np.tanh(s * 0.03) + 1 / np.tanh(s * 0.97) == approx(-eta, rel=1e-9)
        assert mode.damping_ratio == approx(-s.real / abs(s), rel=1e-9)
        assert mode.frequency == approx(mode.number * RATE / 2, rel=0.04)


@pytest.mark.parametrize(("place", "largest"), [(0.01, 0.505), (0.02, 0.511)])
def test_largest_damping_of_the_first_mode(place: float, largest: float):
    # solved from the single damper's equation, to three digits
    ratios = [
        damped_modes(CABLE, 1, [damper(place, eta)])[0].damping_ratio
        for eta in np.geomspace(0.8, 1.3, 41) / (pi * place)
    ]
    assert max(ratios) / place == approx(largest, abs=5e-4)


def test_a_rigid_clamp_shortens_the_string():
    for mode in damped_modes(CABLE, 4, [damper(0.05, 1e7)]):
        assert mode.frequency == approx(mode.number * RATE / 2 / 0.95, rel=1e-6)
        assert mode.damping_ratio < 1e-6
        assert mode.position_shares[0] < 1e-5


def test_a_blocked_damper_on_a_soft_support_is_a_spring():
    # omega (cot(omega a) + cot(omega (1 - a))) = -k L/T
    def balance(omega: float) -> float:
        return np.sin(omega) * omega + 30.0 * np.sin(0.05 * omega) * np.sin(0.95 * omega)

    for mode in damped_modes(CABLE, 4, [damper(0.05, 1e7, 30.0)]):
        n = mode.number
        omega = brentq(balance, n * pi + 1e-6, n * pi / 0.95)
        assert 2 * pi * mode.frequency / RATE == approx(omega, rel=1e-6)
        assert mode.damping_ratio < 1e-5


def test_without_dampers_the_string_is_free():
    for mode in damped_modes(CABLE, 5):
        assert mode.frequency == approx(mode.number / (2 * LENGTH) * sqrt(TENSION / MASS), rel=1e-12)
        assert (mode.damping_ratio, mode.position_shares) == (0.0, ())


def test_the_cable_s_own_dampers_are_the_default():
    own = Cable("S2", LENGTH, 0.16, MASS, TENSION, 0.5, 0.0, dampers=(damper(0.03, 10.0),))
    assert damped_modes(own, 3) == damped_modes(CABLE, 3, own.dampers)
    assert damped_modes(own, 3, []) == damped_modes(CABLE, 3)


def test_a_stiff_support_is_a_rigid_one():
    stiff, rigid = (damped_modes(CABLE, 3, [damper(0.03, 8.0, k)]) for k in (1e9, inf))
    for a, b in zip(stiff, rigid, strict=True):
        assert a.damping_ratio == approx(b.damping_ratio, rel=1e-6)


def test_a_soft_support_takes_the_damping_away():
    # asymptotic: the largest ratio falls by 1/(1 + T/(k x)) and its coefficient likewise (derived)
    place, factor = 0.01, 1 / (1 + 1 / (100.0 * 0.01))
    best = factor / (pi * place)
    (mode,) = damped_modes(CABLE, 1, [damper(place, best, 100.0)])
    assert mode.damping_ratio == approx(0.5 * place * factor, rel=0.02)


def test_dampers_at_one_place_add():
    one = damped_modes(CABLE, 4, [damper(0.03, 10.0), damper(0.03, 4.0)])
    for a, b in zip(one, damped_modes(CABLE, 4, [damper(0.03, 14.0)]), strict=True):
        assert a.damping_ratio == approx(b.damping_ratio, rel=1e-10)
        assert a.position_shares == approx(b.position_shares * 2, rel=1e-9)
    for options in ({"bending": True}, {"sag": True}):
        a, b = (
            damped_modes(CABLE, 2, d, **options)
            for d in ([damper(0.03, 10.0), damper(0.03, 4.0)], [damper(0.03, 14.0)])
        )
        assert a[1].damping_ratio == approx(b[1].damping_ratio, rel=1e-9)


@pytest.mark.parametrize("sag", [False, True])
def test_a_string_of_linear_finite_elements_agrees(sag: bool):
    near = [damper(0.025, 6.4), damper(0.0375, 9.0, 40.0, "upper")]
    elements = [(0.025, 6.4, None), (1 - 0.0375, 9.0, 40.0)]
    slack = Cable("S3", LENGTH, 0.16, MASS, TENSION, 0.5, 0.0, axial_stiffness=2e10)
    parameter = lambda_squared(slack) if sag else 0.0
    for mode in damped_modes(slack, 4, near, sag=sag):
        found = string_eigenvalue(mode.eigenvalue / RATE, 480, elements, parameter)
        assert 2 * pi * mode.frequency / RATE == approx(found.imag, rel=1e-4)
        assert mode.damping_ratio == approx(-found.real / abs(found), rel=1e-4)


@pytest.mark.parametrize(
    ("place", "eta"), [(0.1875, 1.9), (0.1875, 2.1), (0.1875, 30.0), (0.1, 5.0), (0.3, 1.2)]
)
def test_modes_past_one_that_stopped_vibrating(place: float, eta: float):
    # linear elements, all eigenvalues; at c = 2 sqrt(T m) the mode near 1/(2 place) goes and does not come back
    n = 160
    h, i = 1 / n, np.arange(n - 1)
    k = (
        np.diag(np.full(n - 1, 2 / h))
        - np.diag(np.full(n - 2, 1 / h), 1)
        - np.diag(np.full(n - 2, 1 / h), -1)
    )
    m = (
        np.diag(np.full(n - 1, 4 * h / 6))
        + np.diag(np.full(n - 2, h / 6), 1)
        + np.diag(np.full(n - 2, h / 6), -1)
    )
    c = np.diag(np.where(i == round(place * n) - 1, eta, 0.0))
    inverse = np.linalg.inv(m)
    full = np.linalg.eigvals(np.block([[np.zeros_like(k), np.eye(n - 1)], [-inverse @ k, -inverse @ c]]))
    slow = full[(full.imag > 0.1) & (full.imag < 25) & (full.real > -5)]
    modes = [x for x in damped_modes(CABLE, 6, [damper(place, eta)]) if x.eigenvalue.real / RATE > -5]
    for mode, s in zip(modes, slow[np.argsort(slow.imag)], strict=False):
        assert abs(mode.eigenvalue / RATE - s) < 0.03
    assert len(modes) >= 4


def test_three_dampers_agree_with_finite_elements():
    three = [damper(0.025, 5.0), damper(0.1, 1.0), damper(0.0375, 9.0, end="upper")]
    elements = [(0.025, 5.0, None), (0.1, 1.0, None), (1 - 0.0375, 9.0, None)]
    for mode in damped_modes(CABLE, 3, three):
        found = string_eigenvalue(mode.eigenvalue / RATE, 480, elements)
        assert mode.damping_ratio == approx(-found.real / abs(found), rel=1e-4)


@pytest.mark.parametrize("ends", ["clamped", "pinned"])
@pytest.mark.parametrize("sag", [False, True])
def test_a_cable_that_bends_agrees_with_cubic_finite_elements(ends, sag: bool):
    two = [damper(0.025, 6.4), damper(0.0375, 9.0, end="upper")]
    parameter = lambda_squared(CABLE) if sag else 0.0
    found = beam_eigenvalues(
        80, 1e-3, parameter, [(0.025, 6.4), (1 - 0.0375, 9.0)], clamped=ends == "clamped"
    )
    for mode, s in zip(damped_modes(CABLE, 5, two, bending=True, sag=sag, ends=ends), found[:5], strict=True):
        assert abs(mode.eigenvalue / RATE - s) < 1e-5 * abs(s)


def test_undamped_frequencies_in_closed_form():
    # pinned beam: f_n^2 = n^2 T/4mL^2 + n^4 pi^2 EI/4mL^4; Irvine: tan(w/2) = w/2 - (4/Lambda)(w/2)^3
    for mode in damped_modes(CABLE, 5, bending=True, ends="pinned"):
        n = mode.number
        assert 2 * pi * mode.frequency / RATE == approx(n * pi * sqrt(1 + 1e-3 * (n * pi) ** 2), rel=1e-12)
    for mode, own in zip(damped_modes(CABLE, 5, bending=True, sag=True), cable_modes(CABLE, 5), strict=True):
        assert mode.frequency == approx(own.frequency_in, rel=1e-12)
    modes = damped_modes(CABLE, 4, sag=True)
    parameter = lambda_squared(CABLE)
    for mode in modes[0::2]:
        half = pi * mode.frequency / RATE
        turns = (mode.number + 1) // 2  # of the arctangent
        assert half == approx(atan(half - 4 / parameter * half**3) + turns * pi, rel=1e-10)
        assert mode.frequency > mode.number * RATE / 2
    for mode in modes[1::2]:
        assert mode.frequency == approx(mode.number * RATE / 2, rel=1e-12)
    # usual approximation, good to 0.35 % up to 10
    assert modes[0].frequency / (RATE / 2) == approx(sqrt(1 + 8 * parameter / pi**4), rel=0.0035)


def test_little_bending_and_little_sag_are_the_string():
    dampers = [damper(0.03, 10.0, 60.0), damper(0.02, 12.0, end="upper")]
    string = damped_modes(CABLE, 4, dampers)
    limp = Cable("S4", LENGTH, 0.16, MASS, TENSION, 0.5, 0.0, axial_stiffness=1.0, bending_stiffness=1e-3)
    none = Cable("S5", LENGTH, 0.16, MASS, TENSION, 0.5, 0.0)
    for other in (
        damped_modes(limp, 4, dampers, sag=True),
        damped_modes(none, 4, dampers, bending=True),
        damped_modes(limp, 4, dampers, bending=True),
    ):
        for a, b in zip(string, other, strict=True):
            assert (b.frequency, b.damping_ratio) == approx((a.frequency, a.damping_ratio), rel=3e-4)
            assert b.position_shares == approx(a.position_shares, rel=3e-4)


def test_modes_stay_two_where_sag_makes_their_frequencies_equal():
    # at Lambda = 4 pi^2 the first two modes have one frequency; the damper parts them
    equal = brentq(
        lambda ea: lambda_squared(Cable("S6", LENGTH, 0.16, MASS, 3e5, 0.5, 0.0, axial_stiffness=ea))
        - 4 * pi**2, 1e6, 1e12,
    )  # fmt: skip
    cable = Cable("S6", LENGTH, 0.16, MASS, 3e5, 0.5, 0.0, axial_stiffness=equal)
    rate = cable.wave_speed / LENGTH
    modes = damped_modes(cable, 3, [Damper(3.0, 6.0 * sqrt(3e5 * MASS))], sag=True)
    found = {
        complex(np.round(string_eigenvalue(m.eigenvalue / rate, 400, [(0.03, 6.0, None)], 4 * pi**2), 3))
        for m in modes
    }
    assert len(found) == 3
    assert min(abs(modes[0].eigenvalue / rate - s) for s in found) < 1e-3
    assert min(abs(modes[1].eigenvalue / rate - s) for s in found) < 1e-3


def test_shares_are_those_of_a_sine_while_the_damper_is_weak():
    for mode in damped_modes(CABLE, 5, [damper(0.03, 1e-6), damper(0.2, 1e-6, end="upper")]):
        n = mode.number
        assert mode.position_shares == approx(
            (abs(np.sin(0.03 * pi * n)), abs(np.sin(0.2 * pi * n))), rel=1e-5, abs=1e-6
        )


def test_shares_of_a_strong_damper_are_those_of_its_equation():
    (mode,) = damped_modes(CABLE, 1, [damper(0.05, 9.0)])
    s, x = mode.eigenvalue / RATE, np.linspace(0.05, 1, 200_001)
    shape = abs(np.sinh(s * (1 - x)))
    assert mode.position_shares[0] == approx(shape[0] / shape.max(), rel=1e-6)


def test_the_work_of_a_damper():
    rigid, soft = damper(0.03, 10.0), damper(0.03, 10.0, 50.0, "upper")
    (mode,) = damped_modes(CABLE, 1, [rigid, soft])
    first, second = damper_work(mode, [rigid, soft], 0.08)
    omega = 2 * pi * mode.frequency
    assert first.stroke == first.displacement == approx(0.08 * mode.position_shares[0])
    assert first.force == approx(omega * rigid.coefficient * first.stroke)
    # in series: one force, displacements a quarter of a turn apart
    spring = second.force / soft.support_stiffness
    assert second.force == approx(omega * soft.coefficient * second.stroke)
    assert second.displacement == approx(np.hypot(spring, second.stroke))
    assert second.stroke < second.displacement
    assert first.power == approx(first.force**2 / rigid.coefficient / 2)
    assert stroke(soft, mode, 1, [0.0, 0.08]) == approx([0.0, second.stroke])
    assert force(soft, mode, 1, [0.0, 0.08]) == approx([0.0, second.force])
    with pytest.raises(InputError, match="same dampers"):
        damper_work(mode, [rigid], 0.08)


def test_what_dampers_lose_is_the_modal_damping():
    # energy lost in a cycle over 4 pi times the energy, weak dampers
    (mode,) = damped_modes(CABLE, 1, [damper(0.02, 0.05)])
    (work,) = damper_work(mode, [damper(0.02, 0.05)], 0.1)
    omega = 2 * pi * mode.frequency
    energy = 0.5 * MASS * LENGTH / 2 * (omega * 0.1) ** 2
    assert work.power / (2 * omega * energy) == approx(mode.damping_ratio, rel=1e-3)


PLACE, ETA = st.floats(0.005, 0.2), st.floats(0.01, 100.0)
STIFFNESS = st.one_of(st.just(inf), st.floats(1.0, 1e4))
DAMPERS = st.lists(
    st.tuples(PLACE, ETA, STIFFNESS, st.sampled_from(["lower", "upper"])), min_size=1, max_size=3
)
OTHER = {"lower": "upper", "upper": "lower"}


@settings(deadline=None, max_examples=25)
@example([(0.125, 2.0, inf, "lower"), (0.125, 2.0, inf, "upper")])
@example([(0.1875, 2.0, inf, "lower")])
@example([(0.09375, 2.00001, inf, "lower"), (0.2, 1.5, 895.0, "lower")])
@given(DAMPERS)
def test_dampers_take_energy_and_a_mirror_changes_nothing(drawn):
    here = [damper(*d) for d in drawn]
    there = [damper(x, eta, k, OTHER[end]) for x, eta, k, end in drawn]
    (roots,) = scaled_roots(damped_cable(CABLE, here), 3, np.ones(1))
    assert roots.real.max() < 1e-12
    assert np.diff(roots.imag).min() > 0
    for a, b in zip(damped_modes(CABLE, 3, here), damped_modes(CABLE, 3, there), strict=True):
        assert (a.frequency, a.damping_ratio) == approx((b.frequency, b.damping_ratio), rel=1e-9, abs=1e-12)
        assert a.position_shares == approx(b.position_shares, rel=1e-6, nan_ok=True)


@pytest.mark.parametrize(
    "options", [{"sag": True}, {"bending": True}, {"sag": True, "bending": True, "ends": "pinned"}]
)
def test_a_mirror_changes_nothing_with_sag_and_bending(options):
    here = [damper(0.03, 9.0, 50.0), damper(0.06, 2.0), damper(0.02, 5.0, end="upper")]
    there = [damper(0.03, 9.0, 50.0, "upper"), damper(0.06, 2.0, end="upper"), damper(0.02, 5.0)]
    for a, b in zip(
        damped_modes(CABLE, 3, here, **options), damped_modes(CABLE, 3, there, **options), strict=True
    ):
        assert (a.frequency, a.damping_ratio) == approx((b.frequency, b.damping_ratio), rel=1e-9)
        assert a.position_shares == approx(b.position_shares, rel=1e-6)


@settings(deadline=None, max_examples=30)
@given(PLACE, PLACE, st.floats(0.001, 0.02), st.floats(0.001, 0.02))
def test_weak_dampers_at_both_ends_add(a: float, b: float, eta: float, theta: float):
    one, two, both = (
        damped_modes(CABLE, 3, dampers)
        for dampers in (
            [damper(a, eta)],
            [damper(b, theta, end="upper")],
            [damper(a, eta), damper(b, theta, end="upper")],
        )
    )
    for p, q, r in zip(one, two, both, strict=True):
        assert r.damping_ratio == approx(p.damping_ratio + q.damping_ratio, abs=(eta + theta) ** 2)
        # first order: zeta_n = c sin^2(n pi a)/(n pi sqrt(T m))
        first = eta * np.sin(p.number * pi * a) ** 2 / (p.number * pi)
        assert p.damping_ratio == approx(first, abs=eta**2)


@pytest.mark.parametrize("count", [0, -1, True, 2.0])
def test_a_count_that_is_none(count):
    with pytest.raises(InputError, match="whole number of 1 or more"):
        damped_modes(CABLE, count)


def test_a_damper_beyond_mid_span():
    with pytest.raises(InputError, match="nearer anchorage"):
        damped_modes(CABLE, 1, [damper(0.5, 1.0)])
    with pytest.raises(InputError, match="above 0"):
        Damper(3.0, 0.0)


def test_a_bridge_of_twelve_stays_takes_no_time():
    two = [damper(0.03, 8.0), damper(0.02, 9.0, 100.0, "upper")]
    start = process_time()
    for _ in range(12):
        damped_modes(CABLE, 5, two)
    assert process_time() - start < 1.0  # 0.08 s on an idle core
