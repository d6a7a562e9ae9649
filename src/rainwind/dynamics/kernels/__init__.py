"""Compiled by numba, once for an installation: values, derivatives and jets of a tape, and the walk along a curve."""
