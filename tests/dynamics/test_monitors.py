"""Functions of the user along a walk: columns, events at closed-form places, walks that stop in one."""

from math import sqrt

import numpy as np
import pytest

import rainwind as rw
from rainwind.dynamics import zoo
from rainwind.dynamics.results import Branch, Ended
from rainwind.errors import InputError

BRUSSELATOR = zoo.brusselator(1.0)  # equilibrium (a, b / a)


def branch(*monitors: rw.Monitor, ds: float = 0.05, **changes: object) -> Branch:
    known = BRUSSELATOR
    return rw.continue_equilibria(
        known.system, "b", start=known.start, until=known.until, ds=ds, monitors=monitors, **changes
    )  # fmt: skip


def test_a_column_under_its_name():
    found = branch(rw.Monitor("sum", lambda e: e["x"] + e["y"]))
    assert found["sum"] == pytest.approx(1.0 + found["b"], abs=1e-9)
    assert len(found["sum"]) == len(found)
    assert [p.kind for p in found.points()] == ["hopf"]
    with pytest.raises(InputError, match="Known: b, x, y, sum"):
        found["summ"]


@pytest.mark.parametrize("ds", [0.01, 0.05, 0.2, 1.0])
def test_events_lie_where_they_must(ds: float):
    # y = b; the largest real part of the eigenvalues is (b - 2) / 2 about the Hopf point: -1/4 at b = 1.5
    found = branch(
        rw.Monitor("height", lambda e: e["y"] - 3.21, "label"),
        rw.Monitor("growth", lambda e: e.eigenvalues[0].real + 0.25, "label"),
        ds=ds,
    )
    assert [(p.kind, p.note) for p in found.points()] == [
        ("event", "growth"), ("hopf", ""), ("event", "height"),
    ]  # fmt: skip
    assert [p.parameter for p in found.points("event")] == pytest.approx([1.5, 3.21], abs=1e-9)
    assert all(p.certificate.holds for p in found.points())
    assert np.all(np.diff([p.arclength for p in found.points()]) > 0)
    assert found.audit() == []


@pytest.mark.parametrize("ds", [0.05, 1.0])
def test_a_walk_stops_in_the_zero(ds: float):
    found = branch(rw.Monitor("height", lambda e: e["y"] - 3.21, "stop"), ds=ds)
    assert found.ended == (Ended.AT_BOUND, Ended.AT_CONDITION)
    assert found["b"][-1] == pytest.approx(3.21, abs=1e-9)
    assert found["height"][-1] == pytest.approx(0.0, abs=1e-9)
    (event,) = found.points("event")
    assert event.arclength == pytest.approx(found.arclength[-1])
    assert found.audit() == []


def test_both_ends_may_stop():
    found = branch(rw.Monitor("box", lambda e: abs(e["b"] - 0.5) - 0.125, "stop"))
    assert found.ended == (Ended.AT_CONDITION, Ended.AT_CONDITION)
    assert found["b"][[0, -1]] == pytest.approx([0.375, 0.625], abs=1e-9)
    assert len(found.points("event")) == 2


def test_on_curves():
    # Hopf points of the Brusselator at b = 1 + a^2; b = 5 where a = 2
    (hopf,) = branch().points("hopf")
    curve = rw.continue_hopf(
        BRUSSELATOR.system, ("a", "b"), start=hopf, until={"a": (0.1, 3.0), "b": (0.2, 8.0)},
        monitors=[
            rw.Monitor("five", lambda e: e["b"] - 5.0, "label"),
            rw.Monitor("slow", lambda e: e["a"] - 0.5, "stop"),
        ],
    )  # fmt: skip
    assert [(p.note, p["a"], p["b"]) for p in curve.points("event")] == [
        ("slow", pytest.approx(0.5), pytest.approx(1.25)), ("five", pytest.approx(2.0), pytest.approx(5.0)),
    ]  # fmt: skip
    assert curve.ended == (Ended.AT_CONDITION, Ended.AT_BOUND)
    assert curve["a"][0] == pytest.approx(0.5, abs=1e-9)
    # folds of the cubic b + a x - x^3 lie at x = +-sqrt(a / 3)
    known = zoo.cusp()
    fold = rw.continue_equilibria(known.system, "b", start=known.start, until=known.until).points("fold")[0]
    folds = rw.continue_fold(
        known.system, ("b", "a"), start=fold, until=known.curves[0].until,
        monitors=[rw.Monitor("one", lambda e: e["a"] - 1.0, "label")],
    )  # fmt: skip
    assert sorted(p["x"] for p in folds.points("event")) == pytest.approx([-sqrt(1 / 3), sqrt(1 / 3)])


def test_a_jump_is_no_zero():
    found = branch(rw.Monitor("step", lambda e: 1.0 if e["b"] > 3.0 else -1.0, "label"))
    assert [p.kind for p in found.points("event")] in ([], ["event"])
    assert all(not p.certificate.holds for p in found.points("event"))


def test_where_it_is_not_a_number_nothing_is_found():
    found = branch(
        rw.Monitor("root", lambda e: float(np.sqrt(e["b"] - 3.0)) if e["b"] > 3 else np.nan, "label")
    )
    assert found.points("event") == ()
    assert np.isnan(found["root"]).any()


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: rw.Monitor("", abs), "name must be a word"),
        (lambda: rw.Monitor("a", 3.0), "function must be callable"),  # type: ignore[arg-type]
        (lambda: rw.Monitor("a", abs, "halt"), "choose record, label or stop"),  # type: ignore[arg-type]
        (lambda: branch(rw.Monitor("x", abs)), "'x': a column of this name is there already"),
        (
            lambda: branch(*[rw.Monitor("s", lambda e: 1.0)] * 2),
            "'s': a column of this name is there already",
        ),
        (lambda: branch(lambda e: 1.0), "monitors are rw.Monitor"),  # type: ignore[arg-type]
        (lambda: branch(rw.Monitor("s", lambda e: e.state)), "must give one real number"),
    ],
)
def test_bad_input(make, words: str):
    with pytest.raises(InputError, match=words):
        make()
