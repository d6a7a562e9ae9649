"""Assessments of small bridges: the sample case's numbers, symmetry, failures, what is kept and what stops it."""

from dataclasses import replace
from math import pi, radians

import numpy as np
import pytest

from rainwind.engineering import assessment, mode_assessment
from rainwind.engineering.assessment import assess
from rainwind.engineering.bridge import Bridge, Limits, Question
from rainwind.engineering.cable import Cable, Damper
from rainwind.engineering.climate import Climate
from rainwind.physics.rivulet import Rivulet

# the sample case of Peil & Nahrath (2003) as a stay: 1 Hz, soft strands, so that its stretching hardly counts
PAPER = Cable(
    "paper", 130.0, 0.1, 50.0, 50.0 * 260.0**2, pi / 4, 0.0, axial_stiffness=1e7, damping_ratios=(0.002,)
)
ONE = Question(modes=1, directions=4, samples=2, sets=("reconstructed",))
BRIDGE = Bridge("paper", (PAPER,), rivulet=Rivulet(), question=ONE)


@pytest.fixture(autouse=True)
def short_runs(monkeypatch: pytest.MonkeyPatch) -> None:
    """Runs in time of 40 periods: these tests ask nothing of the amplitude's last digits."""
    monkeypatch.setattr("rainwind.engineering.amplitudes.PERIODS", 40.0)
    monkeypatch.setattr("rainwind.engineering.amplitudes.LAST", 10.0)


@pytest.fixture
def unscattered(monkeypatch: pytest.MonkeyPatch) -> None:
    names = ("rivulet.mass", "rivulet.friction", "lift slope", "drag slope", "moment slope")
    monkeypatch.setattr(assessment, "sample_factors", lambda *_: {name: np.ones(2) for name in names})


def test_the_sample_case_gives_the_numbers_of_the_paper(unscattered, monkeypatch) -> None:
    """Section 4: unstable from 8 to 14.8 m/s at 0.2 % with the wind across; section 5: about 0.7 % needed there."""
    monkeypatch.setattr(mode_assessment, "_SPEEDS", 400)
    mode = assess(BRIDGE).stays[0].modes[0]
    east = int(np.argmin(np.abs(mode.directions - pi / 2)))
    assert mode.frequency_out == pytest.approx(1.0, rel=1e-12)
    assert mode.speed_low[east] == pytest.approx([8.0] * 3, abs=0.02)
    assert mode.speed_high[east] == pytest.approx([14.8] * 3, abs=0.05)
    # the worst of all directions needs at least what the wind across does
    assert mode.damping_needed.middle > 0.0069
    assert mode.damping_needed_observed.middle <= mode.damping_needed.middle


def test_turning_the_bridge_turns_its_answer() -> None:
    turned = replace(BRIDGE, stays=(replace(PAPER, heading=pi / 2),))
    a, b = (assess(one).stays[0].modes[0] for one in (BRIDGE, turned))
    assert np.roll(a.speed_low, 1, axis=0) == pytest.approx(b.speed_low, rel=1e-9, nan_ok=True)
    assert a.damping_needed.high == pytest.approx(b.damping_needed.high, rel=1e-9)


def test_the_worst_direction_is_one_in_which_something_grows() -> None:
    """At 4 to 7 m/s, before the usual onset of 8 m/s, only the lighter rivulets are there."""
    wide = replace(BRIDGE, question=replace(ONE, samples=8), limits=Limits(observed_speeds=(4.0, 7.0)))
    mode = assess(wide).stays[0].modes[0]
    assert mode.damping_needed_observed.middle == 0.0 < mode.damping_needed_observed.high
    assert mode.amplitude.high > 0.0
    assert np.cos(mode.worst_direction) > -0.5  # not the wind up along the stay, where there is no rivulet


def test_winds_from_both_sides_are_mirror_images() -> None:
    mode = assess(BRIDGE).stays[0].modes[0]  # heading north: east and west are mirrored
    assert mode.speed_high[1] == pytest.approx(mode.speed_high[3], rel=1e-9)


def test_the_same_question_has_the_same_answer_with_any_number_of_threads() -> None:
    question = replace(ONE, sets=("reconstructed", "reconstructed-cubic"))
    stays = (PAPER, replace(PAPER, name="second", heading=1.0), replace(PAPER, name="third", mass=60.0))
    for bridge in (replace(BRIDGE, question=question), replace(BRIDGE, question=question, stays=stays)):
        for a, b in zip(*(assess(bridge, workers=n).stays for n in (1, 2)), strict=True):
            assert a.cable == b.cable
            assert np.array_equal(a.modes[0].amplitudes, b.modes[0].amplitudes, equal_nan=True)
            assert a.modes[0].damping_needed == b.modes[0].damping_needed


