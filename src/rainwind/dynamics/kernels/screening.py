"""A first look at all intervals of a walk at once: where may something have happened?"""

import numpy as np

from rainwind.dynamics.kernels.compiling import compiled
from rainwind.dynamics.kernels.equations import FOLD, HOPF
from rainwind.dynamics.kernels.spectrum import eigenvalues
from rainwind.dynamics.kernels.tangents import jacobians


@compiled
def spectra(tape, inputs, free, us):
    """Eigenvalues of J at N points: inputs (i,) but for states and free parameters, us (N, .) -> (N, n) complex."""
    operations, template, outputs = tape
    n = outputs.size
    at = np.empty((us.shape[0], inputs.size))
    for row in range(us.shape[0]):
        at[row] = inputs
        at[row, :n] = us[row, :n]
        for k in range(free.size):
            at[row, free[k]] = us[row, n + k]
    _, j = jacobians(operations, template, outputs, at, np.arange(n))
    found = np.empty((us.shape[0], n), np.complex128)
    for row in range(us.shape[0]):
        found[row] = eigenvalues(j[row])
    return found


@compiled
def watched(kind, spectrum, kappa):
    """The eigenvalues whose crossing means something: all but those that a fold or Hopf curve holds on the axis."""
    n = spectrum.size
    drop = np.zeros(n, np.bool_)
    many = n
    for sign in (1.0, -1.0):
        if kind == HOPF or (kind == FOLD and sign > 0.0):
            target = np.sqrt(complex(-kappa)) * sign if kind == HOPF else 0j
            best, index = np.inf, 0
            for i in range(n):
                if not drop[i] and abs(spectrum[i] - target) < best:
                    best, index = abs(spectrum[i] - target), i
            drop[index] = True
            many -= 1
    rest = np.empty(many, np.complex128)
    k = 0
    for i in range(n):
        if not drop[i]:
            rest[k] = spectrum[i]
            k += 1
    return rest


@compiled
def unstable_counts(kind, spectra, kappas):
    """How many watched eigenvalues lie right of the imaginary axis, at N points: spectra (N, n), kappas (N,)."""
    counts = np.zeros(kappas.size, np.int64)
    for i in range(kappas.size):
        for value in watched(kind, spectra[i], kappas[i]):
            counts[i] += value.real > 0.0
    return counts


@compiled
def matched(before, after):
    """The eigenvalues `after` in the order that follows `before`, nearest first."""
    n = before.size
    order = np.empty(n, np.complex128)
    taken_before = np.zeros(n, np.bool_)
    taken_after = np.zeros(n, np.bool_)
    for _ in range(n):
        best = np.inf
        ib, ia = 0, 0
        for i in range(n):
            if taken_before[i]:
                continue
            for j in range(n):
                if not taken_after[j]:
                    x, y = after[j].real - before[i].real, after[j].imag - before[i].imag
                    if x * x + y * y < best:
                        best, ib, ia = x * x + y * y, i, j
        taken_before[ib], taken_after[ia] = True, True
        order[ib] = after[ia]
    return order


@compiled
def unsettled(before, after, speed, length):
    """Whether a value of the same sign at both ends of an interval may have crossed zero and come back.

    before, after (k,): the values; speed (k,): their travel per length just before. Settled means that the way to
    zero and back is at least twice what they travel at that pace.
    """
    for k in range(before.size):
        travel = max(abs(after[k] - before[k]), speed[k] * length)
        if before[k] * after[k] > 0.0 and abs(before[k]) + abs(after[k]) < 2.0 * travel:
            return True
    return False


@compiled
def screen(kind, us, arclength, tests, spectra, continuous):
    """Look at every interval of a walk: which ones need a closer look?

    Returns flags (N - 1,); watched eigenvalues (N, k), each in the order that follows its predecessor, their real
    parts' and the tests' travel per length in the interval that ends at each node (N, k + 2).
    continuous (2,): whether a test value is continuous, or only its sign means something.
    """
    count = arclength.size
    last = us.shape[1] - 1
    first = watched(kind, spectra[0], us[0, last])
    k = first.size
    ordered = np.empty((count, k), np.complex128)
    values = np.empty((count, k + 2))
    speeds = np.zeros((count, k + 2))
    flags = np.zeros(max(count - 1, 0), np.bool_)
    for i in range(count):
        now = watched(kind, spectra[i], us[i, last])
        ordered[i] = matched(ordered[i - 1], now) if i > 0 else now
        for j in range(k):
            values[i, j] = ordered[i, j].real
        values[i, k], values[i, k + 1] = tests[i, 0], tests[i, 1]
        if i == 0:
            continue
        length = max(arclength[i] - arclength[i - 1], 1e-300)
        for j in range(k + 2):
            flags[i - 1] |= values[i, j] * values[i - 1, j] < 0.0 or (values[i, j] == 0.0) != (
                values[i - 1, j] == 0.0
            )
            if j < k or continuous[j - k]:
                speeds[i, j] = abs(values[i, j] - values[i - 1, j]) / length
        if i == 1:
            speeds[0] = speeds[1]
        flags[i - 1] |= unsettled(values[i - 1], values[i], speeds[i - 1], length)
    return flags, ordered, speeds
