"""Reports of a bridge made by hand: every number read back, every nasty name a name."""

import csv
import io
import re
from dataclasses import replace
from html.parser import HTMLParser
from math import degrees, inf, isnan, pi
from pathlib import Path

import numpy as np
import openpyxl
import pytest

from rainwind.engineering.answers import Band
from rainwind.engineering.climate import Climate
from rainwind.errors import InputError
from rainwind.reporting import pdf_writer, words
from rainwind.reporting.back_pages import LIMITS, back_pages
from rainwind.reporting.content import Points, Report, Section, Table, Verbatim, Words
from rainwind.reporting.document import document
from rainwind.reporting.first_page import first_page
from rainwind.reporting.picture_pages import picture_pages
from rainwind.reporting.quantities import QUANTITIES, columns
from rainwind.reporting.report import write_report
from rainwind.reporting.stay_pages import stay_pages
from rainwind.reporting.text_table import harmless

from .sample_answer import CASE_TEXT, NASTY, damped_mode, nasty_answer, sample_answer


@pytest.fixture(scope="module")
def answer():
    return sample_answer()


@pytest.fixture(scope="module")
def content(answer):
    return document(answer)


@pytest.fixture(scope="module")
def folder(answer, tmp_path_factory):
    folder = tmp_path_factory.mktemp("sample")
    write_report(answer, folder)
    return folder


@pytest.fixture(scope="module")
def nasty(tmp_path_factory):
    folder = tmp_path_factory.mktemp("nasty")
    write_report(nasty_answer(), folder)
    return folder


class Page(HTMLParser):
    """Words of a page, its addresses, its tags and whether they close in order."""

    EMPTY = ("meta", "br", "link", "img", "path", "use")

    def __init__(self, text):
        super().__init__()
        self.words, self.addresses, self.open, self.tags, self.badly = [], [], [], [], []
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        self.tags.append(tag)
        self.addresses += [value for name, value in attrs if name in ("src", "href", "xlink:href", "data")]
        if tag not in self.EMPTY:
            self.open.append(tag)

    def handle_startendtag(self, tag, attrs):
        self.addresses += [value for name, value in attrs if name in ("src", "href", "xlink:href", "data")]

    def handle_endtag(self, tag):
        if tag in self.EMPTY:
            return
        if not self.open or self.open.pop() != tag:
            self.badly.append(tag)

    def handle_data(self, data):
        if self.open and self.open[-1] not in ("style", "svg", "g", "defs"):
            self.words.append(data)

    @property
    def text(self):
        text = " ".join(" ".join(self.words).split())
        return text.replace("\u00a0", " ").replace("\u2060", "")


def texts(sections):
    """Every text of a report's sections, in order."""
    found = []
    for section in sections:
        found.append(section.title)
        for block in section.blocks:
            match block:
                case Words(text=text) | Verbatim(text=text):
                    found.append(text)
                case Points(items=items):
                    found += items
                case Table():
                    found += [
                        block.caption,
                        *block.header,
                        *(cell.text for row in block.rows for cell in row),
                    ]
                case _:
                    found.append(block.caption)
    return found


def pages(pdf):
    return len(re.findall(rb"/Type\s*/Page\b", pdf))


def test_four_files_are_written(answer, folder, tmp_path):
    assert sorted(path.name for path in folder.iterdir()) == [
        "report.html",
        "report.pdf",
        "results.csv",
        "results.xlsx",
    ]
    assert [path.name for path in write_report(answer, tmp_path / "new", formats=("csv",))] == ["results.csv"]


def test_an_unknown_format_says_what_is_known(answer, tmp_path):
    with pytest.raises(InputError, match="'docx' is not known; choose from pdf, html, xlsx, csv"):
        write_report(answer, tmp_path, formats=("docx",))


def test_a_folder_that_is_a_file_is_an_input_error(answer, tmp_path):
    (tmp_path / "taken").write_text("")
    with pytest.raises(InputError, match="cannot be written"):
        write_report(answer, tmp_path / "taken", formats=("csv",))


