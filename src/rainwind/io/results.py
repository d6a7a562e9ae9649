"""Results out and in: named tables of arrays with units, as netCDF (all in one file) and CSV (one each)."""

import csv
import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from rainwind.errors import InputError

__all__ = ["Column", "Table", "load_netcdf", "save_csv", "save_netcdf"]


@dataclass(frozen=True)
class Column:
    """One array of a table: its values, its unit ("" for none), and what they are."""

    values: Any
    unit: str = ""
    meaning: str = ""
    dimensions: tuple[str, ...] = ("point",)


@dataclass(frozen=True)
class Table:
    """Columns by name, and facts about all of them: where they come from, with which settings."""

    columns: Mapping[str, Column]
    attributes: Mapping[str, str | float | int] = field(default_factory=dict)

    def __post_init__(self) -> None:
        for name, column in self.columns.items():
            if np.ndim(column.values) != len(column.dimensions):
                raise InputError(
                    f"column '{name}' has {np.ndim(column.values)} dimensions but names "
                    f"{list(column.dimensions)}; name one for each"
                )


def save_netcdf(path: Path | str, tables: Mapping[str, Table], *, source: str, version: str) -> None:
    """Write every table as a group of one netCDF-4 file.

    `source` says which study made them and `version` with which software. Raises InputError where columns along
    one dimension differ in length, and where the file cannot be written.
    """
    import xarray

    for name, table in tables.items():
        _check_lengths(name, table)

    tree = {"/": xarray.Dataset(attrs={"source": source, "software": f"rainwind {version}"})}
    for name, table in tables.items():
        tree[f"/{name}"] = xarray.Dataset(
            {
                label: (column.dimensions, np.asarray(column.values), _facts(column))
                for label, column in table.columns.items()
            },
            attrs=dict(table.attributes),
        )
    with _as_input_error(path, "written"):
        xarray.DataTree.from_dict(tree).to_netcdf(path, engine="h5netcdf")


def load_netcdf(path: Path | str) -> dict[str, Any]:
    """Group name -> xarray.Dataset, as `save_netcdf` wrote them; the file's own facts under "".

    Raises InputError where the file cannot be read or is no netCDF-4 file.
    """
    import xarray

    with _as_input_error(path, "read"):
        found = xarray.open_groups(path, engine="h5netcdf")
        loaded = {name.strip("/"): dataset.load() for name, dataset in found.items()}
        for dataset in found.values():
            dataset.close()
    return loaded


def save_csv(path: Path | str, table: Table) -> None:
    """Write columns of one common length with a header such as `speed [m/s]`.

    Raises InputError where the columns differ in length or have two dimensions, and where the file cannot be
    written.
    """
    shapes = {name: np.shape(column.values) for name, column in table.columns.items()}
    if len(set(shapes.values())) > 1 or any(len(shape) != 1 for shape in shapes.values()):
        raise InputError(f"a CSV file takes columns of one length, not {shapes}; write netCDF instead")
    header = [f"{name} [{column.unit}]" if column.unit else name for name, column in table.columns.items()]
    # "\n" everywhere: the file is the same on every system
    with _as_input_error(path, "written"), Path(path).open("w", newline="", encoding="utf-8") as file:
        rows = csv.writer(file, lineterminator="\n")
        rows.writerow(header)
        rows.writerows(
            zip(*(np.asarray(column.values).tolist() for column in table.columns.values()), strict=True)
        )


def _check_lengths(name: str, table: Table) -> None:
    lengths: dict[str, tuple[str, int]] = {}
    for label, column in table.columns.items():
        for dimension, length in zip(column.dimensions, np.shape(column.values), strict=True):
            first, known = lengths.setdefault(dimension, (label, length))
            if length != known:
                raise InputError(
                    f"table '{name}': along '{dimension}' column '{first}' has {known} values and '{label}' has "
                    f"{length}; give as many of both, or name another dimension"
                )


@contextmanager
def _as_input_error(path: Path | str, verb: str) -> Iterator[None]:
    try:
        yield
    except OSError as error:
        # h5py tells the number of an error of the system in a long sentence of its own
        reason = os.strerror(error.errno) if error.errno else "it is no netCDF-4 file"
        raise InputError(
            f"{path}: cannot be {verb} ({reason}); check its name, folder and permissions"
        ) from error


def _facts(column: Column) -> dict[str, str]:
    return (
        {"units": column.unit or "1", "long_name": column.meaning}
        if column.meaning
        else {"units": column.unit or "1"}
    )
