"""Accuracy per time: our methods, exudyn, solve_dae and IDA on three problems, in one run, on one core.

exudyn runs in redundant coordinates and, for the chain, in minimal ones (`ObjectKinematicTree`), its fastest way.

Run: python benchmarks/accuracy_per_time.py [--quick] [--json out.json] [--plot out.png] [--problems chain ...].
The peers: pip install "exudyn==1.13.*" scipy_dae scikit-sundae; one that is missing is left out, and the table says so.
Every method runs from rough to fine settings, all of them in turn, again and again; the best time counts: of the
integration alone, with compiled code loaded and the system built. The time at an error is interpolated between runs.
"""

import argparse
import gc
import json
import math
import warnings
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path

import one_thread  # noqa: F401 - before numpy is loaded
from accuracy_contenders import PEERS, Contender, TimeLimit, absent_peers, contenders
from accuracy_output import plot, print_problem
from accuracy_problems import Problem, problems
from chain_speed import pin_to_one_core
from peer_solvers import PeerFailed, installed
from tlismni.cli.screen import plain, say, status_line
from work_precision import Point, interpolated

PACKAGES = [package for _, package, _ in PEERS.values()]
TARGETS = (1e-3, 1e-6, 1e-9)
FINE_ENOUGH = 0.3
"""Finer settings are left out once the error is below this part of the smallest target."""
LIMIT, QUICK_LIMIT = 30.0, 3.0
"""Longest run, s."""
REPEATS, QUICK_REPEATS = 7, 2
LONG = 1.0
"""Runs longer than this, in s, are repeated once at most."""


@dataclass
class Curve:
    """What a contender reached."""

    contender: Contender
    settings: list[float] = field(default_factory=list)
    points: list[Point] = field(default_factory=list)
    counts: list[dict[str, int]] = field(default_factory=list)
    end: str = ""
    """Why there are no finer runs."""

    def reach(self, target: float) -> tuple[float, str]:
        """(seconds to the error `target`, how it was found); infinite if it is not reached."""
        useful = [p for p in self.points if math.isfinite(p.error)]
        return interpolated(useful, target) if useful else (math.inf, self.end or "no run succeeded")

    def extrapolated(self, target: float) -> float:
        """Seconds of a fixed-step method beyond its finest run, with the order of its last two runs; else infinite."""
        if not self.contender.fixed_step or len(self.points) < 2:
            return math.inf
        coarse, fine = self.points[-2:]
        order = math.log(coarse.error / fine.error) / math.log(fine.steps / coarse.steps)
        if order < 1.0 or fine.error < target:
            return math.inf
        return fine.seconds * (fine.error / target) ** (1.0 / order)


def first_pass(problem: Problem, contender: Contender, limit: float) -> Curve:
    """The settings from rough to fine, each once, until the finest target or the time limit."""
    curve = Curve(contender)
    for setting in contender.settings:
        try:
            run = contender.run(setting)
        except TimeLimit:
            curve.end = f"a run takes longer than {limit:g} s"
            break
        except PeerFailed as error:
            curve.end = " ".join(str(error).split())[:160]
            if curve.points:
                break
            continue
        error = problem.error(run.q)
        name = f"{setting:g} steps" if contender.fixed_step else f"rtol {setting:.1e}"
        curve.settings.append(setting)
        steps = int(setting) if contender.fixed_step else run.counts.get("steps", 0)
        curve.points.append(Point(name, steps, run.seconds, error))
        curve.counts.append(run.counts)
        if error < FINE_ENOUGH * TARGETS[-1]:
            break
        if run.seconds > (0.5 * limit if contender.fixed_step else limit):
            curve.end = f"a finer run would take longer than {limit:g} s"
            break
    return curve


