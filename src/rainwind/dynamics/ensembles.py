"""Many trajectories at once: starts and parameters that vary, a few numbers kept of each."""

import threading
from collections.abc import Callable, Iterator, Mapping, Sequence
from hashlib import sha256
from pathlib import Path
from time import monotonic
from typing import Any

import numpy as np

from rainwind import __version__
from rainwind.dynamics.checkpoints import Checkpoint
from rainwind.dynamics.ensemble_plan import NOT_DONE, Done, Plan, Rows, tape_key
from rainwind.dynamics.ensemble_results import Ensemble
from rainwind.dynamics.reductions import Lyapunov, View, checked, listed, stops
from rainwind.dynamics.run_inputs import run_drive, run_parameters, run_start, turning_states
from rainwind.dynamics.sampling import Sample, as_sample
from rainwind.dynamics.signals import Signal
from rainwind.dynamics.simulate import TOLERANCES
from rainwind.dynamics.system import System, as_system, number
from rainwind.dynamics.tangent_tape import with_tangents
from rainwind.dynamics.tape import Tape, trace_function
from rainwind.dynamics.tape_outputs import with_outputs
from rainwind.dynamics.workers import Workers, as_workers
from rainwind.errors import ComputationError, InputError, is_interrupt
from rainwind.parameters import unknown_name

Progress = Callable[[int, int, str], None]
_SMALLEST, _LARGEST = 64, 512  # trajectories of a chunk
_CHUNKS = 8  # for each worker, at least
_CHECKED = 4096  # combinations of parameters that the model looks at
_LOOKED_AT = 256  # starts
_FOLDS = 5.0  # by which powers of e a disturbance may change before it gets its length again
_FIRST_RATE = 2.0  # seconds before a rate is told


def ensemble(
    model: Any,
    start: Any = None,
    *,
    varying: Sample | Mapping[str, Any] | None = None,
    duration: float,
    wind: float | Signal | None = None,
    parameters: Mapping[str, float | Signal] | None = None,
    tolerance: float = 1e-9,
    reduce: Any = ("extremes",),
    observe: Mapping[str, Callable[[Any, Any], Any]] | None = None,
    workers: Any = None,
    checkpoint: Path | str | None = None,
    chunk: int | None = None,
    most_steps: int = 10_000_000,
    progress: Progress | None = None,
) -> Ensemble:
    """Follow a system from many starts, or at many parameters, and keep a few numbers of each trajectory.

    start: one state as `simulate` takes it, or (N, n); None: zeros. varying: values of parameters or states (of a
    state: of its start) by name, each (N,), or a sample: `grid`, `latin_hypercube`, `sobol`. wind, parameters: as
    `simulate`, the same for all. reduce: what is kept besides the final states: "extremes", "mean", "settled",
    "lyapunov", or objects such as `Extremes(since=200.0)`, `Returns("y")`, `TimeTo("y", 0.1)`. observe: functions
    (x, p) -> number by name, which reductions may name like states; "energy" is there for a model that offers one.
    workers: a number of threads, `Processes(n)`, `Cluster(address)` or the address; None: a thread for each
    processor. checkpoint: a folder in which finished chunks are kept, and from which the same call goes on.
    chunk: trajectories that a worker takes at a time. progress(done, total, what) is called often.
    No number depends on chunk, workers or neighbours. A trajectory that fails is told in `failures`; Ctrl-C gives
    what is done. Raises InputError for anything that makes no sense.
    """
    system = as_system(model)
    if not number(duration, "duration") > 0.0:
        raise InputError(f"duration = {duration!r}: give a positive time")
    low, high = TOLERANCES
    if not low <= number(tolerance, "tolerance") <= high:
        raise InputError(f"tolerance = {tolerance!r}: give a number from {low:g} to {high:g}")
    for name, value in (("most_steps", most_steps), ("chunk", chunk)):
        if value is not None and (isinstance(value, bool) or not isinstance(value, int) or value < 1):
            raise InputError(f"{name} = {value!r}: give a whole number of 1 or more")
    who = as_workers(workers)
    given = run_parameters(system, parameters, wind)
    signals = {name: value for name, value in given.items() if isinstance(value, Signal)}
    drive = run_drive(system, signals, float(duration))
    fixed = {name: value for name, value in given.items() if not isinstance(value, Signal)}
    fixed |= {name: float(signal.at(0.0)) for name, signal in signals.items()}
    if fixed:
        system.allowed(fixed)
        system = system.with_parameters(fixed)
    sample = as_sample(varying)
    starts, sample = _starts(system, start, sample)
    columns = tuple(name for name in (sample.values if sample else ()) if name in system.parameters)
    for name in columns:
        if name in given:
            raise InputError(f"'{name}' is varied and given in parameters or wind; give it once")
    values = np.stack([sample.values[name] for name in columns], axis=1) if sample and columns else None
    values = np.zeros((len(starts), 0)) if values is None else values
    _check_rows(system, columns, values)
    plan, column_names = _plan(model, system, starts, values, columns, drive, float(duration), float(tolerance), reduce,
                               observe or {}, most_steps)  # fmt: skip
    store = Checkpoint(checkpoint, _about(plan, starts, values)) if checkpoint is not None else None
    rows = _Rows(starts, values)
    collected = _Collected(plan, len(starts), column_names)
    _work(plan, rows, collected, who, store, chunk, progress)
    return Ensemble(
        states=system.states,
        varied=dict(sample.values) if sample else {},
        fixed={name: value for name, value in system.parameters.items() if name not in columns},
        starts=starts,
        final=collected.final,
        times=collected.times,
        codes=collected.codes,
        limits=collected.limits,
        limit_names=plan.margins,
        steps=collected.steps,
        values=collected.values,
        columns=column_names,
        duration=float(duration),
        tolerance=float(tolerance),
        shape=sample.shape if sample else (len(starts),),
        axes=dict(sample.axes) if sample else {},
        interrupted=bool(collected.note),
        note=collected.note,
        units=dict(system.units),
    )


