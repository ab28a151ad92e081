"""CPU time of an event, steps around it included: scenarios, and many bounces of one ball.

    python benchmarks/event_cost.py [--baseline PYTHON] [--repeat N] [--json]

`--baseline`: an interpreter that has another version of the package (an editable install in a worktree of an earlier
commit); both are measured in turns, and ratios are given. Compiling, loading and building a run are not counted.
"""

import argparse
import json
import subprocess
import sys
import time
from pathlib import Path

SCENARIOS = (
    "bouncing_ball", "slider_crank_stop", "pendulum_stop", "newtons_cradle", "rocking_block", "woodpecker",
    "stick_slip", "cable_ground",
)  # fmt: skip
FEW, MANY = (0.97, 25.0), (0.998, 400.0)
"""Restitution and time of two runs of a ball: the difference is that of about a thousand bounces."""


def cpu_of(model, t_end):
    """(least CPU time of five runs, s; events)."""
    from tlismni.core import Simulation

    best, events = float("inf"), 0
    for _ in range(5):
        run = Simulation(model)
        start = time.process_time()
        run.advance(t_end)
        best, events = min(best, time.process_time() - start), len(run.events)
    return best, events


def instant_cost(model, t_end):
    """Least CPU time of what is settled at an instant with events, s: that of a run over the number of its instants.
    Structures that the run meets are there: it has been made before."""
    from tlismni.core import Simulation

    run, best = Simulation(model), float("inf")
    start = run.state()
    for _ in range(4):
        run.restore(start)
        spent, instants = 0.0, 0
        while run.advance_to_event(t_end):
            begin = time.process_time()
            run.handle_event()
            spent, instants = spent + time.process_time() - begin, instants + 1
        best = min(best, spent / instants)
    return best


def measure():
    """Microseconds an event by scenario, steps around it included; "bounce": of one bounce among many; "instant of
    ...": what is settled at an instant alone."""
    from tlismni.models import load

    found = {}
    for name in SCENARIOS:
        scenario = load(name)
        seconds, events = cpu_of(scenario.model, scenario.t_end)
        found[name] = 1e6 * seconds / events
        found[f"instant of {name}"] = 1e6 * instant_cost(scenario.model, scenario.t_end)
    (few, one), (many, other) = (cpu_of(load("bouncing_ball", restitution=e).model, t) for e, t in (FEW, MANY))
    found["bounce"] = 1e6 * (many - few) / (other - one)
    return found


def least(results):
    return {name: min(result[name] for result in results) for name in results[0]}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--baseline", metavar="PYTHON")
    parser.add_argument("--repeat", type=int, default=3)
    parser.add_argument("--json", action="store_true")
    parser.add_argument("--once", action="store_true", help=argparse.SUPPRESS)
    given = parser.parse_args()
    if given.once:
        print(json.dumps(measure()))
        return
    pythons = [sys.executable, *([given.baseline] if given.baseline else [])]
    results = {python: [] for python in pythons}
    for _ in range(given.repeat):
        for python in pythons:
            out = subprocess.run([python, str(Path(__file__).resolve()), "--once"], capture_output=True, check=True)
            results[python].append(json.loads(out.stdout.splitlines()[-1]))
    now = least(results[sys.executable])
    before = least(results[given.baseline]) if given.baseline else {}
    if given.json:
        print(json.dumps({"us": now, "baseline_us": before}))
        return
    print(f"{'us of CPU an event':28}{'now':>10}" + (f"{'baseline':>10}{'ratio':>8}" if before else ""))
    for name, us in now.items():
        print(f"{name:28}{us:10.1f}" + (f"{before[name]:10.1f}{before[name] / us:8.1f}" if before else ""))


if __name__ == "__main__":
    main()
