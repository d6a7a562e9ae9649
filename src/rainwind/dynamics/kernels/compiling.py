"""How kernels are compiled: once for an installation, and again exactly when any of their sources changes.

numba notices a change in a function's own file only, not in the functions it calls. So the cache lies in a folder
named after the contents of all kernels: a stale one is never found.
"""

import os
import sys
from collections.abc import Callable
from hashlib import sha256
from pathlib import Path
from typing import Any

import numba
from numba import njit


def _folder() -> Path:
    """Where compiled kernels of exactly these sources are kept."""
    digest = sha256(f"{numba.__version__} {sys.version}".encode())
    for source in sorted(Path(__file__).parent.glob("*.py")):
        digest.update(source.read_bytes())
    if given := os.environ.get("NUMBA_CACHE_DIR"):
        root = Path(given)
    elif sys.platform == "win32":
        root = Path(os.environ.get("LOCALAPPDATA", Path.home() / "AppData" / "Local"))
    elif sys.platform == "darwin":
        root = Path.home() / "Library" / "Caches"
    else:
        root = Path(os.environ.get("XDG_CACHE_HOME", Path.home() / ".cache"))
    return root / "rainwind" / f"kernels-{digest.hexdigest()[:16]}"


FOLDER = _folder()


def are_compiled() -> bool:
    """Whether this installation's kernels have been compiled before."""
    return any(FOLDER.rglob("march.march*.nbi"))


def _jit(**options: Any) -> Callable[[Callable[..., Any]], Any]:
    def decorate(function: Callable[..., Any]) -> Any:
        before = numba.config.CACHE_DIR  # type: ignore[attr-defined]
        numba.config.CACHE_DIR = str(FOLDER)  # type: ignore[attr-defined]
        try:
            return njit(cache=True, nogil=True, error_model="numpy", **options)(function)
        finally:
            numba.config.CACHE_DIR = before  # type: ignore[attr-defined]

    return decorate


compiled = _jit()
# for what is called from one place: compiling it apart from its caller would only cost time
inlined = _jit(inline="always")
