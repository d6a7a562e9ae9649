"""Assessments of small bridges: the sample case's numbers, symmetry, failures, what is kept and what stops it."""

import time
from dataclasses import replace
from math import pi, radians

import numpy as np
import pytest

from rainwind.engineering import assessment, mode_assessment
from rainwind.engineering.answers import StayAnswer
from rainwind.engineering.assessment import assess
from rainwind.engineering.bridge import Bridge, Limits, Question
from rainwind.engineering.cable import Cable, Damper
from rainwind.engineering.climate import Climate
from rainwind.engineering.dampers import DampedMode
from rainwind.errors import InputError
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
    monkeypatch.setattr(
        assessment, "sample_factors", lambda _, count, __: {name: np.ones(count) for name in names}
    )


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


def test_a_stay_that_is_done_when_the_interrupt_comes_is_kept(tmp_path) -> None:
    two = replace(BRIDGE, stays=(PAPER, replace(PAPER, name="second")))

    def stop(done: int, total: int, what: str) -> None:
        if what == "paper: done":
            raise KeyboardInterrupt

    answer = assess(two, checkpoint=tmp_path, progress=stop, workers=1)
    assert answer.interrupted
    assert [stay.cable.name for stay in answer.stays] == ["paper"]
    assert len(list(tmp_path.glob("stay-*.json"))) == 1
    assert not assess(BRIDGE, progress=stop).interrupted  # nothing is missing


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


def test_a_vertical_stay_is_like_one_that_is_nearly_vertical() -> None:
    modes = [
        assess(replace(BRIDGE, stays=(replace(PAPER, inclination=radians(angle)),))).stays[0].modes[0]
        for angle in (89.999, 90.0)
    ]
    near, upright = (mode.damping_needed.high for mode in modes)
    assert upright == pytest.approx(near, rel=1e-2)
    assert upright > 0.0


def test_a_horizontal_stay_meets_no_wind_along_it() -> None:
    mode = assess(replace(BRIDGE, stays=(replace(PAPER, inclination=0.0),))).stays[0].modes[0]
    assert np.isnan(mode.speed_low[[0, 2]]).all()
    assert np.isfinite(mode.speed_low[[1, 3]]).all()


def test_observed_speeds_between_two_that_are_looked_at() -> None:
    narrow = replace(BRIDGE, limits=Limits(observed_speeds=(10.0, 10.1)))
    mode = assess(narrow).stays[0].modes[0]
    assert 0.0 < mode.damping_needed_observed.middle <= mode.damping_needed.middle


def test_no_rivulet_at_all_is_an_answer(unscattered) -> None:
    """Below 3 m/s there is none: no range, no damping needed, nothing that does not exist in the sentences."""
    still = replace(
        BRIDGE, question=replace(ONE, speeds=(1.0, 3.0)), limits=Limits(observed_speeds=(1.0, 3.0))
    )
    stay = assess(still).stays[0]
    (mode,) = stay.modes
    assert not mode.range_low.exists
    assert not mode.build_up.exists
    assert mode.damping_needed.high == 0.0
    assert mode.margin == np.inf
    assert not any("nan" in sentence for sentence in stay.sentences)


def test_a_stay_without_damping_is_insufficient() -> None:
    stay = assess(replace(BRIDGE, stays=(replace(PAPER, damping_ratios=(0.0,)),))).stays[0]
    assert stay.verdict == "insufficient"
    assert stay.margin == 0.0


def test_a_mode_that_a_damper_stops_is_an_answer(monkeypatch) -> None:
    """All but gone, it has no shape, and so its damper no stroke: a band that does not exist."""
    gone = DampedMode(1, 0.01, 0.995, (np.nan,))
    monkeypatch.setattr(assessment, "_least_damped", lambda *_: [gone])
    stay = assess(replace(BRIDGE, stays=(replace(PAPER, dampers=(Damper(40.0, 2e4),)),))).stays[0]
    (mode,) = stay.modes
    assert mode.stroke is not None
    assert mode.force is not None
    assert not mode.stroke.exists
    assert not mode.force.exists
    assert stay.verdict == "sufficient"


def test_a_climate_without_rain_has_no_hours_with_rain() -> None:
    dry = Climate(
        np.full(4, 12.0), 2 * pi * np.arange(4) / 4, np.zeros(4, dtype=bool), np.full(4, 2190.0), 10.0
    )
    mode = assess(BRIDGE, dry).stays[0].modes[0]
    assert mode.hours is not None
    assert mode.hours_dry is not None
    assert mode.cycles is not None
    assert mode.hours.high == 0.0 == mode.cycles.sum()
    assert mode.hours_dry.middle > 0.0


def test_the_amplitude_at_15_is_checked_only_where_it_is_known() -> None:
    slow, usual = (
        assess(replace(BRIDGE, limits=Limits(observed_speeds=bounds))).stays[0]
        for bounds in ((5.0, 12.0), (5.0, 18.0))
    )
    at_15 = [[check.what for check in stay.checks if "15 m/s" in check.what] for stay in (slow, usual)]
    assert at_15[0] == []
    assert len(at_15[1]) == 4


@pytest.mark.parametrize("workers", [0, -1, 1.5])
def test_a_number_of_threads_that_is_none_is_refused(workers) -> None:
    with pytest.raises(InputError, match="workers"):
        assess(BRIDGE, workers=workers)


def test_observed_speeds_outside_those_looked_at_are_refused() -> None:
    with pytest.raises(InputError, match="observed_speeds"):
        replace(BRIDGE, limits=Limits(observed_speeds=(41.0, 50.0)))


def test_a_full_disk_stops_the_other_stays(tmp_path, monkeypatch) -> None:
    many = replace(BRIDGE, stays=tuple(replace(PAPER, name=f"S{k}") for k in range(4)))
    begun: list[str] = []

    def stay(setting, cable, told):
        begun.append(cable.name)
        time.sleep(
            0.1
        )  # as if it computed: the one that meets the full disk is told before the others are through
        return StayAnswer(cable, (), (), "failed", ())

    def full(self, answer):
        raise OSError("no space left")

    monkeypatch.setattr(assessment, "_stay", stay)
    monkeypatch.setattr(assessment.AnswerStore, "keep", full)
    with pytest.raises(OSError, match="no space"):
        assess(many, checkpoint=tmp_path, workers=1)
    assert len(begun) < 4


def test_the_stability_diagram_tops_out_at_the_damping_needed() -> None:
    """Its line is to first order in the damping, the damping needed exact: a few per cent apart at most here."""
    mode = assess(replace(BRIDGE, question=replace(ONE, directions=36))).stays[0].modes[0]
    assert mode.stability_speeds is not None
    assert mode.stability_needed is not None
    assert mode.stability_needed.shape == (mode.stability_speeds.size, 3)
    assert mode.stability_needed[0] == pytest.approx(np.zeros(3))  # 3 m/s: no rivulet
    inside = (mode.stability_speeds >= 5.0) & (mode.stability_speeds <= 18.0)
    top = mode.stability_needed[inside, 1].max()
    assert 0.85 * mode.damping_needed_observed.middle < top < 1.05 * mode.damping_needed_observed.middle
