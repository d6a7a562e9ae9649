"""A tape with more outputs: functions of the state beside the derivatives, sharing what both compute."""

from collections.abc import Sequence
from typing import Any

from rainwind.dynamics.kernels import opcodes as op
from rainwind.dynamics.tape import Symbol, Tape, _Recorder


def with_outputs(tape: Tape, more: Sequence[Tape]) -> Tape:
    """The outputs of a tape, then those of others.

    The others have the same parameters, and states that are the first ones of the tape.
    """
    r = _Recorder(len(tape.states) + len(tape.parameters))
    inputs = [Symbol(r, ("in", i)) for i in range(r.inputs)]
    outputs = replayed(r, tape, inputs)
    for one in more:
        own = [*inputs[: len(one.states)], *inputs[len(tape.states) :]]
        outputs += replayed(r, one, own)
    return r.finish(tape.states, tape.parameters, [r.key(value) for value in outputs])


def replayed(r: _Recorder, tape: Tape, inputs: Sequence[Any]) -> list[Any]:
    """Record all operations of a tape once more, from other inputs; its outputs."""
    value: dict[int, Any] = dict(enumerate(inputs))
    first = int(tape.operations[0, 1]) if len(tape.operations) else tape.template.size
    value |= {i: float(tape.template[i]) for i in range(len(inputs), first)}
    for code, z, a, b in tape.operations.tolist():
        if code in (op.ADD, op.SUB, op.MUL, op.DIV):
            value[z] = r.binary(code, value[a], value[b])
        elif code == op.NEG:
            value[z] = r.unary(code, value[a])
        else:
            keys = (r.key(value[a]), r.key(value[b])) if code in op.BINARY else (r.key(value[a]),)
            value[z] = r.record(code, *keys)
            if code >= op.FIRST_WITH_TWO:
                value[z + 1] = r.record(code, *keys, second=True)
    return [value[slot] for slot in tape.outputs.tolist()]
