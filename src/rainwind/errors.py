"""Exceptions that a caller may want to catch.

Wrong input raises one of these at the door; an iteration that fails is a result, not an exception.
"""


class RainwindError(Exception):
    """Everything that rainwind raises on purpose."""


class InputError(RainwindError, ValueError):
    """A value that is not allowed: the message says what was given, what is allowed and what to do."""


class TraceError(RainwindError, TypeError):
    """A right-hand side cannot be recorded as a tape; the message names the line."""


class CaseError(InputError):
    """A case file or coefficient file that cannot be read as one; every fault is listed."""


class ComputationError(RainwindError, RuntimeError):
    """No result exists: not one point could be computed."""


def is_interrupt(error: BaseException | None) -> bool:
    """Whether Ctrl-C is behind it: compiled code passes it on as the cause of a SystemError."""
    seen: set[int] = set()
    while error is not None and id(error) not in seen:
        if isinstance(error, KeyboardInterrupt):
            return True
        if not isinstance(error, SystemError):
            return False
        seen.add(id(error))
        error = error.__cause__ or error.__context__
    return False
