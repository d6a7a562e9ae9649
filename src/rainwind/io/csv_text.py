"""The text of a CSV file, or a fault that says what to do."""

from pathlib import Path

from rainwind.errors import CaseError

__all__ = ["csv_text"]


def csv_text(path: Path, of: str) -> str:
    """The text of a CSV file in UTF-8, with or without a byte order mark. Raises CaseError where it cannot be read.

    of: what the file holds, as in "a CSV file of wind and rain".
    """
    try:
        return path.read_text(encoding="utf-8-sig")
    except FileNotFoundError as error:
        raise CaseError(f"{path}: no such file; name a CSV file of {of}") from error
    except UnicodeDecodeError as error:
        raise CaseError(f"{path}: not a text file in UTF-8; save it as CSV in UTF-8") from error
    except (OSError, ValueError) as error:
        reason = "a folder" if path.is_dir() else getattr(error, "strerror", None) or error
        raise CaseError(f"{path}: cannot be read ({reason}); name a CSV file of {of}") from error
