"""The reproduction's targets T1 to T15: each statement of the paper beside what the model gives."""

from collections.abc import Callable, Iterable, Iterator
from typing import Any

from rainwind.studies import targets_equilibria as equilibria
from rainwind.studies import targets_variations as variations
from rainwind.studies.targets_record import Outcome, Target
from rainwind.studies.targets_statements import STATEMENTS


def _later(what: str) -> Callable[[Any], Outcome]:
    return lambda model: Outcome(note=f"not computed yet: comes with {what}", verdict="not_computed")


CYCLES = "the limit cycles (collocation, multipliers, figure 7)"
COMPUTE: dict[str, Callable[[Any], Outcome]] = {
    "T1": equilibria.two_equilibria,
    "T2": equilibria.fold,
    "T3": equilibria.angle_of_d,
    "T4": equilibria.hopf_points,
    "T5": _later(CYCLES),
    "T6": _later(CYCLES),
    "T7": _later("the limit cycles and the time domain (figures 7 and 8); D's own angle is T3"),
    "T8": equilibria.damping_that_stops_it,
    "T9": _later("the bifurcations of limit cycles"),
    "T10": variations.rivulet_friction,
    "T11": variations.cable_frequency,
    "T12": variations.rivulet_mass,
    "T13": variations.degrees_of_freedom,
    "T14": variations.other_coefficients,
    "T15": _later(CYCLES),
}


def target(name: str, model: Any) -> Target:
    """One target, computed with `model`, which is the sample case or some change of it."""
    return Target(STATEMENTS[name], COMPUTE[name](model), is_fitted(name, model))


def is_fitted(name: str, model: Any) -> bool:
    """Whether the model's coefficient set was fitted to the target, as the set itself notes."""
    return STATEMENTS[name].fitted_key in model.coefficients.notes.get("fitted", {})


def targets(model: Any, names: Iterable[str] = tuple(STATEMENTS)) -> Iterator[Target]:
    """The targets one by one, so that whoever asks may stop between them."""
    for name in names:
        yield target(name, model)
