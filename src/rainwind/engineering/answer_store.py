"""Finished stays of an assessment on disk, so that a run that was stopped goes on where it was."""

import hashlib
import json
import os
from contextlib import suppress
from dataclasses import fields, is_dataclass
from pathlib import Path
from typing import Any

import numpy as np

from rainwind import __version__
from rainwind.engineering.answers import Band, CodeCheck, ModeAnswer, StayAnswer
from rainwind.engineering.bridge import Bridge
from rainwind.engineering.cable import Cable, Damper
from rainwind.errors import InputError

__all__ = ["AnswerStore"]

_ROOT = Path(__file__).parents[1]
_ROOMS = ("dynamics", "engineering", "physics")
_CLASSES = {kind.__name__: kind for kind in (Band, Cable, CodeCheck, Damper, ModeAnswer, StayAnswer)}


class AnswerStore:
    """A folder of finished stays, one file each, put in place whole.

    A file is named after everything that its answer depends on: a changed input finds no file and is computed anew.
    Raises InputError where the folder cannot be made.
    """

    def __init__(self, folder: Path | str, bridge: Bridge, sets: Any, climate: Any) -> None:
        self.folder = Path(folder)
        try:
            self.folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise InputError(
                f"checkpoint: {folder} cannot be used ({error.strerror}); check the path"
            ) from error
        shared = (bridge.site, bridge.rivulet, bridge.limits, bridge.question)
        self._shared = f"{__version__} {_program(_ROOT)} {shared!r} {sets!r} {_climate_text(climate)}"

    def kept(self, cable: Cable) -> StayAnswer | None:
        """The answer of an earlier run with the same inputs; None without one, or where its file is damaged."""
        try:
            return _revived(json.loads(self._path(cable).read_text(encoding="utf-8")))
        except (OSError, ValueError, KeyError, TypeError):
            return None

    def keep(self, answer: StayAnswer) -> None:
        """Write one finished stay."""
        path = self._path(answer.cable)
        part = path.with_name(f".{path.name}.{os.getpid()}.part")
        try:
            part.write_text(json.dumps(_plain(answer)), encoding="utf-8")
            part.replace(path)
        finally:
            with suppress(OSError):
                part.unlink(missing_ok=True)

    def _path(self, cable: Cable) -> Path:
        digest = hashlib.sha256(f"{self._shared} {cable!r}".encode()).hexdigest()[:20]
        return self.folder / f"stay-{digest}.json"


def _program(root: Path) -> str:
    """Something that changes when the code behind an answer does, also between two versions."""
    found = hashlib.sha256()
    for file in sorted(file for room in _ROOMS for file in (root / room).rglob("*.py")):
        found.update(file.read_bytes())
    return found.hexdigest()


def _climate_text(climate: Any) -> str:
    """Something that changes when the records do."""
    if climate is None:
        return "no climate"
    found = hashlib.sha256()
    for field in fields(climate):
        value = getattr(climate, field.name)
        found.update(
            np.ascontiguousarray(value).tobytes() if isinstance(value, np.ndarray) else repr(value).encode()
        )
    return found.hexdigest()


def _plain(value: Any) -> Any:
    """What JSON can hold; Python's own reads nan and infinity back."""
    if isinstance(value, np.ndarray):
        return {"array": value.tolist(), "kind": value.dtype.kind}
    if isinstance(value, np.generic):
        return value.item()
    if is_dataclass(value) and not isinstance(value, type):
        own = {field.name: _plain(getattr(value, field.name)) for field in fields(value)}
        return {"class": type(value).__name__, "fields": own}
    if isinstance(value, dict):
        return {"map": [[key, _plain(item)] for key, item in value.items()]}
    if isinstance(value, list | tuple):
        return {"tuple": [_plain(item) for item in value]}
    return value


def _revived(value: Any) -> Any:
    """What `_plain` was given."""
    if not isinstance(value, dict):
        return value
    if "array" in value:
        return np.array(value["array"], dtype={"b": bool, "i": int}.get(value["kind"], float))
    if "class" in value:
        own = {name: _revived(item) for name, item in value["fields"].items()}
        return _CLASSES[value["class"]](**own)
    if "map" in value:
        return {key: _revived(item) for key, item in value["map"]}
    return tuple(_revived(item) for item in value["tuple"])
