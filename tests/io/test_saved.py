"""Branches, curves and orbits saved, loaded, compared, and continued from."""

import dataclasses
from contextlib import suppress

import numpy as np
import pytest

import rainwind as rw
from rainwind.dynamics import cycle_zoo
from rainwind.dynamics.collocation import Grid
from rainwind.dynamics.find_orbit import find_orbit
from rainwind.errors import InputError
from rainwind.io import saved
from rainwind.io.results import Column, Table, load_netcdf, save_netcdf
from rainwind.io.saved import load, save, table


def same(a, b):
    """Equal in every field, every digit and every type of array."""
    if dataclasses.is_dataclass(a):
        return type(a) is type(b) and all(
            same(getattr(a, f.name), getattr(b, f.name)) for f in dataclasses.fields(a)
        )
    if isinstance(a, np.ndarray):
        return a.dtype == b.dtype and a.shape == b.shape and a.tobytes() == b.tobytes()
    if isinstance(a, tuple):
        return isinstance(b, tuple) and len(a) == len(b) and all(map(same, a, b))
    if isinstance(a, dict):
        return list(a) == list(b) and all(same(a[k], b[k]) for k in a)
    return a == b or (a != a and b != b)


def brusselator():
    return rw.System(
        lambda x, p: (p.a - (p.b + 1) * x.x + x.x**2 * x.y, p.b * x.x - x.x**2 * x.y),
        ("x", "y"),
        {"a": 1.0, "b": 1.5},
    )


@pytest.fixture(scope="module")
def equilibria():
    return rw.continue_equilibria(brusselator(), "b", start=[1.0, 1.5], until=(0.5, 4.0))


@pytest.fixture(scope="module")
def orbits(equilibria):
    (hopf,) = equilibria.points("hopf")
    return rw.continue_orbits(brusselator(), "b", start=hopf, until=(0.5, 2.4), ds=0.1)


def round_trip(result, folder):
    save(result, folder / "a.nc")
    return load(folder / "a.nc")


def test_equilibria_and_restart_from_their_hopf_point(equilibria, orbits, tmp_path):
    back = round_trip(equilibria, tmp_path)
    assert same(equilibria, back)
    (hopf,) = back.points("hopf")
    again = rw.continue_orbits(brusselator(), "b", start=hopf, until=(0.5, 2.4), ds=0.1)
    assert same(orbits, again)


def test_a_curve(equilibria, tmp_path):
    (hopf,) = equilibria.points("hopf")
    curve = rw.continue_hopf(brusselator(), ("a", "b"), start=hopf, until={"a": (0.5, 2.0), "b": (0.5, 8.0)})
    back = round_trip(curve, tmp_path)
    assert same(curve, back)
    assert back["b"] == pytest.approx(1 + back["a"] ** 2, abs=1e-8)


def test_orbits_and_restart_from_one(orbits, tmp_path):
    back = round_trip(orbits, tmp_path)
    assert same(orbits, back)
    walks = [
        rw.continue_orbits(brusselator(), "b", start=b[-1], until=(2.2, 2.6), ds=0.1) for b in (orbits, back)
    ]
    assert same(*walks)


@pytest.mark.parametrize("kind", ["pd", "bp"])
def test_restart_from_a_label(kind, tmp_path):
    known = cycle_zoo.twisted.doubling() if kind == "pd" else cycle_zoo.suspended.pitchfork()
    cycle = known.start
    start = find_orbit(
        known.system, lambda t: cycle.at(t) + 1e-3 * np.sin(2 * np.pi * t / cycle.period), period=cycle.period
    )
    branch = rw.continue_orbits(known.system, known.along, start=start, until=known.until, ds=0.1)
    back = round_trip(branch, tmp_path)
    assert same(branch, back)
    walks = [
        rw.continue_orbits(
            known.system, known.along, start=b.points(kind)[0], until=known.until, ds=0.1, limit=5
        )
        for b in (branch, back)
    ]
    assert len(walks[0]) > 2
    assert same(*walks)


def test_one_orbit_and_one_point(orbits, equilibria, tmp_path):
    assert same(orbits[3], round_trip(orbits[3], tmp_path))
    (hopf,) = equilibria.points("hopf")
    assert same(hopf, round_trip(hopf, tmp_path))
    rest = rw.find_equilibrium(brusselator(), [1.0, 1.5])
    assert same(rest, round_trip(rest, tmp_path))


def test_a_system_of_one_state_without_labels_and_one_without_parameters(tmp_path):
    line = rw.System(lambda x, p: p["a/b"] - x["x/y"], ("x/y",), {"a/b": 1.0})
    branch = rw.continue_equilibria(line, "a/b", until=(0.0, 2.0))
    assert same(branch, round_trip(branch, tmp_path))
    free = rw.System(lambda x, p: (x.y, (1 - x.x**2) * x.y - x.x), ("x", "y"))
    orbit = find_orbit(free, {"x": 1.0})
    assert same(orbit, round_trip(orbit, tmp_path))


