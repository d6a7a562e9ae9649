"""Will the stays of a bridge vibrate in rain and wind: every stay, mode and direction, each answer as a band.

For each mode an equivalent section with a rivulet by the rule for the stay's diameter (or the case's own); for each
coefficient set samples of its own of rivulet and slopes. The range of wind speeds is where small vibrations about the
upper rivulet grow; the amplitude is that of runs in time in the direction that needs the most damping.
"""

import os
from collections.abc import Callable, Iterator
from concurrent.futures import CancelledError, Future, ThreadPoolExecutor
from contextlib import suppress
from dataclasses import replace
from math import nan
from pathlib import Path
from threading import Event, Lock
from time import perf_counter

import numpy as np

from rainwind.engineering.answer_store import AnswerStore
from rainwind.engineering.answers import BridgeAnswer, ModeAnswer, StayAnswer
from rainwind.engineering.assumptions import assumption_sentences
from rainwind.engineering.bridge import Bridge, Question
from rainwind.engineering.cable import Cable
from rainwind.engineering.climate import Climate
from rainwind.engineering.criteria import code_checks
from rainwind.engineering.dampers import DampedMode, damped_modes, whole_number
from rainwind.engineering.mode_assessment import Setting
from rainwind.engineering.modes import cable_modes
from rainwind.engineering.remedies import remedy_sentences
from rainwind.engineering.rivulets import RIVULET_SCATTER, sample_factors
from rainwind.engineering.stay_sentences import stay_sentences, verdict
from rainwind.errors import RainwindError
from rainwind.physics.coefficient_files import load_coefficients

__all__ = ["Progress", "assess"]

Progress = Callable[[int, int, str], None]
"""done, total, what: called often, in no more than one thread at a time."""

_FAILURES = (RainwindError, ArithmeticError, ValueError, LookupError, np.linalg.LinAlgError)


def assess(
    bridge: Bridge,
    climate: Climate | None = None,
    *,
    checkpoint: Path | str | None = None,
    workers: int | None = None,
    progress: Progress | None = None,
    case_text: str = "",
) -> BridgeAnswer:
    """Assess every stay of a bridge; climate: its records, as `io.climate_files.read_climate` gives them.

    checkpoint: a folder in which each finished stay is kept; the same call goes on from there. workers: threads,
    None for one on each processor. A stay that fails stands in the answer with its reason; Ctrl-C, or a
    KeyboardInterrupt of `progress`, gives the stays that are done. case_text: the input file, which the report repeats.
    Raises InputError before anything is computed.
    """
    begin = perf_counter()
    sets = tuple(load_coefficients(name) for name in bridge.question.sets)
    sampled = tuple(zip(sets, _samples(bridge.question), strict=True))
    store = AnswerStore(checkpoint, bridge, sets, climate) if checkpoint is not None else None
    if workers is not None:
        whole_number("workers", workers)
    threads = workers or os.cpu_count() or 1
    together = min(threads, len(bridge.stays))
    setting = Setting(bridge, climate, sampled, max(1, threads // together))
    told = _Told(progress, len(bridge.stays) * bridge.question.modes)

    def answer(cable: Cable) -> StayAnswer:
        kept = store.kept(cable) if store is not None else None
        if kept is not None:
            told(cable, bridge.question.modes, "kept from before")
            return kept
        found = _stay(setting, cable, told)
        if store is not None and not found.failure:
            store.keep(found)
        with suppress(KeyboardInterrupt):  # it stops the others; this stay is done
            told(cable, bridge.question.modes, "failed" if found.failure else "done")
        return found

    done: list[StayAnswer] = []
    with ThreadPoolExecutor(together) as pool:
        futures = [pool.submit(answer, cable) for cable in bridge.stays]
        interrupted = False
        for future in futures:
            try:
                done.append(future.result())
            except (KeyboardInterrupt, CancelledError):
                interrupted = True
                _stop(told, futures)
            except BaseException:  # such as a full disk: not the others' work first
                _stop(told, futures)
                raise
    notes = tuple(climate.notes) if climate is not None else ()
    return BridgeAnswer(bridge, tuple(done), perf_counter() - begin, case_text, interrupted, notes)


def _samples(question: Question) -> Iterator[dict[str, np.ndarray]]:
    """The samples of each coefficient set: every so-and-so-many-th of one Latin hypercube for all of them."""
    many = len(question.sets)
    every = sample_factors(RIVULET_SCATTER, many * question.samples, question.seed)
    for first in range(many):
        yield {name: values[first::many] for name, values in every.items()}


class _Told:
    """Progress of stays that are computed together, told one at a time; once it is stopped, every stay stops."""

    def __init__(self, progress: Progress | None, total: int) -> None:
        self.progress, self.total = progress, total
        self.stop, self.lock = Event(), Lock()
        self.modes: dict[str, int] = {}

    def __call__(self, cable: Cable, modes: int, what: str) -> None:
        """So many modes of a stay are done. Raises KeyboardInterrupt where the user stopped it."""
        with self.lock:
            if self.stop.is_set():
                raise KeyboardInterrupt
            self.modes[cable.name] = modes
            if self.progress is None:
                return
            try:
                self.progress(sum(self.modes.values()), self.total, f"{cable.name}: {what}")
            except KeyboardInterrupt:
                self.stop.set()
                raise


def _stop(told: _Told, futures: list[Future[StayAnswer]]) -> None:
    """No stay begins any more, and those that are computed stop."""
    told.stop.set()
    for future in futures:
        future.cancel()


def _stay(setting: Setting, cable: Cable, told: _Told) -> StayAnswer:
    """One stay; a failure is an answer."""
    bridge = setting.bridge
    count = bridge.question.modes
    assumptions = tuple(assumption_sentences(bridge, cable))
    try:
        modes = cable_modes(cable, count)
        damped = _least_damped(cable, count)
        answers = []
        for mode, own in zip(modes, damped, strict=True):
            told(cable, mode.number - 1, f"mode {mode.number} of {count}")
            answers.append(setting.mode(cable, mode, own))
        checks = code_checks(
            cable, modes, [a.damping_total for a in answers], bridge.site.density,
            amplitude_at_15=_amplitude_at(answers, 15.0),
        )  # fmt: skip
    except _FAILURES as error:
        reason = f"{error}" if isinstance(error, RainwindError) else f"{type(error).__name__}: {error}"
        said = (f"Stay {cable.name} could not be assessed: {reason}",)
        return StayAnswer(cable, (), (), "failed", said, assumptions, reason)
    answer = StayAnswer(cable, tuple(answers), tuple(checks), "doubtful", (), assumptions)
    answer = replace(answer, verdict=verdict(answer))
    return replace(answer, sentences=(*stay_sentences(answer, bridge), *remedy_sentences(answer)))


def _least_damped(cable: Cable, count: int) -> list[DampedMode]:
    """Of each mode what its dampers add, in the plane of the stay (with sag) or out of it, whichever is less."""
    bending = cable.bending_stiffness > 0.0
    planes = [damped_modes(cable, count, sag=sag, bending=bending) for sag in (False, True)]
    return [min(pair, key=lambda mode: mode.damping_ratio) for pair in zip(*planes, strict=True)]


def _amplitude_at(answers: list[ModeAnswer], speed: float) -> float:
    """The largest of the modes' amplitudes at a speed, at the band's high end, m; nan beyond the speeds looked at."""
    if not answers[0].speeds[0] <= speed <= answers[0].speeds[-1]:
        return nan
    found = [np.interp(speed, a.speeds, np.nan_to_num(a.amplitudes[:, 2])) for a in answers]
    return float(max(found))
