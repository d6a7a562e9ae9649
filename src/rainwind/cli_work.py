"""Ctrl-C and half-written files: the work of a command runs beside the main thread, which takes the signal.

A signal that arrives inside compiled code can end in a SystemError or a crash. It is handed to the main thread
only, and that one never runs compiled code.
"""

import os
import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

__all__ = ["raise_if_asked", "run_aside", "stopping_between_steps", "unfinished"]

_INTERRUPTED = 130
# threads other than the first get half a megabyte on some systems: too little for compiling
_STACK = 64 * 2**20

_asked = threading.Event()  # to stop at the end of a step
_between_steps = threading.Event()  # the work that runs looks at _asked
_partial: set[Path] = set()


def run_aside(work: Callable[[], Any]) -> None:
    """Run `work` in a thread; what it raises is raised here. Ctrl-C ends the program, or asks the work to stop."""
    raised: list[BaseException] = []

    def guarded() -> None:
        try:
            work()
        except BaseException as error:
            raised.append(error)

    # a shell that starts us in the background has Ctrl-C ignored: leave that as it is
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, _interrupted)
    before = threading.stack_size(_STACK)
    thread = threading.Thread(target=guarded, name="rainwind", daemon=True)
    thread.start()
    threading.stack_size(before)
    while thread.is_alive():
        thread.join(0.1)  # a wait without end hides the signal on Windows
    if raised:
        raise raised[0]


@contextmanager
def stopping_between_steps() -> Iterator[None]:
    """Within it Ctrl-C only sets a flag, which the work reads by `raise_if_asked`; a second one ends all."""
    _asked.clear()
    _between_steps.set()
    try:
        yield
    finally:
        _between_steps.clear()


def raise_if_asked() -> None:
    """KeyboardInterrupt if Ctrl-C came since the last call: once, so that the work can tidy up."""
    if _asked.is_set():
        _asked.clear()
        _between_steps.clear()
        raise KeyboardInterrupt


@contextmanager
def unfinished(path: Path) -> Iterator[Path]:
    """A name beside `path` to write to; it becomes `path` at the end and vanishes if that is not reached."""
    if path.exists() and not path.is_file():  # /dev/stdout: nothing to put in place
        yield path
        return
    final = path.resolve()
    part = final.with_name(f".{final.stem}.{os.getpid()}.part{final.suffix}")
    _partial.add(part)
    try:
        yield part
        part.replace(final)
    except OSError as error:
        if error.filename is not None:
            error.filename = str(path)
        raise
    finally:
        with suppress(OSError):
            part.unlink(missing_ok=True)
        _partial.discard(part)


def _interrupted(*_: object) -> None:
    if _between_steps.is_set() and not _asked.is_set():
        _asked.set()
        _say("stopping after this step; what is done is kept. Ctrl-C again stops at once")
        return
    for part in tuple(_partial):
        with suppress(OSError):
            part.unlink(missing_ok=True)
    _say("interrupted")
    # the thread with the work cannot be ended; nor may its half-written output be waited for
    os._exit(_INTERRUPTED)


def _say(text: str) -> None:
    # not through sys.stderr, which the work may hold; the sequence shows a cursor that a progress bar hid
    with suppress(OSError):
        shown = "\x1b[?25h" if os.isatty(2) else ""
        os.write(2, f"{shown}rainwind: {text}\n".encode())
