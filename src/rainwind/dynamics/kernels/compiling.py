"""How kernels are compiled: once for an installation, and again exactly when a source they depend on changes.

numba notices a change in a function's own file only, not in the functions it calls. So the cache of each file lies in
a folder named after its contents and those of all kernels that it imports: a stale one is never found.
"""

import os
import re
import sys
from collections.abc import Callable
from functools import cache
from hashlib import sha256
from pathlib import Path
from typing import Any

import numba
from numba import njit

_HERE = Path(__file__).parent
_IMPORT = re.compile(r"^from rainwind\.dynamics\.kernels(?:\.(\w+) import| import (\w+))", re.MULTILINE)


def _root() -> Path:
    """Where all compiled kernels are kept."""
    if given := os.environ.get("NUMBA_CACHE_DIR"):
        root = Path(given)
    elif sys.platform == "win32":
        root = Path(os.environ.get("LOCALAPPDATA", Path.home() / "AppData" / "Local"))
    elif sys.platform == "darwin":
        root = Path.home() / "Library" / "Caches"
    else:
        root = Path(os.environ.get("XDG_CACHE_HOME", Path.home() / ".cache"))
    return root / "rainwind"


@cache
def folder(file: str) -> Path:
    """Where the compiled kernels of a file (its name without .py) are kept, for exactly these sources."""
    digest = sha256(f"{numba.__version__} {sys.version}".encode())
    for name in sorted(_needs(file)):
        digest.update((_HERE / f"{name}.py").read_bytes())
    return _root() / f"{file}-{digest.hexdigest()[:16]}"


@cache
def _needs(file: str) -> frozenset[str]:
    """A file and all kernels' files that it imports, and they in turn."""
    found = {a or b for a, b in _IMPORT.findall((_HERE / f"{file}.py").read_text(encoding="utf-8"))}
    return frozenset({file}).union(*(_needs(name) for name in found - {"compiling"}), {"compiling"})


def are_compiled() -> bool:
    """Whether this installation's kernels have been compiled before."""
    return any(folder("march").rglob("march.march*.nbi"))


def _jit(**options: Any) -> Callable[[Callable[..., Any]], Any]:
    def decorate(function: Callable[..., Any]) -> Any:
        before = numba.config.CACHE_DIR  # type: ignore[attr-defined]
        numba.config.CACHE_DIR = str(folder(Path(function.__code__.co_filename).stem))  # type: ignore[attr-defined]
        try:
            return njit(cache=True, nogil=True, error_model="numpy", **options)(function)
        finally:
            numba.config.CACHE_DIR = before  # type: ignore[attr-defined]

    return decorate


compiled = _jit()
# for what is called from one place: compiling it apart from its caller would only cost time
inlined = _jit(inline="always")
# for sums whose order does not matter: they may be split over the lanes of the processor
quick = _jit(fastmath={"reassoc", "nsz", "contract"})
