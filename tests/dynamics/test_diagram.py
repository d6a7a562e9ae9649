"""Diagrams of everything in one parameter: each branch once, labels known in closed form, what exists at a value."""

from dataclasses import replace
from math import pi, sqrt

import numpy as np
import pytest

import rainwind as rw
from rainwind.dynamics import cycle_zoo, zoo
from rainwind.dynamics.crossings import same_orbit
from rainwind.dynamics.diagram import angles
from rainwind.dynamics.diagram_results import Diagram
from rainwind.dynamics.find_orbit import find_orbit
from rainwind.dynamics.results import Certificate, Ended
from rainwind.errors import ComputationError, InputError
from rainwind.physics import paper_model


def of_zoo(known: zoo.Known, **options: object) -> Diagram:
    return rw.diagram(known.system, known.along, until=known.until, starts=[known.start], **options)


@pytest.mark.parametrize("ds", [0.02, 0.05, 0.2, 0.7])
def test_brusselator(ds: float):
    # Hopf at b = 1 + a^2, soft: the equilibrium (a, b/a) is stable below, one orbit above (zoo.brusselator)
    found = of_zoo(zoo.brusselator(1.0), ds=ds)
    assert [len(found.equilibria), len(found.orbits)] == [1, 1]
    (hopf,) = found.points()
    assert (hopf.kind, hopf.parameter) == ("hopf", pytest.approx(2.0, abs=1e-9))
    assert [(r.low, r.high, r.equilibria, r.orbits) for r in found.stable_ranges()] == [
        (0.2, pytest.approx(2.0), (0,), ()),
        (pytest.approx(2.0), 5.0, (), (0,)),
    ]
    assert found.audit() == []


def test_what_exists_at_a_value_is_computed_there():
    known = cycle_zoo.everything()["bautin"]
    found = rw.diagram(known.system, known.along, until=known.until)
    assert [p.kind for p in found.points()] == ["lpc", "hopf"]
    assert [p.parameter for p in found.points()] == pytest.approx([-0.25, 0.0], abs=1e-8)
    # the last values are close to the fold and to the Hopf point
    for b1 in (-0.2, -0.1234, 0.0, 0.3, 1.0, -1.0, -0.25 + 1e-7, -1e-5, -1e-7):
        exact = known.cycles({"b1": b1})
        at = found.at(b1)
        assert len(at.equilibria) == 1
        radius = sorted(float(np.hypot(*cycle.at(0.0))) for cycle in exact)
        assert sorted(orbit.amplitude["x"] for orbit in at.orbits) == pytest.approx(radius, abs=2e-6), b1
        assert all(abs(orbit.parameters["b1"] - b1) < 1e-12 and orbit.residual < 1e-8 for orbit in at.orbits)
        outer = [orbit for orbit in at.stable if isinstance(orbit, rw.Orbit)]
        assert len(outer) == (b1 > -0.25)
    assert not found.stable_at(-0.5)[0].parameters["b1"] + 0.5
    assert "2 orbits" in repr(found.at(-0.2))


def test_values_outside_are_refused():
    found = of_zoo(zoo.brusselator(), orbits=False)
    assert found.orbits == ()
    with pytest.raises(InputError, match=r"b = 7 lies outside the diagram, which goes from 0.2 to 5"):
        found.at(7.0)
    with pytest.raises(InputError, match="special point"):
        found.points("hop")


def test_branch_points_of_equilibria_are_switched_at_and_each_is_told_once():
    found = of_zoo(zoo.pitchfork())
    assert len(found.equilibria) == 2
    assert [p.kind for p in found.points()] == ["bp"]
    assert sorted(float(e.state[0]) for e in found.at(0.81).equilibria) == pytest.approx([-0.9, 0.0, 0.9])
    assert len(found.stable_at(0.81)) == 2
    assert len(of_zoo(zoo.transcritical()).equilibria) == 2


def test_lorenz_has_two_mirrored_branches():
    # Hopf at rho = sigma (sigma + beta + 3) / (sigma - beta - 1), both hard; orbits end homoclinic near 13.926
    found = of_zoo(zoo.lorenz(), mesh=rw.Mesh(20))
    assert (len(found.equilibria), len(found.orbits)) == (2, 2)
    assert [p.parameter for p in found.points("hopf")] == pytest.approx([470 / 19, 470 / 19])
    assert all(branch.ended == (Ended.AT_HOPF, Ended.HOMOCLINIC) for branch in found.orbits)
    assert [float(branch.parameter.min()) for branch in found.orbits] == pytest.approx(
        [13.92656] * 2, abs=1e-4
    )
    assert len(found.at(20.0).orbits) == 2


