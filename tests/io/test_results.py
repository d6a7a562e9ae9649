"""Tables out and in again."""

import numpy as np
import pytest

from rainwind.errors import InputError
from rainwind.io.results import Column, Table, load_netcdf, save_csv, save_netcdf

TABLE = Table(
    {"speed": Column([8.0, 9.5], "m/s", "wind speed U"), "kind": Column(["fold", "hopf"])}, {"damping": 0.002}
)


def test_netcdf_keeps_values_units_and_origin(tmp_path):
    grid = Table({"region": Column(np.arange(6).reshape(2, 3), dimensions=("speed", "damping"))})
    save_netcdf(tmp_path / "a.nc", {"branch": TABLE, "map": grid}, source="figure 9", version="1.2")
    back = load_netcdf(tmp_path / "a.nc")
    assert back["branch"]["speed"].values.tolist() == [8.0, 9.5]
    assert back["branch"]["kind"].values.tolist() == ["fold", "hopf"]
    assert back["branch"]["speed"].attrs == {"units": "m/s", "long_name": "wind speed U"}
    assert back["branch"].attrs["damping"] == 0.002
    assert back["map"]["region"].dims == ("speed", "damping")
    assert back[""].attrs == {"source": "figure 9", "software": "rainwind 1.2"}


def test_csv_has_units_in_its_header(tmp_path):
    save_csv(tmp_path / "a.csv", TABLE)
    assert (tmp_path / "a.csv").read_bytes() == b"speed [m/s],kind\n8.0,fold\n9.5,hopf\n"


def test_tables_that_do_not_fit_are_refused(tmp_path):
    with pytest.raises(InputError, match="name one for each"):
        Table({"a": Column([[1.0]])})
    with pytest.raises(InputError, match="one length"):
        save_csv(tmp_path / "a.csv", Table({"a": Column([1.0]), "b": Column([1.0, 2.0])}))


def test_columns_of_unequal_length_are_named(tmp_path):
    uneven = Table({"a": Column([1.0]), "b": Column([1.0, 2.0])})
    with pytest.raises(
        InputError, match="table 'branch': along 'point' column 'a' has 1 values and 'b' has 2"
    ):
        save_netcdf(tmp_path / "a.nc", {"branch": uneven}, source="figure 9", version="1.2")


def test_places_that_cannot_be_written_or_read(tmp_path):
    nowhere = tmp_path / "none"
    for name in (nowhere / "a.nc", tmp_path):
        with pytest.raises(InputError, match="cannot be written"):
            save_netcdf(name, {"branch": TABLE}, source="figure 9", version="1.2")
    with pytest.raises(InputError, match=r"a\.csv: cannot be written \(No such file"):
        save_csv(nowhere / "a.csv", TABLE)
    (tmp_path / "junk.nc").write_text("junk", encoding="utf-8")
    with pytest.raises(InputError, match=r"a\.nc: cannot be read \(No such file"):
        load_netcdf(nowhere / "a.nc")
    with pytest.raises(InputError, match="it is no netCDF-4 file"):
        load_netcdf(tmp_path / "junk.nc")
    with pytest.raises(InputError, match="cannot be read"):
        load_netcdf(tmp_path)
