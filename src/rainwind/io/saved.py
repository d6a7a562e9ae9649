"""Results out and in again, complete: a loaded branch, orbit or trajectory serves as the first one does.

One netCDF-4 file holds the columns as named arrays with units, for any tool that reads netCDF, and the rest (labels,
certificates, why it ended) as one JSON text in the group `facts`, which refers to numbered arrays and orbits.
"""

import dataclasses
import hashlib
import json
from collections.abc import Mapping, Sequence
from enum import Enum
from pathlib import Path
from typing import Any

import numpy as np

from rainwind import __version__
from rainwind.dynamics.collocation import Grid
from rainwind.dynamics.ensemble_results import Ensemble
from rainwind.dynamics.events import Crossings
from rainwind.dynamics.orbit_results import Orbit, OrbitBranch, OrbitPoint
from rainwind.dynamics.pieces import Pieces
from rainwind.dynamics.results import Branch, Certificate, Ended, Equilibrium, SpecialPoint, Unexplained
from rainwind.dynamics.trajectory import Excursion, RunEnded, Trajectory
from rainwind.errors import InputError
from rainwind.io.results import Column, Table, load_netcdf, save_csv, save_netcdf
from rainwind.io.schema import NUMBERS

__all__ = ["load", "save", "table"]

FORMAT = 1
Result = Branch | OrbitBranch | Orbit | Equilibrium | SpecialPoint | Trajectory | Ensemble
_SAVED = (
    Branch, OrbitBranch, Equilibrium, SpecialPoint, OrbitPoint, Certificate, Unexplained, Grid, Trajectory, Pieces,
    Crossings, Excursion, Ensemble,
)  # fmt: skip
_CLASSES = {kind.__name__: kind for kind in _SAVED}
_STATE_UNITS = {"y": "m", "z": "m", "phi": "rad", "y_dot": "m/s", "z_dot": "m/s", "phi_dot": "rad/s"}
# one number an orbit each: the period, what checks it, and whatever another version adds
_NOT_NUMBERS = ("states", "parameters", "grid", "profile", "exponents")
_NUMBERS = tuple(f.name for f in dataclasses.fields(Orbit) if f.name not in _NOT_NUMBERS)


def save(result: Result, path: Path | str) -> None:
    """Write a branch, a curve, an orbit, a trajectory or an ensemble to a netCDF-4 file; `load` gives it back complete.

    The path ends with .nc; one that ends with .csv gets the table of its columns instead, which cannot be loaded
    again. Raises InputError for what is no result, for another ending, and where the file cannot be written.
    """
    if not isinstance(result, Result):
        raise InputError(
            f"a branch, a curve, an orbit, a trajectory, an ensemble or a point can be saved; got "
            f"{type(result).__name__}"
        )
    ending = Path(path).suffix.lower()
    if ending not in (".nc", ".csv"):
        raise InputError(
            f"{path}: '{ending}' is no ending of a file that can be written; end it with .nc, which can be loaded "
            "again, or with .csv for a table"
        )
    if ending == ".csv":
        save_csv(path, table(result))
        return
    parts = _Parts()
    facts = {"format": FORMAT, "result": parts.plain(result)}
    units = _units(result.states, _parameters(result))
    tables = parts.tables(units)
    if isinstance(result, Branch | OrbitBranch | Trajectory | Ensemble):
        tables["columns"] = table(result)  # for other programs to read: `load` does not
    tables["facts"] = Table({"json": Column([json.dumps(facts)])}, {"digest": ""})
    tables["facts"] = dataclasses.replace(
        tables["facts"], attributes={"digest": _digest({n: dict(t.columns) for n, t in tables.items()})}
    )
    save_netcdf(path, tables, source=f"a saved {type(result).__name__}", version=__version__)