def test_units_are_there_for_other_programs(tmp_path):
    model = rw.paper_model()
    branch = rw.continue_equilibria(
        model, "wind.speed", start=rw.find_equilibria(model)[0], until=(8.0, 12.0)
    )
    save(branch, tmp_path / "a.nc")
    columns = load_netcdf(tmp_path / "a.nc")["columns"]
    assert {n: columns[n].attrs["units"] for n in ("wind.speed", "phi", "z_dot", "unstable")} == {
        "wind.speed": "m/s", "phi": "rad", "z_dot": "m/s", "unstable": "1"
    }  # fmt: skip
    assert columns["phi"].values.tolist() == branch["phi"].tolist()
    assert same(branch, load(tmp_path / "a.nc"))


def test_csv_holds_the_columns(orbits, equilibria, tmp_path):
    save(orbits, tmp_path / "a.csv")
    lines = (tmp_path / "a.csv").read_text(encoding="utf-8").splitlines()
    assert lines[0] == "b,period,x,max x,min x,mean x,y,max y,min y,mean y,unstable,mesh_error,arclength"
    assert len(lines) == len(orbits) + 1
    assert float(lines[3].split(",")[1]) == orbits[2].period
    for result in (equilibria, orbits[0], equilibria.special[0]):
        save(result, tmp_path / "b.csv")
    assert list(table(orbits[0]).columns) == ["time", "x", "y"]
    with pytest.raises(InputError, match="holds columns only"):
        load(tmp_path / "a.csv")


def test_foreign_and_damaged_files(orbits, tmp_path):
    path = tmp_path / "a.nc"
    with pytest.raises(InputError, match="cannot be read"):
        load(path)
    path.write_text("junk", encoding="utf-8")
    with pytest.raises(InputError, match="no netCDF-4 file"):
        load(path)
    save_netcdf(path, {"other": Table({"x": Column([1.0])})}, source="a test", version="0")
    with pytest.raises(InputError, match="no branch, curve or orbit that rainwind saved"):
        load(path)
    save(orbits, path)
    whole = path.read_bytes()
    path.write_bytes(whole[: len(whole) // 2])
    with pytest.raises(InputError):
        load(path)
    at = whole.index(orbits[4].profile[1:4, 0].tobytes())  # one digit of one number
    path.write_bytes(whole[:at] + bytes([whole[at] ^ 1]) + whole[at + 1 :])
    with pytest.raises(InputError, match="damaged"):
        load(path)
    facts = whole.replace(b'{\\"format\\": 1', b'{\\"format\\": 9').replace(b'{"format": 1', b'{"format": 9')
    path.write_bytes(facts)
    with pytest.raises(InputError, match="newer version"):
        load(path)


@pytest.mark.parametrize("what", [3, None, Grid(np.linspace(0, 1, 5), 4)])
def test_only_results_can_be_saved(what, tmp_path):
    with pytest.raises(InputError, match="can be saved; got"):
        save(what, tmp_path / "a.nc")


@pytest.mark.parametrize("name", ["a", "a.txt", "a.nc4", "a.xlsx"])
def test_an_ending_that_cannot_be_written_is_refused(name, orbits, tmp_path):
    with pytest.raises(InputError, match=r"end it with \.nc"):
        save(orbits[0], tmp_path / name)
    assert list(tmp_path.iterdir()) == []


def test_what_to_do_with_a_csv_file(tmp_path):
    with pytest.raises(InputError, match=r"save the result once more under a name that ends with \.nc"):
        load(tmp_path / "o.csv")


@pytest.mark.parametrize("step", ["load_netcdf", "_Read"])
def test_a_fault_of_the_program_is_not_called_a_damaged_file(step, orbits, tmp_path, monkeypatch):
    save(orbits[0], tmp_path / "a.nc")

    def broken(*_):
        raise ZeroDivisionError

    monkeypatch.setattr(f"rainwind.io.saved.{step}", broken)
    with pytest.raises(ZeroDivisionError):
        load(tmp_path / "a.nc")


def test_a_result_that_this_version_does_not_know(equilibria, tmp_path, monkeypatch):
    save(equilibria, tmp_path / "a.nc")
    monkeypatch.delitem(saved._CLASSES, "Certificate")
    with pytest.raises(InputError, match="'Certificate', which this version of rainwind does not know"):
        load(tmp_path / "a.nc")


@pytest.mark.filterwarnings(
    "ignore::pytest.PytestUnraisableExceptionWarning"
)  # h5netcdf's, of a file half open
def test_a_file_with_changed_bytes_is_damaged_or_whole(equilibria, tmp_path):
    path = tmp_path / "a.nc"
    save(equilibria, path)
    whole = path.read_bytes()
    random = np.random.default_rng(3)
    for _ in range(60):
        changed = bytearray(whole)
        at = int(random.integers(len(whole)))
        changed[at : at + 8] = random.bytes(len(changed[at : at + 8]))
        path.write_bytes(changed)
        with suppress(InputError):
            assert same(equilibria, load(path))
