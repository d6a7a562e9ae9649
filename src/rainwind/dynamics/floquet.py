import numpy as np


def log_multipliers_of(g, f):
    many, n, _ = g.shape
    q = []
    for j in range(many + 1):
        v = f[j] / np.linalg.norm(f[j])
        Q, _ = np.linalg.qr(np.column_stack([v, np.eye(n)]))
        if Q[:, 0] @ v < 0:
            Q[:, 0] *= -1
        q.append(Q)
    q[-1] = q[0]
    M = np.eye(n - 1)
    for j in range(many):
        M = (q[j + 1].T @ g[j] @ q[j])[1:, 1:] @ M
    F = np.eye(n)
    for j in range(many):
        F = g[j] @ F
    mu = np.linalg.eigvals(F)
    tr = mu[np.argmin(abs(mu - 1))]
    e = np.log(np.linalg.eigvals(M).astype(complex))
    return e[np.argsort(-e.real)], complex(np.log(tr + 0j))
