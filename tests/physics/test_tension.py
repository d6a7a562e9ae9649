"""The spring of a string: derived by Lagrange, its energy, its one rest position, its frequencies, its refusals."""

from dataclasses import replace
from math import cos, pi, sin, sqrt

import numpy as np
import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp
from scipy.optimize import minimize

from rainwind.dynamics.equilibria import continue_equilibria
from rainwind.dynamics.system import as_system
from rainwind.errors import InputError
from rainwind.physics import CableSection, CoefficientSet, Rivulet, RivuletModel, Wind, paper_model
from rainwind.physics.convexity import least_slope

K3, S, YAW = 900.0, 0.4, 0.7
SECTION = CableSection(
    diameter=0.12, mass=40.0, frequency_y=0.9, frequency_z=1.2, damping_ratio=0.0, inclination=0.6,
    k2_y=31.0, k3_y=170.0, k2_z=-43.0, k3_z=90.0, k3=K3, sag_offset=S,
)  # fmt: skip
STILL = RivuletModel(
    Wind(9.0, yaw=YAW, density=0.0), SECTION, Rivulet(mass=0.8, friction=0.0), paper_model().coefficients
)
BETA = np.arctan(np.tan(YAW) * np.sin(0.6))
LIMITS = (0.5, 7.0, 0.5, 3.0, 10.0, 3.0)
STATES = st.tuples(*(st.floats(-limit, limit) for limit in LIMITS))


def lagrange(held_z: bool):
    """Numbers of (y, phi, z and their rates) -> accelerations of STILL, from T and V by SymPy, V written out here."""
    t = sp.Symbol("t")
    q = [sp.Function(name)(t) for name in ("y", "phi", "z")]
    y, phi, z = q[0], q[1], sp.Integer(0) if held_z else q[2]
    m_s, m_r, r, g = 40.0, 0.8, 0.065, 9.81 * cos(0.6)
    k_y, k_z = (40.0 * (2 * pi * f) ** 2 for f in (0.9, 1.2))
    # the lowest point of the cable's surface is opposite to its top at phi = -beta
    down = sp.Matrix([cos(BETA), -sin(BETA)])
    v = down.dot(sp.Matrix([y, z]))
    y_r, z_r = y - r * sp.cos(phi), z - r * sp.sin(phi)
    kinetic = m_s * (y.diff(t) ** 2 + z.diff(t) ** 2) / 2 + m_r * (y_r.diff(t) ** 2 + z_r.diff(t) ** 2) / 2
    potential = (
        k_y * y**2 / 2 + 31.0 * y**3 / 3 + 170.0 * y**4 / 4 + k_z * z**2 / 2 - 43.0 * z**3 / 3 + 90.0 * z**4 / 4
        + K3 * (S * v + (y**2 + z**2) / 2) ** 2
        - m_r * g * down.dot(sp.Matrix([y_r - y, z_r - z]))
    )  # fmt: skip
    moving = q[:2] if held_z else q
    rows = [(kinetic - potential).diff(c.diff(t)).diff(t) - (kinetic - potential).diff(c) for c in moving]
    matrix, right = sp.linear_eq_to_matrix([sp.expand(row) for row in rows], [c.diff(t, 2) for c in moving])
    places, rates = sp.symbols("y phi z"), sp.symbols("v_y v_phi v_z")
    swap = [(c.diff(t), w) for c, w in zip(q, rates, strict=True)] + list(zip(q, places, strict=True))
    build = sp.lambdify((*places, *rates), [matrix.subs(swap), right.subs(swap)])

    def accelerations(x):
        matrix, right = build(*x)
        return np.linalg.solve(matrix, right).ravel()

    return accelerations


DERIVED = {3: lagrange(held_z=False), 2: lagrange(held_z=True)}


