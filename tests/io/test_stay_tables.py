"""Stays from CSV and Excel files: what is read, and each fault with its row and column."""

from math import radians
from pathlib import Path

import openpyxl
import pytest

from rainwind.engineering.cable import Cable, Damper
from rainwind.errors import CaseError
from rainwind.io.bridge_cases import bridge_from_text
from rainwind.io.stay_tables import key_of_header

HEADERS = ("name", "length_m", "diameter_mm", "mass_kg_m", "tension_kN", "inclination_deg")
ROWS = (("1N", 100, 160, 60, 3000, 30), ("2N", 120, 165, 62.5, 3100, 25))
DEFAULTS = """\
heading_deg = 90
damping_percent = 0.1
surface = "smooth"
base_height_m = 5
bending_stiffness_kNm2 = 0
"""
STAYS = tuple(
    Cable(name, length, diameter / 1000, mass, tension * 1000, radians(slope), radians(90), base_height=5.0)
    for name, length, diameter, mass, tension, slope in ROWS
)


def case(file: str, more: str = "") -> str:
    return f'schema = 1\n[stays]\nfile = "{file}"\n{more}[cable_defaults]\n{DEFAULTS}'


def csv_text(headers: tuple[object, ...] = HEADERS, rows: object = ROWS, separator: str = ",") -> str:
    return "\n".join(separator.join(map(str, row)) for row in (headers, *rows)) + "\n"  # type: ignore[misc]


def read(folder: Path, text: str, file: str = "stays.csv") -> tuple[Cable, ...]:
    (folder / file).write_text(text, encoding="utf-8")
    return bridge_from_text(case(file), "case.toml", folder).stays


def faults_of(folder: Path, text: str, file: str = "stays.csv") -> list[str]:
    with pytest.raises(CaseError) as error:
        read(folder, text, file)
    first, *rest = str(error.value).splitlines()
    assert first == f"case.toml: {len(rest)} fault{'s' if len(rest) > 1 else ''}"
    return [line.strip() for line in rest]


def with_cell(row: int, column: str, cell: object) -> str:
    """The table with one cell replaced; row 2 is the first stay."""
    rows = [list(one) for one in ROWS]
    rows[row - 2][HEADERS.index(column)] = cell
    return csv_text(rows=rows)


def test_one_row_a_stay(tmp_path: Path):
    assert read(tmp_path, csv_text()) == STAYS


@pytest.mark.parametrize("separator", [",", ";", "\t"])
def test_headers_with_units_in_brackets_blank_lines_and_columns(separator: str, tmp_path: Path):
    headers = ("Name", "Length [m]", "diameter (mm)", "Mass [kg/m]", "tension [kN]", "inclination [°]", "")
    text = csv_text(headers, [(*row, "") for row in ROWS], separator)
    first, second, third = text.splitlines()
    blank = separator * 6
    text = f"# my table\n\n{first}\n{blank}\n{second}\n\n{third}\n{blank}\n"
    assert read(tmp_path, text) == STAYS


def test_excel_and_its_sheets(tmp_path: Path):
    book = openpyxl.Workbook()
    book.active.title = "notes"  # type: ignore[union-attr]
    book.active.append(["nothing here"])  # type: ignore[union-attr]
    page = book.create_sheet("stays")
    page.append(["", *HEADERS])
    page.append([])
    page.append([None, 13, *ROWS[0][1:]])  # a name that Excel takes for a number
    page.append([None, *ROWS[1]])
    book.save(tmp_path / "stays.xlsx")
    stays = bridge_from_text(case("stays.xlsx", 'sheet = "stays"\n'), folder=tmp_path).stays
    assert [stay.name for stay in stays] == ["13", "2N"]
    assert stays[1] == STAYS[1]
    with pytest.raises(
        CaseError, match=r"line 3: file = 'stays.xlsx': has no sheet 'x'; it has notes, stays"
    ):
        bridge_from_text(case("stays.xlsx", 'sheet = "x"\n'), folder=tmp_path)
    with pytest.raises(CaseError, match=r"first sheet, 'notes', others are 'stays': name one with sheet = "):
        bridge_from_text(case("stays.xlsx"), folder=tmp_path)
    page["C3"] = "hundred"
    page["C4"] = -1
    book.save(tmp_path / "stays.xlsx")
    with pytest.raises(CaseError) as error:
        bridge_from_text(case("stays.xlsx", 'sheet = "stays"\n'), folder=tmp_path)
    _, first, second = str(error.value).splitlines()
    assert first.startswith(
        "  stays.xlsx, row 3, column 'length_m': length_m = 'hundred' is text, not a number"
    )
    assert second.startswith(
        "  stays.xlsx, row 4, column 'length_m': length_m = -1: cable.length = -1 is not"
    )


