"""The pseudo-arclength walk, compiled: many points of a branch or curve in one call.

A node is a point of the curve with all that detection needs: its tangent, its test values and its eigenvalues.
Borders are turned to the null vectors at every node, so that they never go stale.
"""

import numpy as np
from numba import njit

from rainwind.dynamics.kernels.equations import (
    EQUILIBRIUM,
    FOLD,
    HOPF,
    equations,
    hopf_weights,
    squared,
)
from rainwind.dynamics.kernels.forms import fold_coefficient, lyapunov_coefficient
from rainwind.dynamics.kernels.linear import solve_bordered, solve_many
from rainwind.dynamics.kernels.spectrum import eigenvalues

GOING_ON, LEFT_WINDOW, STEP_TOO_SMALL = 0, 1, 2
# a step is repeated at half its length when the tangent turns by more than 32 degrees, or when the correction is
# longer than half the step: either may be a jump to another branch
MOST_TURN = 0.85
MOST_CORRECTION = 0.5


@njit(cache=True, nogil=True, error_model="numpy")
def solve(kind, tape, inputs, free, left, below, weights, u, scale, tolerance, limit):
    """Newton on as many equations as unknowns. Returns converged, u, largest |F| there."""
    u = u.copy()
    right = np.empty((u.size, 1))
    for _ in range(limit):
        f, d, _ = equations(kind, tape, inputs, free, left, below, weights, u)
        right[:, 0] = -f
        solve_many(d * scale, right)
        u += right[:, 0] * scale
        size = 0.0
        for k in range(u.size):
            size = max(size, abs(right[k, 0]) / (1.0 + abs(u[k] / scale[k])))
        if not np.isfinite(size):
            break
        if size < tolerance:
            f, d, _ = equations(kind, tape, inputs, free, left, below, weights, u)
            return True, u, np.max(np.abs(f))
    return False, u, np.inf


@njit(cache=True, nogil=True, error_model="numpy")
def correct(kind, tape, inputs, free, left, below, weights, u, tangent, scale, tolerance, limit):
    """Newton in the hyperplane through u across `tangent`, then the tangent of the curve where it ends.

    u (N,) is the predicted point, tangent (N,) a unit vector in scaled unknowns u / scale. Returns iterations (0:
    not converged), u, tangent, sign of det [F_u; tangent], J (n, n). Tangent and J belong to the last iterate but
    one, which is within `tolerance` of u.
    """
    size_u = u.size
    target = np.sum(tangent * u / scale)
    u = u.copy()
    bordered = np.empty((size_u, size_u))
    # two right-hand sides in one elimination: the Newton step and the tangent
    right = np.zeros((size_u, 2))
    for iteration in range(limit):
        f, d, jacobian = equations(kind, tape, inputs, free, left, below, weights, u)
        bordered[:-1] = d * scale
        bordered[-1] = tangent
        right[:-1, 0] = -f
        right[-1, 0] = target - np.sum(tangent * u / scale)
        right[:-1, 1] = 0.0
        right[-1, 1] = 1.0
        sign = solve_many(bordered, right)
        size = 0.0
        for k in range(size_u):
            u[k] += right[k, 0] * scale[k]
            size = max(size, abs(right[k, 0]) / (1.0 + abs(u[k] / scale[k])))
        if not np.isfinite(size):
            break
        if size < tolerance:
            new = right[:, 1] / np.sqrt(np.sum(right[:, 1] ** 2))
            return iteration + 1, u, new, sign, jacobian
    return 0, u, tangent, 0.0, np.zeros((outputs_of(tape), outputs_of(tape)))


@njit(cache=True, nogil=True, error_model="numpy", inline="always")
def outputs_of(tape):
    return tape[2].size


@njit(cache=True, nogil=True, error_model="numpy")
def orthonormal(x):
    """The two columns of x (n, 2) made orthonormal."""
    q = x.copy()
    q[:, 0] /= np.sqrt(np.sum(q[:, 0] ** 2))
    q[:, 1] -= np.sum(q[:, 0] * q[:, 1]) * q[:, 0]
    q[:, 1] /= np.sqrt(np.sum(q[:, 1] ** 2))
    return q


