"""Text of CSV files, and what is said where there is none."""

import pytest

from rainwind.errors import CaseError
from rainwind.io.csv_text import csv_text


def test_a_byte_order_mark_is_no_text(tmp_path) -> None:
    file = tmp_path / "a.csv"
    file.write_bytes("\ufeffspeed_m_s\n1\n".encode())
    assert csv_text(file, "wind") == "speed_m_s\n1\n"


def test_what_cannot_be_read_says_what_is_wanted(tmp_path) -> None:
    (tmp_path / "a.csv").write_bytes(b"\xff\xfe1")
    for name, words in (
        ("none.csv", "no such file; name a CSV file of wind and rain"),
        ("a.csv", "not a text file in UTF-8"),
        ("", r"cannot be read \(a folder\); name a CSV file of wind and rain"),
        ("\0", "cannot be read"),
    ):
        with pytest.raises(CaseError, match=words):
            csv_text(tmp_path / name, "wind and rain")
