"""Every root of a smooth function of one variable: interval bisection on the function and its slope."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.optimize import brentq

from rainwind.physics.intervals import Box

_PIECES = 8
_SMALLEST = 1e-8
_MOST_BOXES = 50_000

Bracket = tuple[float, float]


@dataclass(frozen=True)
class Isolated:
    """brackets: intervals that hold one root each; unresolved: intervals that may hold any number of roots.

    Outside them there is no root. An unresolved interval with a change of sign across it is a bracket too.
    """

    brackets: tuple[Bracket, ...]
    unresolved: tuple[Bracket, ...]


@dataclass(frozen=True)
class _Boxes:
    """Adjacent boxes: the sign of function and slope in each (0: not known), and the signs beside them."""

    edges: np.ndarray
    signs: np.ndarray
    slopes: np.ndarray
    zero: np.ndarray
    left: int
    right: int


def isolate_roots(
    function: Callable[[Box], Box], edges: np.ndarray, *, first: Box, period: float | None = None, tiny: float
) -> Isolated:
    """Isolate the roots of `function` between the outer edges; `first` is its enclosure between the edges.

    With a `period`, the outer edges are the same point. Where the function stays below `tiny`, nothing is
    decided.
    A box without zero in the function's enclosure holds no root; a run of boxes between two others, without
    zero in the slope's enclosure, holds one root if the signs beside it differ.
    """
    signs, slopes, zero = _judge(first, tiny, len(edges) - 1)
    if period is not None and signs.any():
        # start at a box without root, so that no run of boxes reaches across the outer edges
        k = int(np.argmax(signs != 0))
        edges = np.concatenate([edges[k:], edges[1 : k + 1] + period])
        signs, slopes, zero = (np.roll(a, -k) for a in (signs, slopes, zero))
        left = right = int(signs[0])
    elif period is not None:
        left = right = 0
    else:
        ends = np.array([edges[0], edges[-1]])
        left, right = (int(s) for s in _judge(function(Box.variable(ends, ends)), tiny, 2)[0])

    brackets: list[Bracket] = []
    unresolved: list[Bracket] = []
    waiting = [_Boxes(edges, signs, slopes, zero, left, right)]
    spent = 0
    while waiting:
        for run in _runs_without_sign(waiting.pop()):
            low, high = float(run.edges[0]), float(run.edges[-1])
            crossed = run.left * run.right < 0
            if run.left and run.right and (np.all(run.slopes > 0) or np.all(run.slopes < 0)):
                if crossed:
                    brackets.append((low, high))
                continue
            widest = float(np.max(np.diff(run.edges)))
            if run.zero.all() or widest < _SMALLEST or spent > _MOST_BOXES:
                unresolved.append((low, high))
                if crossed:
                    brackets.append((low, high))
                continue
            finer = _subdivided(run.edges)
            spent += len(finer)
            signs, slopes, zero = _judge(_sharp(function, finer), tiny, len(finer) - 1)
            waiting.append(_Boxes(finer, signs, slopes, zero, run.left, run.right))
    return Isolated(tuple(sorted(brackets)), tuple(_merged(unresolved)))


def polished_root(function: Callable[[float], Any], bracket: Bracket) -> float:
    """The root inside the bracket, to rounding."""
    low, high = bracket
    at_low, at_high = float(function(low)), float(function(high))
    if at_low * at_high >= 0:
        return low if abs(at_low) <= abs(at_high) else high
    # a root at zero has no relative accuracy: hence the absolute one
    smallest = 1e-25 * max(abs(low), abs(high))
    rounding = 4 * np.finfo(float).eps
    root, _ = brentq(
        function, low, high, xtol=smallest, rtol=rounding, maxiter=1000, full_output=True, disp=False
    )
    return float(root)


def _sharp(function: Callable[[Box], Box], edges: np.ndarray) -> Box:
    """The enclosure between the edges, cut down by the mean value form: sharp where the slope is small."""
    lo, hi = edges[:-1], edges[1:]
    middle = 0.5 * (lo + hi)
    both = function(Box.variable(np.concatenate([lo, middle]), np.concatenate([hi, middle])))
    n = len(lo)
    (vlo, vhi), (slo, shi) = (
        (np.broadcast_to(bound, 2 * n) for bound in pair) for pair in (both.value, both.slope)
    )
    slope = slo[:n], shi[:n]
    mean = Box((vlo[n:], vhi[n:]), slope) + Box(slope, slope) * Box((lo - middle, hi - middle), slope)
    return Box((np.maximum(vlo[:n], mean.value[0]), np.minimum(vhi[:n], mean.value[1])), slope)


def _judge(box: Box, tiny: float, count: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    (lo, hi), (dlo, dhi) = box.value, box.slope
    signs = np.where(lo > 0, 1, np.where(hi < 0, -1, 0))
    slopes = np.where(dlo > 0, 1, np.where(dhi < 0, -1, 0))
    zero = (lo >= -tiny) & (hi <= tiny)
    signs = np.where(zero, 0, signs)
    return np.broadcast_to(signs, count), np.broadcast_to(slopes, count), np.broadcast_to(zero, count)


def _runs_without_sign(boxes: _Boxes) -> Iterator[_Boxes]:
    """The runs of adjacent boxes that may hold roots; pieces where the function vanishes stand alone."""
    kind = np.where(boxes.signs != 0, 0, np.where(boxes.zero, 1, 2))
    starts = np.flatnonzero(np.diff(kind, prepend=-1))
    for i, j in zip(starts, [*starts[1:], len(kind)], strict=True):
        if kind[i]:
            yield _Boxes(
                boxes.edges[i : j + 1],
                boxes.signs[i:j],
                boxes.slopes[i:j],
                boxes.zero[i:j],
                int(boxes.signs[i - 1]) if i else boxes.left,
                int(boxes.signs[j]) if j < len(kind) else boxes.right,
            )


def _subdivided(edges: np.ndarray) -> np.ndarray:
    parts = edges[:-1, None] + np.diff(edges)[:, None] * (np.arange(_PIECES) / _PIECES)
    return np.append(parts.ravel(), edges[-1])


def _merged(intervals: list[Bracket]) -> Iterator[Bracket]:
    """Intervals that touch are one."""
    current: Bracket | None = None
    for low, high in sorted(intervals):
        if current is not None and low <= current[1] + _SMALLEST:
            current = (current[0], max(current[1], high))
            continue
        if current is not None:
            yield current
        current = (low, high)
    if current is not None:
        yield current