def test_the_pdf_has_pages(folder, nasty):
    for place, least in ((folder, 6), (nasty, 14)):
        pdf = (place / "report.pdf").read_bytes()
        assert pdf.startswith(b"%PDF")
        assert pages(pdf) >= least


def paper(answer, **changes):
    """The pages that the sections of stays take on paper; changes: of every section."""
    sections = tuple(replace(section, new_page=False, **changes) for section in stay_pages(answer))
    return pages(pdf_writer.pdf(Report("", "", "", "", sections)))


@pytest.mark.parametrize(
    ("sentences", "as_it_is", "made_smaller"),
    [(1, 1, 1), (8, 2, 1), (80, 3, 3)],
)
def test_a_stay_that_nearly_fits_is_made_smaller_to_fit_its_page(answer, sentences, as_it_is, made_smaller):
    stay = answer.stays[0]
    one = replace(answer, stays=(replace(stay, sentences=("Rain and wind move this stay.",) * sentences),))
    assert paper(one, one_page=False) == as_it_is
    assert paper(one) == made_smaller


def test_the_page_loads_nothing_and_closes_its_tags(folder, nasty):
    for place in (folder, nasty):
        page = Page((place / "report.html").read_text(encoding="utf-8"))
        assert page.badly == []
        assert page.open == []
        assert page.addresses
        assert all(address.startswith("#") for address in page.addresses)
        assert "script" not in page.tags


def test_the_page_names_no_address_but_those_of_the_names_of_xml(folder):
    text = (folder / "report.html").read_text(encoding="utf-8")
    assert "http" not in re.sub(r'xmlns(:\w+)?="[^"]*"', "", text)


def test_of_many_stays_the_meaning_comes_before_the_table(answer):
    kinds = {}
    for count in (3, 15):
        stays = tuple(
            replace(answer.stays[0], cable=replace(answer.stays[0].cable, name=f"S{k}")) for k in range(count)
        )
        blocks = first_page(replace(answer, stays=stays)).blocks
        kinds[count] = [type(block).__name__ for block in blocks if isinstance(block, Table | Points)]
    assert kinds == {3: ["Table", "Points", "Points"], 15: ["Points", "Points", "Table"]}


def test_figures_of_one_page_do_not_share_names(folder):
    text = (folder / "report.html").read_text(encoding="utf-8")
    names = re.findall(r'\bid="([^"]+)"', text)
    assert len(names) == len(set(names)) > 100
    for used in re.findall(r'(?:href="#|url\(#)([^")]+)', text):
        assert used in names


def test_nothing_says_nan(folder, nasty, content):
    assert not [text for text in texts(content.sections) if re.search(r"\bnan\b|\binf\b", text)]
    for place in (folder, nasty):
        assert not re.search(
            r"\bnan\b|\binf\b", Page((place / "report.html").read_text(encoding="utf-8")).text
        )
        assert not re.search(r"\bnan\b", (place / "results.csv").read_text(encoding="utf-8"))


def test_every_text_of_the_content_is_on_the_page(folder, content):
    page = Page((folder / "report.html").read_text(encoding="utf-8")).text
    for text in (content.title, content.subtitle, content.foot, *texts(content.sections)):
        assert " ".join(text.split()) in page


def test_the_summary_has_the_numbers_of_the_answer(answer):
    header, rows = words.summary_rows(answer)
    assert len(header) == len(rows[0]) == len(rows[2]) <= 8
    first, second, third = rows
    mode = answer.stays[0].modes[0]
    assert first[:3] == ["S1", "✗ insufficient", f"{mode.damping_total / 0.0059:.2f}\nmode 1"]
    assert float(first[3]) == 100 * mode.damping_total
    assert first[4] == "0.34 (0.19 to 0.59)"
    assert first[5:7] == ["7.2 (6.1 to 8.6)\nin 81 %", "19 (15 to 40)\nopen in 13 %"]
    assert first[7] == "0.23 (0.11 to 0.37)\nin 81 % of samples"
    assert second == ["S2", "✓ sufficient", "no damping needed", "2.00", "0", "none", "none", "0"]
    assert third[:2] == ["S3", "– not computed\ntoo slack"]


