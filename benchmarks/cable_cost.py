"""Cost of an ANCF cable: CPU time of a step and memory over the number of elements, exudyn beside us in the same run.

Run: python benchmarks/cable_cost.py [--json out.json] [--elements 8 32] [--core 1]. The scenario cable_pendulum at
fixed steps of 1 ms from rest: `hht` against exudyn's generalized-alpha (spectral radius 0.9) with modified and full
Newton, and those of its linear solvers that are feasible; the best of them counts. Building and starting are left out
on both sides: a step costs the difference of a long and a short run, both the best of several. That both have done the
same work tells the distance of their tips at the end.
"""

import one_thread  # isort: skip  # noqa: F401

import argparse
import json
import math
import os
import resource
from collections.abc import Callable
from dataclasses import asdict, dataclass
from pathlib import Path
from time import process_time
from typing import Any

from exudyn_cable import CableRun, pendulum
from tlismni.core import Cable2D, Simulation
from tlismni.models import load

REPEATS = 3
STEP = 1e-3
TOLERANCE = 1e-6
"""Of our Newton iteration, on coordinates and velocities, as of exudyn's."""
LARGEST_DENSE = 40
"""Elements beyond which a dense factorisation is out of the question."""


@dataclass(frozen=True)
class Case:
    """Number of elements, steps of the long run."""

    elements: int
    steps: int


# later steps take fewer factorisations: the same window for those that are compared; at 4096 exudyn ends soon after it
CASES = (Case(8, 1000), Case(32, 160), Case(128, 160), Case(512, 160), Case(4096, 40))


@dataclass(frozen=True)
class Row:
    """One size: s a step, s to build and start, MB of our process, outer iterations and factorisations a step; exudyn's
    settings with their times, and how far its tip is from ours at the end, m."""

    elements: int
    ours: float
    build: float
    memory: float
    iterations: float
    factorizations: float
    exudyn: float
    exudyn_setting: str
    exudyn_iterations: float
    exudyn_all: dict[str, float]
    distance: float
    ratio: float


@dataclass(frozen=True)
class Timed:
    """Our run: s of the short and the whole run, s to build, place of the tip, iterations and factors a step."""

    short: float
    whole: float
    build: float
    tip: tuple[float, float]
    iterations: float
    factorizations: float


def short(case: Case) -> int:
    return max(1, case.steps // 4)


def ours(case: Case) -> Timed:
    start = process_time()
    model = load("cable_pendulum", elements=case.elements).model
    simulation = Simulation(model, "hht", step=STEP, record=False, newton_tolerance=TOLERANCE)
    built = process_time()
    simulation.run_to(STEP * short(case))
    middle = process_time()
    simulation.run_to(STEP * case.steps)
    end = process_time()
    names = [channel.name for channel in simulation.channels]
    x, y = (float(simulation.values()[names.index(name)]) for name in ("tip.x", "tip.y"))
    stats = simulation.stats
    per_step = (stats["outer_iterations"] / stats["steps"], stats["factorizations"] / stats["steps"])
    return Timed(middle - built, end - built, built - start, (x, y), *per_step)


def measure(case: Case, memory: float) -> Row:
    """All settings of one case, interleaved."""
    cable = load("cable_pendulum", elements=case.elements).model.bodies[0]
    if not isinstance(cable, Cable2D):
        raise TypeError(f"the first body of cable_pendulum is a {type(cable).__name__}, not the cable")
    settings: dict[str, Callable[[int], CableRun]] = {}
    for solver in ("EXUdense", "EigenDense", "EigenSparse") if case.elements <= LARGEST_DENSE else ("EigenSparse",):
        for modified in (True, False):
            name = f"{solver}, {'modified' if modified else 'full'} Newton"
            settings[name] = lambda n, a=solver, b=modified: pendulum(cable, STEP, n, a, b)
    mine: list[Timed] = []
    low: dict[str, list[CableRun]] = {name: [] for name in settings}
    high: dict[str, list[CableRun]] = {name: [] for name in settings}
    for _ in range(10 * REPEATS if case.elements < 100 else REPEATS if case.elements < 4000 else 1):
        mine.append(ours(case))
        for name, run in settings.items():
            low[name].append(run(short(case)))
            high[name].append(run(case.steps))
    counted = case.steps - short(case)
    cost = (min(r.whole for r in mine) - min(r.short for r in mine)) / counted
    others = {
        name: (min(r.seconds for r in high[name]) - min(r.seconds for r in low[name])) / counted for name in settings
    }
    best = min(others, key=others.__getitem__)
    last = high[best][-1]
    return Row(
        case.elements, cost, min(r.build for r in mine), memory, mine[-1].iterations, mine[-1].factorizations,
        others[best], best, last.iterations, others, math.dist(mine[-1].tip, last.tip), cost / others[best],
    )  # fmt: skip


def memory_after(case: Case) -> float:
    """MB that this process has needed at most, after a few of our steps."""
    ours(Case(case.elements, 4))
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--json", type=Path)
    parser.add_argument("--elements", type=int, nargs="*", default=[case.elements for case in CASES])
    parser.add_argument("--core", type=int)
    arguments = parser.parse_args()
    if arguments.core is not None:
        os.sched_setaffinity(0, {arguments.core})
    cases = [case for case in CASES if case.elements in arguments.elements]
    memory = {case.elements: memory_after(case) for case in cases}  # before exudyn's models stand in it too
    rows: list[Row] = []
    print(
        f"{'elements':>8} {'ours us':>9} {'(its, LU)':>11} {'exudyn us':>9} {'(its)':>6} {'ratio':>5} {'growth':>6} "
        f"{'build s':>7} {'MB':>5} {'tips m':>8}  best"
    )
    for case in cases:
        row = measure(case, memory[case.elements])
        growth = math.nan
        if rows:
            growth = math.log(row.ours / rows[-1].ours) / math.log(row.elements / rows[-1].elements)
        rows.append(row)
        print(
            f"{row.elements:8d} {row.ours * 1e6:9.1f} ({row.iterations:4.1f}, {row.factorizations:3.1f}) "
            f"{row.exudyn * 1e6:9.1f} ({row.exudyn_iterations:4.1f}) {row.ratio:5.2f} {growth:6.2f} {row.build:7.2f} "
            f"{row.memory:5.0f} {row.distance:8.1e}  {row.exudyn_setting}",
            flush=True,
        )
    if arguments.json:
        data: dict[str, Any] = {"step": STEP, "rows": [asdict(row) for row in rows]}
        arguments.json.write_text(json.dumps(data, indent=2) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
