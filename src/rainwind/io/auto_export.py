"""A model and a start as files for AUTO-07p: equations in Fortran 90, constants, and an orbit's data."""

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from rainwind import __version__
from rainwind.dynamics.equilibria import find_equilibrium
from rainwind.dynamics.kernels import opcodes as op
from rainwind.dynamics.orbit_results import Orbit, OrbitPoint
from rainwind.dynamics.results import Equilibrium, SpecialPoint
from rainwind.dynamics.system import System, as_system, number
from rainwind.errors import InputError
from rainwind.parameters import unknown_name

__all__ = ["export_to_auto"]

RESERVED = range(11, 15)  # PAR(11) is the period; AUTO keeps the next three for itself as well
MOST_DEGREE = 7  # of AUTO's collocation
POINTS_A_NODE = 4  # of an orbit's data file: AUTO interpolates them linearly


def export_to_auto(
    model: Any,
    folder: Path | str,
    start: Any = None,
    *,
    along: str | None = None,
    until: tuple[float, float] | None = None,
    name: str = "model",
) -> tuple[Path, ...]:
    """Write `<name>.f90`, `c.<name>` and, for an orbit, `<name>.dat` into a folder (made if need be).

    start: an Orbit or labelled orbit, which AUTO then follows (IPS = 2), or an equilibrium, a special point or a state
    near one (default: near zero), which it follows in its place (IPS = 1). along: the parameter (default: the first).
    until: its bounds, where AUTO stops and from which the steps are taken; AUTO goes upward, with DS < 0 downward.
    AUTO numbers the parameters, and both files say which is which. In the folder, `@r name` runs it, or `run('name')`
    in AUTO's Python. Raises InputError for bad input and ComputationError where there is no equilibrium.
    """
    system = as_system(model)
    if not system.parameters:
        raise InputError("AUTO follows a parameter, and this system has none; give it one")
    if not isinstance(name, str) or not re.fullmatch(r"[A-Za-z]\w*", name, re.ASCII):
        raise InputError(f"name = {name!r} names files and must be letters, digits and _, a letter first")
    if along is None:
        along = next(iter(system.parameters))
    if along not in system.parameters:
        raise unknown_name(str(along), system.parameters, "parameter")
    start = start.orbit if isinstance(start, OrbitPoint) else start
    if isinstance(start, Orbit | Equilibrium | SpecialPoint):
        if start.states != system.states:
            raise InputError(
                f"start has the states {', '.join(start.states)}, the system has {', '.join(system.states)}; "
                "give a start of this system"
            )
        system = system.with_parameters({k: v for k, v in start.parameters.items() if k in system.parameters})
    orbit = start if isinstance(start, Orbit) else None
    guess = start.state if isinstance(start, Equilibrium | SpecialPoint) else start
    state = orbit.profile[0] if orbit is not None else find_equilibrium(system, guess).state
    window = _window(system, along, until)
    texts = {
        f"{name}.f90": _equations(system, state, name),
        f"c.{name}": _constants(system, along, window, orbit, name),
    }
    if orbit is not None:
        texts[f"{name}.dat"] = _data(orbit)
    folder = Path(folder)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        for file, text in texts.items():
            (folder / file).write_text(text, encoding="ascii", newline="\n")
    except OSError as error:
        raise InputError(
            f"{folder}: cannot be written ({error.strerror}); check the folder and permissions"
        ) from error
    return tuple(folder / file for file in texts)


def places(parameters: Sequence[str]) -> dict[str, int]:
    """The number that each parameter has in AUTO's PAR."""
    free = (i for i in range(1, len(parameters) + 1 + len(RESERVED)) if i not in RESERVED)
    return dict(zip(parameters, free, strict=False))


def _window(system: System, along: str, until: Any) -> tuple[float, float] | None:
    if until is None:
        return None
    try:
        low, high = (number(bound, f"a bound of {along}") for bound in until)
    except (TypeError, ValueError) as error:
        raise InputError(f"until must be two numbers (low, high); got {until!r}") from error
    if not low <= system.parameters[along] <= high or low == high:
        raise InputError(
            f"start: {along} = {system.parameters[along]:g} lies outside until = ({low:g}, {high:g}); move one of them"
        )
    return low, high


