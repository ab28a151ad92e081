"""Cost of an elastic rod against a wall: time of a step and memory over the number of coordinates, exudyn beside us.

Run: python benchmarks/rod_cost.py [--json out.json] [--sizes 101 1001] [--core 1]. Steps in which a wave passes 0.2 of
an element, all of them while the rod is in contact. exudyn's models: one GenericODE2 object with sparse matrices, and a
chain of masses and springs (Mass1D), with modified Newton, up to 500 coordinates with full Newton too (which is slower
from 101 on), contact by penalty (half of an element's stiffness); the best of them counts. Building and starting are
left out: a step costs the difference of a long and a short run, in CPU time of one thread. exudyn's GenericODE2 builds
a dense Jacobian (n^2) and is left out beyond 1001 coordinates.
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

from exudyn_rod import RodRun, chain, generic
from tlismni.core import Simulation
from tlismni.models import load

REPEATS = 3
COURANT = 0.2
GAP = 1e-3
"""Of an element's length: first touch comes at once."""


@dataclass(frozen=True)
class Case:
    """Coordinates, and steps of the long run (ours, exudyn's)."""

    size: int
    steps: int
    exudyn_steps: int


CASES = (Case(101, 900, 900), Case(1001, 2000, 1200), Case(10_001, 400, 60), Case(100_001, 60, 16))


@dataclass(frozen=True)
class Row:
    """One size: s a step, s to build, MB of the process so far; exudyn's settings with their times."""

    size: int
    ours: float
    build: float
    memory: float
    exudyn: float
    exudyn_setting: str
    exudyn_all: dict[str, float]

    @property
    def ratio(self) -> float:
        return self.ours / self.exudyn


def ours(case: Case) -> tuple[float, float]:
    """(s a step, s to build and start)."""
    elements = case.size - 1
    start = process_time()
    s = load("rod_wall", elements=elements, gap=GAP / elements)
    h = COURANT / elements / s.model.bodies[0].wave_speed
    simulation = Simulation(s.model, s.method, **{**s.options, "step": h})
    built = process_time() - start
    t = GAP / elements / 0.1 + 30 * h
    simulation.run_to(t)
    times = []
    for k in range(4):
        start, before = process_time(), simulation.stats["steps"]
        simulation.run_to(t + (k + 1) * case.steps // 4 * h)
        times.append((process_time() - start) / (simulation.stats["steps"] - before))
    assert_contact(simulation.values()[[c.name for c in simulation.channels].index("wall.in_contact")])
    return min(times), built


def assert_contact(value: float) -> None:
    if value != 1.0:
        raise SystemExit("the rod is not in contact at the end of the timed steps: the case has too many of them")


def exudyn_settings(size: int) -> dict[str, Callable[[int], RodRun]]:
    """What is tried in exudyn, each a function of the number of steps."""
    found: dict[str, Callable[[int], RodRun]] = {}
    solvers = ("EXUdense", "EigenDense", "EigenSparse") if size < 500 else ("EigenSparse",)
    for solver in solvers:
        for modified in (True, False):
            newton = "modified" if modified else "full"
            if size <= 1001:
                found[f"GenericODE2, {solver}, {newton}"] = lambda n, a=solver, b=modified: generic(size - 1, n, a, b)
            found[f"Mass1D, {solver}, {newton}"] = lambda n, a=solver, b=modified: chain(size - 1, n, a, b)
    if size > 1001:
        # full Newton is three times slower and up here takes minutes
        found = {name: run for name, run in found.items() if name.endswith("modified")}
    return found


def exudyn(case: Case) -> dict[str, float]:
    """s a step of each setting."""
    found = {}
    for name, run in exudyn_settings(case.size).items():
        short = max(2, case.exudyn_steps // 4)
        best = math.inf
        repeats = REPEATS if case.size < 10_000 else 1
        if "full" in name and case.size > 500:
            continue
        low = min(run(short).seconds for _ in range(repeats))
        high = min(run(case.exudyn_steps).seconds for _ in range(repeats))
        best = min(best, (high - low) / (case.exudyn_steps - short))
        found[name] = best
    return found


def measure(case: Case) -> Row:
    timed = [ours(case) for _ in range(REPEATS)]
    # what we need, before exudyn's models stand in the memory too
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0
    others = exudyn(case)
    name = min(others, key=others.__getitem__)
    return Row(case.size, min(t for t, _ in timed), min(b for _, b in timed), memory, others[name], name, others)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--json", type=Path)
    parser.add_argument("--sizes", type=int, nargs="*", default=[case.size for case in CASES])
    parser.add_argument("--core", type=int)
    arguments = parser.parse_args()
    if arguments.core is not None:
        os.sched_setaffinity(0, {arguments.core})
    ours(Case(101, 400, 0))
    rows: list[Row] = []
    print(f"{'size':>7} {'ours us':>10} {'exudyn us':>10} {'ratio':>6} {'growth':>6} {'build s':>8} {'MB':>6}  best")
    for case in (c for c in CASES if c.size in arguments.sizes):
        row = measure(case)
        growth = math.nan
        if rows:
            growth = math.log(row.ours / rows[-1].ours) / math.log(row.size / rows[-1].size)
        rows.append(row)
        print(
            f"{row.size:7d} {row.ours * 1e6:10.1f} {row.exudyn * 1e6:10.1f} {row.ratio:6.2f} {growth:6.2f} "
            f"{row.build:8.2f} {row.memory:6.0f}  {row.exudyn_setting}",
            flush=True,
        )
    if arguments.json:
        data: dict[str, Any] = {"rows": [{**asdict(row), "ratio": row.ratio} for row in rows]}
        arguments.json.write_text(json.dumps(data, indent=2) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
