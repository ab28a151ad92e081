"""Names of the schemes of the methods that integrate all coordinates as an ODE."""

EXPLICIT_SCHEMES = ("rk23", "rk45", "dop853")
"""Formulas of `scipy.integrate`, in the order of the tables in `explicit.py`."""
IMPLICIT_SCHEMES = ("sdirk4", "trapezoidal")
