"""Passages of singular positions over a grid of tolerances, methods and starts; prints what failed, and the errors.

    python benchmarks/singular_passages.py [--quick] [--json FILE]

To be run under several code generations too: the outcome must not depend on rounding (`benchmarks/codegen.sh`).
"""

import argparse
import itertools
import json
import logging
import math
import sys
import time
from pathlib import Path

import numpy as np
from scipy.integrate import solve_ivp

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests" / "core"))
sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))
from linkages import four_bar, stiffness
from tlismni.core import Simulation, SimulationError

TOLERANCES = tuple(10.0**-k for k in range(4, 13))
METHODS = (
    ("ebdf", {}, 1e-13), ("mebdf", {}, 1e-13), ("irk", {}, 1e-13), ("irk", {"tableau": "gauss3"}, 1e-13),
    ("irk", {"tableau": "sdirk4"}, 1e-13), ("bdf", {}, 1e-13), ("adams", {}, 1e-13), ("ebdf", {"k": "auto"}, 1e-13),
    ("park", {}, 1e-8), ("hht", {}, 1e-8), ("trapezoidal", {}, 1e-8), ("newmark", {}, 1e-8),
)  # fmt: skip
"""With the least tolerance: methods of second order need too many steps below."""
STARTS = ((math.pi / 2, -1.0), (1.1, -6.0), (0.4, -5.3), (0.25, -5.7), (0.9, -3.1), (0.31, -12.0), (0.6, -0.4))


def exact_angle(theta, rate, k, t):
    found = solve_ivp(
        lambda _, y: [y[1], -k * math.cos(y[0])], (0.0, t), [theta, rate], "DOP853", rtol=1e-13, atol=1e-14,
        max_step=0.01, dense_output=True,
    )  # fmt: skip
    return found.sol


def time_of(solution, angle, t):
    low, high = 0.0, t
    for _ in range(80):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if solution(middle)[0] > angle else (low, middle)
    return low


def passage(loops, theta, rate, method, options, rtol):
    """Error of the angle a little behind the first singular position, relative to rtol; or the message."""
    k = stiffness(loops + 1, loops)
    solution = exact_angle(theta, rate, k, 2.0)
    t_end = time_of(solution, -0.35, 2.0)
    began = time.perf_counter()
    try:
        sim = Simulation(four_bar(loops, theta, rate), method, rtol, 0.01 * rtol, max_steps=60_000, **options)
        sim.advance(t_end)
        row = sim.sample()
    except SimulationError as error:
        return {"failed": str(error), "time": time.perf_counter() - began}
    n = sim.assembly.n
    q, v = row[1 : 1 + n], row[sim.table.layout.v]
    angle, speed = solution(t_end)
    cranks = [3 * (2 * i) + 2 for i in range(1)]
    error = max(abs(q[i] - angle) for i in cranks)
    return {
        "error": error / rtol,
        "rate_error": max(abs(v[i] - speed) for i in cranks) / rtol,
        "steps": sim.stats["steps"],
        "time": time.perf_counter() - began,
    }


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--json", default="")
    parser.add_argument("--only", default="")
    given = parser.parse_args()
    logging.basicConfig(level=logging.ERROR)
    failures, rows = 0, []
    for (method, options, least), rtol in itertools.product(METHODS, TOLERANCES):
        name = method + "".join(f",{v}" for v in options.values())
        if rtol < least or (given.only and given.only != name):
            continue
        errors, steps, seconds, bad = [], [], 0.0, []
        for theta, rate in STARTS[:: 3 if given.quick else 1]:
            for loops in (2,) if given.quick else (1, 2):
                found = passage(loops, theta, rate, method, options, rtol)
                rows.append({"method": name, "rtol": rtol, "theta": theta, "rate": rate, "loops": loops, **found})
                seconds += found["time"]
                if "failed" in found:
                    bad.append((theta, rate, loops, found["failed"][:150]))
                else:
                    errors.append(found["error"])
                    steps.append(found["steps"])
        failures += len(bad)
        print(
            f"{name:14s} {rtol:.0e} failed {len(bad)} of {len(bad) + len(errors)}; error/rtol median "
            f"{np.median(errors) if errors else math.nan:9.3g} worst {max(errors, default=math.nan):9.3g}; "
            f"steps {np.median(steps) if steps else 0:.0f}; {seconds:.1f} s", flush=True,
        )  # fmt: skip
        for one in bad:
            print("     ", *one, flush=True)
    if given.json:
        Path(given.json).write_text(json.dumps(rows))
    print(f"{failures} failures of {len(rows)}")
    return failures > 0


if __name__ == "__main__":
    raise SystemExit(main())
