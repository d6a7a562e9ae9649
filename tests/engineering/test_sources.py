"""Every source says where it is from and how far it was seen."""

import re
from pathlib import Path

import pytest

import rainwind.engineering
from rainwind.engineering.sources import SOURCES, STATUS_WORDS, Source, cited
from rainwind.errors import InputError

ROOM = Path(rainwind.engineering.__file__).parent


def test_keys_are_short_and_texts_are_not():
    for key, source in SOURCES.items():
        assert source.key == key
        assert len(key) <= 20
        assert len(source.text) > 50
        assert source.sentence.endswith(f"({STATUS_WORDS[source.status]})")


def test_no_key_is_used_twice():
    text = (ROOM / "sources.py").read_text(encoding="utf-8")
    assert text.count("    Source(\n") == len(SOURCES)


def test_every_key_that_the_room_cites_exists():
    cites = re.compile(r"""(?:source=|cited\()\s*"([^"]+)\"""")
    found = {
        (path.name, key)
        for path in ROOM.glob("*.py")
        for key in cites.findall(path.read_text(encoding="utf-8"))
    }
    assert not [pair for pair in found if pair[1] not in SOURCES]


def test_what_nobody_read_says_so():
    assert SOURCES["PTI"].status == SOURCES["FHWA"].status == "read"
    assert SOURCES["EN 1993-1-11"].status == "second-hand"
    assert SOURCES["dry galloping"].status == "from memory"
    assert SOURCES["rivulet rule"].status == SOURCES["rivulet scatter"].status == "judgement"


def test_unknown_words_are_refused():
    assert cited("PTI") is SOURCES["PTI"]
    with pytest.raises(InputError, match="'PTY' is not known"):
        cited("PTY")
    with pytest.raises(InputError, match="status"):
        Source("x", "y", "certain")  # type: ignore[arg-type]
