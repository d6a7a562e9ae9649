"""Machine code for the Taylor coefficients of a tape along its own flow, in W lanes.

The recurrences are those of `jets.py`. Each is a sum over products of lower coefficients, x_j y_(k-j), whose inner
part (0 < j < k) is known before anything of order k is. So for each order the inner sums of all operations are formed
first, some at a time, in one loop over j; then everything of order k follows from them, in the tape's order. A
derivative x' in a recurrence is a row of its own, j x_j.

Rows, orders, lanes: rows[row][order][lane]. The first rows are the states; `Layout` says which others are where.
"""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from rainwind.dynamics.kernels import opcodes as op
from rainwind.dynamics.kernels import vector_math
from rainwind.dynamics.kernels.machine_code import DOUBLE, INT, Writer

FORGET = 1.0 - 1.0 / 64.0  # what is left after a step of the size that a state once had
LARGEST_STATE = 1e100  # beyond it a trajectory has run away
GROUP = 12  # inner sums formed in one loop: so many that their operands share loads and the sums fit into registers

# rows of control: one vector each, then three for each state, then four for each driven input
TIME, TIME_LOW, STOP, SIGN, STEP, FREE, REACH, KNOT = range(8)
FIRST_OF_STATES = 8  # next state, what its rounding lost, its size
OF_A_STATE = 3
NEXT, LOW, SIZE = range(OF_A_STATE)
OF_A_DRIVEN = 4  # coefficients from the last knot on

Row = tuple[
    str, int
]  # "c": coefficients of a slot, "d": of its derivative times t, "q": of its argument's square


@dataclass(frozen=True)
class Layout:
    """What lies where: rows by what they hold, slots of the constants, rows of the outputs beyond the states."""

    states: int
    order: int
    lanes: int
    driven: tuple[int, ...]
    rows: dict[Row, int]
    constants: tuple[int, ...]
    extra: tuple[int, ...]

    @property
    def controls(self) -> int:
        """How many rows of control."""
        return FIRST_OF_STATES + OF_A_STATE * self.states + OF_A_DRIVEN * len(self.driven)