def load(path: Path | str) -> Any:
    """The result that `save` wrote. Raises InputError for any other file, and for a damaged one."""
    if Path(path).suffix.lower() == ".csv":
        raise InputError(
            f"{path}: a CSV file holds columns only and cannot be loaded; save the result once more under a name that "
            "ends with .nc, and load that"
        )
    foreign = f"{path}: this is no branch, curve or orbit that rainwind saved"
    damaged = f"{path}: the file is damaged; save it again"
    try:
        groups = load_netcdf(path)
    except InputError:
        raise
    # what h5py and h5netcdf raise of a broken file: bad links, names, types and texts
    except (LookupError, AttributeError, RuntimeError, TypeError, ValueError) as error:
        raise InputError(damaged) from error
    if "facts" not in groups or "json" not in groups["facts"]:
        raise InputError(foreign)
    try:
        facts = json.loads(str(groups["facts"]["json"].values[0]))
        if facts["format"] > FORMAT:
            raise InputError(f"{path}: written by a newer version of rainwind; install that")
        kept = groups["facts"].attrs["digest"]
    except (json.JSONDecodeError, LookupError, TypeError) as error:
        raise InputError(damaged) from error
    tables = {name: {k: v.values for k, v in group.items()} for name, group in groups.items() if name}
    if _digest(tables) != kept:
        raise InputError(damaged)
    # nothing is damaged: what fails now is a fault of the program, and is shown as one
    return _Read(tables).revived(facts["result"])


def table(result: Result) -> Table:
    """The columns of a branch or curve as a table: parameters, states (of orbits half peak-to-peak, largest, smallest
    and mean), stability, arclength."""
    units = _units(result.states, _parameters(result))
    if isinstance(result, Branch):
        columns = {
            name: Column(result[name], units.get(name, "")) for name in (*result.along, *result.states)
        }
        columns["unstable"] = Column(result.unstable, meaning="number of unstable eigenvalues")
        columns["residual"] = Column(result.residual)
        columns["arclength"] = Column(result.arclength)
        return Table(_escaped(columns), {"kind": result.kind})
    if isinstance(result, OrbitBranch):
        columns = {name: Column(result.column(name), units.get(name, "")) for name in result.along}
        columns["period"] = Column(result.column("period"), units.get("period", ""))
        for name in result.states:
            for kind, meaning in (("", "half peak-to-peak"), ("max ", ""), ("min ", ""), ("mean ", "")):
                columns[kind + name] = Column(result.column(kind + name), units.get(name, ""), meaning)
        for name in ("unstable", "mesh_error"):
            columns[name] = Column(result.column(name))
        columns["arclength"] = Column(result.arclength)
        return Table(_escaped(columns), {"kind": result.kind})
    if isinstance(result, Orbit):
        columns = {"time": Column(result.times, units.get("period", ""), dimensions=("node",))}
        for name in result.states:
            columns[f"state {name}" if name == "time" else name] = Column(
                result[name], units.get(name, ""), dimensions=("node",)
            )
        return Table(_escaped(columns), {"kind": "orbit", "period": result.period})
    if isinstance(result, Trajectory):
        columns = {"time": Column(result.times, "s" if units else "")}
        for name in (*result.states, *result.driven_names):
            label = f"state {name}" if name == "time" else name
            columns[label] = Column(result[name], units.get(name, ""))
        return Table(_escaped(columns), {"kind": "trajectory", "ended": result.ended.value})
    if isinstance(result, Ensemble):
        columns = {f"start {name}" if name in result.states else name: Column(v, units.get(name, ""))
                   for name, v in result.varied.items()}  # fmt: skip
        columns |= {f"final {name}": Column(result[name], units.get(name, "")) for name in result.states}
        columns["end_time"] = Column(result.times, "s" if units else "")
        columns["ended"] = Column([one.value for one in result.ended])
        for name, array in result.values.items():
            for k, label in enumerate(result.columns[name] or ("",)):
                column = array if result.columns[name] is None else array[:, k]
                columns[f"{name} {label}".strip()] = Column(column)
        return Table(_escaped(columns), {"kind": "ensemble", "duration": result.duration})
    names = (*result.parameters, *result.states)
    values = (*result.parameters.values(), *result.state.tolist())
    return Table(_escaped({n: Column([v], units.get(n, "")) for n, v in zip(names, values, strict=True)}))