@given(STATES)
def test_three_degrees_of_freedom_obey_lagrange(x):
    rates = STILL.rhs(x, STILL.parameters)
    np.testing.assert_allclose(rates[3:], DERIVED[3](x), rtol=1e-9, atol=1e-8)


@given(STATES)
def test_two_degrees_of_freedom_obey_lagrange(x):
    model = replace(STILL, degrees_of_freedom=2)
    rates = model.rhs((x[0], x[1], x[3], x[4]), model.parameters)
    held = (x[0], x[1], 0.0, x[3], x[4], 0.0)
    np.testing.assert_allclose(rates[2:], DERIVED[2](held), rtol=1e-9, atol=1e-8)


def test_without_sag_it_is_the_coupled_cubic_spring():
    taut = replace(STILL, section=replace(SECTION, sag_offset=None))
    none = replace(STILL, section=replace(SECTION, sag_offset=None, k3=None))
    assert "section.sag_offset" not in taut.parameters
    x = np.array([0.3, pi / 2, -0.2, 0.0, 0.0, 0.0])
    pull = np.array(taut.rhs(x, taut.parameters)) - np.array(none.rhs(x, none.parameters))
    force_y, force_z = (-K3 * q * (0.3**2 + 0.2**2) for q in (0.3, -0.2))
    # at phi = 90 degrees the rivulet is carried along in y as if it were free to turn: only z takes it with it
    assert pull[5] == pytest.approx(force_z / 40.8, rel=1e-12)
    assert pull[3] == pytest.approx(force_y / 40.0, rel=1e-12)


@given(STATES, st.sampled_from([2, 3]))
def test_powers_are_the_rate_of_the_energy(state, freedoms):
    wind = Wind(11.0, yaw=YAW, vertical_speed=0.4)
    section = replace(SECTION, damping_ratio=0.003)
    model = replace(STILL, wind=wind, section=section, degrees_of_freedom=freedoms, outside="extend")
    x = np.array(state) if freedoms == 3 else np.array(state)[[0, 1, 3, 4]]
    p, step = model.parameters, 1e-30j
    gradient = [model.energy(x + step * e, p).imag / 1e-30 for e in np.eye(x.size)]
    rate = np.dot(gradient, np.array(model.rhs(x, p)))
    assert rate == pytest.approx(sum(model.powers(x, p).values()), rel=1e-9, abs=1e-8)


def test_energy_stays_in_still_air_without_damping():
    p = STILL.parameters
    x = np.array([0.5, 0.4, -0.4, 0.3, 2.0, 1.0])
    run = solve_ivp(lambda t, x: STILL.rhs(x, p), (0.0, 20.0), x, method="DOP853", rtol=1e-11, atol=1e-12)
    energies = [STILL.energy(x, p) for x in run.y.T]
    assert np.ptp(run.y[2]) > 0.5  # it does move
    np.testing.assert_allclose(energies, energies[0], rtol=1e-8)


# ---- frequencies


@pytest.mark.parametrize("yaw", [0.0, 0.4, -1.1, 2.0])
def test_frequencies_in_plane_and_out_of_plane_whatever_the_yaw(yaw):
    """sqrt((k + 2 k3 s²)/m) along the cable's vertical plane, sqrt(k/m) across it; the rivulet is next to nothing."""
    section = CableSection(
        mass=50.0, frequency_y=1.0, frequency_z=1.0, damping_ratio=0.0, k3=300.0, sag_offset=0.7
    )
    rivulet = Rivulet(mass=1e-9, friction=0.0)
    model = RivuletModel(Wind(9.0, yaw=yaw, density=0.0), section, rivulet, paper_model().coefficients)
    rest = np.array([0.0, -model.beta, 0.0, 0.0, 0.0, 0.0])
    stiffness = -as_system(model).jacobian(rest)[np.ix_([3, 5], [0, 2])]
    squares, directions = np.linalg.eigh((stiffness + stiffness.T) / 2)
    k = 50.0 * (2 * pi) ** 2
    assert np.sqrt(squares) == pytest.approx(
        [sqrt(k / 50.0), sqrt((k + 2 * 300.0 * 0.7**2) / 50.0)], rel=1e-7
    )
    down = np.array([cos(model.beta), -sin(model.beta)])
    assert abs(directions[:, 1] @ down) == pytest.approx(1.0, abs=1e-7)


