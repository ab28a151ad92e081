"""Time of one step of the N-link chain: ours beside exudyn's, one run, one core, interleaved.

Run: python benchmarks/chain_speed.py [--json out.json] [--links 1 10] [--fast]. Fixed-step `hht` against
exudyn's generalized-alpha (spectral radius 0.9) in its fastest setting. The time of a step is the difference
of a long and a short run, so that building, compiling and starting do not count, on either side.
"""

import argparse
import json
import math
import os
import platform
from collections.abc import Callable
from dataclasses import asdict, dataclass
from pathlib import Path
from time import perf_counter

from tlismni.core import simulate
from tlismni.models import load


@dataclass(frozen=True)
class Case:
    """What is run: number of links, step in s, number of steps of the long run, target for ours / exudyn's."""

    links: int
    step: float
    steps: int
    target: float


CASES = (Case(1, 1e-4, 40_000, 1.0), Case(10, 5e-4, 4_000, 0.5), Case(100, 5e-4, 400, 0.5), Case(1000, 1e-4, 40, 0.5))
REPEATS = 3
METHOD = "hht"


@dataclass(frozen=True)
class Row:
    """Result of a case; times of one step in s."""

    links: int
    step: float
    ours: float
    exudyn: float
    exudyn_setting: str
    exudyn_all: dict[str, float]
    ratio: float
    target: float
    tip_distance: float
    """Distance of the two free ends at the end, m: both must have done the same work."""


def ours(case: Case, steps: int) -> tuple[float, tuple[float, float]]:
    """(seconds, free end) of our run of so many steps."""
    model = load("chain", links=case.links).model
    start = perf_counter()
    result = simulate(model, case.step * steps, method=METHOD, step=case.step, record=False)
    seconds = perf_counter() - start
    x, y, angle = result.q[-1][-3:]
    return seconds, (x + 0.5 * math.cos(angle), y + 0.5 * math.sin(angle))


def per_step(timed: Callable[[int], tuple[float, tuple[float, float]]], steps: int) -> tuple[list[float], list]:
    """[short, long] seconds and the free ends, of runs with a quarter of the steps and all of them."""
    runs = [timed(max(1, steps // 4)), timed(steps)]
    return [seconds for seconds, _ in runs], [tip for _, tip in runs]


def run_case(case: Case) -> Row:
    """All settings of one case, interleaved, best of REPEATS."""
    from exudyn_chain import run, settings_for

    settings = settings_for(case.links)
    sides: dict[str, Callable[[int], tuple[float, tuple[float, float]]]] = {"ours": lambda n: ours(case, n)}
    for s in settings:
        sides[s.name] = lambda n, s=s: run(case.links, n * case.step, case.step, s.settings)  # type: ignore[misc]
    ours(case, 2)  # compiled code is loaded once, outside the timing
    times: dict[str, list[list[float]]] = {name: [] for name in sides}
    tips: dict[str, tuple[float, float]] = {}
    for _ in range(REPEATS):
        for name, timed in sides.items():
            seconds, ends = per_step(timed, case.steps)
            times[name].append(seconds)
            tips[name] = ends[1]
    # the best short and the best long run: the noise of a shared machine only ever adds
    counted = case.steps - max(1, case.steps // 4)
    cost = {
        name: (min(long for _, long in pairs) - min(short for short, _ in pairs)) / counted
        for name, pairs in times.items()
    }
    theirs = {name: value for name, value in cost.items() if name != "ours"}
    best = min(theirs, key=lambda name: theirs[name])
    (x, y), (ex, ey) = tips["ours"], tips[best]
    return Row(
        case.links, case.step, cost["ours"], theirs[best], best, theirs, cost["ours"] / theirs[best], case.target,
        math.hypot(x - ex, y - ey),
    )  # fmt: skip


def pin_to_one_core() -> int | None:
    """Keep this process on one core; returns its number, or None where the system cannot."""
    if not hasattr(os, "sched_setaffinity"):
        return None
    core = min(os.sched_getaffinity(0))
    os.sched_setaffinity(0, {core})
    return core


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--json", type=Path, help="write the results there")
    parser.add_argument("--links", type=int, nargs="*", help="only these numbers of links")
    parser.add_argument("--fast", action="store_true", help="exudyn's module without range checks (AVX2)")
    options = parser.parse_args()
    if options.fast:
        os.environ["EXUDYN_MODULE"] = "fast"
    core = pin_to_one_core()
    print(f"core {core}, {platform.processor() or platform.machine()}, best of {REPEATS}, {METHOD}")
    print(f"{'links':>6} {'h':>8} {'ours':>11} {'exudyn':>11} {'ratio':>6} {'target':>7}  tips apart  exudyn's setting")
    rows = []
    for case in CASES:
        if options.links and case.links not in options.links:
            continue
        row = run_case(case)
        rows.append(asdict(row))
        print(
            f"{row.links:6d} {row.step:8.0e} {row.ours * 1e6:8.2f} us {row.exudyn * 1e6:8.2f} us {row.ratio:6.2f} "
            f"{row.target:7.2f}  {row.tip_distance:9.1e}   {row.exudyn_setting}",
            flush=True,
        )
    if options.json:
        options.json.write_text(json.dumps({"core": core, "repeats": REPEATS, "rows": rows}, indent=2))


if __name__ == "__main__":
    main()