# -- the equations ----------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class _Code:
    """A tape as straight-line Fortran: values in t, derivatives by all states and parameters in arrays d."""

    names: dict[int, str]  # of inputs and constants, by slot
    inputs: int

    def value(self, slot: int) -> str:
        return self.names.get(slot, f"t{slot}")

    def moves(self, slot: int) -> bool:
        """Whether a slot is no constant."""
        return slot not in self.names or slot < self.inputs

    def operation(self, code: int, z: int, a: int, b: int) -> Iterator[str]:
        """What an operation computes; sin with cos, sinh with cosh."""
        x, y = self.value(a), self.value(b)
        if code in _INFIX:
            yield f"t{z} = {x} {_INFIX[code]} {y}"
        elif code == op.NEG:
            yield f"t{z} = -{x}"
        elif code == op.ATAN2:
            yield f"t{z} = atan2({x}, {y})"
        else:
            first, second = _FUNCTIONS[code]
            yield f"t{z} = {first}({x})"
            if second:
                yield f"t{z + 1} = {second}({x})"

    def derivative(self, code: int, z: int, a: int, b: int) -> Iterator[str]:
        """The chain rule of an operation."""
        x, y, t = self.value(a), self.value(b), f"t{z}"
        two = {
            op.ADD: ("1", "1"),
            op.SUB: ("1", "-1"),
            op.MUL: (y, x),
            op.DIV: (f"1/{y}", f"-{t}/{y}"),
            op.ATAN2: (f"{y}/({x}**2 + {y}**2)", f"-{x}/({x}**2 + {y}**2)"),
        }
        if code in two:
            terms = [(by, slot) for by, slot in zip(two[code], (a, b), strict=True) if self.moves(slot)]
            yield f"d{z} = " + " + ".join(
                f"d{slot}" if by == "1" else f"({by})*d{slot}" for by, slot in terms
            )
            return
        if code in (op.SINCOS, op.SINHCOSH):
            yield f"d{z} = t{z + 1}*d{a}"
            yield f"d{z + 1} = {'-' if code == op.SINCOS else ''}{t}*d{a}"
            return
        slope = {
            op.NEG: "-1",
            op.POWER: f"{y}*{x}**({y} - 1)",
            op.SQRT: f"0.5d0/{t}",
            op.EXP: t,
            op.LOG: f"1/{x}",
            op.TAN: f"1 + {t}**2",
            op.TANH: f"1 - {t}**2",
            op.ATAN: f"1/(1 + {x}**2)",
            op.ASIN: f"1/sqrt(1 - {x}**2)",
            op.ACOS: f"-1/sqrt(1 - {x}**2)",
            op.ERF: f"2/sqrt({_literal(float(np.pi))})*exp(-{x}**2)",
        }[code]
        yield f"d{z} = ({slope})*d{a}"


def _factor(by: str) -> str:
    """A slope before the array that it multiplies."""
    if by == "1":
        return ""
    return f"{by}*" if re.fullmatch(r"t\d+|u\(\d+\)|par\(\d+\)", by) else f"({by})*"


_INFIX = {op.ADD: "+", op.SUB: "-", op.MUL: "*", op.DIV: "/", op.POWER: "**"}
_FUNCTIONS = {
    op.SQRT: ("sqrt", ""), op.EXP: ("exp", ""), op.LOG: ("log", ""), op.SINCOS: ("sin", "cos"),
    op.SINHCOSH: ("sinh", "cosh"), op.TAN: ("tan", ""), op.TANH: ("tanh", ""), op.ATAN: ("atan", ""),
    op.ASIN: ("asin", ""), op.ACOS: ("acos", ""), op.ERF: ("erf", ""),
}  # fmt: skip


def _equations(system: System, state: np.ndarray, name: str) -> str:
    operations, template, outputs = system.tape.arrays
    rows = operations.tolist()
    n, par = len(system.states), places(list(system.parameters))
    count = n + len(par)
    first = min((row[1] for row in rows), default=len(template))
    names = {i: f"u({i + 1})" for i in range(n)}
    names |= {n + i: f"par({k})" for i, k in enumerate(par.values())}
    names |= {slot: _literal(float(template[slot])) for slot in range(count, first)}
    code = _Code(names, count)
    slots = sorted(
        {slot for row in rows for slot in ((row[1], row[1] + 1) if row[0] in _PAIRS else (row[1],))}
    )
    moving = [slot for slot in (*range(count), *slots) if _used(slot, rows, outputs) or slot in slots]
    head = [
        f"! Written by rainwind {__version__} for AUTO-07p: {name}",
        "!",
        *(f"!   U({i})  {_word(state_name)}" for i, state_name in enumerate(system.states, 1)),
        *(f"!   PAR({k})  {_word(parameter)}" for parameter, k in par.items()),
        "!   PAR(11)  the period of an orbit",
    ]
    lines = [
        "subroutine func(ndim, u, icp, par, ijac, f, dfdu, dfdp)",
        "  implicit none",
        "  integer, intent(in) :: ndim, icp(*), ijac",
        "  double precision, intent(in) :: u(ndim), par(*)",
        "  double precision, intent(out) :: f(ndim)",
        "  double precision, intent(inout) :: dfdu(ndim, ndim), dfdp(ndim, *)",
        *(f"  double precision :: {group}" for group in _grouped([f"t{s}" for s in slots])),
        "  ! derivatives by all states, then all parameters",
        *(f"  double precision, dimension({count}) :: {g}" for g in _grouped([f"d{s}" for s in moving])),
        "",
        *(f"  {line}" for row in rows for line in code.operation(*row)),
        *(f"  f({i}) = {code.value(slot)}" for i, slot in enumerate(outputs.tolist(), 1)),
        "  if (ijac == 0) return",
        "",
        *(f"  d{slot} = 0; d{slot}({slot + 1}) = 1" for slot in moving if slot < count),
        *(f"  {line}" for row in rows for line in code.derivative(*row)),
    ]
    for i, slot in enumerate(outputs.tolist(), 1):
        lines.append(f"  dfdu({i}, :) = " + (f"d{slot}(1:{n})" if code.moves(slot) else "0"))
    lines.append("  if (ijac == 1) return")
    for i, slot in enumerate(outputs.tolist(), 1):
        for j, k in enumerate(par.values(), n + 1):
            lines.append(f"  dfdp({i}, {k}) = " + (f"d{slot}({j})" if code.moves(slot) else "0"))
    lines += [
        "end subroutine func",
        "",
        "subroutine stpnt(ndim, u, par, t)",
        "  implicit none",
        "  integer, intent(in) :: ndim",
        "  double precision, intent(inout) :: u(ndim), par(*)",
        "  double precision, intent(in) :: t",
        *(
            f"  par({k}) = {_literal(system.parameters[parameter])}  ! {_word(parameter)}"
            for parameter, k in par.items()
        ),
        *(
            f"  u({i}) = {_literal(value)}  ! {_word(state_name)}"
            for i, (state_name, value) in enumerate(zip(system.states, state.tolist(), strict=True), 1)
        ),
        "end subroutine stpnt",
    ]
    for empty in ("bcnd", "icnd", "fopt", "pvls"):
        lines += ["", f"subroutine {empty}", f"end subroutine {empty}"]
    return "\n".join([*head, "", *lines, ""])