@pytest.mark.parametrize("amplitude", [0.1, 2.0])
def test_a_taut_string_whirls_in_circles_faster(amplitude):
    """Exact: y = A cos(w t), z = A sin(w t) with w² = (k + k3 A²)/m; the rivulet is next to nothing."""
    section = CableSection(
        mass=50.0, damping_ratio=0.0, k2_y=0.0, k3_y=0.0, k3_z=0.0, k3=300.0, sag_offset=None
    )
    still = Wind(9.0, yaw=0.5, density=0.0)
    model = RivuletModel(still, section, Rivulet(mass=1e-12, friction=0.0), paper_model().coefficients)
    squared = (50.0 * (2 * pi) ** 2 + 300.0 * amplitude**2) / 50.0
    for angle in np.linspace(0.0, 2 * pi, 9):
        here = amplitude * np.array([cos(angle), sin(angle)])
        rates = sqrt(squared) * amplitude * np.array([-sin(angle), cos(angle)])
        found = model.rhs((here[0], 1.0, here[1], rates[0], 0.0, rates[1]), model.parameters)
        np.testing.assert_allclose([found[3], found[5]], -squared * here, atol=1e-9)


# ---- rest positions


def least_energy(at, force_y, force_z, freedoms, start):
    """Where the springs' energy less the forces' work is least, by SciPy, the energy written out here."""

    def potential(q):
        y, z = (q[0], q[1]) if freedoms == 3 else (q[0], 0.0)
        stretch = at.s_y * y + at.s_z * z + (y * y + z * z) / 2
        springs = at.k_y * y**2 / 2 + at.k_y2 * y**3 / 3 + at.k_y3 * y**4 / 4
        springs += at.k_z * z**2 / 2 + at.k_z2 * z**3 / 3 + at.k_z3 * z**4 / 4
        return springs + at.k3 * stretch**2 - force_y * y - force_z * z

    found = minimize(potential, start[: freedoms - 1], method="Nelder-Mead",
                     options={"xatol": 1e-10, "fatol": 1e-14, "maxiter": 4000})  # fmt: skip
    return found.x


@pytest.mark.parametrize("freedoms", [2, 3])
@pytest.mark.parametrize(("k3", "s"), [(300.0, 0.0), (300.0, 0.9), (2500.0, 0.88), (1e5, 0.14)])
def test_equilibria_are_where_scipy_finds_them_from_many_starts(freedoms, k3, s):
    section = CableSection(mass=50.0, frequency_z=1.3, k2_y=0.0, k2_z=0.0, k3=k3, sag_offset=s)
    model = replace(paper_model(degrees_of_freedom=freedoms), section=section, wind=Wind(30.0, yaw=0.6))
    p = model.parameters
    at = model.letters(p)
    found, without = model.all_states(), paper_model().with_parameters(
        {"wind.speed": 30.0, "wind.yaw": 0.6, "section.frequency_z": 1.3}
    ).all_states()  # fmt: skip
    assert found.certified
    np.testing.assert_array_equal(found.states[:, 1], without.states[:, 1])  # the rivulet does not care
    starts = np.random.default_rng(3).uniform(-2.0, 2.0, (6, 2))
    for x in found:
        assert np.max(np.abs(model.rhs(tuple(x), p))) < 1e-9
        force_y, force_z, _ = model.wind_forces(tuple(x), p)
        places = np.array([least_energy(at, force_y, force_z, freedoms, start) for start in starts])
        here = x[[0, 2]] if freedoms == 3 else x[[0]]
        np.testing.assert_allclose(places, np.broadcast_to(here, places.shape), atol=2e-6)


