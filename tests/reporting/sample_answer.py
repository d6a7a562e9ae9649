"""A bridge of three stays with an answer made by hand: one with dampers and hours, one safe, one failed."""

from dataclasses import replace
from math import inf, nan, pi

import numpy as np

from rainwind.engineering.answers import Band, BridgeAnswer, CodeCheck, ModeAnswer, StayAnswer
from rainwind.engineering.bridge import Bridge, Question
from rainwind.engineering.cable import Cable, Damper

CASE_TEXT = 'name = "Brücke"\n\n[[stay]]\nname = "S1"  # <b>&\n'
NONE = Band(nan, nan, nan, 0.0)
NASTY = (
    "#set page(width: 1cm)",
    "$x^2$ and $",
    "<b>bold</b><script>alert(1)</script>",
    "=1+1",
    "@import",
    "Seil Ä ö ü ß ∆",
    "a \"quoted\" 'name'",
    "back\\slash \\",
    "-2+3",
    "+4",
    "*/ // [x](y) ~ _a_ `b`",
    "W" * 300,
    "\x01control\x0b",
    "snow ☃ 橋 \U0001f309",
)


def cable(name: str = "S1", **changes: object) -> Cable:
    """A stay of 120 m."""
    settings: dict[str, object] = {
        "length": 120.0,
        "diameter": 0.16,
        "mass": 60.0,
        "tension": 3.0e6,
        "inclination": 0.6,
        "heading": 0.0,
        "chainage": 20.0,
        **changes,
    }
    return Cable(name, **settings)  # type: ignore[arg-type]


def mode(number: int = 1, **changes: object) -> ModeAnswer:
    """A mode that vibrates, of a stay without dampers."""
    directions = 2 * pi * np.arange(12) / 12
    hit = np.abs(directions - pi / 2) < 0.8
    low = np.where(hit[:, None], [[6.0, 7.0, 8.5]], nan)
    speeds = np.linspace(3.0, 40.0, 14)
    amplitudes = np.exp(-(((speeds - 12.0) / 4.0) ** 2))[:, None] * [[0.11, 0.23, 0.37]]
    made = ModeAnswer(
        number=number,
        frequency_in=0.93 * number,
        frequency_out=0.92 * number,
        damping_own=0.0011,
        damping_total=0.0011,
        scruton={"PTI": 2.1, "Eurocode": 26.4, "twice": 4.2},
        directions=directions,
        speed_low=low,
        speed_high=low + 9.0,
        share=np.where(hit, 0.8, 0.0),
        worst_direction=pi / 2,
        range_low=Band(6.1, 7.2, 8.6, 0.81),
        range_high=Band(15.3, 19.4, 39.7, 0.81),
        unlimited=0.13,
        damping_needed=Band(0.0021, 0.0043, 0.0087),
        damping_needed_observed=Band(0.0019, 0.0034, 0.0059),
        rule_damping=0.0052,
        speeds=speeds,
        amplitudes=amplitudes,
        amplitude=Band(0.11, 0.23, 0.37, 0.81),
        build_up=Band(31.0, 64.0, 128.0, 0.81),
        uplift=Band(0.011, 0.017, 0.026),
        lost=np.zeros(14),
        stability_speeds=np.array([3.0, 8.0, 15.0, 40.0]),
        stability_needed=np.array(
            [[0.0, 0.0, 0.0], [0.001, 0.003, 0.005], [0.0019, 0.0034, 0.0059], [0.0, 0.001, 0.002]]
        ),
        galloping_speed=31.3,
        vortex_speed=0.744,
    )
    return replace(made, **changes)  # type: ignore[arg-type]


def damped_mode(number: int = 1) -> ModeAnswer:
    """A mode with dampers and hours a year."""
    plain = mode(number)
    return replace(
        plain,
        damping_total=0.0048,
        amplitudes_undamped=1.7 * plain.amplitudes,
        amplitude_undamped=Band(0.21, 0.43, 0.67, 0.9),
        stroke=Band(0.0042, 0.0071, 0.0123),
        force=Band(310.0, 720.0, 1410.0),
        hours=Band(2.3, 5.4, 11.2),
        hours_dry=Band(61.0, 93.0, 141.0),
        hours_observed=Band(2.2, 4.9, 8.3),
        cycle_edges=np.array([0.0, 0.1, 0.2, 0.4]),
        cycles=np.array([1.2e3, 3.4e4, 5.6e2]),
    )


def calm_mode(number: int = 1) -> ModeAnswer:
    """A mode that nothing excites."""
    plain = mode(number)
    none = np.full_like(plain.speed_low, nan)
    return replace(
        plain,
        damping_total=0.02,
        damping_own=0.02,
        speed_low=none,
        speed_high=none,
        share=np.zeros(12),
        worst_direction=nan,
        range_low=NONE,
        range_high=NONE,
        unlimited=0.0,
        damping_needed=Band(0.0, 0.0, 0.0),
        damping_needed_observed=Band(0.0, 0.0, 0.0),
        amplitudes=np.zeros((14, 3)),
        amplitude=Band(0.0, 0.0, 0.0),
        build_up=NONE,
        lost=None,
        galloping_speed=inf,
    )


def checks() -> tuple[CodeCheck, ...]:
    """One that passes and one that does not."""
    return (
        CodeCheck("PTI", "Scruton number", 2.1, 10.0, "", "at least", False, "PTI"),
        CodeCheck("EN 1993-1-11", "damping, mode 1", 0.61, 0.5, "%", "at least", True, "EN 1993-1-11"),
    )


def sample_answer() -> BridgeAnswer:
    """Three stays: insufficient with dampers, sufficient, failed."""
    first = cable("S1", dampers=(Damper(3.0, 5e4),), assumed=("bending_stiffness",))
    second = cable("S2", chainage=40.0, heading=pi)
    third = cable("S3", chainage=60.0)
    bridge = Bridge(
        "Test Bridge",
        (first, second, third),
        question=Question(modes=2, directions=12),
        assumptions=("The mass is that of the strands.",),
        sources=("Drawing 12 (read)",),
    )
    stays = (
        StayAnswer(
            first,
            (damped_mode(1), damped_mode(2)),
            checks(),
            "insufficient",
            (
                "Rain-wind vibration is possible.",
                "For the high end of the band a damper would have to add 0.5 %.",
            ),
            ("The rivulet follows the rule.", "No profile."),
        ),
        StayAnswer(second, (calm_mode(1), calm_mode(2)), checks(), "sufficient", ("Nothing happens.",)),
        StayAnswer(third, (), (), "failed", ("Stay S3 could not be assessed: too slack.",), (), "too slack"),
    )
    return BridgeAnswer(bridge, stays, 12.3, CASE_TEXT)


def nasty_answer() -> BridgeAnswer:
    """Stays whose names try to be something else."""
    stays = tuple(
        StayAnswer(
            cable(name, dampers=(Damper(3.0, 5e4),)),
            (damped_mode(1),),
            checks(),
            "doubtful",
            (name,),
            (name,),
        )
        for name in NASTY
    )
    bridge = Bridge(
        "Brücke #1 $ <b> \\ @", tuple(stay.cable for stay in stays), assumptions=NASTY, sources=NASTY
    )
    return BridgeAnswer(bridge, stays, 1.0, "\n".join(NASTY), climate_notes=NASTY)