def test_first_page(answer):
    said = texts([first_page(answer)])
    assert "3 stays: 1 sufficient ✓, 1 insufficient ✗, 1 not computed –" in said
    whole = " ".join(said)
    assert "The least margin is 0.81, stay S1, mode 1: it has 0.480 % of critical damping" in whole
    assert "needs 0.590 % of critical in mode 1, where there is 0.480 %" in whole
    assert f"x_d/L would have to be at least {2 * (0.0059 - 0.0011):.4f}." in whole
    assert "Stay S3 could not be computed: too slack" in whole
    assert "reconstructed from one paper" in whole
    assert "1 at the middle of the band" not in whole
    assert "of 2 computed: 2 at the middle of the band, 1 at its high end, 1 by the PTI rule" in whole
    assert "interrupted" not in whole


def test_an_interrupted_answer_says_so_on_the_first_page(answer):
    part = replace(answer, stays=answer.stays[:1], interrupted=True)
    said = " ".join(texts([first_page(part)]))
    assert "interrupted: 1 of 3 stays were reached" in said
    assert "Run the same command again" in said


def test_a_doubtful_stay_with_enough_for_the_model_is_measured_by_the_rule(answer):
    calm = answer.stays[1]
    modes = tuple(replace(mode, damping_total=0.004) for mode in calm.modes)
    doubtful = replace(answer, stays=(replace(calm, modes=modes, verdict="doubtful"),))
    said = " ".join(texts([first_page(doubtful)]))
    assert (
        "the model finds enough, but the PTI rule asks for 0.520 % of critical in mode 1, where there is 0.400 %"
        in said
    )


def test_a_bridge_of_which_nothing_could_be_computed_still_has_a_report(answer, tmp_path):
    for path in write_report(replace(answer, stays=answer.stays[2:]), tmp_path):
        assert path.stat().st_size > 0
    assert "No stay could be computed" in Page((tmp_path / "report.html").read_text(encoding="utf-8")).text


def test_the_input_stands_in_the_report_as_it_was(content, folder):
    html = (folder / "report.html").read_text(encoding="utf-8")
    assert "&lt;b&gt;&amp;" in html
    assert Verbatim(CASE_TEXT) in content.sections[-1].blocks


def test_assumptions_sources_and_failures_stand_in_the_report(content):
    whole = " ".join(texts(content.sections))
    for said in (
        "The mass is that of the strands.",
        "Drawing 12 (read)",
        "Not computed: too slack",
        "m xi / (rho D²)",
    ):
        assert said in whole
    assert "Stay S1: The rivulet follows the rule. No profile." in whole


def test_the_report_and_its_page_give_the_same_reduced_wind_speeds():
    page = (Path(__file__).parents[2] / "docs/assessment.md").read_text(encoding="utf-8")
    speeds = [re.findall(r"U/\(f d\) of (\d+ to \d+)", text) for text in (page, " ".join(LIMITS))]
    assert speeds[0] == speeds[1]
    assert len(speeds[0]) == 1


def test_an_assumption_of_all_stays_stands_once(answer):
    common = replace(
        answer, stays=tuple(replace(stay, assumptions=("Everyone's guess.",)) for stay in answer.stays)
    )
    assert " ".join(texts(back_pages(common))).count("Everyone's guess.") == 1
    assert "For all stays" in texts(back_pages(common))


def test_the_wind_rose_needs_a_climate(answer):
    climate = Climate(
        np.array([4.0, 8.0, 12.0]),
        np.array([0.1, pi / 2, 2.0]),
        np.array([True, True, False]),
        np.full(3, 2920.0),
        10.0,
    )
    captions = [
        [text for text in texts(picture_pages(answer, one)) if "hours a year with rain by direction" in text]
        for one in (None, climate)
    ]
    assert captions[0] == []
    assert len(captions[1]) == 1


def rows_of(sheet):
    header, *rows = sheet.iter_rows(values_only=True)
    return [dict(zip(header, row, strict=True)) for row in rows]


