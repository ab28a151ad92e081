"""CPU time at an error of 1e-3 and 1e-6: `method="auto"` and the default beside the best of our methods.

Run: python benchmarks/method_choice.py [--problems chain10 cable32 space_cable8 pendulum_stop] [--limit 4]. A problem
is a scenario of the catalogue, or chain, space_chain, cable or space_cable with a number of links or elements. The
error is the largest difference from `irk` at 1e-10 (cables 1e-8) at 20 times, over half the range of the lengths or
angles. Each method runs over tolerances; its time at an error lies between two runs on a line in log-log scale.
"""

import one_thread  # isort: skip  # noqa: F401

import argparse
import math
import re
from collections.abc import Iterator
from time import process_time
from typing import Any

import numpy as np
from space_chain_speed import spatial_chain
from tlismni.core import Cable3D, Marker3D, MaterialPoint3D, Model, OfScales, Simulation, Spherical3D
from tlismni.models import load, names
from tlismni.validation.study.matrix.problems import problem_of

GOALS = (1e-3, 1e-6)
TOLERANCES = (1e-1, 3e-2, *(10.0 ** (-k) for k in range(2, 10)))
METHODS: dict[str, tuple[str, dict[str, Any]]] = {
    "auto": ("auto", {}),
    "ebdf": ("ebdf", {}),
    "ebdf 3": ("ebdf", {"k": 3}),
    "mebdf auto": ("mebdf", {"k": "auto"}),
    "bdf auto": ("bdf", {"order": "auto"}),
    "adams 4": ("adams", {"order": 4}),
    "adams 6": ("adams", {"order": 6}),
    "adams 8": ("adams", {"order": 8}),
    "radau3": ("irk", {}),
    "gauss3": ("irk", {"tableau": "gauss3"}),
    "sdirk4": ("irk", {"tableau": "sdirk4"}),
    "trapezoidal": ("trapezoidal", {}),
    "hht": ("hht", {}),
}
DEFAULT = ("chain1", "chain10", "chain100", "space_chain1", "space_chain10", "cable8", "cable32", "space_cable8")
Array = np.ndarray[Any, Any]


class TooLong(Exception):
    """A run took longer than it may."""


def space_cable(elements: int) -> Model:
    """The rope of the scenario cable_pendulum in space."""
    area, moment, modulus = math.pi * 0.01**2, 0.25 * math.pi * 0.01**4, 1e7
    cable = Cable3D(
        name="cable", elements=elements, length=1.0, mass_per_length=1100.0 * area, axial_stiffness=modulus * area,
        bending_stiffness=modulus * moment,
    )  # fmt: skip
    root = MaterialPoint3D(name="root", body="cable", s=0.0)
    pin = Spherical3D(name="pin", a=Marker3D(), b=Marker3D(body="root"))
    return Model(gravity=(0.3, 0.5, -9.81), bodies=[cable, root], joints=[pin])


def problem(name: str) -> tuple[Model, float]:
    """Model and end, s."""
    found = re.fullmatch(r"(chain|space_chain|cable|space_cable)(\d+)", name)
    if found is None:
        scenario = problem_of(name).load()
        return scenario.model, problem_of(name).t_end or scenario.t_end
    kind, size = found[1], int(found[2])
    if kind == "chain":
        return load("chain", links=size).model, 2.0 if size < 100 else 0.5
    if kind == "space_chain":
        return spatial_chain(size), 2.0 if size < 100 else 0.5
    end = 0.1 if size <= 32 else 0.02
    return (load("cable_pendulum", elements=size).model if kind == "cable" else space_cable(size)), end


def run(model: Model, t_end: float, method: str, rtol: float, limit: float, **options: Any) -> tuple[float, Array, Any]:
    """CPU time, s, coordinates (20, n), and the simulation."""
    sim = Simulation(model, method, rtol, OfScales(0.01 * rtol), record=False, **options)
    rows, began = [], process_time()

    def in_time(t: float) -> None:
        if process_time() - began > limit:
            raise TooLong

    sim.progress = in_time
    for t in np.linspace(0.0, t_end, 21)[1:]:
        sim.run_to(t_end, until=float(t))
        rows.append(sim.sample()[sim.table.layout.q].copy())
    return process_time() - began, np.array(rows), sim


def at_error(runs: list[tuple[float, float]], goal: float) -> float:
    """Least CPU time, s, of (error, time) from rough to fine; infinite where none is good enough."""
    best = math.inf
    for before, (error, seconds) in zip([None, *runs], runs, strict=False):
        if error > goal:
            continue
        if before is not None and before[0] > goal and 0.0 < error < before[0] and before[1] < seconds:
            part = math.log(before[0] / goal) / math.log(before[0] / error)
            seconds = before[1] * (seconds / before[1]) ** part
        best = min(best, seconds)
    return best


def runs_of(
    model: Model, t_end: float, exact: Array, scale: Array, name: str, limit: float
) -> Iterator[tuple[float, float]]:
    """Errors and times of a method from rough to fine."""
    method, options = METHODS[name]
    for rtol in TOLERANCES:
        try:
            seconds, q, _ = run(model, t_end, method, rtol, limit, **options)
            seconds = min(seconds, run(model, t_end, method, rtol, limit, **options)[0])
        except TooLong:
            return
        error = float(np.max(np.abs(q - exact) / scale))
        yield error, seconds
        if error < 0.2 * min(GOALS):
            return


def measure(name: str, limit: float) -> None:
    """Two lines."""
    model, t_end = problem(name)
    _, exact, sim = run(model, t_end, "irk", 1e-8 if "cable" in name else 1e-10, 100.0 * limit)
    angle = np.asarray(sim.assembly.is_angle, dtype=bool)[: exact.shape[1]]
    scale, half = np.ones(len(angle)), 0.5 * np.ptp(exact, axis=0)
    for kind in (True, False):
        if np.any(angle == kind):
            scale[angle == kind] = max(float(half[angle == kind].max()), 1e-12)
    found = {method: list(runs_of(model, t_end, exact, scale, method, limit)) for method in METHODS}
    for goal in GOALS:
        times = {method: at_error(runs, goal) for method, runs in found.items()}
        best = min((method for method in times if method != "auto"), key=times.__getitem__)
        beside = ", ".join(f"{method} {times[method] / times[best]:.2f}" for method in ("auto", "ebdf"))
        print(f"{name:26} {goal:.0e}: {best} {1e3 * times[best]:.2f} ms; {beside}", flush=True)


def main() -> None:
    """The command."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--problems", nargs="*", default=[*DEFAULT, *names()])
    parser.add_argument("--limit", type=float, default=2.0, help="s of CPU time of a run")
    options = parser.parse_args()
    for name in options.problems:
        measure(name, options.limit)


if __name__ == "__main__":
    main()