def _starts(system: System, start: Any, sample: Sample | None) -> tuple[np.ndarray, Sample | None]:
    """Starts (N, n), with the states that are varied put in."""
    many = len(sample) if sample is not None else None
    for name in sample.values if sample else ():
        if name not in system.parameters and name not in system.states:
            raise unknown_name(name, [*system.parameters, *system.states], "parameter or state")
    n = len(system.states)
    array = (
        None if isinstance(start, Mapping) or start is None or hasattr(start, "states") else _numbers(start)
    )
    if array is not None and array.ndim == 2:
        if array.shape[1] != n or not len(array):
            raise InputError(f"start must have shape (N, {n}) with N of 1 or more; got {array.shape}")
        if not np.all(np.isfinite(array)):
            raise InputError(
                f"start: row {int(np.flatnonzero(~np.isfinite(array).all(axis=1))[0])} is not finite; give numbers only"
            )
        if sample is not None and sample.axes:
            raise InputError(
                "a grid varies everything by itself; vary states by name on the grid, or give one start for all"
            )
        if many is not None and many != len(array):
            raise InputError(f"start has {len(array)} rows, varying {many} values; give as many of both")
        starts = array.copy()
    elif start is None:
        starts = np.zeros((many or 1, n))
    else:
        starts = np.tile(run_start(system, start), (many or 1, 1))
    for name, values in (sample.values if sample else {}).items():
        if name in system.states:
            starts[:, system.states.index(name)] = values
    if sample is None and (array is None or array.ndim == 1):
        raise InputError("nothing varies: give varying={name: values}, or start of shape (N, n)")
    return starts, sample


def _numbers(start: Any) -> np.ndarray | None:
    try:
        return np.array(start, dtype=float)
    except (TypeError, ValueError):
        return None