def flat(stay, mode):
    """The mode's numbers by header, straight from the answer."""
    found = {}
    for one in QUANTITIES:
        value = one.value(stay, mode)
        name = one.label + (f" ({one.unit})" if one.unit else "")
        if isinstance(value, Band):
            found |= {f"{name}, 5 %": value.low, f"{name}, middle": value.middle, f"{name}, 95 %": value.high}
            found[f"{one.label}, share of samples"] = value.share
        elif not one.band:
            found[name] = value
    return found


def same(read, value):
    if value is None or isnan(value):
        return read in (None, "")
    if value == inf:
        return read in ("no limit", "inf", "no damping needed")
    return float(read) == pytest.approx(value, rel=1e-12)


def test_the_workbook_reads_back(answer, folder):
    book = openpyxl.load_workbook(folder / "results.xlsx")
    assert book.sheetnames == ["Summary", "Modes", "Checks", "Directions", "Assumptions", "Input"]
    rows = rows_of(book["Modes"])
    modes = [(stay, mode) for stay in answer.stays for mode in stay.modes]
    assert len(rows) == len(modes) == 4
    for row, (stay, mode) in zip(rows, modes, strict=True):
        assert (row["Stay"], row["Mode"]) == (stay.cable.name, mode.number)
        for name, value in flat(stay, mode).items():
            assert same(row[name], value), name
    assert rows[0]["frequency in plane (Hz)"] == 0.93
    assert rows[0]["damping needed, observed speeds (%), 95 %"] == pytest.approx(0.59)
    assert rows[0]["damper stroke (mm), middle"] == pytest.approx(7.1)
    assert rows[0]["damper force (kN), 95 %"] == pytest.approx(1.41)
    assert rows[0]["hours in the range, with rain (h a year), middle"] == 5.4
    assert rows[0]["worst direction, wind from (°)"] == pytest.approx(90.0)
    assert rows[2]["range begins (m/s), middle"] is None
    assert rows[2]["margin"] == "no damping needed"


def test_the_summary_sheet_has_the_answers_numbers(answer, folder):
    sheet = openpyxl.load_workbook(folder / "results.xlsx")["Summary"]
    first, second, third, *_ = rows_of(sheet)
    worst = answer.stays[0].worst
    assert first["Margin"] == pytest.approx(answer.stays[0].margin)
    assert first["Damping there (%)"] == pytest.approx(100 * worst.damping_total)
    assert first["Damping needed, observed speeds (%), middle"] == pytest.approx(0.34)
    assert first["Range begins (m/s), 5 %"] == 6.1
    assert first["Range ends (m/s), 95 %"] == 39.7
    assert first["Range open, share of samples"] == 0.13
    assert first["Amplitude, half peak to peak (m), 95 %"] == 0.37
    assert second["Margin"] == "no damping needed"
    assert third["Failure"] == "too slack"
    assert third["Margin"] is None
    assert sheet.freeze_panes == "B2"


def test_the_other_sheets_read_back(answer, folder):
    book = openpyxl.load_workbook(folder / "results.xlsx")
    checks = rows_of(book["Checks"])
    assert [row["Met"] for row in checks[:2]] == ["no", "yes"]
    assert (checks[1]["Value"], checks[1]["Limit"]) == (0.61, 0.5)
    directions = rows_of(book["Directions"])
    mode = answer.stays[0].modes[0]
    assert len(directions) == 4 * 12
    assert directions[3]["Wind from (°)"] == pytest.approx(degrees(mode.directions[3]))
    assert directions[3]["Range ends (m/s), 95 %"] == mode.speed_high[3, 2]
    assert directions[0]["Range begins (m/s), middle"] is None
    said = [row["Sentence"] for row in rows_of(book["Assumptions"])]
    assert "The mass is that of the strands." in said
    assert [row[0] for row in book["Input"].iter_rows(min_row=2, values_only=True)] == [
        line or None for line in CASE_TEXT.splitlines()
    ]


def test_the_text_table_reads_back(answer, folder):
    rows = list(csv.DictReader(io.StringIO((folder / "results.csv").read_text(encoding="utf-8-sig"))))
    assert [row["stay"] for row in rows] == ["S1", "S1", "S2", "S2", "S3"]
    assert set(columns()) < set(rows[0])
    modes = [(stay, mode) for stay in answer.stays for mode in stay.modes]
    for row, (stay, mode) in zip(rows[:4], modes, strict=True):
        for name, value in flat(stay, mode).items():
            assert same(row[name], value), name
    assert rows[4]["failure"] == "too slack"