_PAIRS = (op.SINCOS, op.SINHCOSH)


def _used(slot: int, rows: list[list[int]], outputs: np.ndarray) -> bool:
    return slot in outputs or any(slot in row[2:] for row in rows)


def _grouped(names: list[str], size: int = 12) -> Iterator[str]:
    """Names for declarations, a few a line."""
    for i in range(0, len(names), size):
        yield ", ".join(names[i : i + size])


def _literal(value: float) -> str:
    """A double precision constant with all its digits; in brackets where it has a sign."""
    digits, _, power = repr(float(value)).partition("e")
    text = f"{digits}d{int(power or 0)}"
    return f"({text})" if value < 0.0 or text.startswith("-") else text


def _word(name: str) -> str:
    """A name as AUTO's files can hold it."""
    return re.sub(r"[^A-Za-z0-9_.+-]", "_", name)


# -- constants and data -----------------------------------------------------------------------------------------------


def _constants(
    system: System, along: str, window: tuple[float, float] | None, orbit: Orbit | None, name: str
) -> str:
    par = places(list(system.parameters))
    k, top = par[along], max(par.values())
    width = window[1] - window[0] if window else 1.0
    values: dict[str, Any] = {
        "unames": {i: _word(state) for i, state in enumerate(system.states, 1)},
        "parnames": {i: _word(parameter) for parameter, i in par.items()}
        | ({} if top < 11 else {11: "period"}),
        "NDIM": len(system.states),
        "IPS": 1 if orbit is None else 2,
        "IRS": 0,
        "ILP": 1,
        "ICP": [k] if orbit is None else [k, 11],
    }
    if orbit is not None:
        values["dat"] = name
    values |= {
        "NTST": 20 if orbit is None else len(orbit.grid.lengths),
        "NCOL": 4 if orbit is None else min(orbit.grid.degree, MOST_DEGREE),
        "IAD": 3,
        "ISP": 2,
        "ISW": 1,
        "IPLT": 0,
        "NBC": 0,
        "NINT": 0,
        "NMX": 2000,
        "NPR": 100,
        "MXBF": 0,
        "IID": 2,
        "ITMX": 9,
        "ITNW": 7,
        "NWTN": 3,
        "JAC": 1,
        "NPAR": max(36, top),
        "EPSL": 1e-8,
        "EPSU": 1e-8,
        "EPSS": 1e-6,
        "DS": 1e-3 * width,
        "DSMIN": 1e-8 * width,
        "DSMAX": 1e-2 * width,
        "IADS": 1,
        "THL": {11: 0.0},
    }
    if window:
        values["UZSTOP"] = {k: list(window)}
    return "".join(f"{key} = {value!r}\n" for key, value in values.items())


def _data(orbit: Orbit) -> str:
    """Time and states, a row a point, over one period."""
    fine = np.linspace(0.0, 1.0, POINTS_A_NODE * orbit.grid.degree + 1)[:-1]
    phases = np.append((orbit.grid.times[:-1, None] + orbit.grid.lengths[:, None] * fine).ravel(), 1.0)
    states = orbit.grid.at(orbit.profile, phases)
    rows = np.column_stack([orbit.period * phases, states])
    return "".join(" ".join(f"{value: .16e}" for value in row) + "\n" for row in rows)
