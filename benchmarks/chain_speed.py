"""Time of one step of the N-link chain: ours beside exudyn's, one run, one core, interleaved, CPU time.

Run: python benchmarks/chain_speed.py [--json out.json] [--links 1 10] [--fast] [--core 1]. Fixed-step `hht` against
exudyn's generalized-alpha (spectral radius 0.9) in its fastest setting. Building and starting are left out on
both sides: a step costs the difference of a long and a short run. Both must have done the same work: the error of
the free end at the end, against minimal coordinates, stands beside the times.
"""

import argparse
import json
import math
import os
import platform
from collections.abc import Callable
from dataclasses import asdict, dataclass
from pathlib import Path
from time import process_time
from typing import Any

from reference import chain_reference
from tlismni.core import Simulation
from tlismni.models import load


@dataclass(frozen=True)
class Case:
    """What is run: number of links, step in s, number of steps of the long run, target for ours / exudyn's."""

    links: int
    step: float
    steps: int
    target: float


CASES = (
    Case(1, 1e-4, 40_000, 1.0),
    Case(10, 5e-4, 4_000, 0.5),
    Case(100, 5e-4, 1_000, 0.5),
    Case(1000, 1e-4, 120, 0.5),
)
REPEATS = 3
METHOD = "hht"


@dataclass(frozen=True)
class Timed:
    """Seconds of the short and the long run; position of the free end after the long one, m; what else is known."""

    short: float
    long: float
    tip: tuple[float, float]
    iterations: float = math.nan
    """Outer iterations a step."""


@dataclass(frozen=True)
class Row:
    """Result of a case; times of one step in s, errors of the free end in m."""

    links: int
    step: float
    steps: int
    ours: float
    our_error: float
    our_iterations: float
    exudyn: float
    exudyn_error: float
    exudyn_setting: str
    exudyn_all: dict[str, float]
    ratio: float
    target: float


def ours(case: Case) -> Timed:
    """Our run: one simulation, timed over its first quarter and over the whole."""
    model = load("chain", links=case.links).model
    simulation = Simulation(model, METHOD, step=case.step, record=False)
    start = process_time()
    simulation.run_to(case.step * short(case))
    middle = process_time()
    simulation.run_to(case.step * case.steps)
    end = process_time()
    q = simulation.sample()[simulation.table.layout.q]
    x, y, angle = (float(value) for value in q[-3:])
    stats = simulation.stats
    tip = (x + 0.5 * math.cos(angle), y + 0.5 * math.sin(angle))
    return Timed(middle - start, end - start, tip, stats["outer_iterations"] / stats["steps"])


def theirs(case: Case, settings: Any) -> Timed:
    """exudyn's run: a short and a long one, each built anew."""
    from exudyn_chain import run

    quick, _ = run(case.links, short(case) * case.step, case.step, settings)
    whole, tip = run(case.links, case.steps * case.step, case.step, settings)
    return Timed(quick, whole, tip)


def short(case: Case) -> int:
    return max(1, case.steps // 4)


def run_case(case: Case) -> Row:
    """All settings of one case, interleaved, best of REPEATS."""
    from exudyn_chain import settings_for

    sides: dict[str, Callable[[], Timed]] = {"ours": lambda: ours(case)}
    for s in settings_for(case.links):
        sides[s.name] = lambda s=s: theirs(case, s.settings)  # type: ignore[misc]
    ours(Case(case.links, case.step, 4, 0.0))  # compiled code is loaded once, outside the timing
    runs: dict[str, list[Timed]] = {name: [] for name in sides}
    for _ in range(REPEATS):
        for name, timed in sides.items():
            runs[name].append(timed())
    # the best short and the best long run: the noise of a shared machine only ever adds
    counted = case.steps - short(case)
    cost = {name: (min(r.long for r in rs) - min(r.short for r in rs)) / counted for name, rs in runs.items()}
    exudyn = {name: value for name, value in cost.items() if name != "ours"}
    best = min(exudyn, key=lambda name: exudyn[name])
    exact = chain_reference(case.links, [0.0, case.step * case.steps], rtol=1e-12, atol=1e-12).tip[:, -1]
    error = {name: math.dist(runs[name][-1].tip, exact) for name in ("ours", best)}
    return Row(
        case.links, case.step, case.steps, cost["ours"], error["ours"], runs["ours"][-1].iterations, exudyn[best],
        error[best], best, exudyn, cost["ours"] / exudyn[best], case.target,
    )  # fmt: skip


def pin_to_one_core(wanted: int | None = None) -> int | None:
    """Keep this process on one core; returns its number, or None where the system cannot."""
    if not hasattr(os, "sched_setaffinity"):
        return None
    core = min(os.sched_getaffinity(0)) if wanted is None else wanted
    os.sched_setaffinity(0, {core})
    return core


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--json", type=Path, help="write the results there")
    parser.add_argument("--links", type=int, nargs="*", help="only these numbers of links")
    parser.add_argument("--fast", action="store_true", help="exudyn's module without range checks (AVX2)")
    parser.add_argument("--core", type=int, help="number of the core to run on")
    options = parser.parse_args()
    if options.fast:
        os.environ["EXUDYN_MODULE"] = "fast"
    core = pin_to_one_core(options.core)
    print(f"core {core}, {platform.processor() or platform.machine()}, best of {REPEATS}, {METHOD}")
    print("links      h  steps     ours  (error, iterations)   exudyn   (error)  ratio target  exudyn's setting")
    rows = []
    for case in CASES:
        if options.links and case.links not in options.links:
            continue
        row = run_case(case)
        rows.append(asdict(row))
        print(
            f"{row.links:5d} {row.step:6.0e} {row.steps:6d} {row.ours * 1e6:8.2f} us ({row.our_error:.1e} m, "
            f"{row.our_iterations:.1f}) {row.exudyn * 1e6:8.2f} us ({row.exudyn_error:.1e} m) {row.ratio:6.2f} "
            f"{row.target:5.2f}  {row.exudyn_setting}",
            flush=True,
        )
    if options.json:
        options.json.write_text(json.dumps({"core": core, "repeats": REPEATS, "rows": rows}, indent=2))


if __name__ == "__main__":
    main()