def test_several_starts_on_one_branch_give_it_once():
    known = zoo.closed_loop()
    once = rw.diagram(known.system, known.along, until=known.until, starts=[known.start] * 3)
    assert len(once.equilibria) == 1


def test_a_given_orbit_is_followed_and_doublings_are_switched_at():
    known = cycle_zoo.everything()["soft doubling"]
    cycle = known.start
    start = _orbit(known, cycle)
    found = rw.diagram(known.system, known.along, until=known.until, starts=[start])
    assert [p.kind for p in found.points()] == ["pd"]
    assert found.points("pd")[0].parameter == pytest.approx(0.0, abs=1e-8)
    assert len(found.orbits) == 2
    at = found.at(0.25)  # the doubled orbit has a + b z1^2 = 0, b = -1
    exact = known.cycles({"a": 0.25})
    assert sorted(orbit.period for orbit in at.orbits) == pytest.approx(
        sorted(cycle.period for cycle in exact), rel=1e-6
    )
    assert [orbit.stable for orbit in sorted(at.orbits, key=lambda orbit: orbit.period)] == [False, True]
    # between the period doubling at a = 0 and the branch's first orbit, too
    close = 0.5 * float(found.orbits[1].parameter.min())
    assert 0 < close < 3e-3
    assert sorted(orbit.period for orbit in found.at(close).orbits) == pytest.approx(
        sorted(cycle.period for cycle in known.cycles({"a": close})), rel=1e-6
    )
    assert [(r.low, r.high, r.orbits) for r in found.stable_ranges()] == [
        (-0.6, pytest.approx(0.0, abs=1e-8), (0,)), (pytest.approx(0.0, abs=1e-8), 0.6, (1,)),
    ]  # fmt: skip
    shallow = rw.diagram(known.system, known.along, until=known.until, starts=[start], depth=0)
    assert len(shallow.orbits) == 1
    assert "1 period doublings or branch points of orbits were not followed: depth = 0" in shallow.audit()


def _orbit(known: cycle_zoo.KnownCycles, cycle: cycle_zoo.Cycle) -> rw.Orbit:
    return find_orbit(known.system, cycle.at, period=cycle.period, mesh=rw.Mesh(20))


def test_orbits_are_compared_whatever_their_phase():
    known = cycle_zoo.everything()["bautin"]
    (inner, outer) = (_orbit(known, cycle) for cycle in known.cycles())
    phases = np.mod(outer.grid.nodes + 0.3, 1.0)
    shifted = replace(outer, profile=outer.grid.at(outer.profile, phases))
    assert same_orbit(outer, shifted)
    assert not same_orbit(outer, inner)
    assert not same_orbit(outer, replace(outer, profile=outer.profile + np.array([0.01, 0.0])))


def test_angles_are_found():
    assert angles(rw.diagram(paper_model(), "wind.speed", until=(9.0, 9.1), orbits=False).system).tolist() == [
        False, True, False, False, False, False,
    ]  # fmt: skip
    assert not angles(zoo.brusselator().system).any()


@pytest.fixture(scope="module")
def paper() -> Diagram:
    return rw.diagram(paper_model(outside="extend"), "wind.speed", until=(4.0, 20.0))


def test_the_sample_case_as_auto_found_it(paper: Diagram):
    # issue 3: AUTO-07p on the set 'reconstructed' with outside = extend, xi = 0.2 %
    found = [(p.kind, p.parameter) for p in paper.points()]
    assert [kind for kind, _ in found] == ["fold", "hopf", "lpc", "ns", "lpc", "hopf"]
    assert [value for _, value in found[1:]] == pytest.approx(
        [8.0639716, 10.6910438, 10.8525928, 12.6676147, 14.7990809], abs=1e-6
    )
    assert (len(paper.equilibria), len(paper.orbits)) == (2, 1)
    assert paper.audit() == []


def test_three_orbits_of_the_sample_case_at_12_m_s(paper: Diagram):
    at = paper.at(12.0)
    sizes = sorted((o.amplitude["y"], o.amplitude["z"], o.stable) for o in at.orbits)
    # half-amplitudes from AUTO-07p (issue 3)
    assert [size[:2] for size in sizes] == [
        pytest.approx((0.174, 0.551), abs=6e-4),
        pytest.approx((0.199, 0.521), abs=6e-4),
        pytest.approx((0.233, 0.203), abs=6e-4),
    ]
    assert [stable for *_, stable in sizes] == [False, False, True]
    assert len(at.equilibria) == 3