class _Parts:
    """A result taken apart: a tree of plain values that refers to numbered arrays and orbits."""

    def __init__(self) -> None:
        self.arrays: list[np.ndarray] = []
        self.orbits: list[Orbit] = []

    def plain(self, value: Any) -> Any:
        """What JSON can hold; numbers keep every digit."""
        if isinstance(value, np.generic):
            value = value.item()
        if value is None or isinstance(value, bool | str | int | float):
            return value
        if isinstance(value, complex):
            return {"complex": [value.real, value.imag]}
        if isinstance(value, RunEnded):
            return {"run ended": value.name}
        if isinstance(value, Enum):
            return {"ended": value.name}
        if isinstance(value, np.ndarray):
            self.arrays.append(value)
            return {"array": len(self.arrays) - 1}
        if isinstance(value, Orbit):
            known = [k for k, orbit in enumerate(self.orbits) if orbit is value]
            if not known:
                self.orbits.append(value)
            return {"orbit": known[0] if known else len(self.orbits) - 1}
        if isinstance(value, Mapping):
            return {"map": [[key, self.plain(item)] for key, item in value.items()]}
        if isinstance(value, tuple | list):
            return {"tuple": [self.plain(item) for item in value]}
        name = type(value).__name__
        if name not in _CLASSES:
            raise InputError(f"a {name} cannot be saved")
        return {"class": name, "fields": {f.name: self.plain(getattr(value, f.name)) for f in _fields(value)}}

    def tables(self, units: Mapping[str, str]) -> dict[str, Table]:
        """The arrays and the orbits."""
        found = {}
        if self.arrays:
            found["arrays"] = Table(
                {k: v for i, a in enumerate(self.arrays) for k, v in _columns(f"a{i}", a).items()}
            )
        if not self.orbits:
            return found
        orbits, first = self.orbits, self.orbits[0]
        columns: dict[str, Column] = {}
        for name in _NUMBERS:
            values = np.array([getattr(orbit, name) for orbit in orbits])
            columns |= _columns(name, values, ("orbit",), units.get(name, ""))
        for name in first.parameters:
            values = [orbit.parameters[name] for orbit in orbits]
            columns[f"parameter {_safe(name)}"] = Column(values, units.get(name, ""), dimensions=("orbit",))
        columns |= _columns(
            "exponents", np.array([orbit.exponents for orbit in orbits]), ("orbit", "exponent")
        )
        columns["degree"] = Column([orbit.grid.degree for orbit in orbits], dimensions=("orbit",))
        columns["intervals"] = Column([len(orbit.grid.lengths) for orbit in orbits], dimensions=("orbit",))
        columns["states"] = Column(list(first.states), dimensions=("state",))
        columns["parameters"] = Column(
            np.array(list(first.parameters), dtype=object), dimensions=("parameter",)
        )
        found["orbits"] = Table({name: c for name, c in columns.items() if np.size(c.values)})
        meshes = np.concatenate([orbit.grid.times for orbit in orbits])
        found["meshes"] = Table({"phase": Column(meshes, "", "time / period", ("mesh_point",))})
        profiles = np.concatenate([orbit.profile for orbit in orbits])
        found["profiles"] = Table(
            {
                f"state {_safe(name)}": Column(profiles[:, k], units.get(name, ""), dimensions=("node",))
                for k, name in enumerate(first.states)
            }
        )
        return found


class _Read:
    """The parts of a file, put together again."""

    def __init__(self, tables: Mapping[str, Mapping[str, np.ndarray]]) -> None:
        self.arrays = tables.get("arrays", {})
        self.orbits = _orbits(tables) if "orbits" in tables else []

    def revived(self, value: Any) -> Any:
        """What `_Parts.plain` was given."""
        if not isinstance(value, dict):
            return value
        ((kind, of), *_) = value.items()
        if kind == "complex":
            return complex(of[0], of[1])
        if kind == "ended":
            return _of_this_version(Ended.__members__, of)
        if kind == "run ended":
            return RunEnded[of]
        if kind == "array":
            return _array(self.arrays, f"a{of}")
        if kind == "orbit":
            return self.orbits[of]
        if kind == "map":
            return {key: self.revived(item) for key, item in of}
        if kind == "tuple":
            return tuple(self.revived(item) for item in of)
        kind = _of_this_version(_CLASSES, of)
        known = {f.name for f in dataclasses.fields(kind)}
        # a field that this version no longer has is left out, one that the file lacks takes its default
        fields = {name: self.revived(item) for name, item in value["fields"].items() if name in known}
        return kind(**fields)


def _of_this_version(known: Mapping[str, Any], name: str) -> Any:
    if name not in known:
        raise InputError(
            f"the file holds a '{name}', which this version of rainwind does not know; install a newer one"
        )
    return known[name]


