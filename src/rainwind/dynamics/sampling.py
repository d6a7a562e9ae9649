"""Which parameters and starts an ensemble has: grids, Latin hypercubes, Sobol's points, or arrays as they are."""

from collections.abc import Mapping
from dataclasses import dataclass
from math import log2
from typing import Any

import numpy as np

from rainwind.dynamics.system import number
from rainwind.errors import InputError


@dataclass(frozen=True, eq=False, repr=False)
class Sample:
    """N values of each varied quantity. values: name -> (N,); shape: of the grid they lie on, (N,) where on none;
    axes: of a grid, name -> its values along that axis."""

    values: Mapping[str, np.ndarray]
    shape: tuple[int, ...]
    axes: Mapping[str, np.ndarray]

    def __len__(self) -> int:
        return int(np.prod(self.shape))

    def __repr__(self) -> str:
        shape = " x ".join(map(str, self.shape))
        return f"<{shape} values of {', '.join(self.values)}>"


def grid(axes: Mapping[str, Any]) -> Sample:
    """All combinations of some values: name -> (m,); the last name varies fastest. Raises InputError."""
    checked = {name: _array(name, values) for name, values in _mapping(axes, "grid").items()}
    for name, values in checked.items():
        if np.unique(values).size < values.size:
            raise InputError(f"grid: '{name}' has a value twice; give each once")
    columns = np.meshgrid(*checked.values(), indexing="ij")
    values = {name: column.ravel() for name, column in zip(checked, columns, strict=True)}
    return Sample(values, tuple(len(v) for v in checked.values()), checked)


def latin_hypercube(of: Mapping[str, Any], count: int, *, seed: int = 0) -> Sample:
    """`count` points, one in each of `count` layers of equal probability of every quantity.

    of: name -> (low, high) for any value between with equal probability, or a distribution: `normal`, `lognormal`, any
    frozen one of scipy.stats. Raises InputError.
    """
    from scipy.stats import qmc

    of, count = _mapping(of, "latin_hypercube"), _count(count)
    return _spread(of, qmc.LatinHypercube(len(of), rng=np.random.default_rng(_seed(seed))).random(count))


def sobol(of: Mapping[str, Any], count: int, *, seed: int = 0) -> Sample:
    """`count` scrambled points of Sobol's sequence, which fill space evenly; a power of two does best.

    of: as `latin_hypercube`. Raises InputError, for a count that is no power of two too: others lose the balance.
    """
    from scipy.stats import qmc

    of, count = _mapping(of, "sobol"), _count(count)
    if not log2(count).is_integer():
        near = 2 ** max(1, round(log2(count)))
        raise InputError(f"sobol: count = {count} is no power of two; give {near}, or take latin_hypercube")
    points = qmc.Sobol(len(of), rng=np.random.default_rng(_seed(seed))).random(count)
    return _spread(of, points)


def uniform(low: float, high: float) -> Any:
    """Any value between two with equal probability, for `latin_hypercube` and `sobol`. Raises InputError."""
    from scipy import stats

    low, high = number(low, "uniform: low"), number(high, "uniform: high")
    if not low < high:
        raise InputError(f"uniform: low = {low:g} must lie below high = {high:g}")
    return stats.uniform(low, high - low)


def normal(mean: float, deviation: float) -> Any:
    """A normal distribution by mean and standard deviation. Raises InputError."""
    from scipy import stats

    if not number(deviation, "normal: deviation") > 0.0:
        raise InputError(f"normal: deviation = {deviation!r} must be positive")
    return stats.norm(number(mean, "normal: mean"), deviation)


def lognormal(median: float, spread: float) -> Any:
    """A quantity whose logarithm is normal: its median, and the standard deviation of the logarithm (0.1: about 10 %
    up or down). Raises InputError."""
    from scipy import stats

    if not number(median, "lognormal: median") > 0.0 or not number(spread, "lognormal: spread") > 0.0:
        raise InputError(f"lognormal: median = {median!r} and spread = {spread!r} must be positive")
    return stats.lognorm(spread, scale=median)


def as_sample(varying: Any) -> Sample | None:
    """What `ensemble(varying=...)` was given: a sample, or arrays (N,) by name. Raises InputError."""
    if varying is None or isinstance(varying, Sample):
        return varying
    arrays = {name: _array(name, values) for name, values in _mapping(varying, "varying").items()}
    lengths = {name: values.size for name, values in arrays.items()}
    if len(set(lengths.values())) > 1:
        raise InputError(
            f"varying: arrays of one length are needed, got {lengths}; for all combinations give "
            "rw.grid({...}) instead"
        )
    (many,) = set(lengths.values())
    return Sample(arrays, (many,), {})


def _spread(of: Mapping[str, Any], points: np.ndarray) -> Sample:
    columns: dict[str, np.ndarray] = {}
    for (name, given), shares in zip(of.items(), points.T, strict=True):
        pair = isinstance(given, tuple | list) and len(given) == 2
        distribution: Any = uniform(*given) if pair else given
        if not hasattr(distribution, "ppf"):
            raise InputError(
                f"'{name}': {given!r} is no distribution; give (low, high), rw.normal(...), rw.lognormal(...) or a "
                "frozen distribution of scipy.stats"
            )
        values = np.asarray(distribution.ppf(np.clip(shares, 1e-12, 1.0 - 1e-12)), dtype=float)
        columns[name] = _array(name, values)
    return Sample(columns, (len(points),), {})


def _mapping(given: Any, what: str) -> Mapping[str, Any]:
    if not isinstance(given, Mapping) or not given or not all(isinstance(name, str) for name in given):
        raise InputError(f"{what}: quantities go by name, for example {{'wind.speed': ...}}; got {given!r}")
    return given


def _array(name: str, values: Any) -> np.ndarray:
    try:
        array = np.array(values, dtype=float)
    except (TypeError, ValueError):
        raise InputError(f"'{name}': {values!r} is no array of numbers") from None
    if array.ndim != 1 or not array.size:
        raise InputError(f"'{name}' needs at least one value, in one row; got the shape {array.shape}")
    if not np.all(np.isfinite(array)):
        raise InputError(
            f"'{name}' has values that are no finite numbers: the first is number {_first(array)}"
        )
    return array


def _first(array: np.ndarray) -> int:
    return int(np.flatnonzero(~np.isfinite(array))[0])


def _count(count: Any) -> int:
    if isinstance(count, bool) or not isinstance(count, int | np.integer) or count < 1:
        raise InputError(f"count = {count!r}: give a whole number of 1 or more")
    return int(count)


def _seed(seed: Any) -> int:
    if isinstance(seed, bool) or not isinstance(seed, int | np.integer) or seed < 0:
        raise InputError(f"seed = {seed!r}: give a whole number of 0 or more")
    return int(seed)
