"""Cost of building a run, of its state, and of many runs: a compiled model beside runs that are built one by one.

    python benchmarks/batch_cost.py [--runs N] [--baseline PYTHON] [--json]

`--baseline`: an interpreter that has another version of the package installed, measured for what it has, in turns.
CPU time of all threads. Compiling and loading are not counted; the least of several repetitions is given.
"""

import argparse
import json
import subprocess
import sys
import time
from pathlib import Path

SCENARIOS = ("bouncing_ball", "pendulum_stop", "slider_crank_stop", "chain")


def least(work, number, repeat=5):
    """Least CPU time of one call, of all threads, s."""
    work()
    best = float("inf")
    for _ in range(repeat):
        start = time.process_time()
        for _ in range(number):
            work()
        best = min(best, (time.process_time() - start) / number)
    return best


def of_one_run():
    """Microseconds of CPU: a simulation built, taken and restored, and of a compiled model."""
    from tlismni.core import Simulation
    from tlismni.models import load

    try:
        from tlismni.core import compile_model
    except ImportError:
        compile_model = None
    found = {}
    for name in SCENARIOS:
        model = load(name).model
        found[f"{name}: Simulation(model)"] = least(lambda model=model: Simulation(model), 50)
        if compile_model is not None:
            compiled = compile_model(model)
            found[f"{name}: of a compiled model"] = least(compiled.simulation, 200)
            start = {compiled.start_names[-1]: 0.0}
            found[f"{name}: with another start"] = least(
                lambda compiled=compiled, start=start: compiled.simulation(start=start), 50
            )
        sim = Simulation(model)
        sim.advance(0.1)
        state = sim.state()
        found[f"{name}: state taken"] = least(sim.state, 1000)
        found[f"{name}: state restored"] = least(lambda sim=sim, state=state: sim.restore(state), 1000)
    return {name: 1e6 * seconds for name, seconds in found.items()}


def of_many_runs(runs):
    """Seconds of CPU of `runs` runs of the bouncing ball for 1 s, other numbers each time."""
    import numpy as np
    from tlismni.core import compile_model, simulate
    from tlismni.models import load

    model = load("bouncing_ball").model
    restitution, speed = np.linspace(0.5, 0.9, runs), np.linspace(-1.0, 1.0, runs)
    few = range(0, runs, max(1, runs // 100))
    start = time.process_time()
    for row in few:
        simulate(model.with_parameters({"restitution": float(restitution[row])}), 1.0, record=False)
    found = {"simulate, one after the other": (time.process_time() - start) * runs / len(few)}
    compiled = compile_model(model)
    from tlismni.core import simulate_many

    for threads in (1, 2):
        for what, numbers in (
            ("the same", {"parameters": None, "runs": runs}),
            ("other start values", {"parameters": None, "start": {"ball.vy": speed}}),
            ("other parameters", {"parameters": {"restitution": restitution}}),
        ):
            done = least(lambda numbers=numbers, t=threads: simulate_many(compiled, t_end=1.0, threads=t, **numbers), 1)
            found[f"simulate_many, {what}, {threads} thread{'s' if threads > 1 else ''}"] = done
    return found


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--runs", type=int, default=1000)
    parser.add_argument("--baseline", metavar="PYTHON")
    parser.add_argument("--json", action="store_true")
    parser.add_argument("--one", action="store_true", help=argparse.SUPPRESS)
    given = parser.parse_args()
    if given.one:
        print(json.dumps(of_one_run()))
        return
    here, there = of_one_run(), {}
    if given.baseline:
        script = [given.baseline, str(Path(__file__)), "--one"]
        done = [json.loads(subprocess.run(script, check=True, stdout=subprocess.PIPE).stdout)]
        again = of_one_run()
        done.append(json.loads(subprocess.run(script, check=True, stdout=subprocess.PIPE).stdout))
        here = {name: min(x, again[name]) for name, x in here.items()}
        there = {name: min(x[name] for x in done) for name in done[0]}
    many = of_many_runs(given.runs)
    if given.json:
        json.dump({"one": here, "baseline": there, "many": many}, sys.stdout, indent=2)
        return
    print(f"{'microseconds':44}{'now':>10}{'baseline':>10}")
    for name, value in here.items():
        print(f"{name:44}{value:10.1f}" + (f"{there[name]:10.1f}" if name in there else ""))
    print(f"\n{given.runs} runs of bouncing_ball for 1 s, seconds of CPU")
    for name, value in many.items():
        print(f"{name:44}{value:10.2f}")


if __name__ == "__main__":
    main()