def repeat(curves: list[Curve], number: int) -> None:
    """Run everything again, in turn: the best time of each counts. Long runs are repeated in round 0 only."""
    for curve in curves:
        for k, point in enumerate(curve.points):
            if point.seconds > LONG and number > 0:
                continue
            try:
                seconds = curve.contender.run(curve.settings[k]).seconds
            except (TimeLimit, PeerFailed):  # a loaded machine: the first time stands
                continue
            if seconds < point.seconds:
                curve.points[k] = replace(point, seconds=seconds)


def measure(problem: Problem, limit: float, rounds: int, quick: bool) -> list[Curve]:
    """All contenders on one problem."""
    with status_line(f"{problem.name}: reference") as show:
        say(f"{problem.name}: reference {', '.join(f'{x:.12g}' for x in problem.reference)} m")
        show(f"{problem.name}: building and compiling the peers")
        curves = []
        found = contenders(problem, limit, quick)
        for number, contender in enumerate(found):
            show(f"{problem.name}: {contender.side} {contender.name} ({number + 1} of {len(found)})")
            try:
                contender.run(contender.settings[0])  # compiled code is loaded, outside the timing
            except (TimeLimit, PeerFailed):
                pass  # the first pass reports it
            curves.append(first_pass(problem, contender, limit))
        for number in range(rounds):
            show(f"{problem.name}: repeating everything, {number + 1} of {rounds}")
            gc.collect()
            repeat(curves, number)
    return curves


def as_data(problem: Problem, curves: list[Curve]) -> dict[str, object]:
    """What was measured on one problem, for JSON."""
    return {
        "name": problem.name,
        "title": problem.title,
        "reference": problem.reference,
        "curves": [
            {
                "side": c.contender.side,
                "method": c.contender.name,
                "end": c.end,
                "reach": {f"{target:g}": c.reach(target) for target in TARGETS},
                "extrapolated": {f"{target:g}": c.extrapolated(target) for target in TARGETS},
                "points": [
                    {**asdict(p), "counts": counts} for p, counts in zip(c.points, c.counts, strict=True)
                ],
            }
            for c in curves
        ],
    }  # fmt: skip


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="fewer methods, settings and repeats; runs of 3 s at most")
    parser.add_argument("--json", type=Path, help="write the results there")
    parser.add_argument("--plot", type=Path, help="draw time against error there (png, pdf or svg)")
    parser.add_argument("--problems", nargs="*", help="only these: chain, slider_crank, slider_crank_stiff")
    parser.add_argument("--repeats", type=int, help="how often everything is run again")
    parser.add_argument("--core", type=int, help="number of the core to run on")
    options = parser.parse_args()
    known = {p.name: p for p in problems()}
    unknown = set(options.problems or ()) - set(known)
    if unknown:
        parser.error(f"there is no problem {sorted(unknown)}; there are {list(known)}")
    warnings.filterwarnings("ignore", category=UserWarning, module="sksundae")
    core = pin_to_one_core(options.core)
    limit = QUICK_LIMIT if options.quick else LIMIT
    rounds = options.repeats if options.repeats is not None else (QUICK_REPEATS if options.quick else REPEATS)
    for side, why in absent_peers().items():
        say(f"left out: {side}: {why}")
    versions = {
        package: installed(package) for package in ("tlismni", *(p.split("==")[0] for _, p, _ in PEERS.values()))
    }
    print(f"core {core}, best of {rounds + 1}, at most {limit:g} s a run; {versions}")
    measured = []
    for name in options.problems or known:
        problem = known[name]
        curves = measure(problem, limit, rounds, options.quick)
        measured.append((problem, curves))
        print_problem(problem, curves, TARGETS)
        # written as it grows: a long run that is stopped has not been for nothing
        if options.json:
            data = {"core": core, "versions": versions, "problems": [as_data(p, c) for p, c in measured]}
            options.json.write_text(json.dumps(plain(data), indent=1, allow_nan=False))
        if options.plot:
            plot(measured, TARGETS, options.plot)


if __name__ == "__main__":
    main()
