"""A first look at all intervals of a walk at once: where may something have happened?"""

import numpy as np

from rainwind.dynamics.kernels.compiling import compiled
from rainwind.dynamics.kernels.equations import FOLD, HOPF
from rainwind.dynamics.kernels.spectrum import eigenvalues
from rainwind.dynamics.kernels.tangents import jacobians

HASTE = 3.0
STEADY = 4.0  # the fastest rate over the slowest
ROUNDING = 1e-14  # of a real part, as a share of the largest eigenvalue


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
def signed(before, after, eigenvalues):
    """Watched eigenvalues (k,) whose real parts keep the sign they had before while they are mere rounding."""
    largest = 0.0
    for value in eigenvalues:
        largest = max(largest, abs(value))
    found = after.copy()
    for k in range(after.size):
        if abs(after[k].real) <= ROUNDING * largest:
            found[k] = complex(1e-300 if before[k].real > 0.0 else -1e-300, after[k].imag)
    return found


@compiled
def hasty(before, after, pace, length, continuous):
    """Whether a value (k,) of one sign at both ends of an interval may have crossed zero and come back.

    It has not when the way to zero and back is longer than what the values travel at HASTE times their pace.
    continuous (2,): whether the last two, the test values, are continuous; of the others only the sign counts.
    """
    for k in range(before.size):
        if k >= before.size - 2 and not continuous[k - before.size + 2]:
            continue
        if _may_return(before[k], after[k], pace[k] * length):
            return True
    return False


@compiled
def _may_return(before, after, pace):
    travel = max(abs(after - before), pace)
    return before * after > 0.0 and abs(before) + abs(after) < HASTE * travel


@compiled
def hasty_intervals(values, pace, arclength, continuous):
    """`hasty` for all intervals of values (N, k) at arclengths (N,), with the pace (N - 1, k) about each.

    A value that runs steadily one way through an interval and both its neighbours has not come back.
    """
    count, many = values.shape
    flags = np.zeros(count - 1, np.bool_)
    for i in range(count - 1):
        length = arclength[i + 1] - arclength[i]
        for k in range(many):
            if k >= many - 2 and not continuous[k - many + 2]:
                continue
            if _may_return(values[i, k], values[i + 1, k], pace[i, k] * length):
                flags[i] |= not (0 < i < count - 2 and _steady(values[:, k], arclength, i))
    return flags


@compiled
def _steady(value, arclength, i):
    """Whether a value changes in one direction, and about as fast, in the interval i and both its neighbours."""
    slowest, fastest = np.inf, 0.0
    forward = value[i + 1] > value[i]
    for j in range(i - 1, i + 2):
        change = value[j + 1] - value[j] if forward else value[j] - value[j + 1]
        rate = change / (arclength[j + 1] - arclength[j])
        slowest, fastest = min(slowest, rate), max(fastest, rate)
    return slowest > fastest / STEADY


@compiled
def screen(kind, us, arclength, tests, spectra, continuous):
    """Put the eigenvalues of a walk in order and look where a value changes its sign.

    Returns flags (N - 1,), whether a watched value's sign differs at both ends of an interval; watched eigenvalues
    (N, k), each in the order that follows its predecessor; their real parts' and the tests' travel per length in
    the interval that ends at each node (N, k + 2).
    """
    count = arclength.size
    last = us.shape[1] - 1
    first = watched(kind, spectra[0], us[0, last])
    k = first.size
    ordered = np.empty((count, k), np.complex128)
    ordered[0] = first
    speeds = np.zeros((count, k + 2))
    flags = np.zeros(max(count - 1, 0), np.bool_)
    for i in range(1, count):
        now = matched(ordered[i - 1], watched(kind, spectra[i], us[i, last]))
        ordered[i] = signed(ordered[i - 1], now, spectra[i])
        length = max(arclength[i] - arclength[i - 1], 1e-300)
        for j in range(k + 2):
            before = ordered[i - 1, j].real if j < k else tests[i - 1, j - k]
            after = ordered[i, j].real if j < k else tests[i, j - k]
            # zero counts as negative, so that a node right on an event hides nothing
            flags[i - 1] |= (after > 0.0) != (before > 0.0)
            if j < k or continuous[j - k]:
                speeds[i, j] = abs(after - before) / length
    if count > 1:
        speeds[0] = speeds[1]
    return flags, ordered, speeds
