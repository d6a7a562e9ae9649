"""Threads, processes and Dask: the same numbers, and what is done is kept, whatever is killed."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

import rainwind as rw
from rainwind.dynamics import workers

POSIX = pytest.mark.skipif(os.name != "posix", reason="signals and process groups of POSIX")
STARTS = np.random.default_rng(0).normal(size=(160, 2))
SCRIPT = """
import sys
import numpy as np
import rainwind as rw
from tests_of_workers import STARTS, run

def say(done, total, what):
    print(done, flush=True)

if __name__ == "__main__":
    kept = run(eval(sys.argv[2]), sys.argv[1], progress=say)
    print("ended", int(kept.done.sum()), kept.note, flush=True)
"""


def pendulum() -> rw.System:
    return rw.System(lambda x, p: (x.w, -rw.sin(x.a) - p.d * x.w), states=("a", "w"), parameters={"d": 0.01})


def run(who, folder=None, progress=None, duration: float = 3000.0) -> rw.Ensemble:
    reduce = (rw.Extremes(since=5.0), rw.Returns("a", since=5.0))
    return rw.ensemble(
        pendulum(), STARTS, duration=duration, reduce=reduce, workers=who, chunk=8, checkpoint=folder,
        progress=progress,
    )  # fmt: skip


@pytest.fixture(scope="module")
def whole() -> rw.Ensemble:
    return run(1)


def same(a: rw.Ensemble, b: rw.Ensemble) -> None:
    assert b.done.all(), b.note
    np.testing.assert_array_equal(a.final, b.final)
    for name, array in a.values.items():
        np.testing.assert_array_equal(array, b.values[name], err_msg=name)


def kept_rows(folder: Path) -> int:
    spans = [tuple(map(int, path.stem.split("-")[1:])) for path in folder.glob("rows-*.npz")]
    rows = [row for begin, end in spans for row in range(begin, end)]
    assert len(set(rows)) == len(rows)  # none twice
    return len(rows)


def started(folder: Path, who: str) -> "subprocess.Popen[str]":
    """The same run in a process of its own."""
    (folder / "tests_of_workers.py").write_text(Path(__file__).read_text(encoding="utf-8"), encoding="utf-8")
    (folder / "script.py").write_text(SCRIPT, encoding="utf-8")
    return subprocess.Popen(
        [sys.executable, str(folder / "script.py"), str(folder / "kept"), who], stdout=subprocess.PIPE, text=True,
        env={**os.environ, "PYTHONPATH": os.pathsep.join([str(folder), *filter(None, sys.path)])},
        start_new_session=os.name == "posix",
    )  # fmt: skip


def until(process: "subprocess.Popen[str]", rows: int) -> int:
    """Wait until a run says that so many rows are done."""
    assert process.stdout is not None
    for line in process.stdout:
        if int(line) >= rows:
            return int(line)
    raise AssertionError("it ended too early")


def test_processes_give_the_same_bits(whole):
    same(whole, run(rw.Processes(2)))


@POSIX
def test_a_process_that_is_killed_is_started_again(whole, monkeypatch):
    pids: list[int] = []

    class Recorded(workers._Process):
        def __init__(self, *of) -> None:
            super().__init__(*of)
            pids.append(self._process.pid)

    monkeypatch.setattr(workers, "_Process", Recorded)

    def kill(done: int, total: int, what: str) -> None:
        if done >= 24 and len(pids) == 2:
            os.kill(pids[0], signal.SIGKILL)

    same(whole, run(rw.Processes(2), progress=kill))
    assert len(pids) == 3


def test_a_process_that_always_dies_ends_the_work_with_a_reason(monkeypatch, capfd):
    monkeypatch.setattr(workers, "_MODULE", "rainwind.not_there")
    found = run(rw.Processes(1))
    assert found.interrupted
    assert not found.done.any()
    assert "rows 0 to 7 died 3 times" in found.note


@POSIX
@pytest.mark.parametrize("who", ["2", "rw.Processes(2)"])
def test_nothing_finished_is_lost_when_the_main_process_is_killed(whole, tmp_path, who: str):
    process = started(tmp_path, who)
    said = until(process, 24)
    process.kill()
    process.wait()
    assert process.stdout is not None
    process.stdout.close()
    kept = kept_rows(tmp_path / "kept")
    assert said <= kept < len(STARTS)
    seen: list[int] = []
    same(whole, run(2, tmp_path / "kept", progress=lambda done, total, what: seen.append(done)))
    assert seen[0] == kept
    assert kept_rows(tmp_path / "kept") == len(STARTS)


@POSIX
def test_processes_end_with_their_main_process(tmp_path):
    process = started(tmp_path, "rw.Processes(2)")
    until(process, 8)
    children = Path(f"/proc/{process.pid}/task/{process.pid}/children")
    if not children.exists():
        process.kill()
        pytest.skip("no /proc with children here")
    tasks = Path(f"/proc/{process.pid}/task").glob("*/children")
    pids = [int(pid) for task in tasks for pid in task.read_text().split()]
    assert len(pids) == 2
    process.kill()
    process.wait()
    assert process.stdout is not None
    process.stdout.close()
    deadline = time.monotonic() + 5.0
    while any(_alive(pid) for pid in pids) and time.monotonic() < deadline:
        time.sleep(0.05)
    assert not any(_alive(pid) for pid in pids)


def _alive(pid: int) -> bool:
    try:
        state = Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()[0]
    except OSError:
        return False
    return state != "Z"


@POSIX
@pytest.mark.parametrize("who", ["2", "rw.Processes(2)"])
def test_ctrl_c_gives_what_is_done(whole, tmp_path, who: str):
    process = started(tmp_path, who)
    until(process, 24)
    process.send_signal(signal.SIGINT)
    out, _ = process.communicate(timeout=10.0)
    assert process.returncode == 0
    _, count, *note = out.splitlines()[-1].split(maxsplit=2)
    assert 24 <= int(count) < len(STARTS)
    assert "interrupted by the user" in note[0]
    assert kept_rows(tmp_path / "kept") == int(count)
    same(whole, run(2, tmp_path / "kept"))


def test_a_cluster_without_dask_says_what_to_install(monkeypatch):
    monkeypatch.setitem(sys.modules, "dask.distributed", None)
    with pytest.raises(rw.RainwindError, match=r"install rainwind\[cluster\]"):
        run("tcp://127.0.0.1:1")


# Dask


@pytest.fixture
def dask():
    pytest.importorskip("distributed", reason="dask.distributed is not installed: rainwind[cluster]")
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("DASK_DISTRIBUTED__ADMIN__TICK__LIMIT", "1h")
        yield


@pytest.fixture
def cluster(dask, tmp_path):
    """A scheduler and two workers in processes of their own; gives the address and all three."""
    address = tmp_path / "scheduler.json"
    common = [sys.executable, "-m"]
    env = {**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
    quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL, "env": env}
    scheduler = subprocess.Popen(
        [*common, "distributed.cli.dask_scheduler", "--port", "0", "--scheduler-file", str(address), "--no-dashboard",
         "--host", "127.0.0.1"], **quiet
    )  # fmt: skip
    both = [
        subprocess.Popen(
            [
                *common,
                "distributed.cli.dask_worker",
                "--scheduler-file",
                str(address),
                "--nthreads",
                "1",
                "--no-dashboard",
                "--no-nanny",
                "--death-timeout",
                "20",
            ],
            **quiet,
        )
        for _ in range(2)
    ]
    deadline = time.monotonic() + 20.0
    while not address.exists() and time.monotonic() < deadline:
        time.sleep(0.1)
    import json

    yield json.loads(address.read_text())["address"], scheduler, both
    for process in (*both, scheduler):
        process.kill()
        process.wait()


@pytest.mark.filterwarnings("ignore")  # what dask warns of is not ours to mend
def test_dask_gives_the_same_bits(whole, cluster):
    same(whole, run(cluster[0]))


@pytest.mark.filterwarnings("ignore")
def test_a_dask_cluster_of_its_own(whole, dask):
    same(whole, run(rw.Cluster(count=2)))


@POSIX
@pytest.mark.filterwarnings("ignore")
def test_a_dask_worker_that_is_killed_costs_its_chunks_only(whole, cluster, tmp_path):
    address, _, both = cluster

    def kill(done: int, total: int, what: str) -> None:
        if done >= 24:
            both[0].kill()

    same(whole, run(address, tmp_path / "kept", progress=kill))
    assert kept_rows(tmp_path / "kept") == len(STARTS)


@POSIX
@pytest.mark.filterwarnings("ignore")
def test_a_dask_scheduler_that_is_killed_loses_no_finished_chunk(whole, cluster, tmp_path):
    address, scheduler, _ = cluster

    def kill(done: int, total: int, what: str) -> None:
        if done >= 24:
            scheduler.kill()

    part = run(address, tmp_path / "kept", progress=kill)
    assert part.interrupted
    assert "scheduler" in part.note
    assert 24 <= part.done.sum() < len(STARTS)
    assert kept_rows(tmp_path / "kept") == part.done.sum()
    same(whole, run(2, tmp_path / "kept"))


@pytest.mark.filterwarnings("ignore")
def test_an_address_where_nobody_answers_is_told(dask, monkeypatch):
    from rainwind.dynamics import dask_cluster

    monkeypatch.setattr(dask_cluster, "_PATIENCE", 1.0)
    with pytest.raises(rw.RainwindError, match="no Dask scheduler answers"):
        run("tcp://127.0.0.1:9")
