"""Van der Pol's cycle at five stiffnesses: period, amplitude and multiplier to 20 digits."""

from math import sqrt
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

from rainwind.dynamics.cycle_zoo.known import Cycle, KnownCycles, Parameters
from rainwind.dynamics.system import System

# mu: (period, amplitude, logarithm of the multiplier) of x'' - mu (1 - x^2) x' + x = 0, from Taylor series of order
# 26 in 28 digits (mpmath). The literature's periods agree: 6.6632868593 (mu = 1), 11.6122306677 (5),
# 19.0783695669 (10).
TABLE = {
    0.1: (6.287111272288726806054, 2.000103979872795923818, -0.6291039210260195955762),
    1.0: (6.6632868593231301897, 2.00861986087484313651, -7.058932808798959179022),
    5.0: (11.61223066771957003456, 2.021508061562321323839, -85.4520185448835406513),
    10.0: (19.07836956693901407043, 2.014285360926405285328, -311.8442192862280184919),
    20.0: (34.68232331165268356712, 2.007789970865430297275, -1194.764379909780095005),
}


def van_der_pol(born: bool = True) -> KnownCycles:
    """x' = y, y' = mu (1 - x^2) y - x; with `born`, y' = (mu - x^2) y - x, its cycle sqrt(mu) times as large.

    The cycle is born at mu = 0, only in the second form from a Hopf point that is not degenerate. Cycles are known at
    the table's values of mu.
    """

    def rhs(x: Any, p: Any) -> Any:
        growth = p.mu - x.x**2 if born else p.mu * (1 - x.x**2)
        return x.y, growth * x.y - x.x

    system = System(rhs, ("x", "y"), {"mu": 1.0})

    def all_cycles(p: Parameters) -> list[Cycle]:
        if p["mu"] not in TABLE:
            return []
        period, amplitude, exponent = TABLE[p["mu"]]
        start = np.array([amplitude * (sqrt(p["mu"]) if born else 1.0), 0.0])

        def at(t: Any) -> np.ndarray:
            run = solve_ivp(
                lambda _, x: system.f(x, p),
                (0, period),
                start,
                "DOP853",
                rtol=1e-13,
                atol=1e-13,
                dense_output=True,
            )
            return np.moveaxis(run.sol(np.mod(t, period).ravel()).reshape(2, *np.shape(t)), 0, -1)

        return [Cycle("main", p, period, at, np.array([0.0, exponent], complex))]

    if born:
        return KnownCycles(system, "mu", (-0.5, 25.0), all_cycles, equilibrium=(0.0, 0.0), hopf=0.0)
    return KnownCycles(system, "mu", (0.02, 25.0), all_cycles)
