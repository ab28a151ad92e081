"""How far results are from those of another version: every scenario and method, and beside it what tolerances allow.

    python benchmarks/differences.py --baseline PYTHON [--scenarios A B] [--methods ebdf irk] [--end 2.0] [--json]

`--baseline`: an interpreter that has another version of the package (an editable install in a worktree of an earlier
commit). Each run is made at two tolerances. Where both versions have the same events, the table has the largest
difference of their times, and that of all channels at the end, in parts of a channel's largest value along the run: at
the one tolerance and at the other. Beside it stands how far this version's own two are apart: what is well below that
is rounding, or other steps.
"""

import argparse
import json
import logging
import subprocess
import sys
from pathlib import Path

METHODS = ("ebdf", "irk", "hht", "newmark", "bdf", "adams")
RTOL, TIGHT = 1e-6, 1e-8
POINTS = 20


def run(name, method, rtol, end):
    """Events and channels of a run: [[t, kind, contact]], {channel: values at POINTS times}; or what went wrong."""
    from tlismni.core import Simulation
    from tlismni.models import load

    scenario = load(name)
    try:
        sim = Simulation(scenario.model, method, rtol=rtol, atol=1e-3 * rtol)
        t_end, rows = min(scenario.t_end, end), []
        for k in range(POINTS):
            sim.advance(t_end * (k + 1) / POINTS)
            rows.append(sim.values().tolist())
    except Exception as error:  # of whatever version
        return {"error": str(error)[:200]}
    names = [channel.name for channel in sim.channels]
    return {
        "events": [[e.t, e.kind, e.contact] for e in sim.events],
        "channels": dict(zip(names, zip(*rows, strict=True), strict=True)),
    }


def differ(one, other):
    """(largest difference of event times, s; of channels at the end, in parts of their size); None for other events."""
    kinds = [[event[1:] for event in x["events"]] for x in (one, other)]
    if kinds[0] != kinds[1]:
        return None, None
    times = max((abs(a[0] - b[0]) for a, b in zip(one["events"], other["events"], strict=True)), default=0.0)
    largest, sizes = 0.0, [abs(x) for column in one["channels"].values() for x in column if x == x]
    least = 1e-6 * max(sizes, default=0.0)  # what is much smaller than all else is rounding
    for name in one["channels"].keys() & other["channels"].keys():
        a, b = one["channels"][name], other["channels"][name]
        size = max(map(abs, (*a, *b)))
        if size > least and all(x == x for x in (*a, *b)) and "residual" not in name and "balance" not in name:
            largest = max(largest, abs(a[-1] - b[-1]) / size)
    return times, largest


def words(found):
    """A pair of differences, for the table."""
    return f"{'other events':>32}" if found[0] is None else f"{found[0]:18.1e}{found[1]:14.1e}"


def main():
    from tlismni.models import names

    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--baseline", metavar="PYTHON")
    parser.add_argument("--scenarios", nargs="+", default=list(names()))
    parser.add_argument("--methods", nargs="+", default=list(METHODS))
    parser.add_argument("--end", type=float, default=2.0, help="s, at most; at most the scenario's own")
    parser.add_argument("--json", action="store_true")
    parser.add_argument("--once", nargs=2, metavar=("SCENARIO", "METHOD"), help=argparse.SUPPRESS)
    given = parser.parse_args()
    logging.disable(logging.WARNING)
    if given.once:
        print(json.dumps([run(*given.once, rtol, given.end) for rtol in (RTOL, TIGHT)]))
        return
    if given.baseline is None:
        parser.error("--baseline: the interpreter of another version is needed")
    table = []
    if not given.json:
        titles = "".join(f"{f'{title}: events, s; channels':>32}" for title in (f"{RTOL:g}", f"{TIGHT:g}", "own"))
        print(f"{'':36}{titles}")
    for name in given.scenarios:
        for method in given.methods:
            command = [str(Path(__file__).resolve()), "--once", name, method, "--end", str(given.end)]
            both = []
            for python in (sys.executable, given.baseline):
                done = subprocess.run([python, *command], capture_output=True, text=True)
                failed = [{"error": done.stderr[-200:]}] * 2
                both.append(json.loads(done.stdout.splitlines()[-1]) if done.returncode == 0 else failed)
            (now, tight), (before, before_tight) = both
            four = {"now": now, "before": before, "now, tight": tight, "before, tight": before_tight}
            row = {
                "scenario": name,
                "method": method,
                "errors": {k: x["error"] for k, x in four.items() if "error" in x},
            }
            if not row["errors"]:
                row["differences"] = [differ(now, before), differ(tight, before_tight), differ(now, tight)]
            table.append(row)
            if not given.json:
                text = f"  {row['errors']}" if row["errors"] else "".join(map(words, row["differences"]))
                print(f"{name:26}{method:10}{text}", flush=True)
    if given.json:
        print(json.dumps(table))


if __name__ == "__main__":
    main()
