"""Predicted and observed side by side: the tables of docs/validation.md, and the same as data."""

from collections.abc import Callable, Iterator
from math import degrees

import numpy as np

from rainwind.engineering.answers import Band, ModeAnswer
from rainwind.engineering.criteria import rule_damping
from rainwind.io.results import Column, Table
from rainwind.studies.field_comparison import TOP, Comparison, Result
from rainwind.studies.field_rivulets import SmallVibrations, Three

__all__ = ["markdown", "rules_markdown", "tables"]

PERCENT = 100.0


def _rows(result: Result) -> Iterator[tuple[Comparison, ModeAnswer]]:
    """Each case with each of its modes."""
    for one in result.cases:
        for mode in one.modes:
            yield one, mode


def markdown(result: Result) -> dict[str, str]:
    """The four tables of docs/validation.md, by name: speeds, directions, amplitudes, damping."""
    return {
        name: _markdown(header, map(row, *zip(*_rows(result), strict=True))) for name, header, row in _TABLES
    }


def rules_markdown(cases: tuple[Three, ...]) -> str:
    """The fifth table: onset, end and damping by the rule for the rivulet, with one of one size and of one shape."""
    return _markdown(_RULES, (_rules_row(*three) for three in cases))


_RULES = (
    "case", "mode", "observed (m/s)", "onset, rule (m/s)", "onset, one size (m/s)", "onset, one shape (m/s)",
    "middle of the end: rule, size, shape", "needed/PTI, rule", "needed/PTI, one size", "needed/PTI, one shape",
)  # fmt: skip


def _rules_row(*three: SmallVibrations) -> tuple[str, ...]:
    case = three[0].case
    least = rule_damping(case.cable, case.site.density)
    return (
        case.name, f"{three[0].mode}", _span(case.speeds, 0), *(_three(one.onset, 1) for one in three),
        ", ".join(_end(one.end.middle) for one in three),
        *(f"{one.needed_observed.middle / least:.1f}, {one.needed.middle / least:.1f}" for one in three),
    )  # fmt: skip


def _markdown(header: tuple[str, ...], rows: Iterator[tuple[str, ...]]) -> str:
    lines = [header, ("---",) * len(header), *rows]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


def _speeds_row(one: Comparison, mode: ModeAnswer) -> tuple[str, ...]:
    open_ = f"{PERCENT * mode.unlimited:.0f} %"
    seen = one.case.reduced(mode.frequency_out) if one.case.mode in (None, mode.number) else None
    return (
        *_head(one, mode), _three(mode.range_low, 1), _span(one.case.speeds, 0),
        _high(mode.range_high), open_, _three(one.onset(mode), 0), _span(seen, 0),
    )  # fmt: skip


def _directions_row(one: Comparison, mode: ModeAnswer) -> tuple[str, ...]:
    case, worst = one.case, one.worst_yaw(mode)
    at = one.onset_at_seen_yaw(mode)
    tested = "" if case.tested_yaw is None else f"tested {_span(_degrees(case.tested_yaw), 0)}"
    return (
        *_head(one, mode), "–" if np.isnan(worst) else f"{degrees(worst):.0f}", _ranges(one.yaws(mode)),
        _span(_degrees(case.yaw), 0) if case.yaw else tested or "–",
        "–" if at is None else " / ".join(f"{value:.1f}" for value in at),
    )  # fmt: skip


def _amplitudes_row(one: Comparison, mode: ModeAnswer) -> tuple[str, ...]:
    seen, d = one.case.amplitude, one.case.cable.diameter
    said = one.case.mode in (None, mode.number)
    lost = "–" if mode.lost is None else f"{PERCENT * mode.lost.max():.0f} %"
    diameters = None if seen is None or not said else (seen[0] / d, seen[1] / d)
    return *_head(one, mode), _three(one.amplitude(mode), 1), _span(diameters, 1), lost


def _damping_row(one: Comparison, mode: ModeAnswer) -> tuple[str, ...]:
    rule, field = mode.rule_damping, one.case.field_damping
    return (
        *_head(one, mode), f"{PERCENT * mode.damping_total:.2g}", _percents(mode.damping_needed_observed),
        _percents(mode.damping_needed), f"{PERCENT * rule:.2f}", f"{mode.damping_needed_observed.middle / rule:.1f}",
        f"{mode.damping_needed.middle / rule:.1f}",
        "–" if field is None else f"{PERCENT * field[0]:g} to {PERCENT * field[1]:g}",
    )  # fmt: skip


