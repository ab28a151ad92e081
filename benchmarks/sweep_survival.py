"""A sweep on a local Dask cluster of two workers survives the kill of a worker and of everything, and loses nothing.

    python benchmarks/sweep_survival.py --runs 10000

The sweep is a process of its own. At a quarter of the runs one worker is killed, at half of them the sweep and the
whole cluster. A new cluster and the same call then finish it. Nothing that was kept may be computed again: the files of
the parts must be the same bytes with the same time as before.
"""

import argparse
import json
import os
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np
from tlismni.core.sweeps import load_sweep, sweep
from tlismni.models.sweep import ScenarioProblem

PERIODS, FREQUENCY = 20, 2.8
PERIOD = 2.0 * np.pi / FREQUENCY
PATIENCE = 3600.0


def problem() -> ScenarioProblem:
    """The impact oscillator after 20 periods."""
    return ScenarioProblem.of(
        "impact_oscillator", {"frequency": FREQUENCY}, t_end=PERIODS * PERIOD, channels=["mass.x", "mass.vx"]
    )


def vary(runs: int) -> dict[str, Any]:
    """A grid of about `runs` points over restitution and damping."""
    side = round(runs**0.5)
    return {"restitution": np.linspace(0.3, 0.9, side), "damping_ratio": np.linspace(0.01, 0.1, side)}


def drive(folder: Path, address: str, runs: int, part: int) -> None:
    """What the process of the sweep does."""
    sweep(problem(), vary(runs), out=folder, cluster=address, part=part)


def cluster() -> Any:
    """Two workers, processes of one thread each."""
    from distributed import LocalCluster

    return LocalCluster(n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None, memory_limit=0)


def kept(folder: Path) -> dict[str, tuple[int, bytes]]:
    """Time and bytes of every part that there is."""
    return {path.name: (path.stat().st_mtime_ns, path.read_bytes()) for path in (folder / "parts").glob("*.parquet")}


def wait_for(folder: Path, count: int, process: subprocess.Popen) -> None:
    """Until so many parts are there."""
    until = time.monotonic() + PATIENCE
    while len(list((folder / "parts").glob("*.parquet"))) < count:
        if process.poll() is not None:
            raise RuntimeError(f"the sweep ended with code {process.returncode} before it had {count} parts")
        if time.monotonic() > until:
            raise RuntimeError(f"{count} parts did not come within {PATIENCE:g} s")
        time.sleep(0.02)


def start(folder: Path, address: str, runs: int, part: int) -> subprocess.Popen:
    """The sweep as a process."""
    return subprocess.Popen([sys.executable, __file__, "--drive", str(folder), address, str(runs), str(part)])


def survive(folder: Path, runs: int, part: int) -> dict[str, Any]:
    """Kill a worker, then everything, then finish. Figures of what came of it."""
    points = vary(runs)
    total = len(points["restitution"]) * len(points["damping_ratio"])
    parts = -(-total // part)
    began = time.perf_counter()
    with cluster() as first:
        process = start(folder, first.scheduler_address, runs, part)
        wait_for(folder, max(1, parts // 4), process)
        victim = next(iter(first.workers.values()))
        os.kill(victim.process.process.pid, signal.SIGKILL)
        wait_for(folder, max(2, parts // 2), process)
        process.send_signal(signal.SIGKILL)
        process.wait()
    before = kept(folder)
    with cluster() as second:
        process = start(folder, second.scheduler_address, runs, part)
        if process.wait() != 0:
            raise RuntimeError(f"the second sweep ended with code {process.returncode}")
    after, found = kept(folder), load_sweep(folder)
    run = found["run"]
    rng = np.random.default_rng(0)
    sample = np.sort(rng.choice(total, min(50, total), replace=False))
    names = ("restitution", "damping_ratio")
    alone = problem().run({name: found[name][sample] for name in names}, 1)
    return {
        "runs": total,
        "parts": parts,
        "parts_before_restart": len(before),
        "parts_computed_again": sum(after[name] != entry for name, entry in before.items()),
        "rows": len(run),
        "every_run_once": bool(np.array_equal(np.sort(run), np.arange(total))),
        "failed": len(found.failures),
        "same_bits_as_alone": bool(
            all(np.array_equal(found[c][sample], alone.columns[c]) for c in ("mass.x", "mass.vx"))
        ),
        "seconds": round(time.perf_counter() - began, 1),
    }


if __name__ == "__main__":
    if sys.argv[1:2] == ["--drive"]:
        drive(Path(sys.argv[2]), sys.argv[3], int(sys.argv[4]), int(sys.argv[5]))
    else:
        parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
        parser.add_argument("--runs", type=int, default=10_000)
        parser.add_argument("--part", type=int, default=50)
        given = parser.parse_args()
        with tempfile.TemporaryDirectory() as place:
            print(json.dumps(survive(Path(place) / "sweep", given.runs, given.part), indent=2))
