"""Finished chunks of an ensemble on disk: one file each, put in place whole, beside a description of the run."""

import json
import os
from collections.abc import Iterator, Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any
from zipfile import BadZipFile

import numpy as np

from rainwind.dynamics.ensemble_plan import Done
from rainwind.errors import InputError

_ABOUT = "ensemble.json"
_FACTS = ("final", "times", "ended", "limits", "steps")


class Checkpoint:
    """A folder of finished chunks of one run.

    about: what the run is, as texts by name; a folder of another run is refused, naming what differs. A file appears
    under its name only when it is complete, so a process killed at any moment leaves whole chunks or none.
    Raises InputError.
    """

    def __init__(self, folder: Path | str, about: Mapping[str, str]) -> None:
        self.folder = Path(folder)
        try:
            self.folder.mkdir(parents=True, exist_ok=True)
            kept = self.folder / _ABOUT
            if kept.exists():
                self._compare(json.loads(kept.read_text(encoding="utf-8")), about)
            elif any(not path.name.startswith(".") for path in self.folder.iterdir()):
                raise InputError(
                    f"checkpoint: {folder} is not empty and holds no ensemble; give a folder of its own"
                )
            else:
                _put(kept, json.dumps(dict(about), indent=1).encode())
        except OSError as error:
            raise InputError(
                f"checkpoint: {folder} cannot be used ({error.strerror}); check the path"
            ) from error
        except json.JSONDecodeError as error:
            raise InputError(f"checkpoint: {folder}/{_ABOUT} is damaged; give another folder") from error

    def _compare(self, kept: Any, about: Mapping[str, str]) -> None:
        if kept != dict(about):
            differs = [name for name in about if not isinstance(kept, dict) or kept.get(name) != about[name]]
            raise InputError(
                f"checkpoint: {self.folder} belongs to another ensemble, which differs in {', '.join(differs)}; give "
                "another folder, or the same arguments as then"
            )

    def chunks(self) -> Iterator[Done]:
        """All finished chunks, by first row; none covers a row that another one has. Damaged files are left out."""
        free = 0
        for path in sorted(self.folder.glob("rows-*.npz"), key=_rows):
            done = _loaded(path)
            if done is not None and done.begin >= free:
                free = done.begin + len(done)
                yield done

    def keep(self, done: Done) -> None:
        """Write one chunk."""
        name = f"rows-{done.begin}-{done.begin + len(done)}.npz"
        part = self.folder / f".{name}.{os.getpid()}.part"
        arrays: dict[str, Any] = {f"own {key}": getattr(done, key) for key in _FACTS}
        arrays |= {f"found {key}": array for key, array in done.found.items()}
        try:
            with part.open("wb") as file:
                np.savez(file, begin=done.begin, **arrays)
                file.flush()
                os.fsync(file.fileno())
            part.replace(self.folder / name)
        finally:
            with suppress(OSError):
                part.unlink(missing_ok=True)


def _rows(path: Path) -> tuple[int, int]:
    """By first row; of two that begin alike the longer one first."""
    with suppress(ValueError):
        begin, end = path.stem.split("-")[1:]
        return int(begin), -int(end)
    return -1, 0


def _loaded(path: Path) -> Done | None:
    try:
        # a file of our own, because NumPy leaves a damaged one open
        with path.open("rb") as opened, np.load(opened, allow_pickle=False) as file:
            arrays = {key: file[key] for key in file.files}
        own = {key: arrays[f"own {key}"] for key in _FACTS}
    except (OSError, ValueError, KeyError, BadZipFile, EOFError):
        return None
    found = {key.removeprefix("found "): array for key, array in arrays.items() if key.startswith("found ")}
    return Done(int(arrays["begin"]), found=found, **own)


def _put(path: Path, data: bytes) -> None:
    part = path.with_name(f".{path.name}.{os.getpid()}.part")
    part.write_bytes(data)
    part.replace(path)