def _check_rows(system: System, names: tuple[str, ...], values: np.ndarray) -> None:
    """Let the model look at combinations of parameters: all, or some of very many and the extreme ones."""
    if not names:
        return
    rows = np.unique(values, axis=0)
    if len(rows) > _CHECKED:
        extreme = [*values.argmin(axis=0), *values.argmax(axis=0)]
        spread = np.linspace(0, len(values) - 1, _CHECKED).astype(int)
        rows = values[np.unique([*extreme, *spread])]
    for row in rows.tolist():
        try:
            system.allowed(dict(zip(names, row, strict=True)))
        except InputError as error:
            text = ", ".join(f"{name} = {value:.6g}" for name, value in zip(names, row, strict=True))
            raise InputError(f"varying reaches {text}: {error}") from None


def _plan(
    model: Any, system: System, starts: np.ndarray, values: np.ndarray, columns: tuple[str, ...], drive: Any,
    duration: float, tolerance: float, reduce: Any, observe: Mapping[str, Any], most_steps: int,
) -> tuple[Plan, dict[str, tuple[str, ...] | None]]:  # fmt: skip
    if not isinstance(observe, Mapping) or not all(callable(function) for function in observe.values()):
        raise InputError(f"observe = {observe!r}: give functions by name, {{'lift': lambda x, p: ...}}")
    functions = dict(observe)
    asks = listed(reduce)
    if (
        hasattr(model, "energy")
        and "energy" not in functions
        and any("energy" in _asked(one) for one in asks)
    ):
        functions["energy"] = model.energy
    taken = [name for name in functions if name in system.states or name in system.parameters]
    if taken:
        raise InputError(f"observe: '{taken[0]}' is a state or parameter already; give another name")
    names = system.states, tuple(system.parameters)
    limits = {name: margin for name, (_, margin) in system.limits.items() if system.refusal is not None}
    extra: list[Tape] = [trace_function(f, *names, f"limit '{name}'") for name, f in limits.items()]
    extra += [trace_function(f, *names, f"observable '{name}'") for name, f in functions.items()]
    flow = system.tape
    if any(isinstance(one, Lyapunov) or one == "lyapunov" for one in asks):
        flow = with_tangents(flow)
    rows = (*flow.states, *(f"limit {name}" for name in limits), *functions)
    view = View(rows, system.states, duration, turning_states(system, starts[0]), tolerance)
    reductions, column_names = checked(reduce, view)
    shift = len(flow.states) - len(system.states)
    drive = type(drive)(drive.names, drive.numbers + shift, drive.pieces)
    plan = Plan(
        flow=flow,
        full=with_outputs(flow, extra) if extra else flow,
        extra=tuple(extra),
        margins=tuple(limits),
        view=view,
        base=np.array(list(system.parameters.values()), dtype=float),
        columns=tuple(list(system.parameters).index(name) for name in columns),
        drive=drive,
        tolerance=tolerance,
        most_steps=most_steps,
        stops=stops(reductions, view, _longest(system, starts, columns, values, duration))
        if shift
        else (duration,),
        reductions=reductions,
    )
    return plan, column_names


def _longest(
    system: System, starts: np.ndarray, columns: tuple[str, ...], values: np.ndarray, duration: float
) -> float:
    """For how long a disturbance may grow or shrink before it gets its length again, judged at some of the starts."""
    some = np.unique(np.linspace(0, len(starts) - 1, _LOOKED_AT).astype(int))
    jacobians = system.jacobian(starts[some], {name: values[some, k] for k, name in enumerate(columns)})
    jacobians = jacobians[np.isfinite(jacobians).all(axis=(1, 2))]
    rates = np.abs(np.linalg.eigvals(jacobians).real.max(axis=1)) if len(jacobians) else np.zeros(1)
    return max(min(duration / 8.0, _FOLDS / max(float(rates.max()), 1e-300)), duration / 1000.0)


def _asked(one: Any) -> Sequence[str]:
    of = getattr(one, "of", ())
    return (of,) if isinstance(of, str) else tuple(of)


