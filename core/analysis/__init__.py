"""Analyses that look at a run as a whole: Lyapunov exponents, Floquet multipliers."""

from .floquet import FloquetResult, floquet_multipliers
from .lyapunov import LyapunovResult, lyapunov_exponents

__all__ = ["FloquetResult", "LyapunovResult", "floquet_multipliers", "lyapunov_exponents"]
