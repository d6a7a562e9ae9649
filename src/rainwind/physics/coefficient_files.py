"""Coefficient sets from TOML files: the shipped ones by name, others by path. Degrees become radians here."""

import tomllib
from collections.abc import Callable
from functools import lru_cache
from importlib.resources import files
from math import degrees, radians
from os import PathLike, fspath
from pathlib import Path
from typing import Any

from rainwind.errors import CaseError, InputError
from rainwind.parameters import unknown_name
from rainwind.physics.blend import Blend
from rainwind.physics.checks import finite_number
from rainwind.physics.coefficients import NARROWEST, CoefficientSet
from rainwind.physics.curves import Curve, Table, as_curve

_NEEDED = ("name", "source", "status", "valid_deg", "lift", "drag")
_OPTIONAL = ("variable", "moment", "blend", "rivulet_height_m", "reading_error")
_NOTES = ("fitted", "missed", "also_found")
_TABLE = ("alpha_deg", "value", "degree", "allowed_error")
_BLEND = ("centre_deg", "half_width_deg", "width")
_BARE = ("bare_lift", "bare_drag", "bare_moment")


def shipped_sets() -> tuple[str, ...]:
    """Names of the coefficient sets that come with the package; "reconstructed" is the default one."""
    return tuple(_shipped())


def load_coefficients(name_or_path: str | PathLike[str]) -> CoefficientSet:
    """A shipped set by name, or the set in a TOML file.

    The file has name, source, status, valid_deg = [low, high], lift, drag and, optionally, moment,
    rivulet_height_m, reading_error, blend, variable (a note) and the notes [fitted], [missed], [also_found].
    A curve is a list of polynomial coefficients in alpha (rad), text in alpha, or a table
    {alpha_deg = [...], value = [...], degree = 6, allowed_error = 0.02} that covers valid_deg. status is
    "measured", "read off", "reconstructed", "unverified", "artificial" or "test".
    Raises CaseError, with every fault of the file, or InputError for a name that is not shipped.
    """
    given = fspath(name_or_path)
    shipped = _shipped()
    if given in shipped:
        return _read_shipped(given)
    path = Path(given)
    if path.suffix != ".toml" and not path.exists():
        error = unknown_name(given, shipped, "coefficient set")
        raise CaseError(f"{error}; or give the path of a .toml file")
    try:
        content = path.read_bytes()
    except OSError as error:
        raise CaseError(f"the coefficient file {given} cannot be read: {error.strerror or error}") from None
    return parse_coefficients(content, where=given)


def parse_coefficients(content: bytes, *, where: str) -> CoefficientSet:
    """The set in the TOML text `content`; `where` names it in errors. Raises CaseError with every fault."""
    try:
        case = tomllib.loads(content.decode())
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise CaseError(f"{where} is not a TOML file in UTF-8: {error}") from None
    faults = _unknown_keys(case, (*_NEEDED, *_OPTIONAL, *_NOTES), "")
    faults += [f"'{key}' is missing" for key in _NEEDED if key not in case]

    def read(key: str, convert: Callable[[Any], Any]) -> Any:
        if key not in case:
            return None
        try:
            return convert(case[key])
        except InputError as error:
            faults.append(str(error))
            return None

    curves = {key: read(key, lambda given, key=key: _curve(key, given)) for key in ("lift", "drag", "moment")}
    valid = read("valid_deg", _degrees_range)
    blend = read("blend", _blend)
    notes = {key: case[key] for key in ("variable", *_NOTES) if key in case}
    if not faults:
        try:
            return CoefficientSet(
                name=case["name"],
                source=case["source"],
                status=case["status"],
                valid=valid,
                blend=blend,
                rivulet_height=case.get("rivulet_height_m"),
                reading_error=case.get("reading_error"),
                notes=notes,
                **curves,
            )
        except InputError as error:
            faults.append(str(error))
    raise CaseError(f"{where} is not a usable coefficient set: " + "; ".join(faults))


@lru_cache(maxsize=1)
def _shipped() -> dict[str, str]:
    folder = files("rainwind.physics") / "data"
    names = sorted(item.name for item in folder.iterdir() if item.name.endswith(".toml"))
    return {name.removesuffix(".toml").replace("_", "-"): name for name in names}


@lru_cache(maxsize=16)
def _read_shipped(name: str) -> CoefficientSet:
    file = files("rainwind.physics") / "data" / _shipped()[name]
    return parse_coefficients(file.read_bytes(), where=name)


def _unknown_keys(table: dict[str, Any], known: tuple[str, ...], inside: str) -> list[str]:
    return [str(unknown_name(f"{inside}{key}", known, "key")) for key in table if key not in known]


def _degrees_range(given: Any) -> tuple[float, float]:
    if not isinstance(given, list) or len(given) != 2:
        raise InputError(f"valid_deg = {given!r} must be two angles in degrees, low and high")
    low, high = (finite_number("valid_deg", v) for v in given)
    if low >= high:
        raise InputError(f"valid_deg = [{low:g}, {high:g}] is reversed or empty; give the lower angle first")
    if radians(high - low) < NARROWEST:
        raise InputError(
            f"valid_deg = [{low:g}, {high:g}] is narrower than {degrees(NARROWEST):.0f} degrees and looks like "
            f"radians; write [{degrees(low):.4g}, {degrees(high):.4g}] if it is"
        )
    return radians(low), radians(high)


def _curve(key: str, given: Any) -> Curve:
    if not isinstance(given, dict):
        return as_curve(key, given)
    faults = _unknown_keys(given, _TABLE, f"{key}.")
    faults += [f"'{key}.{part}' is missing" for part in ("alpha_deg", "value") if part not in given]
    faults += [
        f"'{key}.{part}' = {given[part]!r} must be a list of numbers"
        for part in ("alpha_deg", "value")
        if part in given and not isinstance(given[part], list)
    ]
    if faults:
        raise InputError("; ".join(faults))
    alpha = tuple(radians(finite_number(f"{key}.alpha_deg", angle)) for angle in given["alpha_deg"])
    rest = {part: given[part] for part in ("degree", "allowed_error") if part in given}
    try:
        return Table(alpha, tuple(given["value"]), **rest)
    except InputError as error:
        raise InputError(f"{key}: {error}") from None


def _blend(given: Any) -> Blend:
    if not isinstance(given, dict):
        raise InputError(f"blend = {given!r} must be a table with {', '.join((*_BLEND, *_BARE))}")
    faults = _unknown_keys(given, (*_BLEND, *_BARE), "blend.")
    faults += [f"'blend.{key}' is missing" for key in _BLEND if key not in given]
    if faults:
        raise InputError("; ".join(faults))
    return Blend(
        centre=radians(finite_number("blend.centre_deg", given["centre_deg"])),
        half_width=radians(finite_number("blend.half_width_deg", given["half_width_deg"])),
        width=given["width"],
        **{key: given[key] for key in _BARE if key in given},
    )
