"""An independent cable: finite elements, a state with velocities, eigenvalues by ARPACK or LAPACK."""

import numpy as np
import scipy.linalg
from scipy.sparse import block_array, block_diag, csc_array, diags_array, eye_array
from scipy.sparse.linalg import LinearOperator, eigs, splu

Dampers = list[tuple[float, float, float | None]]


def string_eigenvalue(near: complex, elements: int, dampers: Dampers, sag: float = 0.0) -> complex:
    """The eigenvalue, over sqrt(T/m)/L, nearest to `near` of a string of linear elements.

    dampers: (place, c/sqrt(T m), k L/T or None), places at nodes; a support is one more displacement without mass.
    sag: Irvine's parameter; the added tension is one more unknown.
    """
    n, h = elements - 1, 1.0 / elements
    size = n + len(dampers) + 1
    chain = np.ones(n), np.ones(n - 1)
    edge = csc_array((size - n, size - n))
    k, m, c = (
        block_diag(
            [diags_array([off * chain[1], on * chain[0], off * chain[1]], offsets=[-1, 0, 1]), edge]
        ).tolil()
        for on, off in ((2 / h, -1 / h), (4 * h / 6, h / 6), (0.0, 0.0))
    )
    k[:n, -1], k[size - 1, :n], k[size - 1, size - 1] = sag * h, -h, 1.0
    for j, (place, eta, stiffness) in enumerate(dampers):
        i, support = round(place * elements) - 1, n + j
        assert abs((i + 1) * h - place) < 1e-12
        c[i, i] += eta
        k[support, support] = 1.0 if stiffness is None else stiffness
        if stiffness is not None:
            c[i, support] = c[support, i] = -eta
            c[support, support] = eta
    one, none = eye_array(size), csc_array((size, size))
    a = block_array([[none, one], [-k, -c]], format="csc")
    b = block_array([[one, none], [none, m]], format="csc")
    inverse = splu(csc_array(a - near * 1.001 * b))
    shape = (2 * size, 2 * size)
    operator = LinearOperator(shape, matvec=lambda x: inverse.solve(b @ x), dtype=complex)  # type: ignore[call-arg]
    nearest = eigs(operator, 3, v0=np.ones(2 * size), return_eigenvectors=False)
    found = near * 1.001 + 1 / nearest
    return complex(found[np.argmin(abs(found - near))])


def beam_eigenvalues(
    elements: int, epsilon: float, sag: float, dampers: list[tuple[float, float]], *, clamped: bool
) -> np.ndarray:
    """Eigenvalues, over sqrt(T/m)/L, with positive imaginary part, by size, of cubic (Hermite) elements.

    epsilon: EI/(T L²); sag: Irvine's parameter; dampers: (place, c/sqrt(T m)), rigid, at nodes.
    """
    h = 1.0 / elements
    bend = np.array([[12, 6*h, -12, 6*h], [6*h, 4*h*h, -6*h, 2*h*h], [-12, -6*h, 12, -6*h],
                     [6*h, 2*h*h, -6*h, 4*h*h]]) * epsilon / h**3  # fmt: skip
    pull = np.array([[36, 3*h, -36, 3*h], [3*h, 4*h*h, -3*h, -h*h], [-36, -3*h, 36, -3*h],
                     [3*h, -h*h, -3*h, 4*h*h]]) / (30 * h)  # fmt: skip
    mass = np.array([[156, 22*h, 54, -13*h], [22*h, 4*h*h, 13*h, -3*h*h], [54, 13*h, 156, -22*h],
                     [-13*h, -3*h*h, -22*h, 4*h*h]]) * h / 420  # fmt: skip
    area = np.array([h / 2, h * h / 12, h / 2, -h * h / 12])
    size = 2 * (elements + 1)
    k, m, c, load = np.zeros((size, size)), np.zeros((size, size)), np.zeros((size, size)), np.zeros(size)
    for e in range(elements):
        i = slice(2 * e, 2 * e + 4)
        k[i, i] += bend + pull
        m[i, i] += mass
        load[i] += area
    k += sag * np.outer(load, load)
    for place, eta in dampers:
        node = round(place * elements)
        assert abs(node * h - place) < 1e-12
        c[2 * node, 2 * node] += eta
    held = {0, size - 2} | ({1, size - 1} if clamped else set())
    free = [i for i in range(size) if i not in held]
    k, m, c = (x[np.ix_(free, free)] for x in (k, m, c))
    one, none = np.eye(len(free)), np.zeros((len(free), len(free)))
    mass_inverse = np.linalg.inv(m)
    found = scipy.linalg.eigvals(np.block([[none, one], [-mass_inverse @ k, -mass_inverse @ c]]))
    found = found[found.imag > 0.1]
    return found[np.argsort(abs(found))]
