"""A process that computes chunks for another one: `python -m rainwind.dynamics.worker_process`, by pipes."""

import os
import sys
import threading
from queue import Queue
from typing import Any

from rainwind.dynamics.ensemble_plan import compute
from rainwind.dynamics.workers import read, write


def main() -> None:
    """Read a plan, then rows again and again; write what came of them. Ends at once when the pipe ends."""
    # what a library prints must not get between the messages
    with os.fdopen(os.dup(sys.stdout.fileno()), "wb") as out:
        os.dup2(sys.stderr.fileno(), sys.stdout.fileno())
        waiting: Queue[Any] = Queue()

        def listen() -> None:
            while True:
                try:
                    waiting.put(read(sys.stdin.buffer))
                except (EOFError, OSError):
                    os._exit(0)

        threading.Thread(target=listen, daemon=True).start()
        plan = waiting.get()
        while True:
            rows = waiting.get()
            try:
                answer: Any = compute(plan, rows)
            except Exception as error:
                answer = error
            write(out, answer)


if __name__ == "__main__":
    main()
