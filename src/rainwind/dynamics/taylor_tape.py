"""A tape written anew so that its Taylor coefficients cost less, with the same meaning.

Of all operations, only products and their like of two things that move cost more than one multiplication for each
coefficient: a sum over all lower ones. So polynomials in Horner's form, one product for each degree, become
combinations of powers, which all polynomials of one argument share and of which every other is a square; constant
factors leave products; divisions by constants become products. Coefficients are the user's own, and nothing is
multiplied out: what comes out differs by rounding only.
"""

from collections import Counter
from collections.abc import Sequence
from typing import Any

import numpy as np

from rainwind.dynamics.kernels import opcodes as op
from rainwind.dynamics.tape import Symbol, Tape, _Recorder

HIGHEST_POWER = 32  # of polynomials that are written in powers


def moving_slots(tape: Tape, driven: Sequence[int] = ()) -> np.ndarray:
    """Marks the slots that vary with time: states, the inputs numbered in `driven`, and what depends on them."""
    moves = np.zeros(tape.template.size, dtype=np.bool_)
    moves[: len(tape.states)] = True
    moves[list(driven)] = True
    for code, z, a, b in tape.operations:
        if moves[a] or moves[b]:
            moves[z] = True
            moves[z + (code >= op.FIRST_WITH_TWO)] = True
    return moves


def for_taylor(tape: Tape, driven: Sequence[int] = ()) -> Tape:
    """The tape to make machine code from; inputs and outputs are the same, in the same order."""
    return _Rewriting(tape, moving_slots(tape, driven)).run()


