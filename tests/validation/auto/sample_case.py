"""The paper's sample case in AUTO-07p: the constants of each run, and the equations called directly."""

from __future__ import annotations

import ctypes
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from .auto_runner import Array, Auto, LabelledPoint, Run

EQUATIONS = Path(__file__).with_name("rainwind.f90")
STATES = ("y", "phi", "z", "y_dot", "phi_dot", "z_dot")
XI_RANGE = (0.0002, 0.01)

DEFAULT_TOLERANCES = {"EPSL": 1e-7, "EPSU": 1e-7, "EPSS": 1e-5}
TIGHT_TOLERANCES = {"EPSL": 1e-10, "EPSU": 1e-10, "EPSS": 1e-8}

COMMON: dict[str, Any] = {
    "unames": dict(enumerate(STATES, 1)),
    "parnames": {1: "U", 2: "xi"},
    "NDIM": 6,
    "IPS": 1,
    "ILP": 1,
    "ICP": [1],
    "NTST": 1,
    "NCOL": 4,
    "IAD": 3,
    "ISP": 2,
    "ISW": 1,
    "MXBF": 0,
    "NMX": 20000,
    "NPR": 1000000,
    "IID": 2,
    "ITMX": 9,
    "ITNW": 7,
    "NWTN": 3,
    "JAC": 1,
    "DS": -0.01,
    "DSMIN": 1e-6,
    "DSMAX": 0.05,
    "IADS": 1,
} | DEFAULT_TOLERANCES

# D from 25 m/s down to the fold, then C up to 25 m/s again
EQUILIBRIA = COMMON | {"UZSTOP": {1: [4.0, 25.1]}}

# Starts at a Hopf point; PAR(2) comes first so that AUTO's "LP" is an extremum of the damping
HOPF_CURVE = COMMON | {"ISW": 2, "ICP": [2, 1], "UZSTOP": {2: list(XI_RANGE), 1: [4.0, 25.1]}}

# Starts at the fold. The curve is a straight line, for equilibria do not depend on xi: steps of xi alone
FOLD_CURVE = HOPF_CURVE | {"ILP": 0, "DS": 1e-4, "DSMIN": 1e-8, "DSMAX": 1e-4}

# Starts at a Hopf point
ORBITS = COMMON | {
    "IPS": 2,
    "ICP": [1, 11],
    "NTST": 40,
    "NPR": 0,
    "NMX": 1500,
    "DS": 0.01,
    "DSMAX": 0.05,
    "UZSTOP": {1: [4.0, 25.1]},
}

# The whole branch of cycles at xi = 0.2 %, from the Hopf point on D to that on C; at its end AUTO would turn round
# and come back. 416 points with all labels
ORBIT_BRANCH = ORBITS | {"NTST": 60, "NMX": 1000, "DSMAX": 0.037, "UZSTOP": {1: [8.0642, 25.1]}}

# Curves of cycles in (U, xi), 200 points each. Each takes two runs: the first, from a labelled point of ORBIT_BRANCH,
# only makes the starting data (`extended`); the second starts from there
LPC_CURVE = ORBITS | {
    "ISW": 2,
    "ICP": [1, 2, 11],
    "NTST": 60,
    "NMX": 200,
    "UZSTOP": {1: [4.0, 25.1], 2: [1e-4, 0.01]},
}
# towards more damping, to the fold-Hopf point at 7.997 m/s, where it begins
NS_CURVE = LPC_CURVE | {"DSMAX": 0.0243, "UZSTOP": {1: [7.998, 25.1], 2: [1e-4, 0.01]}}
PD_CURVE = LPC_CURVE


def tight(constants: Mapping[str, Any]) -> dict[str, Any]:
    """The same run with tight tolerances."""
    return dict(constants) | TIGHT_TOLERANCES


def backward(constants: Mapping[str, Any]) -> dict[str, Any]:
    """The same run in the other direction."""
    return dict(constants) | {"DS": -constants["DS"]}


def fold_and_hopf_points(branch: Run) -> tuple[LabelledPoint, LabelledPoint, LabelledPoint]:
    """The fold, the Hopf point on D and that on C, from a run of EQUILIBRIA at xi = 0.2 %."""
    (fold,) = branch.points("LP")
    on_d, on_c = branch.points("HB")
    return fold, on_d, on_c


def extended(auto: Auto, curve: Mapping[str, Any], start: LabelledPoint) -> LabelledPoint:
    """AUTO's starting data of a curve of cycles: the cycle with its null vectors."""
    return auto.run(curve, start).labelled[-1]


class Equations:
    """f and its derivatives, called straight from the compiled Fortran."""

    def __init__(self, auto: Auto) -> None:
        self.func = ctypes.CDLL(str(auto.shared_library())).func_

    def __call__(self, state: Array, speed: float, damping_ratio: float) -> tuple[Array, Array, Array]:
        """f of shape (6,), its Jacobian (6, 6), and its derivatives by (speed, damping ratio), (6, 2)."""
        u = np.array(state, dtype=float)
        par = np.zeros(36)
        par[:2] = speed, damping_ratio
        f, dfdu, dfdp = np.zeros(6), np.zeros((6, 6), order="F"), np.zeros((6, 36), order="F")
        pointers = [a.ctypes.data_as(ctypes.c_void_p) for a in (u, par, f, dfdu, dfdp)]
        icp = (ctypes.c_int * 2)(1, 2)
        n, ijac = ctypes.byref(ctypes.c_int(6)), ctypes.byref(ctypes.c_int(2))
        self.func(n, pointers[0], icp, pointers[1], ijac, *pointers[2:])
        return f, np.ascontiguousarray(dfdu), np.ascontiguousarray(dfdp[:, :2])

    def eigenvalues(self, point: LabelledPoint) -> np.ndarray:
        """Eigenvalues of the Jacobian at a point, largest real part first; shape (6,), complex."""
        _, jacobian, _ = self(point.state[:6], point.parameters[0], point.parameters[1])
        values = np.linalg.eigvals(jacobian)
        return values[np.lexsort((values.imag, -values.real.round(10)))]
