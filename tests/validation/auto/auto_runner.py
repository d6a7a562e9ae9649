"""Run AUTO-07p on an equations file: compile once, run, read its files, time its executable alone.

AUTO is found as the Debian package `auto-07p` installs it (or where the variable `AUTO_DIR` says).
Only its object files are linked and only its documented file formats are read; none of its programs is used.
"""

from __future__ import annotations

import os
import re
import shutil
import statistics
import subprocess
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Constants = Mapping[str, Any]

# The documented type codes. For the two-parameter codes only the last digit matters, but for GH (-32).
LABELS = {1: "BP", 2: "LP", 3: "HB", 4: "RG", 5: "LP", 6: "BP", 7: "PD", 8: "TR", 9: "EP"}
LABELS |= {-1: "BT", -2: "CP", -3: "ZH", -4: "UZ", -5: "R1", -6: "R2", -7: "R3", -8: "R4", -9: "MX"}


class AutoFailed(RuntimeError):
    """AUTO or the compiler ended with an error; the message carries what it printed."""


@dataclass(frozen=True)
class LabelledPoint:
    """A point that AUTO stored with a label (fort.8, about 11 digits)."""

    kind: str  # "LP", "HB", "GH", "EP", ...
    label: int
    point: int  # its row on the branch, from 1
    state: Array  # shape (n,); of an orbit, the state at its beginning
    parameters: Array  # PAR(1..), shape (npar,)
    times: Array  # shape (m,): 0 for an equilibrium, the mesh on [0, 1] for an orbit
    profile: Array  # shape (m, n)
    text: str  # its record, which a further run starts from


@dataclass(frozen=True)
class Run:
    """What AUTO wrote about one run."""

    columns: tuple[str, ...]  # of `table`: the parameter, the norm, the states, further parameters
    table: Array  # shape (points, columns), as in fort.7
    stable: NDArray[np.bool_]  # shape (points,)
    labelled: tuple[LabelledPoint, ...]
    constants: dict[str, Any]
    diagnostics: str  # fort.9
    reported_seconds: float  # AUTO's own "Total Time"

    def points(self, kind: str) -> tuple[LabelledPoint, ...]:
        """The labelled points of one kind, in the order of the branch."""
        return tuple(p for p in self.labelled if p.kind == kind)

    def spectrum(self, point: int) -> NDArray[np.complex128]:
        """Eigenvalues or multipliers (6 digits) that fort.9 lists at a row; empty if it lists none."""
        pattern = rf"^ *\d+ +{point} +(?:Eigenvalue|Multiplier) +(\d+):? +(\S+) +(\S+)"
        found = {
            int(i): complex(float(re_), float(im))
            for i, re_, im in re.findall(pattern, self.diagnostics, re.M)
        }
        return np.array([found[i] for i in sorted(found)], dtype=complex)

    def spectra(self) -> dict[int, NDArray[np.complex128]]:
        """`spectrum` of every row for which fort.9 lists one, read at once."""
        pattern = re.compile(r"^ *\d+ +(\d+) +(?:Eigenvalue|Multiplier) +(\d+):? +(\S+) +(\S+)", re.M)
        rows: dict[int, dict[int, complex]] = {}
        for row, i, real, imaginary in pattern.findall(self.diagnostics):
            rows.setdefault(int(row), {})[int(i)] = complex(float(real), float(imaginary))
        return {row: np.array([found[i] for i in sorted(found)]) for row, found in rows.items()}


@dataclass(frozen=True)
class Timing:
    """Seconds that the executable alone takes, process start and its files included."""

    points: int
    wall_median: float
    wall_best: float
    cpu_median: float  # user + system time of the process
    reported_median: float  # AUTO's own "Total Time", without process start

    @property
    def per_point(self) -> float:
        """Median wall time by number of points."""
        return self.wall_median / self.points


def auto_directory() -> Path | None:
    """Where AUTO's object files lie, or None if AUTO or the Fortran compiler is not installed."""
    folder = Path(os.environ.get("AUTO_DIR", "/usr/lib/auto-07p"))
    if shutil.which("gfortran") is None or not (folder / "lib" / "main.o").is_file():
        return None
    return folder


def auto_version() -> str:
    """The version of the Debian package, or "unknown"."""
    try:
        command = ["dpkg-query", "--show", "--showformat=${Version}", "auto-07p"]
        return subprocess.run(command, capture_output=True, text=True, check=True).stdout.strip()
    except (OSError, subprocess.CalledProcessError):
        return "unknown"


