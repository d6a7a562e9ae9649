"""What is hard to detect: events at a node, events together, values that touch zero, spectra that stay on the axis."""

import numpy as np
import pytest

import rainwind as rw
from rainwind.dynamics import zoo

STEPS = (0.01, 0.05, 0.2, 1.0)


def oscillators(shift: float) -> rw.System:
    """Two Hopf normal forms of frequency 1, crossing at mu = 0 and mu = shift."""

    def rhs(x, p):
        r, s = x.a**2 + x.b**2, x.c**2 + x.d**2
        first, second = p.mu - r, p.mu - shift - s
        return first * x.a - x.b, x.a + first * x.b, second * x.c - x.d, x.c + second * x.d

    return rw.System(rhs, ("a", "b", "c", "d"), {"mu": -0.5})


def follow(system, start, until, ds):
    return rw.continue_equilibria(system, "mu", start=start, until=until, ds=ds)


@pytest.mark.parametrize("ds", STEPS)
def test_two_identical_oscillators_are_reported_as_one_unexplained_change(ds):
    branch = follow(oscillators(0.0), [0] * 4, (-1, 1.5), ds)
    assert branch.points() == ()
    (gap,) = branch.unexplained
    assert gap.change == 4
    assert gap.parameters[0]["mu"] <= 1e-9
    assert gap.parameters[1]["mu"] >= -1e-9
    assert gap.parameters[1]["mu"] - gap.parameters[0]["mu"] < 1e-8
    assert "changes by +4 and no label explains it" in branch.audit()[0]


@pytest.mark.parametrize("ds", STEPS)
@pytest.mark.parametrize("shift", [1e-2, 1e-4, 1e-7])
def test_two_equal_frequencies_that_cross_one_after_the_other(shift, ds):
    branch = follow(oscillators(shift), [0] * 4, (-1, 1.5), ds)
    assert [p.kind for p in branch.points()] == ["hopf", "hopf"]
    assert [p.parameter for p in branch.points()] == pytest.approx([0, shift], abs=1e-11)
    assert branch.audit() == []


@pytest.mark.parametrize("ds", STEPS)
def test_two_real_eigenvalues_that_cross_together_are_unexplained(ds):
    system = rw.System(lambda x, p: [p.mu * x.a - x.a**3, p.mu * x.b - x.b**3], ("a", "b"), {"mu": -0.53})
    branch = follow(system, [0, 0], (-1, 1.5), ds)
    assert branch.points() == ()
    assert [gap.change for gap in branch.unexplained] == [2]


@pytest.mark.parametrize("ds", STEPS)
def test_a_fold_and_a_branch_point_at_once(ds):
    """A pair that crosses where a real eigenvalue crosses: three at once."""

    def rhs(x, p):
        return p.mu * x.a - x.a**3, p.mu * x.b - x.c - x.b**3, x.b + p.mu * x.c

    branch = follow(rw.System(rhs, ("a", "b", "c"), {"mu": -0.53}), [0, 0, 0], (-1, 1.5), ds)
    assert [gap.change for gap in branch.unexplained] == [3]


@pytest.mark.parametrize("ds", STEPS)
@pytest.mark.parametrize("start", [-0.53, -0.5, -0.25, 1e-9, 0.125])
def test_a_pair_that_touches_the_axis_gives_no_label(start, ds):
    def rhs(x, p):
        return p.mu**2 * x.a - x.b - x.a**3, x.a + p.mu**2 * x.b - x.b**3

    branch = follow(rw.System(rhs, ("a", "b"), {"mu": start}), [0, 0], (-1, 1.5), ds)
    assert branch.points() == ()
    assert branch.audit() == []


@pytest.mark.parametrize("ds", STEPS)
def test_an_inflection_gives_no_label(ds):
    system = rw.System(lambda x, p: [p.mu - x.a**3], ("a",), {"mu": -0.53})
    branch = follow(system, [-0.8], (-1, 1.5), ds)
    assert branch.points() == ()
    assert branch.audit() == []


@pytest.mark.parametrize("ds", STEPS)
def test_real_eigenvalues_that_become_a_pair_give_no_label(ds):
    system = rw.System(lambda x, p: [-x.a + x.b, -p.mu * x.a - x.b], ("a", "b"), {"mu": -0.53})
    branch = follow(system, [0, 0], (-0.9, 1.5), ds)
    assert branch.points() == ()
    assert branch.audit() == []


@pytest.mark.parametrize("ds", STEPS)
def test_an_undamped_system_stays_on_the_axis_without_labels(ds):
    def rhs(x, p):
        pull = 0.5 * (x.y - x.x)
        return x.v, p.mu - rw.sin(x.x) + pull, x.w, -rw.sin(x.y) - pull

    system = rw.System(rhs, ("x", "v", "y", "w"), {"mu": 0.3})
    branch = follow(system, [0.3, 0, 0.1, 0], (-0.8, 0.9), ds)
    assert branch.points() == ()
    assert branch.audit() == []


@pytest.mark.parametrize("start", [0.0, 1e-12, -1e-12, 0.125, -0.125])
def test_a_node_right_on_a_hopf_point_hides_nothing(start):
    known = zoo.hopf()
    for ds in STEPS:
        branch = follow(known.system.with_parameters({"mu": start}), [0, 0], (-1, 1.5), ds)
        assert [p.kind for p in branch.points()] == ["hopf"]


