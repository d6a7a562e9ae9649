"""Results out and in: named tables of arrays with units, as netCDF (all in one file) and CSV (one each)."""

import csv
from collections.abc import Mapping
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
    """Write every table as a group of one netCDF-4 file; OSError where the file cannot be written.

    `source` says which study made them and `version` with which software.
    """
    import xarray

    tree = {"/": xarray.Dataset(attrs={"source": source, "software": f"rainwind {version}"})}
    for name, table in tables.items():
        tree[f"/{name}"] = xarray.Dataset(
            {
                label: (column.dimensions, np.asarray(column.values), _facts(column))
                for label, column in table.columns.items()
            },
            attrs=dict(table.attributes),
        )
    xarray.DataTree.from_dict(tree).to_netcdf(path, engine="h5netcdf")


def load_netcdf(path: Path | str) -> dict[str, Any]:
    """Group name -> xarray.Dataset, as `save_netcdf` wrote them; the file's own facts under ""."""
    import xarray

    found = xarray.open_groups(path, engine="h5netcdf")
    loaded = {name.strip("/"): dataset.load() for name, dataset in found.items()}
    for dataset in found.values():
        dataset.close()
    return loaded


def save_csv(path: Path | str, table: Table) -> None:
    """Write columns of one common length with a header such as `speed [m/s]`.

    Raises InputError where the columns differ in length or have two dimensions.
    """
    shapes = {name: np.shape(column.values) for name, column in table.columns.items()}
    if len(set(shapes.values())) > 1 or any(len(shape) != 1 for shape in shapes.values()):
        raise InputError(f"a CSV file takes columns of one length, not {shapes}; write netCDF instead")
    header = [f"{name} [{column.unit}]" if column.unit else name for name, column in table.columns.items()]
    # "\n" everywhere: the file is the same on every system
    with Path(path).open("w", newline="", encoding="utf-8") as file:
        rows = csv.writer(file, lineterminator="\n")
        rows.writerow(header)
        rows.writerows(
            zip(*(np.asarray(column.values).tolist() for column in table.columns.values()), strict=True)
        )


def _facts(column: Column) -> dict[str, str]:
    return (
        {"units": column.unit or "1", "long_name": column.meaning}
        if column.meaning
        else {"units": column.unit or "1"}
    )