class Program:
    """A tape sorted for its code: what moves, what is stored, which inner sums there are."""

    def __init__(
        self,
        operations: np.ndarray,
        outputs: np.ndarray,
        moves: np.ndarray,
        states: int,
        driven: Sequence[int],
        controlled: int,
    ) -> None:
        self.moves, self.states, self.driven, self.controlled = moves, states, tuple(driven), controlled
        self.outputs = [int(z) for z in outputs[:states]]
        self.extra = [int(z) for z in outputs[states:]]
        self.rows = {int(r[1]): tuple(int(i) for i in r) for r in operations if moves[r[1]]}
        for z, row in list(self.rows.items()):
            if row[0] >= op.FIRST_WITH_TWO:
                self.rows[z + 1] = row
        self.higher = self._needed([*self.outputs, *self.extra], self.arguments)
        self.zeroth = self._needed([*self.outputs, *self.extra], self.all_arguments)
        self.at_the_end = self._needed(self.extra, self.arguments)
        sums = {pair for z in self.higher for pair in self.inner_sums(z)}
        self.stored: list[Row] = [("c", i) for i in range(states)]
        self.stored += [("c", i) for i in self.driven]
        wanted = {row for pair in sums for row in pair} | {("c", z) for z in self.extra}
        self.stored += sorted(wanted - set(self.stored))

    def scaled(self, z: int) -> tuple[int, int] | None:
        """(c, x) where slot z is a constant's slot c times x."""
        row = self.rows.get(z)
        if row is None or row[0] != op.MUL or self.moves[row[2]] == self.moves[row[3]]:
            return None
        return (row[2], row[3]) if self.moves[row[3]] else (row[3], row[2])

    def wraps(self, z: int) -> int | None:
        """The angle u where z is atan2(sin u, cos u): u itself but for whole turns."""
        code, _, a, b = self.rows[z]
        of_a = self.rows.get(a)
        same = (
            code == op.ATAN2
            and of_a is not None
            and of_a[0] == op.SINCOS
            and (a, b) == (of_a[1], of_a[1] + 1)
        )
        return of_a[2] if same and of_a is not None and z == self.rows[z][1] else None

    def all_arguments(self, z: int) -> list[int]:
        """What coefficient 0 of a slot needs."""
        code, _, a, b = self.rows[z]
        if code in (op.ADD, op.SUB):
            found = []
            for x in (a, b):
                scaled = self.scaled(x)
                found.append(x if scaled is None else scaled[1])
            return found
        return [a, b] if code in op.BINARY else [a]

    def arguments(self, z: int) -> list[int]:
        """What coefficient k of a slot needs at order k."""
        angle = self.wraps(z)
        return self.all_arguments(z) if angle is None else [angle]

    def _needed(self, slots: Iterable[int], arguments: Any) -> list[int]:
        stack, needed = [z for z in slots if self.moves[z]], set()
        while stack:
            z = stack.pop()
            if z in self.rows:
                first = self.rows[z][1]
                if z not in needed:
                    both = {first, first + 1} if self.rows[z][0] >= op.FIRST_WITH_TWO else {z}
                    needed |= both
                    stack += [x for x in arguments(z) if self.moves[x]]
        return sorted(z for z in needed if z == self.rows[z][1])

    def inner_sums(self, z: int) -> list[tuple[Row, Row]]:
        """The pairs of rows whose inner sums a slot's recurrence has."""
        code, _, a, b = self.rows[z]
        c = lambda x: ("c", x)  # noqa: E731
        d = lambda x: ("d", x)  # noqa: E731
        moves, s = self.moves, z + 1
        if code == op.MUL:
            return [_pair(c(a), c(b))] if moves[a] and moves[b] else []
        if code == op.DIV:
            return [(c(z), c(b))] if moves[b] else []
        if code == op.POWER:
            return [(d(a), c(z)), (d(z), c(a))]
        if code == op.SQRT:
            return [(c(z), c(z))]
        if code == op.EXP:
            return [(d(a), c(z))]
        if code == op.LOG:
            return [(d(z), c(a))]
        if code in (op.SINCOS, op.SINHCOSH):
            return [(d(a), c(s)), (d(a), c(z))]
        if code in (op.TAN, op.TANH):
            return [(d(a), c(s)), (c(z), c(z))]
        if code == op.ATAN:
            return [(c(a), c(a)), (d(z), c(s))]
        if code in (op.ASIN, op.ACOS):
            return [(c(a), c(a)), (c(s), c(s)), (d(z), c(s))]
        if code == op.ERF:
            return [(c(a), c(a)), (("q", z), c(s)), (d(a), c(s))]
        if code == op.ATAN2 and self.wraps(z) is None:
            found = [(c(x), c(x)) for x in (a, b) if moves[x]] + [(d(z), c(s))]
            if moves[a] and moves[b]:
                found += [(d(a), c(b)), (d(b), c(a))]
            return found
        return []


def _pair(x: Row, y: Row) -> tuple[Row, Row]:
    return (x, y) if x <= y else (y, x)


