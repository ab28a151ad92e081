"""Sweeps: one model at many points of its parameters, on threads or a cluster, kept in a folder, as one table."""

from .problem import ModelProblem, Outcomes, Problem
from .sampling import grid, sampled
from .sweep import Sweep, load_sweep, sweep

__all__ = ["ModelProblem", "Outcomes", "Problem", "Sweep", "grid", "load_sweep", "sampled", "sweep"]
