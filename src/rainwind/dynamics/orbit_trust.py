"""Whether multipliers of an orbit may be believed, and what makes them wrong: mesh, rounding, or stiffness."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rainwind.dynamics.kernels import trust as kernel
from rainwind.dynamics.kernels.periodic_schur import log_multipliers

Complex = NDArray[np.complex128]

WRONG = 1e-3  # error of the trivial multiplier above which turns of the parameter may be the mesh's own
LOST = 0.1  # the same, by rounding: signs of what the parameter does are noise then
_EPS = float(np.finfo(float).eps)
_FLOOR = 0.3  # share of rounding in an error above which a finer mesh is not tried
_FAR = -12.0  # log|mu| below which a multiplier is far inside the circle, however wrong it is
_STIFF = 0.2  # of the sum of those far inside: Liouville's error that they may have made
UNSURE = 0.1  # error of log mu above which neither stability nor labels are certain
_TRIES = 3


@dataclass(frozen=True, slots=True)
class Doubt:
    """Why an orbit's multipliers are in doubt.

    rounding: the `trivial_error` that no mesh removes; spread: how far exponents move when the intervals'
    matrices change by as much as they are known to be wrong.
    """

    rounding: float = 0.0
    spread: float = 0.0


NONE = Doubt()


def trivial_error(trivial: complex, exponents: Complex) -> float:
    """How far the trivial multiplier is from 1, so that it has a meaning at folds and branch points too.

    Let (M - 1) f = e v for the flow f, |f| = |v| = 1: f closes but for a small e. Where the nearest other multiplier
    is 1 + d, one step of inverse iteration from f finds 1 + b e / d, b being the shear (M - 1) v . f. That
    grows without bound as d goes to zero, and the eigenvalues themselves, both about 1 + (b e)^(1/2), are no
    better. So what is returned is |mu - 1| times d, or times 1 where d is larger.
    """
    error = abs(_defect(trivial))
    distances = np.abs(exponents)
    return float(error * min(1.0, float(distances.min()) if distances.size else 1.0))


def doubt(
    steps: np.ndarray, flow: np.ndarray, factors: np.ndarray, trivial: complex, exponents: Complex
) -> Doubt:
    """Where the trivial multiplier is wrong: how much of that may be rounding, and what it means for exponents.

    steps (N, m n, .), flow (N + 1, n) and the multipliers of one and the same profile: after Newton's last
    step, not before it.
    """
    error = trivial_error(trivial, exponents)
    floor, wrong = kernel.flow_defects(steps, flow)
    floor *= error / max(abs(_defect(trivial)), 1e-300)  # the same units
    # on a coarse mesh the left vectors may miss the growth, which is there all the same
    floor = max(floor, _EPS * float(np.exp(min(kernel.magnified(factors, flow), 700.0))))
    return Doubt(min(floor, 1.0), _spread(factors, wrong, exponents))


def _defect(trivial: complex) -> complex:
    """mu - 1 from log mu."""
    return np.exp(min(trivial.real, 700.0) + 1j * trivial.imag) - 1.0


def _spread(factors: np.ndarray, wrong: np.ndarray, exponents: Complex) -> float:
    """How far exponents that are not far inside the circle move when each factor changes by `wrong`."""
    if not np.all(np.isfinite(wrong)):
        return float("inf")
    random = np.random.default_rng(0)
    near = np.maximum(exponents.real, _FAR)
    found = 0.0
    for _ in range(_TRIES):
        change = random.normal(size=factors.shape) / np.sqrt(max(factors.shape[-1], 1))
        moved = log_multipliers(factors + wrong[:, None, None] * change)
        if np.any(np.isnan(moved)):
            return float("inf")
        found = max(found, float(np.max(np.abs(np.maximum(moved.real, _FAR) - near), initial=0.0)))
    return found


def lost_in_rounding(found: Doubt) -> bool:
    """Whether rounding decides the signs of the parameter's direction and of the determinant, on any mesh."""
    return found.rounding >= LOST


def mesh_is_to_blame(error: float, found: Doubt) -> bool:
    """Whether the trivial multiplier is wrong, and rather by the mesh than by rounding."""
    return error > WRONG and found.rounding < min(LOST, _FLOOR * error)


def coarsening_is_safe(error: float, liouville: float, exponents: Complex, degree: int) -> bool:
    """Whether multipliers will still be right with two thirds of the intervals, by the order of their error."""
    larger = 1.5 ** (2 * degree)
    return error * larger < 0.1 * WRONG and stiffness(larger * liouville, exponents) == 0.0


def stiffness(liouville: float, exponents: Complex) -> float:
    """By how much log mu of multipliers not far inside may be wrong from rates too fast for the mesh, or 0.

    Gauss collocation turns exp(z) over an interval into a rational function of modulus 1 at z = -infinity. A
    disturbance that decays within a fraction of an interval then has a multiplier near the circle.
    Liouville's formula knows how much decay is missing. The decay of multipliers far inside may be the one
    that is missing, up to a fifth of what they have: they lose more only where their size tells nothing any
    more, past the rational function's minimum.
    """
    if abs(liouville) < UNSURE:
        return 0.0
    far = exponents.real <= _FAR
    if not np.isfinite(liouville) or np.all(far):
        return 0.0
    missing = abs(liouville) - _STIFF * float(np.abs(exponents.real[far & np.isfinite(exponents.real)]).sum())
    return missing if missing > UNSURE else 0.0


def intervals_for(many: int, degree: int, error: float, missing: float, most: int) -> int:
    """How many intervals an orbit should have whose trivial multiplier errs by `error` and decay by `missing`.

    The error of multipliers falls like many^(-2 degree). Decay is followed up to about exp(-2 degree) an
    interval; where not even `most` intervals would do, stiffness alone asks for none.
    """
    wanted = many
    if error > WRONG:
        wanted = int(many * min(3.0, max(1.5, (min(error, 1e6) / (0.1 * WRONG)) ** (0.5 / degree))))
    if missing and missing < 2 * degree * (most - many):
        wanted = max(wanted, int(1.5 * many))
    return min(wanted, most)


def words(trivial: complex, found: Doubt, liouville: float, exponents: Complex) -> str:
    """What a reader should know about the multipliers of an orbit, or nothing."""
    if abs(trivial) < WRONG and abs(liouville) < UNSURE:
        return ""
    error = trivial_error(trivial, exponents)
    missing = stiffness(liouville, exponents)
    if missing:
        return (
            "disturbances grow or decay faster than the mesh follows: the sum of log|mu| is wrong "
            "(Liouville's formula), and one inside the circle may be much smaller than computed; give more intervals"
        )
    if mesh_is_to_blame(error, found):
        return "the mesh is too coarse for the trivial multiplier; give more intervals"
    if found.spread > UNSURE:
        return "multipliers are lost in rounding: disturbances grow too far on their way round the orbit"
    return ""