@pytest.mark.parametrize("distance", [1e-2, 1e-3, 1e-4])
def test_close_folds_from_every_start(distance):
    known = zoo.close_folds(distance)
    a = known.system.parameters["a"]
    for x in (-1.1, -0.7, -0.2, 0.15, 0.6, 1.1):
        system = known.system.with_parameters({"b": x**3 - a * x})
        for ds in STEPS:
            branch = rw.continue_equilibria(system, "b", start=[x], until=known.until, ds=ds)
            assert [p.kind for p in branch.points()] == ["fold", "fold"]
            assert branch.audit() == []


@pytest.mark.parametrize("c", [0.12, -0.24, 5.0])
def test_close_folds_where_the_branch_bends_sharply(c):
    """The state in units so large that the branch seems to jump between its flat ends."""

    def rhs(x, p):
        y = (x.x - 0.7) / c
        return [c * (p.mu + 0.75e-6 * y - y**3)]

    for y in (-1.098, -0.4, 0.3, 0.9):
        system = rw.System(rhs, ("x",), {"mu": y**3 - 0.75e-6 * y})
        for ds in (0.2, 0.45, 0.787, 1.0):
            branch = follow(system, [c * y + 0.7], (-1.5, 1.5), ds)
            assert [p.kind for p in branch.points()] == ["fold", "fold"], (y, ds)


# --- the paper's branches ------------------------------------------------------------------------------


PAPER = {
    # damping ratio: speeds of fold and Hopf points along the branch, AUTO-07p to its 10 digits where it has them
    0.002: [("hopf", 8.0639715889), ("fold", 7.997047163), ("hopf", 14.799080927)],
    0.0005: [("hopf", 8.3177672134), ("fold", 7.997047163), ("hopf", 12.760467166), ("hopf", 16.9605334)],
    0.001: [("hopf", None), ("fold", 7.997047163), ("hopf", 16.154167542), ("hopf", 19.279837973)],
    # beyond the fold-Hopf point: the Hopf point is 1e-5 m/s from the fold
    0.0037: [("fold", 7.997047163), ("hopf", None), ("hopf", None)],
}
WINDOW = {"wind.speed": (4.0, 25.0), "section.damping_ratio": (1e-4, 0.02)}
FOLD_HOPF, HOPF_HOPF = (7.997047163, 0.0036812132256), (16.369468755, 0.00085985877698)


def paper_branch(damping, ds, speed=20.0):
    model = rw.paper_model(outside="extend")
    system = rw.System(model.rhs, model.states, model.parameters)
    system = system.with_parameters({"section.damping_ratio": damping, "wind.speed": speed})
    guess = (
        {"y": 0.0134, "phi": 0.5159, "z": 0.0088}
        if speed == 20.0
        else {"y": 0.00684, "phi": 0.559, "z": 0.005}
    )
    start = rw.find_equilibrium(system, guess)
    return system, rw.continue_equilibria(system, "wind.speed", start=start, until=(4, 25), ds=ds)


@pytest.mark.parametrize("ds", STEPS)
@pytest.mark.parametrize("damping", PAPER)
def test_the_labels_of_the_papers_branch(damping, ds):
    for speed in (20.0, 14.8):
        _, branch = paper_branch(damping, ds, speed)
        assert branch.audit() == []
        assert [p.kind for p in branch.points()] == [kind for kind, _ in PAPER[damping]]
        for point, (_, speed_at) in zip(branch.points(), PAPER[damping], strict=True):
            if speed_at is not None:
                assert point.parameter == pytest.approx(speed_at, abs=2e-8)


def test_the_papers_labels_are_the_same_at_every_step():
    for damping in PAPER:
        found = [[p.parameter for p in paper_branch(damping, ds)[1].points()] for ds in STEPS]
        np.testing.assert_allclose(found, np.broadcast_to(found[0], np.shape(found)), atol=1e-9)


@pytest.mark.parametrize("ds", STEPS)
@pytest.mark.parametrize("damping", [0.002, 0.0005])
def test_the_labels_of_the_papers_curves(damping, ds):
    system, branch = paper_branch(damping, 0.05)
    for start in branch.points():
        follow_curve = rw.continue_fold if start.kind == "fold" else rw.continue_hopf
        curve = follow_curve(
            system, ("wind.speed", "section.damping_ratio"), start=start, until=WINDOW, ds=ds
        )
        assert curve.audit() == []
        expected = {"zh": FOLD_HOPF} if start.kind == "fold" else {"zh": FOLD_HOPF, "hh": HOPF_HOPF}
        if 12 < start.parameter < 14:
            expected = {"gh": (12.7121572, 0.000493720868), "hh": HOPF_HOPF}
        assert {p.kind for p in curve.points()} == set(expected)
        assert len(curve.points()) == len(expected)
        for kind, (speed, ratio) in expected.items():
            (point,) = curve.points(kind)
            assert point["wind.speed"] == pytest.approx(speed, abs=1e-7)
            assert point["section.damping_ratio"] == pytest.approx(ratio, abs=1e-10)