@settings(max_examples=150, deadline=None)
@given(
    st.floats(-6, 7).map(lambda e: 10**e),
    st.floats(0, 0.999),
    st.floats(0.1, 3.0),
    st.floats(-3.1, 3.1),
    st.floats(1.0, 400.0),
)
def test_the_position_is_found_to_rounding_however_stiff(k3, share, frequency, yaw, speed):
    """share: of the sag offset with which the cable would snap through."""
    least = 50.0 * (2 * pi * min(frequency, 1.0)) ** 2
    section = CableSection(
        frequency_y=frequency, k2_y=0.0, k3_y=0.0, k3_z=0.0, k3=k3, sag_offset=sqrt(share * least / k3)
    )
    model = replace(paper_model(), section=section, wind=Wind(speed, yaw=yaw))
    found = model.all_states()
    assert found.certified
    assert len(found) >= 2
    for x in found:
        force = np.hypot(*model.wind_forces(tuple(x), model.parameters)[:2])
        rates = np.array(model.rhs(tuple(x), model.parameters))
        size = k3 * np.hypot(x[0], x[2]) * section.sag_offset**2 + k3 * np.hypot(x[0], x[2]) ** 3 + force
        assert np.hypot(rates[3], rates[5]) < 1e-10 * (1.0 + size)


def test_least_slope_against_a_scan():
    q = np.linspace(-4, 4, 80_001)
    for k, k2, k3 in ((1974.0, 0.0077, 0.00115), (5.0, 2.0, 0.7), (5.0, -2.0, 0.7), (3.0, 0.0, 0.0)):
        assert least_slope(k, k2, k3) == pytest.approx(
            np.min(k + 2 * k2 * q + 3 * k3 * q**2), abs=1e-2 * k2**2
        )
    assert least_slope(1.0, 1.0, 0.0) == least_slope(1.0, 0.0, -1.0) == -np.inf


def test_the_bound_on_the_sag_offset_is_sharp():
    """Just beyond k3 s² = k the slope along the plane is negative at q = -s, below it nowhere."""
    k, k3 = 50.0 * (2 * pi) ** 2, 700.0
    border = sqrt(k / k3)
    springs = {"k2_y": 0.0, "k3_y": 0.0, "k3_z": 0.0, "k3": k3}
    CableSection(**springs, sag_offset=0.999 * border)
    with pytest.raises(InputError, match=r"section\.sag_offset = 1\.69.*snap through.* must stay below 1973"):
        CableSection(**springs, sag_offset=1.01 * border)
    model = replace(
        STILL, wind=Wind(9.0, density=0.0), section=CableSection(**springs, sag_offset=0.999 * border)
    )
    for share, sign in ((0.999, -1.0), (1.01, 1.0)):
        p = {**model.parameters, "section.sag_offset": share * border}
        x = np.array([-share * border, 0.0, 0.0, 0.0, 0.0, 0.0])
        across = as_system(model).jacobian(x, p)[5, 2]
        assert np.sign(across) == sign


# ---- the tape


@pytest.mark.parametrize(("freedoms", "outside", "count"), [(3, "blend", 149), (2, "extend", 108)])
def test_without_it_the_tape_is_as_long_as_before_there_was_one(freedoms, outside, count):
    model = paper_model(outside=outside, degrees_of_freedom=freedoms)
    assert not {"section.k3", "section.sag_offset"} & set(model.parameters)
    assert len(as_system(model).tape.operations) == count
    # squares, sum, k3, two products and two differences; y alone: its square, k3, product and difference
    taut = replace(model, section=replace(model.section, k3=1.0))
    assert len(as_system(taut).tape.operations) == count + (8 if freedoms == 3 else 4)
    sagging = replace(model, section=replace(model.section, k3=1.0, sag_offset=0.1))
    assert len({m.structure for m in (model, taut, sagging)}) == 3


