"""What threads gain: instances of an FMU stepped in as many threads of a native host, against one alone.

Run: python benchmarks/fmu_threads.py [--json out.json] [--repeats 5]   (wants a C compiler)

Chains as FMU 2.0, doStep + get of an angle in each thread, all begun at once. With n threads on as many free cores the
time of a run would be that of one; one after the other it would be n times as long. The gain n t_1 / t_n is that of the
best runs, those with one thread and with more taken in turn.
"""

import one_thread  # isort: skip  # noqa: F401

import argparse
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import fmpy
from tlismni.fmu_wrapper import export_fmu
from tlismni.fmu_wrapper.export import fmi2_platform, shim_path

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE / "fmu_peers"))

from case import SOLVER, chain  # noqa: E402

HOST = HERE.parent / "tests" / "fmu_wrapper" / "host_threads.c"
CASES = {10: (1e-3, 4000), 30: (1e-2, 400), 100: (1e-2, 100)}
"""Communication step, s, and number of steps, by links."""


def build(folder: Path) -> Path:
    """The host program."""
    program = folder / "host"
    headers = Path(fmpy.__file__).parent / "c-code"
    compiler = os.environ.get("CC", "cc")
    command = [compiler, "-O2", f"-I{headers}", "-o", str(program), str(HOST), "-ldl", "-lpthread"]
    subprocess.run(command, check=True)
    return program


def arguments_of(links: int, folder: Path) -> list[str]:
    """What the host wants to know of the FMU of a chain."""
    path = export_fmu(chain(links), folder / f"chain{links}.fmu", **SOLVER)
    unzipped = fmpy.extract(str(path), unzipdir=str(folder / f"chain{links}"))
    description = fmpy.read_model_description(unzipped)
    references = {v.name: v.valueReference for v in description.modelVariables}
    identifier = description.coSimulation.modelIdentifier
    library = Path(unzipped, "binaries", fmi2_platform(), identifier + shim_path().suffix)
    resources = Path(unzipped, "resources").as_uri()
    return [str(library), resources, description.guid, str(references["link1.angle"])]


def run(host: Path, threads: int, links: int, fmu: list[str]) -> tuple[float, set[str]]:
    """Wall-clock time of the slowest thread, s, and the values that the threads end with."""
    step, steps = CASES[links]
    command = [str(host), str(threads), str(steps), str(step), *fmu]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    lines = [line.split() for line in done.stdout.splitlines()]
    return max(float(line[2]) for line in lines), {line[1] for line in lines}


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--json", type=Path)
    parser.add_argument("--repeats", type=int, default=5)
    given = parser.parse_args()
    found = []
    print(f"{len(os.sched_getaffinity(0))} cores\nlinks  step s  threads  time s  gain")
    with tempfile.TemporaryDirectory() as name:
        host = build(Path(name))
        for links in CASES:
            fmu, values = arguments_of(links, Path(name)), set()
            best = dict.fromkeys((1, 2, 4), float("inf"))
            for _ in range(given.repeats):
                for threads in best:
                    seconds, ended = run(host, threads, links, fmu)
                    best[threads], values = min(best[threads], seconds), values | ended
            if len(values) != 1:
                raise SystemExit(f"the instances of {links} links ended differently: {values}")
            for threads, seconds in best.items():
                gain = threads * best[1] / seconds
                found.append({"links": links, "threads": threads, "seconds": seconds, "gain": gain})
                print(f"{links:5d} {CASES[links][0]:7g} {threads:8d} {seconds:7.3f} {gain:5.2f}")
    if given.json:
        given.json.write_text(json.dumps(found, indent=1))


if __name__ == "__main__":
    main()
