"""exudyn's side of the benchmarks: a model with a choice of settings, timed without recording, in CPU time."""

import math
from dataclasses import dataclass
from time import process_time

import numpy as np
from numpy.typing import NDArray
from tlismni.core import Model
from tlismni.models import load
from tlismni.validation.exudyn_model import build_exudyn_model
from tlismni.validation.exudyn_run import ExudynSettings, solve

SOLVERS = ("EXUdense", "EigenDense", "EigenSparse")
LARGEST_DENSE = 20
"""Links beyond which a dense factorisation is out of the question (23 ms a step at 100 links)."""


@dataclass(frozen=True)
class Setting:
    """One way to run exudyn."""

    name: str
    settings: ExudynSettings


def settings_for(links: int, *integrators: str, rtol: float = 1e-8, atol: float = 1e-10) -> list[Setting]:
    """The settings worth trying: linear solvers that are feasible, modified and full Newton."""
    found = []
    for integrator in integrators or ("generalized_alpha",):
        for solver in SOLVERS if links <= LARGEST_DENSE else ("EigenSparse",):
            for modified in (True, False):
                settings = ExudynSettings(
                    integrator=integrator,  # type: ignore[arg-type]
                    modified_newton=modified,
                    linear_solver=solver,
                    relative_tolerance=rtol,
                    absolute_tolerance=atol,
                )
                newton = "modified" if modified else "full"
                found.append(Setting(f"{integrator}, {solver}, {newton} Newton", settings))
    return found


def run_model(model: Model, t_end: float, step: float, settings: ExudynSettings) -> tuple[float, NDArray[np.float64]]:
    """(CPU time of exudyn's solver in s, coordinates of all bodies at the end)."""
    build = build_exudyn_model(model, sensors=False)
    began = process_time()
    solve(build, t_end, step, settings)
    seconds = process_time() - began
    # exudyn's coordinates are displacements from the start
    start = np.concatenate([body.initial_state()[0] for body in model.bodies])
    return seconds, start + np.array(build.mbs.systemData.GetODE2Coordinates())


def run(links: int, t_end: float, step: float, settings: ExudynSettings) -> tuple[float, tuple[float, float]]:
    """(CPU time of exudyn's solver in s, position of the free end of the chain in m)."""
    seconds, q = run_model(load("chain", links=links).model, t_end, step, settings)
    x, y, angle = (float(value) for value in q[-3:])
    return seconds, (x + 0.5 * math.cos(angle), y + 0.5 * math.sin(angle))