def test_the_tape_agrees_with_plain_numbers():
    x = np.array([0.5, 0.4, -0.4, 0.3, 2.0, 1.0])
    np.testing.assert_allclose(as_system(STILL).f(x), STILL.rhs(x, STILL.parameters), rtol=1e-13, atol=1e-13)


# ---- walks


def test_a_walk_along_the_tension_ends_where_all_states_says():
    model = replace(paper_model(), section=CableSection(k3=100.0, sag_offset=0.3), wind=Wind(20.0, yaw=0.3))
    start = model.all_states()[-1]
    branch = continue_equilibria(model, "section.k3", start=start, until=(0.0, 5000.0))
    assert branch["section.k3"][[0, -1]] == pytest.approx([0.0, 5000.0])
    end = model.all_states({"section.k3": 5000.0})[-1]
    assert [branch[name][-1] for name in ("y", "phi", "z")] == pytest.approx(list(end[:3]), abs=1e-9)
    assert abs(branch["z"][-1] - branch["z"][0]) > 1e-4


def test_a_walk_does_not_leave_what_is_allowed():
    model = replace(paper_model(), section=CableSection(k3=100.0, sag_offset=0.3))
    with pytest.raises(InputError, match=r"until for section\.sag_offset .* snap through"):
        continue_equilibria(model, "section.sag_offset", start=model.all_states()[0], until=(0.0, 30.0))


# ---- the door


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"k3": -1.0}, r"section\.k3 = -1 .*0 or more"),
        ({"k3": "x"}, r"section\.k3 = 'x' is not a number"),
        ({"k3": 10.0, "sag_offset": -0.1}, r"section\.sag_offset = -0\.1 .*0 or more"),
        (
            {"sag_offset": 0.1},
            r"section\.sag_offset = 0\.1 acts through section\.k3.*give section\.k3, or leave",
        ),
        (
            {"k3": 10.0, "k3_z": -1.0},
            r"the one in z gets ever softer; set section\.k2_z = 0 and section\.k3_z",
        ),
        (
            {"k3": 10.0, "k2_y": 200.0, "k3_y": 1.0},
            r"the one in y has the slope -11359\.4.*section\.k2_y = 0",
        ),
    ],
)
def test_what_the_section_refuses(changes, message):
    with pytest.raises(InputError, match=message):
        CableSection(**changes)


def test_what_all_states_refuses():
    model = replace(paper_model(), section=CableSection(k3=10.0, sag_offset=1.0))
    assert model.all_states({"section.sag_offset": 2.0}).certified
    with pytest.raises(InputError, match="snap through"):
        model.all_states({"section.sag_offset": 20.0})
    with pytest.raises(InputError, match=r"section\.k3 = -3"):
        model.all_states({"section.k3": -3.0})


def test_the_papers_springs_go_with_it():
    CableSection(k3=100.0, sag_offset=1.0)


def test_a_constant_force_in_closed_form():
    """One axis, no sag: k y + k3 y³ = F by Cardano."""
    drag = CoefficientSet("drag", "test", "artificial", (-pi, pi), 0.0, 1.0, 0.02)
    section = CableSection(k2_y=0.0, k3_y=0.0, k3_z=0.0, k3=5000.0)
    model = replace(paper_model(drag, "extend"), section=section).with_parameters({"wind.speed": 40.0})
    force, k = 0.5 * 1.225 * 0.1 * 40.0**2, 50.0 * (2 * pi) ** 2
    root = sqrt((force / 10000.0) ** 2 + (k / 15000.0) ** 3)
    z = np.cbrt(force / 10000.0 + root) + np.cbrt(force / 10000.0 - root)
    for x in model.all_states():
        assert x[2] == pytest.approx(z, rel=1e-13)
        assert x[0] == pytest.approx(0.0, abs=1e-15)
