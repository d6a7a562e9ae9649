"""What is written for AUTO-07p; tests/validation/test_export_to_auto.py runs it there."""

import ast

import numpy as np
import pytest

import rainwind as rw
from rainwind.dynamics.find_orbit import find_orbit
from rainwind.errors import InputError
from rainwind.io.auto_export import export_to_auto, places


def oscillator(**more):
    def rhs(x, p):
        growth = p.mu - x["θ"] ** 2 - x.y**2
        return growth * x["θ"] - x.y, x["θ"] + growth * x.y

    return rw.System(rhs, ("θ", "y"), {"mu": 0.25, **more})


def constants(path):
    lines = [line.partition(" = ") for line in path.read_text(encoding="ascii").splitlines()]
    return {key: ast.literal_eval(value) for key, _, value in lines}


def test_parameters_pass_over_those_that_auto_reserves():
    names = [f"p{i}" for i in range(13)]
    assert list(places(names).values()) == [*range(1, 11), 15, 16, 17]


def test_an_equilibrium(tmp_path):
    model = oscillator(**{f"p{i}": 1.0 + i for i in range(40)})
    files = export_to_auto(model, tmp_path / "a" / "b", along="p20", until=(0.0, 30.0), name="osc_1")
    assert [file.name for file in files] == ["osc_1.f90", "c.osc_1"]
    found = constants(files[1])
    assert (found["IPS"], found["ICP"], found["UZSTOP"], found["NPAR"]) == (1, [26], {26: [0.0, 30.0]}, 45)
    assert found["unames"] == {1: "_", 2: "y"}
    assert found["parnames"] | {11: "period", 26: "p20"} == found["parnames"]
    text = files[0].read_text(encoding="ascii")
    assert "  par(26) = 21.0d0  ! p20" in text
    assert max(map(len, text.splitlines())) <= 132  # Fortran's limit


def test_an_orbit(tmp_path):
    orbit = find_orbit(oscillator(), [0.1, 0.0])
    files = export_to_auto(oscillator().with_parameters({"mu": 9.0}), tmp_path, orbit)
    found = constants(files[1])
    assert (found["IPS"], found["ICP"], found["dat"], found["NCOL"]) == (2, [1, 11], "model", 4)
    assert "  par(1) = 0.25d0  ! mu" in files[0].read_text(encoding="ascii")  # the orbit's, not the model's
    data = np.loadtxt(files[2])
    assert data[[0, -1], 0] == pytest.approx([0.0, orbit.period])
    assert np.all(np.diff(data[:, 0]) > 0)
    assert np.hypot(data[:, 1], data[:, 2]) == pytest.approx(0.5, abs=1e-8)


@pytest.mark.parametrize(
    ("model", "options", "message"),
    [
        (rw.System(lambda x, p: -x.y, ("y",)), {}, "this system has none"),
        (oscillator(), {"name": "my model"}, "letters, digits and _"),
        (oscillator(), {"along": "nu"}, "nu"),
        (oscillator(), {"until": (1.0, 2.0)}, r"mu = 0\.25 lies outside until"),
        (oscillator(), {"until": 3.0}, r"until must be two numbers \(low, high\)"),
        (oscillator(), {"start": [1.0]}, "a state is 2 finite numbers"),
    ],
)
def test_bad_input(model, options, message, tmp_path):
    with pytest.raises(InputError, match=message):
        export_to_auto(model, tmp_path, **options)


def test_a_start_of_another_system_and_a_folder_that_cannot_be(tmp_path):
    other = rw.find_equilibrium(rw.System(lambda x, p: p.a - x.z, ("z",), {"a": 1.0}))
    with pytest.raises(InputError, match="give a start of this system"):
        export_to_auto(oscillator(), tmp_path, other)
    (tmp_path / "file").write_text("", encoding="utf-8")
    with pytest.raises(InputError, match="cannot be written"):
        export_to_auto(oscillator(), tmp_path / "file")
