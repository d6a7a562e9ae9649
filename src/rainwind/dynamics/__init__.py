"""Numerics of x' = f(x, p): equilibria, their bifurcations and curves of these; knows nothing of wind, water or cables."""