class TaylorCode:
    """Writes `coefficients(rows, constants, control)` and `step(rows, constants, control)` of a program."""

    def __init__(self, program: Program, order: int, lanes: int) -> None:
        self.p, self.order, self.lanes = program, order, lanes
        rows = {row: i for i, row in enumerate(program.stored)}
        constants: dict[int, int] = {}
        for z in program.zeroth:
            for slot in (*program.rows[z][2:], *(self._constants_of(z))):
                if not program.moves[slot]:
                    constants.setdefault(slot, len(constants))
        for z in (*program.outputs, *program.extra):
            if not program.moves[z]:
                constants.setdefault(z, len(constants))
        extra = tuple(rows["c", z] for z in program.extra)
        self.constants = constants
        self.layout = Layout(program.states, order, lanes, program.driven, rows, tuple(constants), extra)

    def _constants_of(self, z: int) -> list[int]:
        found = []
        for x in self.p.rows[z][2:]:
            scaled = self.p.scaled(x)
            found += [] if scaled is None else [scaled[0]]
        return found

    # the coefficients

    def coefficients(self) -> Writer:
        """All coefficients of all rows from the states, constants and driven inputs."""
        w = self.w = Writer("coefficients", self.lanes, ("rows", "constants", "control"))
        self.values: dict[Any, Any] = {}  # of the order being written
        self.at_zero: dict[Any, Any] = {}  # coefficient 0 of slots, and reciprocals of some
        self._given()
        for z in self.p.zeroth:
            self._zeroth(z)
        self._fixed_extra()
        self._store(0, w.pointers["rows"])
        self._advance_states(0, w.pointers["rows"], w.number(1.0))
        if self.order > 1:
            self._orders()
        if self.p.extra:
            self.values = {}
            here = w.ahead(w.pointers["rows"], INT(self.order))
            self._order(
                self.p.at_the_end,
                INT(self.order),
                here,
                w.number(float(self.order)),
                w.number(1.0 / self.order),
            )
            self._store(self.order, here)
        w.b.ret(INT(0))
        return w

    def _row(self, row: Row) -> int:
        return self.layout.rows[row] * (self.order + 1)

    def _control(self, row: int) -> Any:
        return self.w.load(self.w.pointers["control"], row)

    def _constant(self, slot: int) -> Any:
        return self.w.load(self.w.pointers["constants"], self.constants[slot])

    def _given(self) -> None:
        """Coefficient 0 of the states, and all of the driven inputs, moved to the present time."""
        w, n = self.w, self.p.states
        for i in range(n):
            x = self._control(FIRST_OF_STATES + OF_A_STATE * i + NEXT)
            self.at_zero[i] = x
            w.store(x, w.pointers["rows"], self._row(("c", i)))
        for i, slot in enumerate(self.p.driven):
            first = FIRST_OF_STATES + OF_A_STATE * n + OF_A_DRIVEN * i
            a, b, c, d = (self._control(first + j) for j in range(OF_A_DRIVEN))
            t = w.b.fadd(w.b.fsub(self._control(TIME), self._control(KNOT)), self._control(TIME_LOW))
            three = w.b.fmul(w.number(3.0), d)
            shifted = [
                w.fma(t, w.fma(t, w.fma(t, d, c), b), a),
                w.fma(t, w.fma(t, three, w.b.fadd(c, c)), b),
                w.fma(t, three, c),
                d,
            ]
            self.at_zero[slot] = shifted[0]
            for kind in ("c", "d"):
                if (kind, slot) in self.layout.rows:
                    for j, value in enumerate(shifted[: self.order + 1]):
                        value = w.b.fmul(w.number(float(j)), value) if kind == "d" else value
                        w.store(value, w.pointers["rows"], self._row((kind, slot)) + j)

    def _zero(self, slot: int) -> Any:
        """Coefficient 0 of any slot."""
        return self.at_zero[slot] if self.p.moves[slot] else self._constant(slot)

    def _zeroth(self, z: int) -> None:
        """Coefficient 0 of an operation, and what its recurrence divides by."""
        w, v = self.w, self.at_zero
        code, _, a, b = self.p.rows[z]
        if code in (op.ADD, op.SUB):
            v[z] = self._sum(code, a, b, self._zero)
            return
        x = self._zero(a)
        if code == op.MUL:
            v[z] = w.b.fmul(x, self._zero(b))
        elif code == op.DIV:
            v[z] = w.b.fdiv(x, self._zero(b))
        elif code == op.NEG:
            v[z] = w.b.fneg(x)
        else:
            y = self._zero(b) if code in op.BINARY else x
            v[z], v[z + 1] = vector_math.operate(w, code, x, y)
        divisor = {
            op.DIV: b, op.POWER: a, op.LOG: a, op.SQRT: z,
            op.ATAN: z + 1, op.ASIN: z + 1, op.ACOS: z + 1, op.ATAN2: z + 1,
        }.get(code)  # fmt: skip
        if divisor is not None and ("1/", divisor) not in v and self.p.moves[divisor]:
            v["1/", divisor] = w.b.fdiv(w.number(1.0), v[divisor])

    def _fixed_extra(self) -> None:
        """Extra outputs that do not move: one coefficient, and zeros."""
        for slot in {z for z in self.p.extra if not self.p.moves[z]}:
            row = self._row(("c", slot))
            self.w.store(self._constant(slot), self.w.pointers["rows"], row)
            for j in range(1, self.order + 1):
                self.w.store(self.w.number(0.0), self.w.pointers["rows"], row + j)

    def _store(self, k: Any, here: Any, kf: Any = None) -> None:
        """Store what is kept of the order just written; `here` points to this order in row 0."""
        values = self.at_zero if k == 0 and kf is None and here is self.w.pointers["rows"] else self.values
        for (kind, slot), number in self.layout.rows.items():
            value = values.get(("q", slot) if kind == "q" else slot)
            if slot not in self.p.rows or value is None:
                continue
            if kind == "d":
                if values is self.at_zero:  # never read
                    continue
                value = self.w.b.fmul(self.kf, value)
            self.w.store(value, here, number * (self.order + 1))

    def _advance_states(self, k: Any, here: Any, inverse: Any) -> None:
        """x_(k+1) = f_k / (k + 1), where `here` points to order k; inverse: 1 / (k + 1)."""
        w = self.w
        first = isinstance(k, int)
        for i, slot in enumerate(self.p.outputs):
            f = self._zero(slot) if first else self._value(slot)
            if f is None:
                f = w.number(0.0)
            row = self._row(("c", i)) + 1
            w.store(f if first else w.b.fmul(f, inverse), here, row)
            if ("d", i) in self.layout.rows:
                w.store(f, here, self._row(("d", i)) + 1)

    def _orders(self) -> None:
        """The loop over orders 1 ... order - 1."""
        w, b = self.w, self.w.b
        start, loop, end = b.block, b.append_basic_block("order"), b.append_basic_block("orders_end")
        one = DOUBLE(1.0)
        b.branch(loop)
        b.position_at_end(loop)
        k, kf, inverse = b.phi(INT, "k"), b.phi(DOUBLE), b.phi(DOUBLE)
        here = w.ahead(w.pointers["rows"], k)
        kf_next = b.fadd(kf, one)
        inverse_next = b.fdiv(one, kf_next)
        self.values = {}
        self._order(self.p.higher, k, here, w.splat(kf), w.splat(inverse))
        self._store(k, here)
        self._advance_states(k, here, w.splat(inverse_next))
        k_next = b.add(k, INT(1))
        for phi, first, later in ((k, INT(1), k_next), (kf, one, kf_next), (inverse, one, inverse_next)):
            phi.add_incoming(first, start)
            phi.add_incoming(later, b.block)
        b.cbranch(b.icmp_signed("<", k_next, INT(self.order)), loop, end)
        b.position_at_end(end)

    def _order(self, slots: list[int], k: Any, here: Any, kf: Any, inverse: Any) -> None:
        """Coefficients k of some slots; `here` points to order k in row 0."""
        self.here, self.kf, self.inverse = here, kf, inverse
        pairs = list(dict.fromkeys(pair for z in slots for pair in self.p.inner_sums(z)))
        self.sums: dict[tuple[Row, Row], Any] = {}
        for group in _groups(pairs, GROUP):
            self._inner(group, k, here)
        for z in slots:
            self._higher(z)

    def _inner(self, group: list[tuple[Row, Row]], k: Any, here: Any) -> None:
        """Sum of x_j y_(k-j) for 0 < j < k of a group of pairs of rows, from the middle outwards."""
        w, b = self.w, self.w.b
        even, loop = b.append_basic_block("even"), b.append_basic_block("inner")
        test, after = b.append_basic_block("test"), b.append_basic_block("after")
        rows = w.pointers["rows"]
        zero = w.number(0.0)
        before = b.block
        half = b.lshr(k, INT(1))
        b.cbranch(b.icmp_signed("==", b.and_(k, INT(1)), INT(0)), even, test)
        b.position_at_end(even)
        middle = w.ahead(rows, half)
        of_row = {row: w.load(middle, self._row(row)) for pair in group for row in dict.fromkeys(pair)}
        middles = []
        for x, y in group:
            left = b.fmul(w.number(0.5), of_row[x]) if x == y else of_row[x]
            middles.append(b.fmul(left, of_row[y]))
        b.branch(test)
        b.position_at_end(test)
        starts = []
        for value in middles:
            phi = b.phi(w.vector)
            phi.add_incoming(zero, before)
            phi.add_incoming(value, even)
            starts.append(phi)
        first = b.lshr(b.sub(k, INT(1)), INT(1))
        b.cbranch(b.icmp_signed(">", first, INT(0)), loop, after)
        b.position_at_end(loop)
        j = b.phi(INT)
        totals = [b.phi(w.vector) for _ in group]
        low, high = w.ahead(rows, j), w.ahead(rows, b.sub(k, j))
        lows: dict[Row, Any] = {}
        highs: dict[Row, Any] = {}

        def get(where: dict[Row, Any], pointer: Any, row: Row) -> Any:
            if row not in where:
                where[row] = w.load(pointer, self._row(row))
            return where[row]

        sums = []
        for (x, y), total in zip(group, totals, strict=True):
            value = w.fma(get(lows, low, x), get(highs, high, y), total)
            if x != y:
                value = w.fma(get(highs, high, x), get(lows, low, y), value)
            sums.append(value)
        j_next = b.sub(j, INT(1))
        j.add_incoming(first, test)
        j.add_incoming(j_next, loop)
        for total, start, value in zip(totals, starts, sums, strict=True):
            total.add_incoming(start, test)
            total.add_incoming(value, loop)
        b.cbranch(b.icmp_signed(">", j_next, INT(0)), loop, after)
        b.position_at_end(after)
        for pair, start, value in zip(group, starts, sums, strict=True):
            self.sums[pair] = b.phi(w.vector)
            self.sums[pair].add_incoming(start, test)
            self.sums[pair].add_incoming(value, loop)
        for pair in group:
            if pair[0] == pair[1]:
                self.sums[pair] = b.fadd(self.sums[pair], self.sums[pair])

    # the step

    def step(self) -> Writer:
        """Choose each lane's step, take it, say which lanes have arrived (low 32 bits) or run away (high 32).

        With the radius of convergence guessed from the last two coefficients of all states, each in its own size
        (Jorba & Zou, Experimental Mathematics 14 (2005) 99-117), the step is a fixed share of it (2^REACH).
        """
        w = self.w = Writer("step", self.lanes, ("rows", "constants", "control"))
        b, n, p = w.b, self.p.states, self.order
        rows, control = w.pointers["rows"], w.pointers["control"]
        # away from a singularity the radius grows by no more than the step; gaps in a series make it look larger
        free = self._control(FREE)
        most = b.select(b.fcmp_ordered(">", free, w.number(0.0)), b.fadd(free, free), w.number(math.inf))
        sizes = []
        for i in range(self.p.controlled):
            own = FIRST_OF_STATES + OF_A_STATE * i
            now = w.absolute(w.load(rows, self._row(("c", i))))
            sizes.append(w.larger(now, b.fmul(w.number(FORGET), self._control(own + SIZE))))
        sizes = self._sizes_of_zeros(sizes, w.smaller(most, w.number(1.0)))
        last = before = w.number(1e-300)
        for i, size in enumerate(sizes):
            row = self._row(("c", i))
            w.store(size, control, FIRST_OF_STATES + OF_A_STATE * i + SIZE)
            share = b.fdiv(w.number(1.0), w.larger(size, w.number(1e-280)))
            last = w.larger(b.fmul(w.absolute(w.load(rows, row + p)), share), last)
            before = w.larger(b.fmul(w.absolute(w.load(rows, row + p - 1)), share), before)
        huge = w.number(1e300)
        log_last = b.fmul(vector_math.rough_log2(w, w.smaller(last, huge)), w.number(-1.0 / p))
        log_before = b.fmul(
            vector_math.rough_log2(w, w.smaller(before, huge)), w.number(-1.0 / max(p - 1, 1))
        )
        h = vector_math.rough_exp2(w, b.fadd(w.smaller(log_last, log_before), self._control(REACH)))
        h = w.smaller(h, most)
        w.store(h, control, FREE)
        time, low, stop, sign = (self._control(row) for row in (TIME, TIME_LOW, STOP, SIGN))
        left = b.fsub(b.fsub(stop, time), low)
        # a last step that is longer by a millionth does no harm, a tiny one after it would be for nothing
        arrives = b.fcmp_ordered(">=", b.fmul(h, w.number(1.000001)), b.fmul(left, sign))
        h = b.select(arrives, left, b.fmul(h, sign))
        w.store(h, control, STEP)
        # time moves on, and each state stays a number
        long = b.fcmp_ordered(">=", w.absolute(h), b.fmul(w.number(2.0**-52), w.absolute(time)))
        fine = b.or_(arrives, long)
        states = []
        for i in range(n):
            row = self._row(("c", i))
            total = w.load(rows, row + p)
            for j in range(p - 1, 0, -1):
                total = w.fma(total, h, w.load(rows, row + j))
            x = w.load(rows, row)
            added = w.fma(total, h, self._control(FIRST_OF_STATES + OF_A_STATE * i + LOW))
            new, lost = self._exact_sum(x, added)
            ends = b.fcmp_ordered("<", w.absolute(new), w.number(LARGEST_STATE))
            fine = b.and_(fine, ends)
            states.append((x, new, lost))
        for i, (x, new, lost) in enumerate(states):
            own = FIRST_OF_STATES + OF_A_STATE * i
            w.store(b.select(fine, new, x), control, own + NEXT)
            w.store(b.select(fine, lost, w.number(0.0)), control, own + LOW)
        later, rest = self._exact_sum(time, h)
        later, rest = self._exact_sum(later, b.fadd(rest, low))
        later, rest = b.select(arrives, stop, later), b.select(arrives, w.number(0.0), rest)
        w.store(b.select(fine, later, time), control, TIME)
        w.store(b.select(fine, rest, low), control, TIME_LOW)
        runs = b.fcmp_ordered("!=", sign, w.number(0.0))
        arrived = w.mask(b.and_(runs, b.and_(fine, arrives)))
        bad = w.mask(b.and_(runs, b.not_(fine)))
        b.ret(b.or_(arrived, b.shl(bad, INT(32))))
        return w

    def _sizes_of_zeros(self, sizes: list[Any], h: Any) -> list[Any]:
        """Sizes as they are; of states that have been zero, the size of their terms after a time h."""
        w, b, rows = self.w, self.w.b, self.w.pointers["rows"]
        some, after, before = b.append_basic_block("zeros"), b.append_basic_block("sizes"), b.block
        smallest = sizes[0]
        for size in sizes[1:]:
            smallest = w.smaller(smallest, size)
        zeros = w.mask(b.fcmp_ordered("==", smallest, w.number(0.0)))
        b.cbranch(b.icmp_signed("!=", zeros, INT(0)), some, after)
        b.position_at_end(some)
        found = []
        for i, size in enumerate(sizes):
            row = self._row(("c", i))
            terms = w.number(0.0)
            for j in range(self.order, 0, -1):
                terms = b.fmul(h, b.fadd(terms, w.absolute(w.load(rows, row + j))))
            found.append(b.select(b.fcmp_ordered("==", size, w.number(0.0)), terms, size))
        b.branch(after)
        b.position_at_end(after)
        phis = [b.phi(w.vector) for _ in sizes]
        for phi, size, other in zip(phis, sizes, found, strict=True):
            phi.add_incoming(size, before)
            phi.add_incoming(other, some)
        return phis

    def _exact_sum(self, x: Any, y: Any) -> tuple[Any, Any]:
        """x + y and what is lost by rounding (Knuth)."""
        b = self.w.b
        total = b.fadd(x, y)
        part = b.fsub(total, x)
        return total, b.fadd(b.fsub(x, b.fsub(total, part)), b.fsub(y, part))

    # one operation at order k

    def _value(self, slot: int) -> Any:
        """Coefficient k of any slot, None where it is zero for certain."""
        if not self.p.moves[slot]:
            return None
        if slot not in self.values:
            if slot in self.p.rows:  # a scaled slot that no other needs by itself
                self._higher(slot)
            else:
                self.values[slot] = self.w.load(self.here, self._row(("c", slot)))
        return self.values[slot]

    def _sum(self, code: int, a: int, b: int, value: Any) -> Any:
        """a + b or a - b at some order, given by `value`; products by constants are joined to it."""
        w = self.w
        minus = code == op.SUB
        of_a, of_b = self.p.scaled(a), self.p.scaled(b)
        if of_b is not None:
            factor = self._constant(of_b[0])
            x = value(of_b[1])
            left = value(a) if of_a is None else w.b.fmul(self._constant(of_a[0]), value(of_a[1]))
            product = w.b.fneg(factor) if minus else factor
            return w.b.fmul(product, x) if left is None else w.fma(product, x, left)
        right = value(b)
        if of_a is not None:
            factor, x = self._constant(of_a[0]), value(of_a[1])
            if right is None:
                return w.b.fmul(factor, x)
            return w.fma(factor, x, w.b.fneg(right) if minus else right)
        left = value(a)
        if right is None:
            return left
        if left is None:
            return w.b.fneg(right) if minus else right
        return w.b.fsub(left, right) if minus else w.b.fadd(left, right)

    def _square(self, x: int) -> Any:
        """Coefficient k of a slot's square."""
        twice = self.w.b.fadd(self.at_zero[x], self.at_zero[x])
        return self.w.fma(twice, self._value(x), self.sums[("c", x), ("c", x)])

    def _higher(self, z: int) -> None:
        """Coefficient k of an operation, by the recurrences of `jets.py`."""
        w, v, b = self.w, self.values, self.w.b
        if z in v:
            return
        code, _, x, y = self.p.rows[z]
        moves, s = self.p.moves, z + 1
        zero = self.at_zero

        def total(left: Row, right: Row) -> Any:
            return self.sums[left, right]

        def driven(left: Row, right: Row, factor: Any, value: Any) -> Any:
            """(inner sum + the last term) / k of z' = x' y, the last term being k x_k y_0."""
            return w.fma(value, factor, b.fmul(total(left, right), self.inverse))

        c, d = (lambda i: ("c", i)), (lambda i: ("d", i))
        if code in (op.ADD, op.SUB):
            v[z] = self._sum(code, x, y, self._value)
        elif code == op.NEG:
            v[z] = b.fneg(self._value(x))
        elif code == op.MUL and not (moves[x] and moves[y]):
            constant, moving = self.p.scaled(z)
            v[z] = b.fmul(self._constant(constant), self._value(moving))
        elif code == op.MUL and x == y:
            v[z] = self._square(x)
        elif code == op.MUL:
            left, right = _pair(c(x), c(y))
            v[z] = w.fma(zero[x], self._value(y), w.fma(zero[y], self._value(x), total(left, right)))
        elif code == op.DIV and not moves[y]:
            v[z] = b.fdiv(self._value(x), self._constant(y))
        elif code == op.DIV:
            rest = w.fma(zero[z], self._value(y), total(c(z), c(y)))
            rest = b.fneg(rest) if not moves[x] else b.fsub(self._value(x), rest)
            v[z] = b.fmul(rest, zero["1/", y])
        elif code == op.POWER:
            e = self._constant(y)
            rest = b.fsub(b.fmul(e, total(d(x), c(z))), total(d(z), c(x)))
            rest = w.fma(b.fmul(e, zero[z]), self._value(x), b.fmul(rest, self.inverse))
            v[z] = b.fmul(rest, zero["1/", x])
        elif code == op.SQRT:
            rest = b.fsub(self._value(x), total(c(z), c(z)))
            v[z] = b.fmul(b.fmul(w.number(0.5), rest), zero["1/", z])
        elif code == op.EXP:
            v[z] = driven(d(x), c(z), zero[z], self._value(x))
        elif code == op.LOG:
            rest = b.fsub(self._value(x), b.fmul(total(d(z), c(x)), self.inverse))
            v[z] = b.fmul(rest, zero["1/", x])
        elif code in (op.SINCOS, op.SINHCOSH):
            v[z] = driven(d(x), c(s), zero[s], self._value(x))
            second = driven(d(x), c(z), zero[z], self._value(x))
            v[s] = b.fneg(second) if code == op.SINCOS else second
        elif code in (op.TAN, op.TANH):
            v[z] = driven(d(x), c(s), zero[s], self._value(x))
            square = w.fma(b.fadd(zero[z], zero[z]), v[z], total(c(z), c(z)))
            v[s] = b.fneg(square) if code == op.TANH else square
        elif code == op.ATAN:
            v[s] = self._square(x)
            rest = b.fsub(self._value(x), b.fmul(total(d(z), c(s)), self.inverse))
            v[z] = b.fmul(rest, zero["1/", s])
        elif code in (op.ASIN, op.ACOS):
            rest = b.fneg(b.fadd(self._square(x), total(c(s), c(s))))
            v[s] = b.fmul(b.fmul(w.number(0.5), rest), zero["1/", s])
            value = self._value(x) if code == op.ASIN else b.fneg(self._value(x))
            v[z] = b.fmul(b.fsub(value, b.fmul(total(d(z), c(s)), self.inverse)), zero["1/", s])
        elif code == op.ERF:
            square = self._square(x)
            v["q", z] = b.fmul(self.kf, square)
            v[s] = b.fneg(driven(("q", z), c(s), zero[s], square))
            v[z] = driven(d(x), c(s), zero[s], self._value(x))
        elif code == op.ATAN2:
            self._atan2(z, x, y)
        else:
            raise NotImplementedError(f"opcode {code}")

    def _atan2(self, z: int, x: int, y: int) -> None:
        """(x^2 + y^2) z' = y x' - x y'."""
        w, v, b, zero, moves = self.w, self.values, self.w.b, self.at_zero, self.p.moves
        angle = self.p.wraps(z)
        if angle is not None:
            v[z] = self._value(angle)
            return
        s = z + 1
        squares = [self._square(i) for i in (x, y) if moves[i]]
        v[s] = squares[0] if len(squares) == 1 else b.fadd(*squares)
        rest = self.sums[("d", z), ("c", s)]
        if moves[x] and moves[y]:
            rest = b.fsub(b.fsub(rest, self.sums[("d", x), ("c", y)]), b.fneg(self.sums[("d", y), ("c", x)]))
        rest = b.fneg(b.fmul(rest, self.inverse))
        if moves[x]:
            rest = w.fma(self._zero(y), self._value(x), rest)
        if moves[y]:
            rest = w.fma(b.fneg(self._zero(x)), self._value(y), rest)
        v[z] = b.fmul(rest, zero["1/", s])


def _groups(pairs: list[tuple[Row, Row]], most: int) -> list[list[tuple[Row, Row]]]:
    """Pairs that share rows together, at most so many in a group."""
    left, groups = list(pairs), []
    while left:
        group, rows = [left.pop(0)], set()
        while left and len(group) < most:
            rows |= set(group[-1])
            best = max(left, key=lambda pair: len(rows & set(pair)))
            left.remove(best)
            group.append(best)
        groups.append(group)
    return groups