def _about(plan: Plan, starts: np.ndarray, values: np.ndarray) -> dict[str, str]:
    """What a run is, as texts: equal where all numbers that come out are equal."""

    def digest(*arrays: np.ndarray) -> str:
        found = sha256()
        for array in arrays:
            found.update(str(array.shape).encode() + np.ascontiguousarray(array, dtype=float).tobytes())
        return found.hexdigest()[:16]

    from importlib.metadata import version

    return {
        "model": tape_key(plan.full)[:16],
        "parameters": digest(plan.base, np.array(plan.columns), values),
        "starts": digest(starts),
        "wind": digest(plan.drive.numbers, plan.drive.pieces.times, plan.drive.pieces.coefficients)
        if plan.drive.names
        else "steady",
        "duration": repr(plan.view.duration),
        "tolerance": repr(plan.tolerance),
        "most_steps": repr(plan.most_steps),
        "reductions": repr(plan.reductions),
        "rainwind": __version__,
        "numba": version("numba"),
        "llvmlite": version("llvmlite"),
        "numpy": version("numpy"),
    }


class _Rows:
    def __init__(self, starts: np.ndarray, values: np.ndarray) -> None:
        self.starts, self.values = starts, values

    def __len__(self) -> int:
        return len(self.starts)

    def missing(self, codes: np.ndarray, chunk: int) -> Iterator[Rows]:
        """Chunks of the rows that are not done."""
        left = np.flatnonzero(codes == NOT_DONE)
        breaks = np.flatnonzero(np.diff(left) > 1) + 1
        for run in np.split(left, breaks):
            for k in range(0, run.size, chunk):
                begin, end = int(run[k]), int(run[min(k + chunk, run.size) - 1]) + 1
                yield Rows(begin, self.starts[begin:end], self.values[begin:end])


class _Collected:
    """All that is done so far."""

    def __init__(self, plan: Plan, many: int, columns: Mapping[str, tuple[str, ...] | None]) -> None:
        n = plan.width
        self.final, self.times = np.full((many, n), np.nan), np.full(many, np.nan)
        self.codes, self.limits = np.full(many, NOT_DONE, dtype=np.int8), np.full(many, -1, dtype=np.int8)
        self.steps = np.zeros((many, 2), dtype=np.int64)
        self.values = {
            name: np.full(many if names is None else (many, len(names)), np.nan)
            for name, names in columns.items()
        }
        self.note = ""

    def take(self, done: Done) -> None:
        here = slice(done.begin, done.begin + len(done))
        self.final[here], self.times[here], self.limits[here] = done.final, done.times, done.limits
        self.steps[here] = done.steps
        for name, array in done.found.items():
            self.values[name][here] = array
        self.codes[here] = done.ended

    @property
    def count(self) -> int:
        return int(np.count_nonzero(self.codes != NOT_DONE))


def _work(
    plan: Plan, rows: _Rows, collected: _Collected, who: Workers, store: Checkpoint | None, chunk: int | None,
    progress: Progress | None,
) -> None:  # fmt: skip
    many, stop = len(rows), threading.Event()
    if store is not None:
        for done in store.chunks():
            if done.begin + len(done) <= many and set(done.found) == set(collected.values):
                collected.take(done)
    before, begin = collected.count, monotonic()
    size = chunk or min(_LARGEST, max(_SMALLEST, -(-(many - before) // (_CHUNKS * max(who.count, 1)))))
    try:
        if progress is not None:
            progress(before, many, "trajectories")
        if before == many:
            return
        for done in who.run(plan, rows.missing(collected.codes.copy(), size), stop):
            if done is not None:
                if store is not None:
                    store.keep(done)
                collected.take(done)
            if progress is not None:
                progress(
                    collected.count, many, _rate(collected.count - before, many - collected.count, begin)
                )
    except (KeyboardInterrupt, SystemError) as error:
        if not is_interrupt(error):
            raise
        collected.note = "interrupted by the user; what is done is here"
    except ComputationError as error:
        collected.note = str(error)


def _rate(done: int, left: int, begin: float) -> str:
    spent = monotonic() - begin
    if not done or spent < _FIRST_RATE:
        return "trajectories"
    rate = done / spent
    seconds = left / rate
    if seconds < 90:
        time = f"{seconds:.0f} s"
    elif seconds < 5400:
        time = f"{seconds / 60:.0f} min"
    else:
        time = f"{seconds / 3600:.1f} h"
    return f"{rate:.3g} trajectories/s, {time} left"