@njit(cache=True, nogil=True, error_model="numpy")
def null_borders(kind, u, jacobian, left, below):
    """Borders turned to the null vectors at u, and the weights that go with them."""
    weights = np.zeros((2, 4))
    if kind == FOLD:
        v, _ = solve_bordered(jacobian, left, below, False)
        w, _ = solve_bordered(jacobian, left, below, True)
        return w / np.sqrt(np.sum(w * w)), v / np.sqrt(np.sum(v * v)), weights
    if kind == HOPF:
        matrix = squared(jacobian, u[-1])
        x, _ = solve_bordered(matrix, left, below, False)
        y, _ = solve_bordered(matrix, left, below, True)
        x, y = orthonormal(x), orthonormal(y)
        return y, x, hopf_weights(jacobian, x, y)
    return left, below, weights


@njit(cache=True, nogil=True, error_model="numpy")
def critical_vector(jacobian, omega, plane):
    """q (n,) complex of unit length with J q = i omega q, in the invariant plane (n, 2) with orthonormal columns."""
    m = np.ascontiguousarray(plane.T) @ (jacobian @ plane)
    s0, s1 = m[0, 1] + 0j, 1j * omega - m[0, 0]
    if abs(s0) + abs(s1) < abs(m[1, 0]) + abs(1j * omega - m[1, 1]):
        s0, s1 = 1j * omega - m[1, 1], m[1, 0] + 0j
    q = plane[:, 0] * s0 + plane[:, 1] * s1
    return q / np.sqrt(np.sum(q.real**2 + q.imag**2))


@njit(cache=True, nogil=True, error_model="numpy")
def test_values(kind, tape, inputs, free, u, tangent, sign, jacobian, left, below):
    """Two values whose signs reveal special points.

    Equilibria: the parameter's share of the tangent (fold), det [F_u; tangent] (branch point). Folds: the quadratic
    coefficient (cusp), w'v (Bogdanov-Takens). Hopf points: kappa (Bogdanov-Takens), l1 (generalised Hopf).
    """
    n = outputs_of(tape)
    values = np.zeros(2)
    if kind == EQUILIBRIUM:
        values[0], values[1] = tangent[n], sign
        return values
    at = inputs.copy()
    at[:n] = u[:n]
    for k in range(free.size):
        at[free[k]] = u[n + k]
    if kind == FOLD:
        values[0], values[1] = fold_coefficient(tape, at, below[:, 0].copy(), left[:, 0].copy())
    else:
        kappa = u[-1]
        values[0] = kappa
        if kappa > 0.0:
            omega = np.sqrt(kappa)
            q = critical_vector(jacobian, omega, below)
            values[1] = lyapunov_coefficient(tape, at, jacobian, omega, q)
    return values


@njit(cache=True, nogil=True, error_model="numpy")
def node(kind, tape, inputs, free, left, below, weights, u, tangent, scale, tolerance, limit):
    """Correct a predicted point and describe it.

    Returns iterations (0: failed), u, tangent, test values (2,), eigenvalues (n,), left, below, weights.
    """
    iterations, u, tangent, sign, jacobian = correct(
        kind, tape, inputs, free, left, below, weights, u, tangent, scale, tolerance, limit
    )
    if iterations == 0:
        return 0, u, tangent, np.zeros(2), np.zeros(outputs_of(tape), np.complex128), left, below, weights
    if kind != EQUILIBRIUM:
        left, below, weights = null_borders(kind, u, jacobian, left, below)
    values = test_values(kind, tape, inputs, free, u, tangent, sign, jacobian, left, below)
    return iterations, u, tangent, values, eigenvalues(jacobian), left, below, weights


@njit(cache=True, nogil=True, error_model="numpy")
def next_step(step, iterations, cosine, largest):
    """The next step's length after a good step: longer where Newton was quick and the curve straight."""
    if iterations <= 3 and cosine > 0.98:
        step *= 1.5
    elif iterations > 5 or cosine < 0.93:
        step *= 0.6
    return min(step, largest)


