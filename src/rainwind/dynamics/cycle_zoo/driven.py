"""Linear systems driven by a normal-form oscillator: cycles and multipliers in closed form."""

from math import log, pi, sqrt
from typing import Any

import numpy as np

from rainwind.dynamics.cycle_zoo.known import Cycle, KnownCycles, Parameters
from rainwind.dynamics.system import System


def circle(cosine: Any, sine: Any, turn: Any) -> tuple[Any, Any]:
    """r' = r (1 - r^2), theta' = turn: the unit circle, with multiplier exp(-2 T) across it."""
    growth = 1 - cosine**2 - sine**2
    return growth * cosine - turn * sine, turn * cosine + growth * sine


def forced_oscillator() -> KnownCycles:
    """x'' + 2 d x' + x = drive cos(frequency t): one cycle, no special point, multipliers from s^2 + 2 d s + 1."""

    def rhs(x: Any, p: Any) -> Any:
        acceleration = p.drive * x.cosine - 2 * p.damping * x.speed - x.place
        return x.speed, acceleration, *circle(x.cosine, x.sine, p.frequency)

    def all_cycles(p: Parameters) -> list[Cycle]:
        w, d = p["frequency"], p["damping"]
        response = p["drive"] / (1 - w**2 + 2j * d * w)
        period = 2 * pi / w

        def at(t: Any) -> np.ndarray:
            wave: Any = np.exp(1j * w * np.asarray(t))
            place = response * wave
            return np.stack([place.real, (1j * w * place).real, wave.real, wave.imag], axis=-1)

        roots = np.array([-d + 1j * sqrt(1 - d**2), -d - 1j * sqrt(1 - d**2)])
        exponents = np.array([*(roots * period), 0, -2 * period], complex)
        return [Cycle("main", p, period, at, exponents)]

    system = System(
        rhs, ("place", "speed", "cosine", "sine"), {"frequency": 0.6, "damping": 0.05, "drive": 1.0}
    )
    return KnownCycles(system, "frequency", (0.3, 3.0), all_cycles)


STIFF_POWERS = (2.0, -5.0, -20.0, -40.0)


def stiff() -> KnownCycles:
    """z_i' = rate_i z_i + drive cos(theta), period 1: multipliers 1e2, 1, exp(-2), 1e-5, 1e-20, 1e-40."""
    rates = [power * log(10.0) for power in STIFF_POWERS]
    names = tuple(f"z{i}" for i in range(len(rates)))

    def rhs(x: Any, p: Any) -> Any:
        lags = [rate * x[name] + p.drive * x.cosine for name, rate in zip(names, rates, strict=True)]
        return *circle(x.cosine, x.sine, 2 * pi), *lags

    def all_cycles(p: Parameters) -> list[Cycle]:
        def at(t: Any) -> np.ndarray:
            wave: Any = np.exp(2j * pi * np.asarray(t))
            lags = [(p["drive"] * wave / (2j * pi - rate)).real for rate in rates]
            return np.stack([wave.real, wave.imag, *lags], axis=-1)

        return [Cycle("main", p, 1.0, at, np.array([0.0, -2.0, *rates], complex))]

    system = System(rhs, ("cosine", "sine", *names), {"drive": 1.0})
    return KnownCycles(system, "drive", (0.5, 3.0), all_cycles)