def test_all_kinds_of_cells(tmp_path: Path):
    headers = (
        *HEADERS[:4],
        "tension",
        *HEADERS[5:],
        "damping [%]",
        "surface",
        "assumed",
        "damper_position_m",
    )
    headers = (*headers, "damper coefficient [kNs/m]", "damper_end")
    rows = [
        (*ROWS[0][:4], "3 MN", 30, "0.2 0.1", "dimples", "tension; heading", 3, 100, "upper"),
        (*ROWS[1][:4], "3100 kN", 25, "", "", "", "", "", ""),
    ]
    a, b = read(tmp_path, csv_text(headers, rows))
    assert a.tension == 3e6
    assert a.damping_ratios == (0.002, 0.001)
    assert a.surface == "dimples"
    assert a.assumed == ("tension", "heading")
    assert a.dampers == (Damper(3.0, 1e5, end="upper"),)
    assert b == STAYS[1]


@pytest.mark.parametrize(
    ("header", "shown"), [("damping [%]", "0.15%"), ("damping_ratio", "0.15%"), ("damping [%]", 0.15)]
)
def test_a_cell_in_per_cent_is_read_as_excel_shows_it(header: str, shown: object, tmp_path: Path):
    book = openpyxl.Workbook()
    page = book.active
    assert page is not None
    page.append([*HEADERS, header])
    page.append([*ROWS[0], 0.0015 if shown == "0.15%" else shown])
    if shown == "0.15%":
        page.cell(2, len(HEADERS) + 1).number_format = "0.00%"
    book.save(tmp_path / "stays.xlsx")
    defaults = DEFAULTS.replace("damping_percent", "# damping_percent")
    text = f'schema = 1\n[stays]\nfile = "stays.xlsx"\n[cable_defaults]\n{defaults}'
    (stay,) = bridge_from_text(text, folder=tmp_path).stays
    assert stay.damping_ratios == pytest.approx((0.0015,), rel=1e-14)


def test_a_name_may_begin_with_a_sharp(tmp_path: Path):
    assert [stay.name for stay in read(tmp_path, with_cell(3, "name", "#2"))] == ["1N", "#2"]


@pytest.mark.parametrize(
    ("header", "key"),
    [
        ("length_m", "length_m"),
        (" length [m] ", "length_m"),
        ("Length(mm)", "length_mm"),
        ("Base height [m]", "base_height_m"),
        ("damping [%]", "damping_percent"),
        ("EI [kNm²]", "ei_kNm2"),
        ("bending stiffness [kN m^2]", "bending_stiffness_kNm2"),
        ("mass [kg/m]", "mass_kg_m"),
        ("heading [°]", "heading_deg"),
        ("heading deg", "heading_deg"),
        ("name", "name"),
        ("name []", "name"),
    ],
)
def test_headers(header: str, key: str):
    assert key_of_header(header) == key


