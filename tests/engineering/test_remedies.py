"""The damper that a remedy names, put on the stay, adds what its modes need; one nearer the anchorage does not."""

import re
from dataclasses import replace

import numpy as np
import pytest

from rainwind.engineering.answers import Band, ModeAnswer, StayAnswer
from rainwind.engineering.cable import Cable, Damper
from rainwind.engineering.damper_design import design_for
from rainwind.engineering.dampers import damped_modes
from rainwind.engineering.remedies import damper_remedy, remedy_sentences

CABLE = Cable("7", 120.0, 0.16, 65.0, 3e6, 0.6, 0.0, damping_ratios=(0.001,))
ONE = Band(1.0, 2.0, 3.0)
NOTHING = np.full((4, 3), np.nan)


def answer(*needs: Band, verdict: str = "insufficient") -> StayAnswer:
    modes = tuple(
        ModeAnswer(
            k, float(k), float(k), 0.001, 0.001, {}, np.arange(4.0), NOTHING, NOTHING, np.zeros(4), 0.0, ONE, ONE, 0.0,
            need, need, 0.003, np.arange(2.0), NOTHING[:2], ONE, ONE, ONE,
        )
        for k, need in enumerate(needs, 1)
    )  # fmt: skip
    return StayAnswer(CABLE, modes, (), verdict, ())  # type: ignore[arg-type]


def test_the_damper_adds_what_every_mode_needs() -> None:
    remedy = damper_remedy(answer(Band(0.002, 0.006, 0.02), Band(0.001, 0.004, 0.01)), "middle")
    assert remedy.targets == pytest.approx({1: 0.005, 2: 0.003})
    assert remedy.design is not None
    for c in (remedy.design.low * 1.01, remedy.design.coefficient, remedy.design.high * 0.99):
        added = [m.damping_ratio for m in damped_modes(CABLE, 2, [Damper(remedy.design.position, c)])]
        assert added[0] >= 0.005 * 0.999
        assert added[1] >= 0.003 * 0.999


def test_nearer_than_the_least_position_nothing_does() -> None:
    remedy = damper_remedy(answer(Band(0.002, 0.006, 0.02)), "middle")
    assert remedy.design is not None
    least = remedy.design.least_position
    assert least == pytest.approx(
        2 * 0.005 * CABLE.length, rel=0.02
    )  # half of x_d/L at most, section 3 of Krenk
    assert design_for(CABLE, remedy.targets, 0.98 * least).margin < 1.0
    assert design_for(CABLE, remedy.targets, 1.02 * least).margin > 1.0


def test_what_no_damper_can_add_is_said() -> None:
    stay = answer(Band(0.01, 0.05, 0.4))
    assert damper_remedy(stay, "high").design is None
    middle, high = remedy_sentences(stay)
    assert re.search(r"; at \d+\.\d\d m, a coefficient of [\d.]+ to [\d.]+ kNs/m will do\.$", middle)
    assert "no single damper near the anchorage can do that" in high


def test_enough_damping_needs_no_remedy() -> None:
    assert not list(remedy_sentences(answer(Band(0.0, 0.0, 0.0))))
    assert not list(remedy_sentences(answer(Band(0.1, 0.2, 0.3), verdict="sufficient")))
    failed = replace(answer(), failure="no tension")
    assert not list(remedy_sentences(failed))


def test_a_little_damping_far_in_is_said_without_exponents() -> None:
    """0.02 % more: a damper 6 cm from the anchorage of thousands of kNs/m."""
    (sentence,) = remedy_sentences(answer(Band(0.0, 0.001, 0.0012)))
    assert "e+" not in sentence
    assert "(0.0 %" not in sentence


def test_a_remedy_stands_in_place_of_the_dampers_there_are() -> None:
    plain = answer(Band(0.002, 0.006, 0.02))
    damped = replace(plain, cable=replace(CABLE, dampers=(Damper(2.0, 1e4),)))
    assert [("in place of those it has" in next(iter(remedy_sentences(one)))) for one in (plain, damped)] == [
        False,
        True,
    ]