class _Rewriting:
    """Each moving slot is a polynomial in one slot, its atom; most are their own."""

    def __init__(self, tape: Tape, moves: np.ndarray) -> None:
        self.tape, self.moves = tape, moves
        self.recorder = _Recorder(len(tape.states) + len(tape.parameters))
        self.row_of = {int(z): i for i, (_, z, _, _) in enumerate(tape.operations)}
        inputs = self.recorder.inputs
        self.new: dict[int, Any] = {i: Symbol(self.recorder, ("in", i)) for i in range(inputs)}
        first = int(tape.operations[0, 1]) if len(tape.operations) else tape.template.size
        self.new |= {i: float(tape.template[i]) for i in range(inputs, first)}
        # of each moving slot: its atom, and the polynomial's coefficients, which do not move
        self.form: dict[int, tuple[int, tuple[Any, ...]]] = {
            i: (i, (0.0, 1.0)) for i in range(inputs) if moves[i]
        }
        products = [
            row for row in tape.operations.tolist() if row[0] == op.MUL and moves[row[2]] and moves[row[3]]
        ]
        self.factors = Counter(slot for row in products for slot in row[2:])

    def run(self) -> Tape:
        for code, z, a, b in self.tape.operations.tolist():
            if not self.moves[z]:
                self._write(code, z, self.new[a], self.new[b])
            else:
                form = self._form(code, a, b)
                # a shifted argument such as x - a, of which powers are taken: to multiply it out would cost digits
                shifted = (
                    form is not None
                    and self.factors[z] > 1
                    and len(form[1]) == 2
                    and not _is_zero(form[1][0])
                )
                self.form[z] = (z, (0.0, 1.0)) if form is None or shifted else form
                if code >= op.FIRST_WITH_TWO:
                    self.form[z + 1] = z + 1, (0.0, 1.0)
        outputs = self.tape.outputs.tolist()
        for z in sorted(self._needed_atoms(outputs)):
            self._write_atom(z)
        keys = [self.recorder.key(self._value(slot)) for slot in outputs]
        return self.recorder.finish(self.tape.states, self.tape.parameters, keys)

    def _write(self, code: int, z: int, a: Any, b: Any) -> None:
        """Record one operation as it is."""
        r = self.recorder
        if code in (op.ADD, op.SUB, op.MUL, op.DIV):
            self.new[z] = r.binary(code, a, b)
        elif code == op.NEG:
            self.new[z] = r.unary(code, a)
        else:
            keys = (r.key(a), r.key(b)) if code in op.BINARY else (r.key(a),)
            self.new[z] = r.record(code, *keys)
            if code >= op.FIRST_WITH_TWO:
                self.new[z + 1] = r.record(code, *keys, second=True)

    def _form(self, code: int, a: int, b: int) -> tuple[int, tuple[Any, ...]] | None:
        """The result of an operation as a polynomial in an older atom, or None where it is an atom itself."""
        r = self.recorder
        one_moves = self.moves[a] != self.moves[b]
        if code == op.NEG:
            atom, c = self.form[a]
            return atom, tuple(r.unary(op.NEG, x) for x in c)
        if code in (op.ADD, op.SUB):
            left, right = self._polynomial(a), self._polynomial(b)
            if left[0] is not None and right[0] is not None and left[0] != right[0]:
                return None
            size = max(len(left[1]), len(right[1]))
            p, q = (side[1] + (0.0,) * (size - len(side[1])) for side in (left, right))
            atom = right[0] if left[0] is None else left[0]
            return int(atom or 0), tuple(r.binary(code, x, y) for x, y in zip(p, q, strict=True))
        if code == op.MUL and one_moves:
            factor, moving = (a, b) if self.moves[b] else (b, a)
            atom, c = self.form[moving]
            return atom, tuple(r.binary(op.MUL, self.new[factor], x) for x in c)
        if code == op.DIV and self.moves[a] and not self.moves[b]:
            atom, c = self.form[a]
            inverse = r.binary(op.DIV, 1.0, self.new[b])
            return atom, tuple(r.binary(op.MUL, inverse, x) for x in c)
        if code == op.MUL:
            for one, other in ((a, b), (b, a)):
                atom, c = self.form[other]
                scale = self._scale(one)
                if scale is not None and self.form[one][0] == atom and len(c) <= HIGHEST_POWER:
                    return atom, (0.0, *(r.binary(op.MUL, scale, x) for x in c))
        return None

    def _polynomial(self, slot: int) -> tuple[int | None, tuple[Any, ...]]:
        return self.form[slot] if self.moves[slot] else (None, (self.new[slot],))

    def _scale(self, slot: int) -> Any:
        """c where a slot is c times its atom, else None."""
        c = self.form[slot][1]
        return c[1] if _is_zero(c[0]) and len(c) == 2 else None

    def _factors(self, z: int) -> tuple[Any, list[int]]:
        """A product of two moving slots as a constant factor and two slots."""
        _, _, a, b = self.tape.operations[self.row_of[z]].tolist()
        factor: Any = 1.0
        slots = []
        for slot in (a, b):
            scale = self._scale(slot)
            if scale is None:
                # minus a polynomial is the polynomial, with the sign taken out
                row = self.tape.operations[self.row_of[slot]].tolist()
                if row[0] == op.NEG:
                    factor, slot = self.recorder.unary(op.NEG, factor), row[2]
            else:
                factor, slot = self.recorder.binary(op.MUL, factor, scale), self.form[slot][0]
            slots.append(slot)
        return factor, slots

    def _needed_atoms(self, slots: list[int]) -> set[int]:
        """The atoms that other than states are needed for some slots."""
        stack, needed = [self.form[slot][0] for slot in slots if self.moves[slot]], set()
        while stack:
            z = stack.pop()
            if z in self.new or z in needed:
                continue
            needed.add(z)
            if z not in self.row_of:  # the second slot of an operation comes with the first
                stack.append(z - 1)
                continue
            _, _, a, b = self.tape.operations[self.row_of[z]].tolist()
            arguments = self._factors(z)[1] if self._is_product(z) else (a, b)
            stack += [self.form[slot][0] for slot in arguments if self.moves[slot]]
        return needed

    def _is_product(self, z: int) -> bool:
        code, _, a, b = self.tape.operations[self.row_of[z]].tolist()
        return bool(code == op.MUL and self.moves[a] and self.moves[b])

    def _write_atom(self, z: int) -> None:
        if z in self.new:
            return
        code, _, a, b = self.tape.operations[self.row_of[z]].tolist()
        if self._is_product(z):
            factor, (x, y) = self._factors(z)
            product = self.recorder.binary(op.MUL, self._value(x), self._value(y))
            self.new[z] = self._scaled(factor, product)
        else:
            self._write(code, z, self._value(a), self._value(b))

    def _value(self, slot: int) -> Any:
        """A slot's polynomial, written out in powers of its atom."""
        if not self.moves[slot]:
            return self.new[slot]
        atom, c = self.form[slot]
        total: Any = c[0]
        for degree in range(1, len(c)):
            if not _is_zero(c[degree]):
                term = self._scaled(c[degree], self._power(self.new[atom], degree))
                total = self.recorder.binary(op.ADD, total, term)
        return total

    def _scaled(self, factor: Any, value: Any) -> Any:
        if isinstance(factor, float) and factor == -1.0:
            return self.recorder.unary(op.NEG, value)
        return self.recorder.binary(op.MUL, factor, value)

    def _power(self, value: Any, degree: int) -> Any:
        """Even powers as squares, odd ones as an even one times the atom."""
        if degree == 1:
            return value
        if degree % 2:
            return self.recorder.binary(op.MUL, self._power(value, degree - 1), value)
        half = self._power(value, degree // 2)
        return self.recorder.binary(op.MUL, half, half)


def _is_zero(value: Any) -> bool:
    return isinstance(value, float) and value == 0.0
