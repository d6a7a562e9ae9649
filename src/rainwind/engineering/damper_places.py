"""Where dampers stand along a cable and how they resist, without dimensions."""

from collections.abc import Sequence

import numpy as np

from rainwind.engineering.cable import Cable, Damper
from rainwind.errors import InputError

__all__ = ["DamperPlaces"]

SAME_PLACE = 1e-9
"""Dampers closer than this share of the length stand at one place."""


class DamperPlaces:
    """The dampers of one cable. Lengths over L, eigenvalues over sqrt(T/m)/L, forces over T.

    places: (p,) from the lower anchorage, rising, each once. A damper of coefficient c on a support of stiffness k
    has the force Z v with Z = t c lambda/(1 + t c lambda/k), where t scales all coefficients together; the
    impedances of dampers at one place add. Raises InputError for a damper beyond mid-span.
    """

    def __init__(self, cable: Cable, dampers: Sequence[Damper]) -> None:
        length, tension = cable.length, cable.tension
        for damper in dampers:
            if damper.position >= length / 2:
                raise InputError(
                    f"a damper {damper.position:g} m from the {damper.end} anchorage of stay '{cable.name}', "
                    f"which is {length:g} m long, lies beyond mid-span; give the distance from the nearer anchorage"
                )
        shares = [damper.position / length for damper in dampers]
        at = np.array([x if d.end == "lower" else 1.0 - x for x, d in zip(shares, dampers, strict=True)])
        order = np.argsort(at, kind="stable")
        steps = np.diff(at[order], prepend=-1.0) > SAME_PLACE
        self.index = np.empty(len(at), dtype=int)
        """(d,): of the place at which each damper stands."""
        self.index[order] = np.cumsum(steps) - 1
        self.places = at[order][steps]
        self.eta = np.array([d.coefficient for d in dampers]) / np.sqrt(tension * cable.mass)
        """(d,): c/sqrt(T m)."""
        self.compliance = tension / length / np.array([d.support_stiffness for d in dampers])
        """(d,): T/(k L), zero for a rigid support."""
        self._adds = (self.index == np.arange(len(self.places))[:, None]).astype(float)

    def resistance(self, s: np.ndarray, t: complex) -> tuple[np.ndarray, np.ndarray]:
        """Z L/(T s) at each place and its derivative by s, both (p, n), for eigenvalues s (n,)."""
        each = t * self.eta[:, None] / (1.0 + self.compliance[:, None] * t * self.eta[:, None] * s)
        return self._adds @ each, self._adds @ (-self.compliance[:, None] * each**2)
