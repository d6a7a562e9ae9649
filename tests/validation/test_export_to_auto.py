"""Exported models in AUTO-07p: the same derivatives, the same Hopf points, the same orbits."""

import ast
import ctypes
from pathlib import Path

import numpy as np
import pytest

import rainwind as rw
from rainwind.dynamics.find_orbit import find_orbit
from rainwind.dynamics.system import as_system
from rainwind.io.auto_export import export_to_auto, places

from .auto.auto_runner import Auto, auto_directory
from .auto.sample_case import TIGHT_TOLERANCES

pytestmark = [
    pytest.mark.validation,
    pytest.mark.skipif(auto_directory() is None, reason="AUTO-07p or gfortran is not installed"),
]


def brusselator(b=1.5):
    return rw.System(
        lambda x, p: (p.a - (p.b + 1) * x.x + x.x**2 * x.y, p.b * x.x - x.x**2 * x.y),
        ("x", "y"),
        {"a": 1.0, "b": b},
    )


def compiled(files, tmp_path):
    """AUTO with the exported equations, and the exported constants."""
    auto = Auto(files[0], tmp_path)
    lines = [line.partition(" = ") for line in files[1].read_text().splitlines()]
    return auto, {key: ast.literal_eval(value) for key, _, value in lines}


def derivatives(auto, state, par, n):
    """f, dfdu and dfdp as the Fortran gives them."""
    func = ctypes.CDLL(str(auto.shared_library())).func_
    u, p = np.array(state, dtype=float), np.zeros(60)
    p[np.array(list(par)) - 1] = list(par.values())
    f, dfdu, dfdp = np.zeros(n), np.zeros((n, n), order="F"), np.zeros((n, 60), order="F")
    pointers = [a.ctypes.data_as(ctypes.c_void_p) for a in (u, p, f, dfdu, dfdp)]
    size, two = ctypes.byref(ctypes.c_int(n)), ctypes.byref(ctypes.c_int(2))
    func(size, pointers[0], (ctypes.c_int * 2)(1, 2), pointers[1], two, *pointers[2:])
    return f, dfdu, dfdp[:, np.array(list(par)) - 1]


def every_function():
    """All operations that a tape may hold, and 16 parameters, past those that AUTO reserves."""

    def rhs(x, p):
        a, b = x
        s = rw.sin(a) * rw.cos(b) + rw.tan(a * p[0]) - rw.sinh(b) / rw.cosh(a)
        s = s + rw.asin(0.3 * a) - rw.acos(0.3 * b) + rw.atan(a * b) * rw.atan2(a, b * b + p[14])
        t = rw.exp(-a) * rw.log(b + 3.0) - rw.sqrt(b + 2.0) + (a + 2.0) ** 1.7 + rw.erf(b) * rw.tanh(-a)
        return (
            s,
            t - p[15] * 1e-3,
        )

    return rw.System(rhs, ("a", "b"), {f"p{i}": 0.1 + 0.05 * i for i in range(16)})


@pytest.mark.parametrize("model", [every_function(), rw.paper_model(), rw.paper_model(outside="extend")])
def test_values_and_derivatives(model, tmp_path, monkeypatch):
    system = as_system(model)
    if "a" in system.states:  # where it rests does not matter here
        rest = type("Rest", (), {"state": np.zeros(2)})
        monkeypatch.setattr("rainwind.io.auto_export.find_equilibrium", lambda *_: rest)
    auto, _ = compiled(export_to_auto(model, tmp_path / "out"), tmp_path)
    names = list(system.parameters)
    numbers = places(names)
    assert not set(numbers.values()) & {11, 12, 13, 14}
    n = len(system.states)
    x = np.array([0.4, 0.7, -0.2, 0.4, -1.1, 0.3])[:n]
    par = {numbers[k]: v for k, v in system.parameters.items()}
    f, dfdu, dfdp = derivatives(auto, x, par, n)
    assert f == pytest.approx(system.f(x), rel=1e-12, abs=1e-12)
    assert dfdu == pytest.approx(system.jacobian(x), rel=1e-11, abs=1e-11)
    assert dfdp == pytest.approx(system.jacobian_parameters(x, names), rel=1e-11, abs=1e-11)


def test_the_brusselators_hopf_point(tmp_path):
    files = export_to_auto(
        brusselator(), tmp_path / "out", [1.0, 1.5], along="b", until=(0.5, 4.0), name="brus"
    )
    assert [Path(file).name for file in files] == ["brus.f90", "c.brus"]
    auto, constants = compiled(files, tmp_path)
    (hopf,) = auto.run(constants | TIGHT_TOLERANCES).points("HB")
    assert hopf.parameters[1] == pytest.approx(2.0, abs=1e-6)


def test_the_papers_hopf_point(tmp_path):
    model = rw.paper_model(outside="extend").with_parameters({"wind.speed": 14.0})
    start = next(e for e in rw.find_equilibria(model) if e.kind == "unstable focus")
    files = export_to_auto(model, tmp_path / "out", start, along="wind.speed", until=(10.0, 25.0))
    auto, constants = compiled(files, tmp_path)
    (theirs,) = auto.run(constants | TIGHT_TOLERANCES).points("HB")
    (ours,) = rw.continue_equilibria(model, "wind.speed", start=start, until=(10.0, 25.0)).points("hopf")
    assert theirs.parameters[places(list(model.parameters))["wind.speed"] - 1] == pytest.approx(
        ours.parameter, abs=1e-6
    )


def orbits_in_auto(model, along, until, orbit, tmp_path):
    files = export_to_auto(model, tmp_path / "out", orbit, along=along, until=until, name="cycle")
    auto, constants = compiled(files, tmp_path)
    (tmp_path / "cycle.dat").write_bytes(files[2].read_bytes())
    run = auto.run(constants | TIGHT_TOLERANCES | {"NPR": 5, "NMX": 40})
    k = places(list(model.parameters))[along] - 1
    return [(point.parameters[k], point.parameters[10]) for point in run.labelled]


@pytest.mark.parametrize("case", ["brusselator", "paper"])
def test_auto_continues_an_exported_orbit(case, tmp_path):
    if case == "brusselator":
        model, along, until, start = brusselator(2.5), "b", (2.1, 3.0), [1.0, 2.0]
    else:
        along, until = "wind.speed", (12.0, 14.7)
        model = rw.paper_model(outside="extend").with_parameters({along: 14.0})
        rest = next(e for e in rw.find_equilibria(model) if e.kind == "unstable focus")
        start = rest.state + 0.1 * np.eye(6)[0]
    orbit = find_orbit(model, start)
    theirs = orbits_in_auto(model, along, until, orbit, tmp_path)
    assert len(theirs) > 5
    assert theirs[0] == pytest.approx((model.parameters[along], orbit.period), rel=1e-7)
    for value, period in theirs[1::3]:
        again = find_orbit(as_system(model).with_parameters({along: value}), orbit.at, period=orbit.period)
        assert again.period == pytest.approx(period, rel=1e-7)
