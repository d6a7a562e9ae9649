"""The reproduction's targets T1 to T15: each statement of the paper beside what the model gives."""

from collections.abc import Callable, Iterable, Iterator
from typing import Any

from rainwind.studies import targets_cycles as cycles
from rainwind.studies import targets_equilibria as equilibria
from rainwind.studies import targets_variations as variations
from rainwind.studies.targets_record import Outcome, Target
from rainwind.studies.targets_statements import STATEMENTS

COMPUTE: dict[str, Callable[[Any], Outcome]] = {
    "T1": equilibria.two_equilibria,
    "T2": equilibria.fold,
    "T3": equilibria.angle_of_d,
    "T4": equilibria.hopf_points,
    "T5": cycles.folds_of_cycles,
    "T6": cycles.direction,
    "T7": cycles.swing,
    "T8": cycles.damping_that_stops_it,
    "T9": cycles.low_damping,
    "T10": variations.rivulet_friction,
    "T11": variations.cable_frequency,
    "T12": variations.rivulet_mass,
    "T13": variations.degrees_of_freedom,
    "T14": variations.other_coefficients,
    "T15": cycles.amplitude,
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
