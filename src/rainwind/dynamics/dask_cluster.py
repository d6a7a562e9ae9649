"""Chunks of an ensemble on a Dask cluster, its own or one by address."""

import threading
from collections.abc import Iterator
from contextlib import ExitStack, suppress
from typing import Any

from rainwind.dynamics.ensemble_plan import Done, Plan, Rows, compute
from rainwind.errors import ComputationError, InputError

_WAIT = 0.1
_AHEAD = 2  # chunks that wait for each thread of the cluster
_PATIENCE = 10.0  # seconds to reach a scheduler


def chunks_by_dask(
    scheduler: Any, count: int, plan: Plan, chunks: Iterator[Rows], stop: threading.Event
) -> Iterator[Done | None]:
    """Chunks as they are done; None now and then. Raises InputError, ComputationError where the scheduler is lost."""
    try:
        from dask.distributed import Client, LocalCluster  # pyright: ignore[reportMissingImports]
    except ImportError:
        raise InputError(
            "a cluster needs dask.distributed, which is not installed; install rainwind[cluster], or take "
            "workers=rw.Processes(n)"
        ) from None
    with ExitStack() as closing:
        if scheduler is None:
            no_page: Any = None  # Dask's own types know no cluster without a web page
            cluster = LocalCluster(
                n_workers=count or None, threads_per_worker=1, dashboard_address=no_page, processes=True
            )
            closing.callback(_quietly, cluster.close)
            client = Client(cluster)
            closing.callback(_quietly, client.close)
        elif isinstance(scheduler, str):
            try:
                client = Client(scheduler, timeout=_PATIENCE)
            except (OSError, TimeoutError, ValueError) as error:
                raise InputError(
                    f"no Dask scheduler answers at {scheduler!r} ({error}); check the address"
                ) from error
            closing.callback(_quietly, client.close)
        else:
            client = scheduler
        yield from _submitted(client, plan, chunks, stop)


def _submitted(
    client: Any, plan: Plan, chunks: Iterator[Rows], stop: threading.Event
) -> Iterator[Done | None]:
    from dask.distributed import wait  # pyright: ignore[reportMissingImports]

    waiting: dict[Any, Rows] = {}
    exhausted = False
    try:
        while not stop.is_set():
            ahead = _AHEAD * max(1, sum(client.nthreads().values()))
            while not exhausted and len(waiting) < ahead:
                rows = next(chunks, None)
                if rows is None:
                    exhausted = True
                else:
                    waiting[client.submit(compute, plan, rows, pure=False)] = rows
            if not waiting:
                return
            with suppress(TimeoutError):
                wait(list(waiting), timeout=_WAIT, return_when="FIRST_COMPLETED")
            for future in [one for one in waiting if one.done()]:
                done = future.result()
                del waiting[future]
                yield done
            if client.status not in ("running", "connecting"):
                raise ConnectionError(f"the client is {client.status}")
            yield None
    except Exception as error:
        if type(error).__name__ in _LOST or isinstance(error, OSError):
            raise ComputationError(f"the Dask scheduler is lost: {error}") from error
        if type(error).__name__ == "KilledWorker":
            raise ComputationError(f"the workers of the cluster died again and again: {error}") from error
        raise
    finally:
        with suppress(Exception):
            client.cancel(list(waiting))


_LOST = {
    "CommClosedError",
    "CancelledError",
    "FutureCancelledError",
    "FuturesCancelledError",
    "ClosedClientError",
}


def _quietly(close: Any) -> None:
    with suppress(Exception):
        close()
