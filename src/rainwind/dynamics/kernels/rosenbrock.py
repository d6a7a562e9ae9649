"""Steps of the Rosenbrock method Rodas5P: order 5, L-stable, stiffly accurate, with the tape's exact Jacobian.

Source: Steinebach (2023), Construction of Rosenbrock-Wanner method Rodas5P and numerical benchmarks within the Julia
Differential Equations package, BIT Numer. Math. 63:27. The scheme is the one of Hairer & Wanner, Solving Ordinary
Differential Equations II, eq. (IV.7.25): each stage solves (I / (h gamma) - J) u_i = f(t + c_i h, x + sum a_ij u_j)
+ sum C_ij u_j / h + h d_i df/dt; the last stage is the estimate of the error.
"""

import numpy as np

from rainwind.dynamics.kernels.compiling import compiled, inlined
from rainwind.dynamics.kernels.tangents import first_order
from rainwind.dynamics.kernels.values import run

GAMMA = 0.21193756319429014
# stages 6, 7 and 8 share their first five weights; the solution adds u_6 + u_7 + u_8
_LAST = (
    -7.502846399306121,
    2.561846144803919,
    -11.627539656261098,
    -0.18268767659942256,
    0.030198172008377946,
)
A = np.array([
    [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
    [3.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
    [2.849394379747939, 0.45842242204463923, 0.0, 0.0, 0.0, 0.0, 0.0],
    [-6.954028509809101, 2.489845061869568, -10.358996098473584, 0.0, 0.0, 0.0, 0.0],
    [2.8029986275628964, 0.5072464736228206, -0.3988312541770524, -0.04721187230404641, 0.0, 0.0, 0.0],
    [*_LAST, 0.0, 0.0],
    [*_LAST, 1.0, 0.0],
    [*_LAST, 1.0, 1.0],
])  # fmt: skip
C = np.array([
    [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
    [-14.155112264123755, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
    [-17.97296035885952, -2.859693295451294, 0.0, 0.0, 0.0, 0.0, 0.0],
    [147.12150275711716, -1.41221402718213, 71.68940251302358, 0.0, 0.0, 0.0, 0.0],
    [165.43517024871676, -0.4592823456491126, 42.90938336958603, -5.961986721573306, 0.0, 0.0, 0.0],
    [24.854864614690072, -3.0009227002832186, 47.4931110020768, 5.5814197821558125, -0.6610691825249471, 0.0, 0.0],
    [30.91273214028599, -3.1208243349937974, 77.79954646070892, 34.28646028294783, -19.097331116725623,
     -28.087943162872662, 0.0],
    [37.80277123390563, -3.2571969029072276, 112.26918849496327, 66.9347231244047, -40.06618937091002,
     -54.66780262877968, -9.48861652309627],
])  # fmt: skip
NODES = np.array(
    [0.0, 0.6358126895828704, 0.4095798393397535, 0.9769306725060716, 0.4288403609558664, 1.0, 1.0, 1.0]
)
D = np.array([
    0.21193756319429014, -0.42387512638858027, -0.3384627126235924, 1.8046452872882734, 2.325825639765069, 0.0, 0.0,
    0.0,
])  # fmt: skip
# the polynomial of a step: x0 (1 - s) + s (x1 + (1 - s) (k_1 + s (k_2 + s k_3))), k_i = sum_j H_ij u_j, of order 4
H = np.array([
    [25.948786856663858, -2.5579724845846235, 10.433815404888879, -2.3679251022685204, 0.524948541321073,
     1.1241088310450404, 0.4272876194431874, -0.17202221070155493],
    [-9.91568850695171, -0.9689944594115154, 3.0438037242978453, -24.495224566215796, 20.176138334709044,
     15.98066361424651, -6.789040303419874, -6.710236069923372],
    [11.419903575922262, 2.8879645146136994, 72.92137995996029, 80.12511834622643, -52.072871366152654,
     -59.78993625266729, -0.15582684282751913, 4.883087185713722],
])  # fmt: skip
STAGES, WIDTH = 8, 5
# where in a step its polynomial is held against the equations: p' - f(p), which the matrix of the stages turns into an
# error of the state; in very stiff runs that is far above the error at the step's end
PROBES = (0.25, 0.75)

RUNNING, STEP_TOO_SMALL, TOO_LARGE = 0, 1, 2
LARGEST = 1e100
_EPS = 2.220446049250313e-16
_SAFETY, _SLOWEST, _FASTEST = 0.9, 0.2, 6.0
# by what a step is cut when something in it is not finite
_CUT = 0.25


@compiled
def _factor(matrix, pivots):
    """LU with row pivoting in place; False for a singular matrix or one that is not finite."""
    n = pivots.size
    for j in range(n):
        pivot = j
        for i in range(j + 1, n):
            if abs(matrix[i, j]) > abs(matrix[pivot, j]):
                pivot = i
        pivots[j] = pivot
        if matrix[pivot, j] == 0.0 or not np.isfinite(matrix[pivot, j]):
            return False
        if pivot != j:
            for c in range(n):
                matrix[j, c], matrix[pivot, c] = matrix[pivot, c], matrix[j, c]
        inverse = 1.0 / matrix[j, j]
        for i in range(j + 1, n):
            factor = matrix[i, j] * inverse
            matrix[i, j] = factor
            if factor != 0.0:
                for c in range(j + 1, n):
                    matrix[i, c] -= factor * matrix[j, c]
    return True


@compiled
def _substitute(matrix, pivots, right):
    """Solve with what `_factor` left; right (n,) becomes the solution."""
    n = pivots.size
    for j in range(n):
        pivot = pivots[j]
        if pivot != j:
            right[j], right[pivot] = right[pivot], right[j]
    for i in range(1, n):
        total = right[i]
        for j in range(i):
            total -= matrix[i, j] * right[j]
        right[i] = total
    for i in range(n - 1, -1, -1):
        total = right[i]
        for j in range(i + 1, n):
            total -= matrix[i, j] * right[j]
        right[i] = total / matrix[i, i]


@compiled
def _drive(slots, numbers, coefficients, s):
    """Fill in the driven parameters at s after the last knot."""
    for j in range(numbers.size):
        c = coefficients[j]
        slots[numbers[j]] = c[0] + s * (c[1] + s * (c[2] + s * c[3]))


@compiled
def _worst(errors, sizes, new, tolerance):
    """The largest error (n,) over what is allowed; infinite where one is no number."""
    largest, worst = 0.0, 0.0
    for i in range(new.size):
        largest = max(largest, sizes[i], abs(new[i]))
    for i in range(new.size):
        ratio = abs(errors[i]) / (tolerance * max(sizes[i], abs(new[i])) + 4.0 * _EPS * largest + 1e-300)
        if not np.isfinite(ratio):
            return np.inf
        worst = max(worst, ratio)
    return worst


@compiled
def _polynomial(u, state, new, piece):
    """The polynomials of a step in s = 0 ... 1: piece (n, 5), from its stages u (8, n) and its ends."""
    for i in range(state.size):
        k1, k2, k3 = 0.0, 0.0, 0.0
        for j in range(STAGES):
            k1 += H[0, j] * u[j, i]
            k2 += H[1, j] * u[j, i]
            k3 += H[2, j] * u[j, i]
        c = piece[i]
        c[0], c[1], c[2], c[3], c[4] = state[i], new[i] - state[i] + k1, k2 - k1, k3 - k2, -k3


@inlined
def _value(c, s):
    return c[0] + s * (c[1] + s * (c[2] + s * (c[3] + s * c[4])))


@inlined
def _slope(c, s):
    return c[1] + s * (2.0 * c[2] + s * (3.0 * c[3] + s * 4.0 * c[4]))


@compiled
def advance(
    operations,
    template,
    outputs,
    numbers,
    knots,
    drive,
    state,
    sizes,
    t,
    h,
    end,
    tolerance,
    times,
    coefficients,
):
    """Steps from t towards `end`, at most as many as `times` (B + 1,) and `coefficients` (B, n, 5) can hold.

    operations, template: a tape with everything filled in that neither states nor driven parameters enter. numbers
    (m,): the driven parameters among the inputs; knots (s + 1,), drive (s, m, 4): their polynomials; steps stop at
    knots. state (n,) and sizes (n,), the largest moduli so far, are moved on in place. h: the step to try first, or 0.
    Allowed at the end of a step and between its ends is an error of `tolerance` times the size of each state, and
    rounding of the largest one.
    Returns (steps taken, status, t, the next step to try, steps refused).
    """
    n, m = state.size, numbers.size
    slots = template.copy()
    tangents = np.zeros((template.size, n + m))
    active = np.zeros(template.size, dtype=np.bool_)
    for k in range(n):
        tangents[k, k] = 1.0
        active[k] = True
    for k in range(m):
        tangents[numbers[k], n + k] = 1.0
        active[numbers[k]] = True
    f = np.empty(n)
    f_t = np.zeros(n)
    jacobian = np.zeros((n, n))
    matrix = np.empty((n, n))
    pivots = np.empty(n, dtype=np.int64)
    u = np.empty((STAGES, n))
    new = np.empty(n)
    piece = np.empty((n, WIDTH))
    defect = np.empty(n)
    segment = 0
    while segment < knots.size - 2 and knots[segment + 1] <= t:
        segment += 1
    count, refused = 0, 0
    times[0] = t
    fresh = True  # whether f and J at the state are still to be computed
    while t < end and count < coefficients.shape[0]:
        while segment < knots.size - 2 and knots[segment + 1] <= t:
            segment += 1
            fresh = True
        start = t - knots[segment]
        if fresh:
            for i in range(n):
                slots[i] = state[i]
            _drive(slots, numbers, drive[segment], start)
            first_order(operations, slots, tangents, active)
            for i in range(n):
                z = outputs[i]
                f[i] = slots[z]
                f_t[i] = 0.0
                for k in range(n):
                    jacobian[i, k] = tangents[z, k] if active[z] else 0.0
                for k in range(m):
                    if active[z]:
                        c = drive[segment, k]
                        f_t[i] += tangents[z, n + k] * (c[1] + start * (2.0 * c[2] + start * 3.0 * c[3]))
            fresh = False
        if h <= 0.0:
            h = _first_step(f, f_t, jacobian, tolerance, end - t)
        stop = min(end, knots[segment + 1])
        last = t + 1.01 * h >= stop
        # what the clock can tell apart, so that pieces join however late a fast jump comes
        step = stop - t if last else (t + h) - t
        if not step > 4.0 * _EPS * abs(t) or step < 1e-300:
            return count, STEP_TOO_SMALL, t, h, refused
        for i in range(n):
            for k in range(n):
                matrix[i, k] = -jacobian[i, k]
            matrix[i, i] += 1.0 / (step * GAMMA)
        error = np.inf
        if _factor(matrix, pivots):
            for stage in range(STAGES):
                if stage > 0:
                    for i in range(n):
                        slots[i] = state[i]
                        for j in range(stage):
                            slots[i] += A[stage, j] * u[j, i]
                    _drive(slots, numbers, drive[segment], start + NODES[stage] * step)
                    run(operations, slots)
                for i in range(n):
                    total = 0.0
                    for j in range(stage):
                        total += C[stage, j] * u[j, i]
                    rate = slots[outputs[i]] if stage > 0 else f[i]
                    u[stage, i] = rate + total / step + step * D[stage] * f_t[i]
                if stage == STAGES - 1:
                    for i in range(n):
                        new[i] = slots[i]
                _substitute(matrix, pivots, u[stage])
            for i in range(n):
                new[i] += u[STAGES - 1, i]
            error = _worst(u[STAGES - 1], sizes, new, tolerance)
        if error <= 1.0:
            _polynomial(u, state, new, piece)
            for s in PROBES:
                for i in range(n):
                    slots[i] = _value(piece[i], s)
                _drive(slots, numbers, drive[segment], start + s * step)
                run(operations, slots)
                for i in range(n):
                    defect[i] = _slope(piece[i], s) / step - slots[outputs[i]]
                _substitute(matrix, pivots, defect)
                error = max(error, _worst(defect, sizes, new, tolerance))
        if not np.isfinite(error):
            h = _CUT * step
            refused += 1
            continue
        factor = min(_FASTEST, max(_SLOWEST, _SAFETY * max(error, 1e-10) ** -0.2))
        if error > 1.0:
            h = step * min(factor, 0.9)
            refused += 1
            continue
        for i in range(n):
            scale = 1.0
            for j in range(WIDTH):
                coefficients[count, i, j] = piece[i, j] * scale
                scale /= step
            state[i] = new[i]
            sizes[i] = max(sizes[i], abs(new[i]))
            if abs(new[i]) > LARGEST:
                return count, TOO_LARGE, t, h, refused
        # a step cut short by a knot says little about the next
        h = max(h, step * factor) if last else step * factor
        t = stop if last else t + step
        count += 1
        times[count] = t
        fresh = True
    return count, RUNNING, t, h, refused


@compiled
def _first_step(f, f_t, jacobian, tolerance, span):
    """A first step from f and x'' = J f + df/dt, which the control of the error then mends."""
    n = f.size
    rate, bend = 0.0, 0.0
    for i in range(n):
        second = f_t[i]
        for k in range(n):
            second += jacobian[i, k] * f[k]
        rate += f[i] * f[i]
        bend += second * second
    if not (np.isfinite(bend) and np.isfinite(rate)):
        return 1e-6 * span
    guess = 0.1 * tolerance**0.2 * np.sqrt(rate / bend) if bend > 0.0 else 0.01 * span
    return min(max(guess, 1e-9 * span), 0.1 * span) if rate > 0.0 else 0.01 * span