FAULTS = {
    "decimal comma": (
        csv_text(rows=[(*ROWS[0][:4], "3,5", 30)], separator=";"),
        "stays.csv, row 2, column 'tension_kN': tension_kN = '3,5' is text with a comma; write a plain number with a "
        "decimal point, 3.5",
    ),
    "text": (
        with_cell(3, "length_m", "long"),
        "stays.csv, row 3, column 'length_m': length_m = 'long' is text, not a number",
    ),
    "negative": (
        with_cell(2, "mass_kg_m", -60),
        "stays.csv, row 2, column 'mass_kg_m': mass_kg_m = -60.0: cable.mass = -60 is not allowed",
    ),
    "not finite": (
        with_cell(2, "mass_kg_m", "nan"),
        "stays.csv, row 2, column 'mass_kg_m': mass_kg_m = nan is not a finite number",
    ),
    "angle": (
        with_cell(3, "inclination_deg", 300),
        "stays.csv, row 3, column 'inclination_deg': inclination_deg = 300.0 is 5.23599 rad; allowed is 0 to pi/2",
    ),
    "kN for MN": (
        with_cell(3, "tension_kN", 3.1),
        "stays.csv, row 3, column 'tension_kN': tension_kN = 3.1 with 62.5 kg/m over 120 m gives a first frequency of",
    ),
    "empty cell": (
        with_cell(3, "mass_kg_m", ""),
        "stays.csv, row 3: the row has no mass; add for example mass_kg_m",
    ),
    "no name": (with_cell(3, "name", " "), "stays.csv, row 3: the row has no name; add for example name ="),
    "two of one name": (
        with_cell(3, "name", "1N"),
        "stays.csv, row 3, column 'name': name = '1N': another stay has this name; give each its own",
    ),
    "unknown column": (
        csv_text((*HEADERS, "colour [m]"), [(*ROWS[0], "red")]),
        "stays.csv, row 1: unknown column 'colour [m]'; ",
    ),
    "nearly a key": (
        csv_text((*HEADERS[:5], "inclinaton_deg"), [ROWS[0]])
        .replace("name,", "inclination_deg,name,")
        .replace("1N", "1,1N"),
        "stays.csv, row 1: unknown column 'inclinaton_deg'; did you mean 'inclination_deg'?",
    ),
    "no column": (
        csv_text(HEADERS[:5], [row[:5] for row in ROWS]),
        "stays.csv, row 1: no column gives the inclination; add one with the header inclination_deg, or "
        "inclination_deg in [cable_defaults]",
    ),
    "two columns of one thing": (
        csv_text((*HEADERS, "length [cm]"), [(*ROWS[0], 3)]),
        "stays.csv, row 1: the columns 'length_m' and 'length [cm]' both give the length; keep one",
    ),
    "wrong unit": (
        csv_text((*HEADERS[:5], "inclination_m"), [ROWS[0]]),
        "stays.csv, row 2, column 'inclination_m': inclination_m = 30.0 has the unit 'm', which is no unit of an angle",
    ),
    "half a damper": (
        csv_text((*HEADERS, "damper_position_m"), [(*ROWS[0], 3)]),
        "stays.csv, row 2: the row's damper has no coefficient; add for example coefficient_kNs_m",
    ),
    "damper beyond mid-span": (
        csv_text((*HEADERS, "damper_position_m", "damper_coefficient_kNs_m"), [(*ROWS[0], 51, 9)]),
        "stays.csv, row 2, column 'damper_position_m': position_m = 51.0 lies beyond mid-span of stay '1N'",
    ),
    "empty": ("\n\n", "line 3: file = 'stays.csv': is empty; write one row of headers"),
    "headers only": (csv_text(rows=[]), "line 3: file = 'stays.csv': has headers and no row below them"),
}


@pytest.mark.parametrize(("text", "words"), FAULTS.values(), ids=FAULTS.keys())
def test_one_fault(text: str, words: str, tmp_path: Path):
    (fault,) = faults_of(tmp_path, text)
    assert fault.startswith(words)


def test_faults_of_rows_come_behind_those_of_the_case_in_the_order_of_the_rows(tmp_path: Path):
    rows: list[tuple[object, ...]] = [(f"S{number}", 100, -160, 60, 3000, 30) for number in range(2, 13)]
    rows[5] = ("S7", "long", 160, 60, 3000, 30)  # found earlier than numbers that the physics refuses
    (tmp_path / "stays.csv").write_text(csv_text(rows=rows), encoding="utf-8")
    with pytest.raises(CaseError) as error:
        bridge_from_text(case("stays.csv") + "colour = 3\n", "case.toml", tmp_path)
    first, second, *rest = str(error.value).splitlines()
    assert first == "case.toml: 12 faults"
    assert "line 10: unknown key 'colour' in [cable_defaults]" in second
    assert [line.split(",")[1] for line in rest] == [f" row {number}" for number in range(2, 13)]


def test_files_that_cannot_be_read(tmp_path: Path):
    with pytest.raises(CaseError, match=r"line 3: file = 'none.csv': there is no such file"):
        bridge_from_text(case("none.csv"), folder=tmp_path)
    (tmp_path / "latin.csv").write_bytes("name\nSüd\n".encode("latin-1"))
    with pytest.raises(CaseError, match="is no text in UTF-8; save it as CSV UTF-8"):
        bridge_from_text(case("latin.csv"), folder=tmp_path)
    (tmp_path / "no.xlsx").write_text("name", encoding="utf-8")
    with pytest.raises(CaseError, match="cannot be read as an Excel file"):
        bridge_from_text(case("no.xlsx"), folder=tmp_path)
