"""Sentences of answers made by hand: nothing that does not exist, no speeds in the wrong order, numbers to be read."""

from dataclasses import replace
from math import inf, nan, pi

import numpy as np
import pytest

from rainwind.engineering.answers import Band, ModeAnswer, StayAnswer
from rainwind.engineering.bridge import Bridge, Limits
from rainwind.engineering.cable import Cable
from rainwind.engineering.stay_sentences import stay_sentences, verdict

CABLE = Cable("1", 100.0, 0.1, 60.0, 3e6, 0.5, 1.0)
NOWHERE = Band(nan, nan, nan, 0.0)
NOTHING = Band(0.0, 0.0, 0.0)


def mode(number: int = 1, **changes: object) -> ModeAnswer:
    """A mode in which nothing vibrates."""
    none = np.full((2, 3), nan)
    given = ModeAnswer(
        number, 1.0, 1.1, 0.001, 0.002, {}, np.array([0.0, pi]), none, none, np.zeros(2), pi, NOWHERE, NOWHERE, 0.0,
        NOTHING, NOTHING, 0.003, np.array([5.0, 18.0]), np.zeros((2, 3)), NOTHING, NOWHERE, NOWHERE, lost=np.zeros(2),
    )  # fmt: skip
    return replace(given, **changes)  # type: ignore[arg-type]


def said(*modes: ModeAnswer, observed: tuple[float, float] = (5.0, 18.0)) -> str:
    stay = StayAnswer(CABLE, modes, (), "doubtful", ())
    text = " ".join(stay_sentences(stay, Bridge("b", (CABLE,), limits=Limits(observed_speeds=observed))))
    assert "nan" not in text
    assert "inf" not in text
    return text


def test_a_quiet_stay_is_quiet_in_all_modes() -> None:
    text = said(mode(1), mode(2))
    assert "no mode needs damping" in text
    assert "worst with wind" not in text
    assert "above" not in text


def test_a_range_beyond_the_observed_speeds_is_not_within_them() -> None:
    """25 to 40 m/s, observed to 18: nothing "within the observed speeds 25.0 to 18.0 m/s"."""
    text = said(mode(range_low=Band(20.0, 25.0, 30.0, 0.5), range_high=Band(40.0, 40.0, 40.0, 0.5)))
    assert "within the observed" not in text
    assert "outside the observed speeds, 5 to 18 m/s" in text
    assert "40.0 (40.0 to 40.0) m/s in 50 % of the samples; the middle" in text
    assert "worst with wind" not in text  # of no wind at these speeds


@pytest.mark.parametrize(
    ("low", "high", "part"),
    [(8.0, 14.0, ""), (3.0, 14.0, "5.0 to 14.0"), (8.0, 25.0, "8.0 to 18.0"), (3.0, 25.0, "5.0 to 18.0")],
)
def test_the_part_of_a_range_at_observed_speeds(low: float, high: float, part: str) -> None:
    bands = {"range_low": Band(low, low, low), "range_high": Band(high, high, high)}
    text = said(mode(**bands, damping_needed_observed=Band(0.001, 0.002, 0.003), worst_direction=pi / 8))
    assert (f"within the observed speeds {part} m/s" in text) is bool(part)
    assert "within the observed" not in text or part
    # the stay rises towards 57.3 degrees: 34.8 to one side of it and to the other
    assert "worst with wind from 22° (NNE) or 92° (E)." in text


def test_small_numbers_keep_digits_and_large_margins_lose_them() -> None:
    needed = Band(0.0, 1e-4, 1.5e-4)
    text = said(mode(damping_needed_observed=needed, amplitude=Band(0.004, 0.012, 0.02)))
    assert "needs 0.010 (0.000 to 0.015) % (margin above 10 at the high end)" in text
    assert "0.012 (0.004 to 0.020) m" in text
    # 0.2 % there, over 8 % needed, as the table beside it says
    assert "(margin 0.025 at the high end)" in said(mode(damping_needed_observed=Band(0.01, 0.02, 0.08)))
    assert "0.50 (0.20 to 0.90) m" in said(mode(amplitude=Band(0.2, 0.5, 0.9)))


def test_a_share_of_few_samples_is_not_none() -> None:
    bands = {
        "range_low": Band(8.0, 8.0, 8.0, 0.003),
        "range_high": Band(9.0, 9.0, 9.0, 0.003),
        "unlimited": 0.003,
    }
    text = said(mode(**bands))
    assert "in less than 1 % of the samples" in text
    assert "In less than 1 % of the samples mode 1 is still unstable" in text


def test_the_verdict_asks_model_and_rule_of_each_mode() -> None:
    """0.2 % there. Model: middle, high; rule: enough or not."""
    bands = {
        "little": Band(0.0, 0.0005, 0.001),
        "between": Band(0.0, 0.001, 0.003),
        "much": Band(0.0, 0.003, 0.004),
    }

    def one(needed: str, rule: float) -> ModeAnswer:
        return mode(damping_needed_observed=bands[needed], rule_damping=rule)

    def found(*modes: ModeAnswer) -> str:
        return verdict(StayAnswer(CABLE, modes, (), "doubtful", ()))

    assert found(one("little", 0.001)) == "sufficient"
    assert found(one("little", 0.003)) == "doubtful"
    assert found(one("between", 0.001)) == "doubtful"
    assert found(one("between", 0.003)) == "doubtful"
    assert found(one("much", 0.001)) == "doubtful"
    assert found(one("much", 0.003)) == "insufficient"
    assert found(one("much", 0.001), one("little", 0.003)) == "doubtful"  # not in one mode
    assert found(one("little", 0.001), one("much", 0.003)) == "insufficient"
    assert mode().margin == inf