def test_headers_are_told_apart():
    assert len(set(columns())) == len(columns())


def test_nasty_names_are_texts_in_the_workbook(nasty):
    book = openpyxl.load_workbook(nasty / "results.xlsx")
    for sheet in book:
        assert not [cell.coordinate for row in sheet.iter_rows() for cell in row if cell.data_type == "f"]
    names = [row["Stay"] for row in rows_of(book["Modes"])]
    assert names == [re.sub(r"[\x01\x0b]", "", name) for name in NASTY]


def test_nasty_names_are_no_formulas_in_the_text_table(nasty):
    rows = list(csv.reader(io.StringIO((nasty / "results.csv").read_text(encoding="utf-8-sig"))))
    assert len(rows) == 1 + len(NASTY)
    assert not [row[0] for row in rows if row[0][:1] in "=+-@\t\r"]
    assert rows[4][0] == "'=1+1"


@pytest.mark.parametrize("text", ["=1+1", "+4", "-2", "@a", " =1", "\t=1"])
def test_harmless(text):
    assert harmless(text).startswith("'")
    assert harmless("S1") == "S1"


def test_nasty_names_are_words_on_the_page(nasty):
    html = (nasty / "report.html").read_text(encoding="utf-8")
    assert "<script>" not in html
    assert "<b>" not in html
    page = Page(html).text
    for name in NASTY[:11]:
        assert " ".join(name.split()) in page


def test_the_typesetter_gets_no_control_characters_and_words_that_can_break(tmp_path):
    words_, points = Words("a\x01\x0bb 5 %"), Points(("W" * 30,))
    section = Section("\x02t", (words_, points, Verbatim("x\x03 5 %")))
    data = pdf_writer._report(Report("t", "s", "h", "f", (section,)), tmp_path)["sections"][0]
    assert data["title"] == "t"
    assert data["blocks"][0]["text"] == "ab 5\u00a0%"
    assert data["blocks"][1]["items"] == ["\u200b".join(["WWWW"] * 7 + ["WW"])]
    assert data["blocks"][2]["lines"] == ["x 5 %"]


def test_nasty_names_are_not_run_by_the_typesetter(nasty):
    # "#set page(width: 1cm)" as code would make pages 28 points wide
    boxes = re.findall(rb"/MediaBox\s*\[([^\]]+)\]", (nasty / "report.pdf").read_bytes())
    assert boxes
    assert {tuple(round(float(x)) for x in box.split()) for box in boxes} == {(0, 0, 595, 842)}


def test_cycles_of_all_modes_stand_in_one_table_with_the_digits_they_have(answer):
    stay = replace(
        answer.stays[0], modes=(damped_mode(1), replace(damped_mode(2), cycles=np.array([0.4, 362668, 0])))
    )
    tables = [
        block
        for section in stay_pages(replace(answer, stays=(stay,)))
        for block in section.blocks
        if isinstance(block, Table) and block.caption.startswith("Cycles")
    ]
    (table,) = tables
    assert table.header == ("Amplitude (m)", "0 to 0.1", "0.1 to 0.2", "0.2 to 0.4")
    rows = [[cell.text for cell in row] for row in table.rows]
    assert rows == [["Mode 1", "1200", "34000", "560"], ["Mode 2", "0", "360000", "0"]]


def test_limits_of_codes_are_round_numbers(answer):
    whole = texts(stay_pages(answer))
    assert {"at least 10", "at least 0.5 %"} <= set(whole)


@pytest.mark.parametrize(("samples", "few"), [(42, True), (43, False)])
def test_few_samples_are_called_few(answer, samples, few):
    asked = replace(answer.bridge.question, samples=samples, sets=("a", "b", "c"))
    said = " ".join(texts([first_page(replace(answer, bridge=replace(answer.bridge, question=asked)))]))
    assert ("the ends are rough" in said) == few