@njit(cache=True, nogil=True, error_model="numpy")
def march(
    kind, tape, inputs, free, left, below, weights, u, tangent, scale, lower, upper,
    step, largest, smallest, tolerance, limit, count,
):  # fmt: skip
    """Walk from the node (u, tangent) until a free parameter has left [lower, upper], or for `count` nodes.

    Returns status, number of nodes, and for each node: u, tangent, step, test values, eigenvalues, left, below,
    weights; last the next step's length.
    """
    n = outputs_of(tape)
    us = np.empty((count, u.size))
    tangents = np.empty((count, u.size))
    steps = np.empty(count)
    values = np.empty((count, 2))
    spectra = np.empty((count, n), np.complex128)
    lefts = np.empty((count, left.shape[0], left.shape[1]))
    belows = np.empty((count, below.shape[0], below.shape[1]))
    weightss = np.empty((count, 2, 4))
    status = GOING_ON
    done = 0
    while done < count:
        predicted = u + step * tangent * scale
        iterations, new, turned, tests, spectrum, new_left, new_below, new_weights = node(
            kind, tape, inputs, free, left, below, weights, predicted, tangent, scale, tolerance, limit
        )
        cosine = np.sum(turned * tangent)
        correction = np.sqrt(np.sum(((new - predicted) / scale) ** 2))
        if iterations == 0 or cosine < MOST_TURN or correction > MOST_CORRECTION * step:
            step *= 0.5
            if step < smallest:
                status = STEP_TOO_SMALL
                break
            continue
        u, tangent, left, below, weights = new, turned, new_left, new_below, new_weights
        us[done], tangents[done], steps[done], values[done], spectra[done] = u, tangent, step, tests, spectrum
        lefts[done], belows[done], weightss[done] = left, below, weights
        done += 1
        outside = False
        for k in range(free.size):
            outside = outside or u[n + k] < lower[k] or u[n + k] > upper[k]
        if outside:
            status = LEFT_WINDOW
            break
        step = next_step(step, iterations, cosine, largest)
    return status, done, us, tangents, steps, values, spectra, lefts, belows, weightss, step


@njit(cache=True, nogil=True, error_model="numpy")
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
                distance = abs(after[j] - before[i])
                if not taken_after[j] and distance < best:
                    best, ib, ia = distance, i, j
        taken_before[ib], taken_after[ia] = True, True
        order[ib] = after[ia]
    return order


@njit(cache=True, nogil=True, error_model="numpy")
def watched(kind, spectrum, kappa):
    """The eigenvalues whose crossing means something: all but those that a fold or Hopf curve holds on the axis."""
    n = spectrum.size
    drop = np.zeros(n, np.bool_)
    if kind == FOLD:
        drop[np.argmin(np.abs(spectrum))] = True
    elif kind == HOPF:
        for sign in (1.0, -1.0):
            target = np.sqrt(complex(-kappa)) * sign
            best, index = np.inf, -1
            for i in range(n):
                if not drop[i] and abs(spectrum[i] - target) < best:
                    best, index = abs(spectrum[i] - target), i
            drop[index] = True
    rest = np.empty(n - np.sum(drop), np.complex128)
    k = 0
    for i in range(n):
        if not drop[i]:
            rest[k] = spectrum[i]
            k += 1
    return rest


@njit(cache=True, nogil=True, error_model="numpy")
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


@njit(cache=True, nogil=True, error_model="numpy")
def screen(kind, us, arclength, tests, spectra, continuous):
    """Look at every interval of a walk: which ones need a closer look?

    Returns flags (N - 1,); watched eigenvalues (N, k), each in the order that follows its predecessor, their real
    parts' and the tests' travel per length in the interval that ends at each node (N, k + 2).
    continuous (2,): whether a test value is continuous, or only its sign means something.
    """
    count = arclength.size
    first = watched(kind, spectra[0], us[0, -1])
    k = first.size
    ordered = np.empty((count, k), np.complex128)
    ordered[0] = first
    values = np.empty((count, k + 2))
    speeds = np.zeros((count, k + 2))
    flags = np.zeros(max(count - 1, 0), np.bool_)
    values[0, :k], values[0, k:] = first.real, tests[0]
    for i in range(1, count):
        ordered[i] = matched(ordered[i - 1], watched(kind, spectra[i], us[i, -1]))
        values[i, :k], values[i, k:] = ordered[i].real, tests[i]
        length = arclength[i] - arclength[i - 1]
        for j in range(k + 2):
            speeds[i, j] = abs(values[i, j] - values[i - 1, j]) / max(length, 1e-300)
            if values[i, j] * values[i - 1, j] <= 0.0 and (j < k or values[i, j] != values[i - 1, j]):
                flags[i - 1] = True
        for j in range(2):
            if not continuous[j]:
                speeds[i, k + j] = 0.0
        if i == 1:
            speeds[0] = speeds[1]
        if not flags[i - 1]:
            before, after = values[i - 1].copy(), values[i].copy()
            for j in range(2):
                if not continuous[j]:
                    before[k + j] = after[k + j] = 0.0
            flags[i - 1] = unsettled(before, after, speeds[i - 1], length)
    return flags, ordered, speeds
