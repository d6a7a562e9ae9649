"""Numbers at the border: what becomes SI, and what is refused."""

from math import isclose, pi, radians

import pytest

from rainwind.errors import InputError
from rainwind.io import units
from rainwind.io.units import KINDS, from_text, number, to_si, written


@pytest.mark.parametrize(
    ("kind", "suffix", "given", "si"),
    [
        ("angle", "deg", 180.0, pi),
        ("angle", "rad", 0.3, 0.3),
        ("ratio", "percent", 0.2, 0.002),
        ("ratio", "ratio", 0.002, 0.002),
        ("length", "mm", 100.0, 0.1),
        ("length", "cm", 10.0, 0.1),
        ("speed", "km_h", 36.0, 10.0),
        ("mass per length", "g_m", 200.0, 0.2),
        ("force", "kN", 4500.0, 4.5e6),
        ("force", "MN", 4.5, 4.5e6),
        ("bending stiffness", "kNm2", 900.0, 9e5),
        ("bending stiffness", "MNm2", 0.9, 9e5),
        ("damper coefficient", "kNs_m", 80.0, 8e4),
        ("stiffness", "kN_m", 5000.0, 5e6),
        ("stiffness", "MN_m", 5.0, 5e6),
        ("time", "h", 2.0, 7200.0),
        ("time", "min", 90.0, 5400.0),
        ("rain rate", "mm_h", 0.5, 0.5),
    ],
)
def test_suffixes(kind: str, suffix: str, given: float, si: float):
    assert to_si(given, KINDS[kind], suffix) == si


@pytest.mark.parametrize(
    ("kind", "text", "si"),
    [
        ("angle", "45 deg", radians(45)),
        ("angle", "45°", radians(45)),
        ("angle", "0.5 rad", 0.5),
        ("ratio", "0.2 %", 0.002),
        ("length", "100 mm", 0.1),
        ("length", "10cm", 0.1),
        ("speed", "32 km/h", 32 / 3.6),
        ("speed", "1e1 m/s", 10.0),
        ("density", "1.225 kg/m^3", 1.225),
        ("mass per length", "50 kg/m", 50.0),
        ("frequency", "1 Hz", 1.0),
        ("friction", "0.05 Nms", 0.05),
        ("friction", "0.05 N m s", 0.05),
        ("friction", "0.05 N*m*s/m", 0.05),
        ("force", "4.5 MN", 4.5e6),
        ("force", "4500 kN", 4.5e6),
        ("bending stiffness", "900 kNm^2", 9e5),
        ("bending stiffness", "900 kNm2", 9e5),
        ("bending stiffness", "900 kN m²", 9e5),
        ("bending stiffness", "900 kN*m**2", 9e5),
        ("damper coefficient", "80 kNs/m", 8e4),
        ("damper coefficient", "80 kN s/m", 8e4),
        ("damper coefficient", "80 N*s/mm", 8e4),
        ("stiffness", "5 MN/m", 5e6),
        ("time", "2 h", 7200.0),
        ("time", "90 min", 5400.0),
        ("rain rate", "0.5 mm/h", 0.5),
        ("rain rate", "12 mm/day", 0.5),
        ("quadratic stiffness", "0.0077 N/m^3", 0.0077),
        ("cubic stiffness", "0.00115 N/m^4", 0.00115),
    ],
)
def test_text_with_unit(kind: str, text: str, si: float):
    assert isclose(from_text(text, KINDS[kind]), si, rel_tol=1e-15)


@pytest.mark.parametrize(
    ("kind", "text", "words"),
    [
        ("angle", "45", "no unit"),
        ("angle", "2 %", "no unit of an angle"),
        ("ratio", "3 deg", "no unit of a ratio"),
        ("length", "45 deg", "no unit of a length"),
        ("frequency", "6 rad/s", "no unit of a frequency"),  # pint would call it 6 Hz
        ("speed", "9 m", "no unit of a speed"),
        ("quadratic stiffness", "1 N/m^2", 'such as "0.0077 N/m^3"'),
        ("length", "fast", "not a number with a unit"),
        ("length", "nan m", "not a number with a unit"),
        ("length", "1e400 m", "not a finite number"),
        ("length", "3 foo", "'foo' that is not known"),
        ("length", "3 m)", "not known"),
        ("speed", "9 m_s", "did you mean m/s?"),
        ("speed", "9 ms", "did you mean m/s?"),
        ("speed", "9 kmh", "did you mean km/h?"),
        ("speed", "9 KM/H", "did you mean km/h?"),
        ("density", "1.2 kg_m3", "did you mean kg/m^3?"),
        ("length", "79,0 mm", "decimal point, 79.0 mm"),
        ("length", "", "not a number with a unit"),
    ],
)
def test_text_refused(kind: str, text: str, words: str):
    with pytest.raises(InputError) as error:
        from_text(text, KINDS[kind])
    assert words in str(error.value)
    assert "write" in str(error.value)


@pytest.mark.parametrize("value", ["9", True, [9], {}, float("nan"), float("inf"), 10**400, None])
def test_no_number(value: object):
    with pytest.raises(InputError, match="number"):
        number(value)


@pytest.mark.parametrize("kind", KINDS.values(), ids=lambda kind: kind.name)
def test_what_is_written_reads_back_exactly(kind):
    for value in (0.1, 0.055, pi / 4, 1 / 3, 1.234567890123456, 0.002, 1e-300):
        suffix, shown = written(value, kind)
        assert to_si(shown, kind, suffix) == value


@pytest.mark.parametrize(
    "unit", ["m^", "m/s{", "*m", "'m'**m", "m/0", "dB**m", "mdB", "Nkgm", "..3", "m if m"]
)
def test_a_text_that_is_no_unit(unit: str):
    with pytest.raises(InputError, match="write a length with its unit"):
        from_text(f"3 {unit}", KINDS["length"])


@pytest.mark.parametrize("what", [RuntimeError, KeyError, MemoryError])
def test_a_fault_of_the_program_is_not_called_an_unknown_unit(what, monkeypatch: pytest.MonkeyPatch):
    class Broken:
        def Quantity(self, *_):  # pint's name
            raise what

    monkeypatch.setattr(units, "_registry", Broken)
    with pytest.raises(what):
        from_text("3 m", KINDS["length"])
