"""Bands of samples, and finished stays that are read back as they were."""

from dataclasses import replace
from math import inf, nan

import numpy as np
import pytest

from rainwind.engineering.answer_store import _ROOT, AnswerStore, _program
from rainwind.engineering.answers import Band, CodeCheck, ModeAnswer, StayAnswer
from rainwind.engineering.bridge import Bridge
from rainwind.engineering.cable import Cable, Damper
from rainwind.errors import InputError

CABLE = Cable("1", 100.0, 0.16, 60.0, 3e6, 0.5, 1.0, dampers=(Damper(2.0, 1e4),))
BRIDGE = Bridge("b", (CABLE,))


def answer(cable: Cable = CABLE) -> StayAnswer:
    line = np.array([[1.0, 2.0, nan], [3.0, inf, 4.0]])
    one = Band(1.0, 2.0, 3.0, 0.5)
    mode = ModeAnswer(
        1, 1.0, 1.1, 0.001, 0.002, {"a": 1.0}, np.array([0.0, 3.0]), line, line, np.array([0.5, 1.0]), 3.0, one, one,
        0.0, one, one, 0.003, np.array([5.0, 6.0]), line, one, one, one, lost=np.array([0.0, 1.0]), stroke=one,
    )  # fmt: skip
    return StayAnswer(
        cable, (mode,), (CodeCheck("PTI", "Sc", 8.0, 10.0, "", "at least", False, "x"),), "doubtful", ("s",)
    )


def same(a: object, b: object) -> bool:
    if isinstance(a, np.ndarray):
        return isinstance(b, np.ndarray) and a.dtype == b.dtype and np.array_equal(a, b, equal_nan=True)
    if hasattr(a, "__dataclass_fields__"):
        return type(a) is type(b) and all(same(getattr(a, f), getattr(b, f)) for f in a.__dataclass_fields__)
    if isinstance(a, tuple):
        return isinstance(b, tuple) and len(a) == len(b) and all(map(same, a, b))
    return a == b or (a != a and b != b)


def test_a_band_is_made_of_quantiles_of_what_exists() -> None:
    band = Band.of(np.array([*np.linspace(0.0, 1.0, 101), *[nan] * 101]))
    assert (band.low, band.middle, band.high, band.share) == pytest.approx((0.05, 0.5, 0.95, 0.5))
    assert not Band.of(np.array([nan])).exists


def test_a_finished_stay_is_read_back_whole(tmp_path) -> None:
    AnswerStore(tmp_path, BRIDGE, (), None).keep(answer())
    kept = AnswerStore(tmp_path, BRIDGE, (), None).kept(CABLE)
    assert same(answer(), kept)


@pytest.mark.parametrize(
    "change", [{"tension": 3.1e6}, {"damping_ratios": (0.002,)}, {"dampers": ()}, {"name": "2"}]
)
def test_a_changed_stay_is_computed_anew(tmp_path, change) -> None:
    store = AnswerStore(tmp_path, BRIDGE, (), None)
    store.keep(answer())
    assert store.kept(replace(CABLE, **change)) is None


def test_a_changed_question_is_computed_anew(tmp_path) -> None:
    AnswerStore(tmp_path, BRIDGE, (), None).keep(answer())
    other = replace(BRIDGE, question=replace(BRIDGE.question, samples=9))
    assert AnswerStore(tmp_path, other, (), None).kept(CABLE) is None


def test_a_damaged_file_is_computed_anew(tmp_path) -> None:
    store = AnswerStore(tmp_path, BRIDGE, (), None)
    store.keep(answer())
    (file,) = tmp_path.glob("stay-*.json")
    file.write_text(file.read_text()[:-5])
    assert store.kept(CABLE) is None


def test_a_folder_that_is_a_file_is_refused(tmp_path) -> None:
    (tmp_path / "x").write_text("")
    with pytest.raises(InputError, match="cannot be used"):
        AnswerStore(tmp_path / "x", BRIDGE, (), None)


def test_a_changed_program_has_another_name(tmp_path) -> None:
    (tmp_path / "physics").mkdir()
    file = tmp_path / "physics" / "x.py"
    file.write_text("A = 1")
    before = _program(tmp_path)
    assert before == _program(tmp_path)
    file.write_text("A = 2")
    assert before != _program(tmp_path)
    assert _program(_ROOT) != _program(tmp_path / "nowhere")  # the real one has files