def _orbits(tables: Mapping[str, Mapping[str, np.ndarray]]) -> list[Orbit]:
    columns, meshes, profiles = tables["orbits"], tables["meshes"]["phase"], tables["profiles"]
    states = tuple(map(str, columns["states"]))
    parameters = tuple(map(str, columns.get("parameters", ())))
    every = np.stack([profiles[f"state {_safe(name)}"] for name in states], axis=1)
    many, degrees = columns["intervals"], columns["degree"]
    exponents = _array(columns, "exponents").astype(complex)
    numbers = {name: _array(columns, name) for name in _NUMBERS}
    found: list[Orbit] = []
    mesh = node = 0
    for i in range(len(many)):
        times = np.array(meshes[mesh : mesh + many[i] + 1])
        mesh += many[i] + 1
        length = many[i] * degrees[i] + 1
        before = found[-1].grid if found else None
        same = before is not None and before.degree == degrees[i] and np.array_equal(before.times, times)
        found.append(
            Orbit(
                states=states,
                parameters={name: float(columns[f"parameter {_safe(name)}"][i]) for name in parameters},
                grid=before if same and before is not None else Grid(times, int(degrees[i])),
                profile=every[node : node + length].copy(),
                exponents=exponents[i],
                **{name: values[i].item() for name, values in numbers.items()},
            )
        )
        node += length
    return found


def _columns(
    name: str, array: np.ndarray, dimensions: tuple[str, ...] | None = None, unit: str = ""
) -> dict[str, Column]:
    """One array; netCDF knows no complex numbers, and no arrays of length zero."""
    dimensions = dimensions or tuple(f"{name}_{k}" for k in range(array.ndim))
    if array.size == 0:
        return {f"{name}.empty": Column(np.array(array.shape), dimensions=(f"{name}_shape",))}
    if np.iscomplexobj(array):
        parts = {"real": np.real(array), "imag": np.imag(array)}
        return {
            f"{name}.{part}": Column(values, unit, dimensions=dimensions) for part, values in parts.items()
        }
    return {name: Column(array, unit, dimensions=dimensions)}


def _array(arrays: Mapping[str, np.ndarray], name: str) -> np.ndarray:
    if f"{name}.empty" in arrays:
        return np.zeros(tuple(arrays[f"{name}.empty"].tolist()))
    if name in arrays:
        return np.array(arrays[name])
    found = np.empty(arrays[f"{name}.real"].shape, dtype=complex)
    found.real, found.imag = arrays[f"{name}.real"], arrays[f"{name}.imag"]  # keeps the sign of a zero
    return found


def _fields(value: Any) -> Sequence[dataclasses.Field[Any]]:
    return [f for f in dataclasses.fields(value) if f.init]


def _digest(tables: Mapping[str, Mapping[str, Any]]) -> str:
    """What changes when any number of any table changes."""
    found = hashlib.sha256()
    for name in sorted(tables):
        for label in sorted(tables[name]):
            column = tables[name][label]
            values = np.asarray(column.values if isinstance(column, Column) else column)
            found.update(f"{name}/{label}{values.shape}".encode())
            if values.dtype.kind in "fiub":
                found.update(np.ascontiguousarray(values, dtype="<f8").tobytes())
            else:
                found.update("\n".join(map(str, values.ravel())).encode())
    return found.hexdigest()


def _parameters(result: Result) -> Mapping[str, Any]:
    return result.parameters


def _units(states: Sequence[str], parameters: Mapping[str, float]) -> dict[str, str]:
    """The units of a result of the cable's model; other models give none."""
    if "wind.speed" not in parameters or not set(states) <= set(_STATE_UNITS):
        return {}
    numbers = {f"{n.table}.{n.field}": n.kind.si[0] for n in NUMBERS}
    return {**{n: numbers[n] for n in parameters if n in numbers}, **_STATE_UNITS, "period": "s"}


def _safe(name: str) -> str:
    """A name without a slash, which parts groups in netCDF."""
    return name.replace("%", "%25").replace("/", "%2F")


def _escaped(columns: Mapping[str, Column]) -> dict[str, Column]:
    return {_safe(name): column for name, column in columns.items()}
