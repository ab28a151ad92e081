"""Time to reach an error of 1e-6 m of the free end: 10 links, t = 2 s, ours with error control, exudyn's fixed step.

Run: python benchmarks/work_precision.py [--json out.json]. The reference is in reference.py. exudyn has methods of
order 2 only: its steps are doubled until the error is reached or a run is longer than MAX_SECONDS; then time
and error are extrapolated from the two finest runs with the order that they show, and the table says so.
"""

import argparse
import json
import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from time import perf_counter

from chain_speed import pin_to_one_core
from reference import chain_reference
from tlismni.core import simulate
from tlismni.models import load

LINKS, T_END, TARGET = 10, 2.0, 1e-6
MAX_SECONDS = 120.0
TOLERANCES = tuple(10.0 ** (-0.5 * k) for k in range(8, 23))
REPEATS = 3


@dataclass(frozen=True)
class Point:
    """One run: what was set, how many steps it took, seconds, distance of the free end from the reference in m."""

    setting: str
    steps: int
    seconds: float
    error: float


@dataclass(frozen=True)
class Reach:
    """Time to reach the target, and how it was found."""

    method: str
    seconds: float
    how: str
    points: list[Point]


def tip_error(tip: tuple[float, float], reference: Sequence[float]) -> float:
    return math.hypot(tip[0] - reference[0], tip[1] - reference[1])


def interpolated(points: list[Point], target: float) -> tuple[float, str]:
    """Time at which the error is `target`: between the last run that misses it and the next (log-log)."""
    missed = [k for k, p in enumerate(points) if p.error > target]
    if not missed:
        return points[0].seconds, f"the first run has it: {points[0].setting}, error {points[0].error:.1e}"
    if missed[-1] == len(points) - 1:
        return math.inf, "not reached"
    a, b = points[missed[-1]], points[missed[-1] + 1]
    share = math.log(a.error / target) / math.log(a.error / b.error)
    seconds = a.seconds * (b.seconds / a.seconds) ** share
    fastest = min(points[missed[-1] + 1 :], key=lambda p: p.seconds)
    if fastest.seconds <= seconds:
        # on stiff problems finer tolerances may cost less
        return fastest.seconds, f"faster with {fastest.setting}, error {fastest.error:.1e}"
    return seconds, f"between {a.setting}, error {a.error:.1e}, and {b.setting}, error {b.error:.1e}"


def our_reach(method: str, reference: Sequence[float]) -> Reach:
    """Our method with tolerances from loose to tight, best of REPEATS each."""
    model = load("chain", links=LINKS).model
    simulate(model, 1e-3, method=method, record=False)  # load compiled code
    points = []
    for tolerance in TOLERANCES:
        seconds = math.inf
        for _ in range(REPEATS):
            start = perf_counter()
            result = simulate(model, T_END, method=method, rtol=tolerance, atol=0.01 * tolerance, record=False)
            seconds = min(seconds, perf_counter() - start)
        x, y, angle = result.q[-1][-3:]
        tip = (x + 0.5 * math.cos(angle), y + 0.5 * math.sin(angle))
        points.append(Point(f"rtol {tolerance:.1e}", int(result.stats["steps"]), seconds, tip_error(tip, reference)))
    return Reach(method, *interpolated(points, TARGET), points)


def exudyn_reach(integrator: str, reference: Sequence[float]) -> Reach:
    """exudyn with a growing number of steps, in the setting that is fastest at the start."""
    from exudyn_chain import run, settings_for

    settings = settings_for(LINKS, integrator, rtol=1e-10, atol=1e-10)
    steps = 4000
    first = [(run(LINKS, T_END, T_END / steps, s.settings), s) for s in settings]
    setting = min(first, key=lambda found: found[0][0])[1]
    points: list[Point] = []
    while True:
        seconds, tip = run(LINKS, T_END, T_END / steps, setting.settings)
        points.append(Point(f"h {T_END / steps:.1e}", steps, seconds, tip_error(tip, reference)))
        if points[-1].error <= TARGET:
            return Reach(setting.name, *interpolated(points, TARGET), points)
        if len(points) > 2 and 2.0 * seconds > MAX_SECONDS:
            break
        steps *= 2
    coarse, fine = points[-2:]
    order = math.log(coarse.error / fine.error) / math.log(2.0)
    if order < 1.0:
        return Reach(setting.name, math.inf, "not reached: its error no longer falls with the step", points)
    factor = (fine.error / TARGET) ** (1.0 / order)
    how = f"extrapolated from {fine.steps} steps, error {fine.error:.1e}, with the observed order {order:.2f}"
    return Reach(setting.name, fine.seconds * factor, how, points)


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--json", type=Path, help="write the results there")
    parser.add_argument("--methods", nargs="*", default=["ebdf"], help="our methods")
    options = parser.parse_args()
    core = pin_to_one_core()
    end = chain_reference(LINKS, [0.0, T_END])
    reference = [float(x) for x in end.tip[:, -1]]
    print(f"core {core}; free end at t = {T_END:g} s: ({reference[0]:.10f}, {reference[1]:.10f}) m")
    reaches = [our_reach(method, reference) for method in options.methods]
    reaches += [exudyn_reach(integrator, reference) for integrator in ("generalized_alpha", "trapezoidal")]
    for reach in reaches:
        print(f"\n{reach.method}")
        for p in reach.points:
            print(f"  {p.setting:>14} {p.steps:9d} steps {p.seconds:10.4f} s   error {p.error:.2e} m")
        print(f"  {TARGET:g} m in {reach.seconds:.4g} s ({reach.how})")
    ours = min(r.seconds for r in reaches[: len(options.methods)])
    theirs = min(r.seconds for r in reaches[len(options.methods) :])
    print(f"\nours {ours:.4g} s, exudyn {theirs:.4g} s: {theirs / ours:.1f} times as long")
    if options.json:
        data = {"core": core, "target": TARGET, "reference": reference, "runs": [asdict(r) for r in reaches]}
        options.json.write_text(json.dumps(data, indent=2))


if __name__ == "__main__":
    main()
