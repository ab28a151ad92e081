"""The stage solver: TLISMNI's two loops. Every implicit formula is one or more stages of it."""

from dataclasses import dataclass
from typing import Any

from . import jfnk, simple
from .matrices import refactor
from .solver import solve_stage


@dataclass(frozen=True)
class OuterLoop:
    """An outer loop of the stage solver."""

    name: str
    description: str
    stage: Any
    """Function of STAGE_SIGNATURE."""
    most_iterations: float
    basis_rows: int = 1
    """Scratch vectors that it needs."""


OUTER_LOOPS = {
    loop.name: loop
    for loop in (
        OuterLoop("newton", "modified Newton with the exact sparse tangent; the default", solve_stage, 10.0),
        OuterLoop(
            "simple",
            "the fixed point of Shabana and Hussein, optionally accelerated; converges only for c_q omega^2 < 1",
            simple.solve_simple_stage,
            60.0,
            simple.BASIS_ROWS,
        ),
        OuterLoop(
            "jfnk",
            "inexact Newton with GMRES on difference quotients, preconditioned by old factors",
            jfnk.solve_jfnk_stage,
            12.0,
            jfnk.BASIS_ROWS,
        ),
    )
}

__all__ = ["OUTER_LOOPS", "OuterLoop", "refactor", "solve_stage"]
