"""The stage solver: TLISMNI's two loops. Every implicit formula is one or more stages of it."""

from .solver import refactor, solve_stage

__all__ = ["refactor", "solve_stage"]
