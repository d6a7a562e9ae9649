"""Who computes the chunks of an ensemble: threads, processes, or a Dask cluster. What comes out is the same."""

import os
import pickle
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from queue import Empty, Queue
from typing import IO, Any, Protocol

from rainwind.dynamics.ensemble_plan import Done, Plan, Rows, compute
from rainwind.errors import ComputationError, InputError

_STACK = 64 * 2**20  # of a thread: half a megabyte, as some systems give, is too little for compiling
_TRIES = 3  # of a chunk whose process dies
_WAIT = 0.1
_MODULE = "rainwind.dynamics.worker_process"


class Workers(Protocol):
    """Whoever computes chunks."""

    @property
    def count(self) -> int:
        """How many chunks are computed at a time."""
        ...

    def run(self, plan: Plan, chunks: Iterator[Rows], stop: threading.Event) -> Iterator[Done | None]:
        """Chunks as they are done, in any order; None now and then while waiting. `stop` ends the work early."""
        ...


@dataclass(frozen=True)
class Threads:
    """Threads of this process; None: one for each processor."""

    count: int

    def run(self, plan: Plan, chunks: Iterator[Rows], stop: threading.Event) -> Iterator[Done | None]:
        """Chunks as they are done."""

        def work(take: Callable[[], Rows | None], give: Callable[[Done], None]) -> None:
            while (rows := take()) is not None:
                done = compute(plan, rows, stop.is_set)
                if done is not None:
                    give(done)

        yield from _together([work] * self.count, chunks, stop)


@dataclass(frozen=True)
class Processes:
    """Processes of this machine, each of which computes one chunk at a time. One that dies is started again."""

    count: int

    def __post_init__(self) -> None:
        _whole(self.count, "Processes")

    def run(self, plan: Plan, chunks: Iterator[Rows], stop: threading.Event) -> Iterator[Done | None]:
        """Chunks as they are done."""

        def work(take: Callable[[], Rows | None], give: Callable[[Done], None]) -> None:
            process = None
            try:
                while (rows := take()) is not None:
                    for attempt in range(_TRIES):
                        if process is None:
                            process = _Process(plan, stop)
                        done = process.compute(rows)
                        if done is not None or stop.is_set():
                            break
                        process.end()
                        process = None
                        if attempt == _TRIES - 1:
                            last = rows.begin + len(rows) - 1
                            raise ComputationError(
                                f"the process that computes rows {rows.begin} to {last} died {_TRIES} times; "
                                "see what it printed, or try workers=1"
                            )
                    else:
                        done = None
                    if done is not None:
                        give(done)
            finally:
                if process is not None:
                    process.end()

        yield from _together([work] * self.count, chunks, stop)


@dataclass(frozen=True)
class Cluster:
    """A Dask cluster: the address of its scheduler ("tcp://host:8786"), a dask.distributed Client, or None for a
    cluster of its own on this machine, with `count` workers. Needs the extra `cluster`. Raises InputError."""

    scheduler: Any = None
    count: int = 0

    def run(self, plan: Plan, chunks: Iterator[Rows], stop: threading.Event) -> Iterator[Done | None]:
        """Chunks as they are done. Raises ComputationError where the scheduler is lost."""
        from rainwind.dynamics.dask_cluster import chunks_by_dask

        yield from chunks_by_dask(self.scheduler, self.count, plan, chunks, stop)


def as_workers(given: Any) -> Workers:
    """What `ensemble(workers=...)` was given: None, a number of threads, an address, or one of the above."""
    if given is None:
        return Threads(_processors())
    if isinstance(given, str):
        return Cluster(given)
    if isinstance(given, Threads | Processes | Cluster):
        return given
    if hasattr(given, "scheduler_info") and hasattr(given, "submit"):
        return Cluster(given)
    return Threads(_whole(given, "workers"))


def _whole(given: Any, what: str) -> int:
    if isinstance(given, bool) or not isinstance(given, int) or given < 1:
        raise InputError(
            f"{what} = {given!r}: give a number of threads (1 or more), rw.Processes(n), rw.Cluster(address), or the "
            "address of a Dask scheduler"
        )
    return given


def _processors() -> int:
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


_Work = Callable[[Callable[[], Rows | None], Callable[[Done], None]], None]


def _together(works: list[_Work], chunks: Iterator[Rows], stop: threading.Event) -> Iterator[Done | None]:
    """Some threads that take chunks until there are none; what they give, and their errors, come out here."""
    found: Queue[Done | BaseException | None] = Queue()
    taking = threading.Lock()
    ended = threading.Event()

    def take() -> Rows | None:
        with taking:
            return None if stop.is_set() or ended.is_set() else next(chunks, None)

    def guarded(work: _Work) -> None:
        try:
            work(take, found.put)
        except BaseException as error:
            found.put(error)
        found.put(None)

    with _large_stacks():
        threads = [
            threading.Thread(target=guarded, args=(work,), name="rainwind-ensemble", daemon=True)
            for work in works
        ]
        for thread in threads:
            thread.start()
    left = len(threads)
    try:
        while left:
            try:
                one = found.get(timeout=_WAIT)
            except Empty:
                yield None
                continue
            if isinstance(one, BaseException):
                raise one
            if one is None:
                left -= 1
            else:
                yield one
    finally:
        ended.set()
        if left:
            stop.set()
            for thread in threads:
                thread.join()


@contextmanager
def _large_stacks() -> Iterator[None]:
    before = threading.stack_size(_STACK)
    try:
        yield
    finally:
        threading.stack_size(before)


class _Process:
    """One process, which reads rows and writes what came of them: pickled, each with its length before it."""

    def __init__(self, plan: Plan, stop: threading.Event) -> None:
        self._stop = stop
        command = [sys.executable, "-m", _MODULE]
        path = os.pathsep.join(p for p in sys.path if p)
        self._process = subprocess.Popen(
            command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, env={**os.environ, "PYTHONPATH": path},
            start_new_session=os.name == "posix",  # Ctrl-C is for us alone
        )  # fmt: skip
        self._found: Queue[Any] = Queue()
        threading.Thread(target=self._read, daemon=True).start()
        self._send(plan)

    def compute(self, rows: Rows) -> Done | None:
        """None where the process died, or `stop` was set meanwhile."""
        self._send(rows)
        while not self._stop.is_set():
            with suppress(Empty):
                found = self._found.get(timeout=_WAIT)
                if isinstance(found, BaseException):
                    raise found
                return found
        return None

    def end(self) -> None:
        """End it at once."""
        self._process.kill()
        self._process.wait()
        for pipe in (self._process.stdin, self._process.stdout):
            if pipe is not None:
                with suppress(OSError):
                    pipe.close()

    def _send(self, message: Any) -> None:
        assert self._process.stdin is not None
        with suppress(OSError):  # it died: reading says so
            write(self._process.stdin, message)

    def _read(self) -> None:
        assert self._process.stdout is not None
        while True:
            try:
                message = read(self._process.stdout)
            except (OSError, EOFError, ValueError):
                message = None
            self._found.put(message)
            if message is None:
                return


def write(file: IO[bytes], message: Any) -> None:
    """One message."""
    data = pickle.dumps(message, protocol=pickle.HIGHEST_PROTOCOL)
    file.write(len(data).to_bytes(8, "little") + data)
    file.flush()


def read(file: IO[bytes]) -> Any:
    """The next message. Raises EOFError where there is none."""
    head = file.read(8)
    size = int.from_bytes(head, "little")
    data = file.read(size) if len(head) == 8 else b""
    if len(head) < 8 or len(data) < size:
        raise EOFError
    return pickle.loads(data)
