"""Numerics of x' = f(x, p): equilibria, their bifurcations, curves of these; knows nothing of wind, water or cables."""