class Auto:
    """One equations file, compiled in a working folder of its own."""

    # those of Debian's own build of AUTO, without its hardening
    flags = ("-O2", "-fopenmp", "-std=legacy")

    def __init__(self, equations: Path, folder: Path) -> None:
        """Compile `equations` (Fortran 90) into `folder`; raises AutoFailed if that cannot be done."""
        directory = auto_directory()
        if directory is None:
            raise AutoFailed(
                "AUTO-07p or gfortran was not found; install auto-07p and gfortran, or set AUTO_DIR"
            )
        self.equations = Path(equations).resolve()
        self.folder = Path(folder).resolve()
        self.folder.mkdir(parents=True, exist_ok=True)
        self.executable = self.folder / f"{self.equations.stem}.exe"
        objects = sorted(str(p) for p in (directory / "lib").glob("*.o"))
        self._gfortran(*self.flags, str(self.equations), *objects, "-o", str(self.executable))
        self._environment = os.environ | {"OMP_NUM_THREADS": "1"}

    def run(self, constants: Constants, start: LabelledPoint | None = None) -> Run:
        """Run AUTO once. `start` is a labelled point of an earlier run; IRS is set to match."""
        constants = self._prepare(constants, start)
        _, _, said = self._execute()
        columns, table, stable = read_branch((self.folder / "fort.7").read_text())
        return Run(
            columns=columns,
            table=table,
            stable=stable,
            labelled=read_solutions((self.folder / "fort.8").read_text()),
            constants=constants,
            diagnostics=(self.folder / "fort.9").read_text(),
            reported_seconds=_total_time(said),
        )

    def time(self, constants: Constants, start: LabelledPoint | None = None, *, repeats: int = 21) -> Timing:
        """Time the executable alone: nothing of Python's is between its start and its end."""
        points = len(self.run(constants, start).table)  # warms the file cache as well
        walls, cpus, reported = [], [], []
        for _ in range(repeats):
            self._prepare(constants, start)
            wall, cpu, said = self._execute()
            walls.append(wall)
            cpus.append(cpu)
            reported.append(_total_time(said))
        median = statistics.median
        return Timing(points, median(walls), min(walls), median(cpus), median(reported))

    def shared_library(self) -> Path:
        """The equations alone as a shared library, for calling `func_` from ctypes."""
        library = self.folder / f"lib{self.equations.stem}.so"
        if not library.exists():
            self._gfortran("-O2", "-fPIC", "-shared", str(self.equations), "-o", str(library))
        return library

    def _gfortran(self, *arguments: str) -> None:
        done = subprocess.run(["gfortran", *arguments], cwd=self.folder, capture_output=True, text=True)
        if done.returncode != 0:
            raise AutoFailed(f"gfortran could not compile {self.equations.name}:\n{done.stderr}")

    def _prepare(self, constants: Constants, start: LabelledPoint | None) -> dict[str, Any]:
        """Write the two input files: fort.2, the constants, and fort.3, the point to start from."""
        constants = dict(constants) | {"IRS": 0 if start is None else start.label}
        for name in ("fort.3", "fort.7", "fort.8", "fort.9"):
            (self.folder / name).unlink(missing_ok=True)
        (self.folder / "fort.2").write_text("".join(f"{k} = {v!r}\n" for k, v in constants.items()))
        if start is not None:
            (self.folder / "fort.3").write_text(start.text)
        return constants

    def _execute(self) -> tuple[float, float, str]:
        """Wall time, CPU time and printed text of one run of the executable."""
        with open(self.folder / "stdout", "w+") as printed:
            begin = time.perf_counter()
            process = subprocess.Popen(
                [str(self.executable)],
                cwd=self.folder,
                env=self._environment,
                stdin=subprocess.DEVNULL,
                stdout=printed,
                stderr=subprocess.STDOUT,
            )
            _, status, usage = os.wait4(process.pid, 0)
            wall = time.perf_counter() - begin
            process.returncode = os.waitstatus_to_exitcode(status)
            printed.seek(0)
            said = printed.read()
        if process.returncode != 0 or not (self.folder / "fort.7").exists():
            raise AutoFailed(f"AUTO ended with status {process.returncode}:\n{said[-4000:]}")
        return wall, usage.ru_utime + usage.ru_stime, said


def read_branch(text: str) -> tuple[tuple[str, ...], Array, NDArray[np.bool_]]:
    """Columns, table and stability from the text of a b. file (fort.7)."""
    columns: tuple[str, ...] = ()
    rows, stable = [], []
    for line in text.splitlines():
        head = line.split(maxsplit=4)
        if head[:1] == ["0"]:
            if head[1:4] == ["PT", "TY", "LAB"]:
                columns = tuple(re.split(r"\s{2,}", head[4].strip()))
            continue
        rows.append([float(word) for word in head[4].split()])
        stable.append(int(head[1]) < 0)
    return columns, np.array(rows), np.array(stable, dtype=bool)


def read_solutions(text: str) -> tuple[LabelledPoint, ...]:
    """All labelled points from the text of an s. file (fort.8)."""
    lines = text.splitlines()
    points, at = [], 0
    while at < len(lines):
        header = [int(word) for word in lines[at].split()]
        _, row, code, label, n_free, _, n_mesh, width, n_lines, n_intervals, _, n_par = header[:12]
        record = lines[at : at + n_lines + 1]
        words: Sequence[str] = " ".join(record[1:]).split()
        values = np.array([float(word) for word in words[: n_mesh * width]]).reshape(n_mesh, width)
        n_state = header[13] if len(header) > 13 else width - 1
        after = n_mesh * width
        if n_intervals > 0:
            after += 2 * n_free + n_mesh * (width - 1)
            parameters = words[after : after + n_par]
        else:
            parameters = words[-n_par:]
        points.append(
            LabelledPoint(
                kind="GH" if code == -32 else LABELS[int(np.fmod(code, 10))],
                label=label,
                point=abs(row),
                state=values[0, 1 : 1 + n_state],
                parameters=np.array([float(word) for word in parameters]),
                times=values[:, 0],
                profile=values[:, 1 : 1 + n_state],
                text="\n".join(record) + "\n",
            )
        )
        at += n_lines + 1
    return tuple(points)


def _total_time(said: str) -> float:
    """AUTO's own clock."""
    found = re.search(r"Total Time\s+(\S+)", said)
    return float(found.group(1)) if found else float("nan")