def test_attractors_of_the_sample_case(paper: Diagram):
    assert paper.stable_at(9.0) == ()
    (orbit,) = paper.stable_at(12.0)
    assert isinstance(orbit, rw.Orbit)
    (rest,) = paper.stable_at(18.0)
    assert rest["phi"] == pytest.approx(0.5278, abs=1e-4)
    # between the Hopf point and the first orbit of the branch
    (small,) = paper.stable_at(14.79907)
    assert 0 < small.amplitude["y"] < 0.01
    assert [(r.equilibria, r.orbits) for r in paper.stable_ranges()] == [((), ()), ((), (0,)), ((1,), ())]


@pytest.mark.parametrize("ds", [0.02, 0.2, 1.0])
def test_no_duplicates_whatever_the_step(ds: float):
    # with outside = blend the lower rivulet A is there at every speed: four equilibria above 8 m/s, two below
    found = rw.diagram(paper_model(), "wind.speed", until=(4.0, 20.0), ds=ds)
    assert (len(found.equilibria), len(found.orbits)) == (3, 1)
    assert [p.kind for p in found.points()] == ["fold", "hopf", "lpc", "ns", "lpc", "hopf"]
    assert [len(found.at(speed).equilibria) for speed in (4.0, 7.9, 8.0, 12.0, 20.0)] == [2, 2, 4, 4, 4]


def test_an_interrupt_keeps_what_is_done():
    told: list[tuple[int, int, str]] = []

    def stop(done: int, total: int, what: str) -> None:
        told.append((done, total, what))
        if "orbits" in what and ": 30," in what:
            raise KeyboardInterrupt

    found = of_zoo(zoo.brusselator(), progress=stop)
    assert found.interrupted
    assert len(found.equilibria) == 1
    assert len(found.orbits[0]) == 30
    assert found.audit()[0] == "interrupted by the user: branches are missing"
    assert "interrupted" in repr(found)
    assert all(0 <= done <= total for done, total, _ in told)
    assert [done for done, _, _ in told] == sorted(done for done, _, _ in told)


def test_what_cannot_be_started_is_a_note(monkeypatch: pytest.MonkeyPatch):
    def fail(*_: object, **__: object) -> None:
        raise ComputationError("Newton went astray")

    monkeypatch.setattr("rainwind.dynamics.diagram.continue_orbits", fail)
    found = of_zoo(zoo.brusselator())
    assert found.orbits == ()
    assert found.notes == ("orbits from hopf at b = 2: Newton went astray",)
    assert "note: orbits from hopf" in repr(found)


def test_a_label_without_certificate_is_no_place_to_switch(monkeypatch: pytest.MonkeyPatch):
    known = cycle_zoo.everything()["soft doubling"]
    start = _orbit(known, known.start)
    monkeypatch.setattr(Certificate, "holds", property(lambda _: False))
    doubted = rw.diagram(known.system, known.along, until=known.until, starts=[start])
    assert len(doubted.orbits) == 1
    assert any("not being certain" in fault for fault in doubted.audit())


def test_bad_input():
    system = zoo.brusselator().system
    with pytest.raises(InputError, match="no parameter 'bb'"):
        rw.diagram(system, "bb", until=(0.2, 5.0))
    with pytest.raises(InputError, match="depth = -1"):
        rw.diagram(system, "b", until=(0.2, 5.0), depth=-1)
    with pytest.raises(InputError, match="the first must be the smaller"):
        rw.diagram(system, "b", until=(5.0, 0.2))
    nowhere = rw.System(lambda x, p: [1.0 + x.x**2 + p.a**2], ("x",), {"a": 0.0})
    with pytest.raises(ComputationError, match="no equilibrium was found for a from -1 to 1"):
        rw.diagram(nowhere, "a", until=(-1.0, 1.0))


def test_tables_have_columns_of_one_length(paper: Diagram):
    tables = paper.tables()
    assert list(tables) == ["equilibria_0", "equilibria_1", "orbits_0", "special_points"]
    for columns in tables.values():
        assert len({len(column) for column in columns.values()}) == 1
    points = tables["special_points"]
    assert points["period"][1] == pytest.approx(2 * pi / 6.268258, rel=1e-6)
    orbits = tables["orbits_0"]
    assert np.all((orbits["log largest multiplier"] > 0) == (orbits["unstable"] > 0))
    assert sqrt(2) < orbits["max y"].size