_TABLES: tuple[tuple[str, tuple[str, ...], Callable[[Comparison, ModeAnswer], tuple[str, ...]]], ...] = (
    (
        "speeds",
        ("case", "mode", "f (Hz)", "onset, model (m/s)", "observed (m/s)", "end, model (m/s)", "open",
         "U/(f D) at onset", "U/(f D) observed"),
        _speeds_row,
    ),
    (
        "directions",
        ("case", "mode", "f (Hz)", "worst yaw, model (°)", "yaws of vibration, model (°)", "yaw observed (°)",
         "onset there, model (m/s)"),
        _directions_row,
    ),
    (
        "amplitudes",
        ("case", "mode", "f (Hz)", "model (D)", "observed (D)", "rivulet lost"),
        _amplitudes_row,
    ),
    (
        "damping",
        ("case", "mode", "f (Hz)", "there (%)", "needed, observed speeds (%)", "needed, all speeds (%)",
         "PTI (%)", "needed/PTI, observed", "needed/PTI, all", "enough in the field (%)"),
        _damping_row,
    ),
)  # fmt: skip


def _head(one: Comparison, mode: ModeAnswer) -> tuple[str, str, str]:
    return one.case.name, f"{mode.number}", f"{mode.frequency_out:.2f}"


def _three(band: Band, digits: int) -> str:
    if not band.exists:
        return "–"
    return " / ".join(f"{value:.{digits}f}" for value in (band.low, band.middle, band.high))


def _high(band: Band) -> str:
    """The end of the range; the end of what was looked at is a >."""
    return " / ".join(map(_end, (band.low, band.middle, band.high)))


def _end(value: float) -> str:
    return f">{TOP:.0f}" if value > TOP - 1e-6 else f"{value:.0f}"


def _percents(band: Band) -> str:
    return " / ".join(f"{PERCENT * value:.2f}" for value in (band.low, band.middle, band.high))


def _span(pair: tuple[float, float] | None, digits: int) -> str:
    if pair is None or np.isnan(pair[0]):
        return "–"
    low, high = (f"{value:.{digits}f}" for value in pair)
    if float(low) == 0.0 < float(high) and digits == 1:
        return f"up to {high}"
    return low if low == high else f"{low} to {high}"


def _ranges(pairs: tuple[tuple[float, float], ...]) -> str:
    return ", ".join(_span((degrees(low), degrees(high)), 0) for low, high in pairs) or "–"


def _degrees(pair: tuple[float, float] | None) -> tuple[float, float] | None:
    return None if pair is None else (degrees(pair[0]), degrees(pair[1]))


def tables(result: Result) -> dict[str, Table]:
    """One table, a row for each case and mode."""
    rows = list(_rows(result))

    def band(of: Callable[[Comparison, ModeAnswer], Band]) -> np.ndarray:
        return np.array([[b.low, b.middle, b.high] for b in (of(*row) for row in rows)])

    three = ("point", "quantile")
    return {
        "comparison": Table(
            {
                "case": Column(np.array([one.case.name for one, _ in rows])),
                "mode": Column(np.array([mode.number for _, mode in rows])),
                "frequency": Column(np.array([mode.frequency_out for _, mode in rows]), "Hz"),
                "observed_low": Column(np.array([one.case.speeds[0] for one, _ in rows]), "m/s"),
                "observed_high": Column(np.array([one.case.speeds[1] for one, _ in rows]), "m/s"),
                "onset": Column(band(lambda _, m: m.range_low), "m/s", "lowest unstable speed", three),
                "end": Column(band(lambda _, m: m.range_high), "m/s", "highest unstable speed", three),
                "unlimited": Column(np.array([m.unlimited for _, m in rows]), "", "share of samples"),
                "amplitude": Column(
                    band(lambda _, m: m.amplitude), "m", "half peak to peak at observed speeds", three
                ),
                "damping_needed": Column(band(lambda _, m: m.damping_needed), "", "at all speeds", three),
                "damping_needed_observed": Column(
                    band(lambda _, m: m.damping_needed_observed), "", "at observed speeds", three
                ),
                "rule_damping": Column(np.array([m.rule_damping for _, m in rows]), "", "PTI"),
            },
            {"quantiles": "0.05, 0.5, 0.95", "highest_speed": TOP},
        )
    }