def test_a_damper_raises_the_margin_and_has_a_stroke() -> None:
    damped = replace(PAPER, dampers=(Damper(3.9, 40e3),))
    plain, better = (assess(replace(BRIDGE, stays=(c,))).stays[0].modes[0] for c in (PAPER, damped))
    assert better.damping_total > plain.damping_total + 0.005
    assert better.margin > plain.margin
    assert better.damping_needed.middle == pytest.approx(plain.damping_needed.middle, rel=1e-3)
    assert plain.stroke is None
    assert better.amplitude_undamped is not None
    assert better.amplitude_undamped.high == pytest.approx(plain.amplitude.high, rel=1e-9)
    assert better.stroke is not None
    assert 0.0 <= better.stroke.high <= better.amplitude.high


def test_a_stay_that_fails_does_not_stop_the_others() -> None:
    slack = replace(PAPER, name="slack", length=400.0, tension=3e5, inclination=0.1, axial_stiffness=1e9)
    answer = assess(replace(BRIDGE, stays=(slack, PAPER)))
    assert [stay.verdict == "failed" for stay in answer.stays] == [True, False]
    assert "slack" in answer.stays[0].sentences[0]
    assert answer.stays[0].failure
    assert answer.stays[1].modes


def test_what_was_finished_is_not_computed_again(tmp_path, monkeypatch) -> None:
    first = assess(BRIDGE, checkpoint=tmp_path)
    monkeypatch.setattr(assessment, "_stay", lambda *_: pytest.fail("computed again"))
    again = assess(BRIDGE, checkpoint=tmp_path)
    assert again.stays[0].modes[0].damping_needed == first.stays[0].modes[0].damping_needed
    assert again.stays[0].sentences == first.stays[0].sentences


def test_an_interrupt_keeps_the_stays_that_are_done(tmp_path) -> None:
    two = replace(BRIDGE, stays=(PAPER, replace(PAPER, name="second")))

    def stop(done: int, total: int, what: str) -> None:
        assert total == 2
        if what.startswith("second"):
            raise KeyboardInterrupt

    answer = assess(two, checkpoint=tmp_path, progress=stop, workers=1)
    assert answer.interrupted
    assert [stay.cable.name for stay in answer.stays] == ["paper"]
    assert len(list(tmp_path.glob("stay-*.json"))) == 1


def test_verdicts_follow_model_and_rule() -> None:
    quiet, loud = (replace(PAPER, damping_ratios=(xi,)) for xi in (0.1, 0.0001))
    verdicts = [assess(replace(BRIDGE, stays=(c,))).stays[0].verdict for c in (quiet, loud)]
    assert verdicts == ["sufficient", "insufficient"]


def test_sentences_name_what_decides() -> None:
    stay = assess(BRIDGE).stays[0]
    text = " ".join(stay.sentences)
    for word in ("m/s", "PTI", "%", "margin"):
        assert word in text
    assert "nan" not in text


def test_a_steep_stay_in_wind_along_it_still_meets_wind() -> None:
    steep = replace(PAPER, inclination=radians(89.0))
    mode = assess(replace(BRIDGE, stays=(steep,))).stays[0].modes[0]
    assert mode.speed_low.shape == (4, 3)


def test_cycles_are_the_mean_over_samples_of_the_hours_in_the_range() -> None:
    """Wind from every direction alike at 12 m/s, always wet: every hour in the range counts 3600 f cycles."""
    count = 4
    climate = Climate(
        np.full(count, 12.0),
        2 * pi * np.arange(count) / count,
        np.ones(count, dtype=bool),
        np.full(count, 2190.0),
        10.0,
    )
    mode = assess(BRIDGE, climate).stays[0].modes[0]
    assert mode.hours is not None
    assert mode.hours_dry is not None
    assert mode.cycles is not None
    assert mode.hours.high <= 8760.0
    assert mode.hours_dry.high == 0.0
    # two samples: the mean of their hours is the middle of the band
    assert mode.cycles.sum() == pytest.approx(3600.0 * mode.frequency_out * mode.hours.middle, rel=1e-9)
    assert mode.hours.middle > 0.0


def test_an_interrupt_stops_all_stays_that_are_computed_together(tmp_path) -> None:
    many = replace(BRIDGE, stays=tuple(replace(PAPER, name=f"S{k}") for k in range(8)))

    def stop(done: int, total: int, what: str) -> None:
        if done >= 3:
            raise KeyboardInterrupt

    answer = assess(many, checkpoint=tmp_path, progress=stop, workers=2)
    assert answer.interrupted
    assert len(answer.stays) < 8
    kept = len(list(tmp_path.glob("stay-*.json")))
    assert kept >= len(answer.stays)
    assert len(assess(many, checkpoint=tmp_path, workers=2).stays) == 8
