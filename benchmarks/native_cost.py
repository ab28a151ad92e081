"""What FMUs without Python cost a C host, beside those with it: python benchmarks/native_cost.py [SCENARIO ...]

Needs a C compiler, fmpy (for the standard's headers) and the library of machine code. One process a measurement.
FMUs of others in the same host: native_peers.py.
"""

import argparse
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import fmpy
from native_host import figures, host, under_fmpy
from tlismni.fmu_wrapper import export_fmu
from tlismni.fmu_wrapper.errors import ExportError
from tlismni.fmu_wrapper.export import fmi2_platform
from tlismni.models import load, names

USUAL = ("bouncing_ball", "chain", "slider_crank_stop", "rod_rod")


def measure(program: Path, path: Path) -> dict[str, float]:
    """What the host prints for one FMU."""
    folder = path.with_suffix("")
    fmpy.extract(str(path), unzipdir=str(folder))
    description: Any = fmpy.read_model_description(str(folder))
    inputs = [v.valueReference for v in description.modelVariables if v.causality == "input"]
    outputs = [v.valueReference for v in description.modelVariables if v.causality == "output" and v.type == "Real"]
    binaries = folder / "binaries" / fmi2_platform()
    library = next(binaries.glob(f"{description.coSimulation.modelIdentifier}.*"))
    arguments = [library, (folder / "resources").as_uri(), description.guid, description.defaultExperiment.stopTime]
    arguments += [inputs[0] if inputs else 0, *outputs[:2]]
    found = figures(program, arguments)
    fmpy_us = under_fmpy(library, folder / "resources", description.guid, inputs[:1], outputs[:2], 1e-12)
    return {**found, "under_fmpy_us": fmpy_us}


def costs(scenarios: list[str]) -> None:
    """A table of both kinds."""
    with tempfile.TemporaryDirectory() as folder:
        program = host(Path(folder))
        for name in scenarios:
            for native in (True, False):
                path = Path(folder, f"{name}_{'native' if native else 'python'}.fmu")
                began = time.perf_counter()
                export_fmu(load(name), path, native=native)
                exported = time.perf_counter() - began
                found = {"bytes": path.stat().st_size, "export_s": exported, **measure(program, path)}
                print(name, "native" if native else "python", *(f"{k}={v:.4g}" for k, v in found.items()), flush=True)


def first_result() -> None:
    """Wall and CPU time of a process from its start to the first result of `bouncing_ball`, with no caches, and of a C
    host from the image to the same."""
    code = (
        "from tlismni.models import load; from tlismni.core import simulate; s = load('bouncing_ball'); "
        "print(simulate(s.model, s.t_end, method=s.method, rtol=s.rtol, atol=s.atol, **s.options)['ball.y'][-1])"
    )
    for attempt in ("first", "again"):
        with tempfile.TemporaryDirectory() as home:
            environment = {**os.environ, "HOME": home, "XDG_CACHE_HOME": home, "PYTHONDONTWRITEBYTECODE": "1"}
            began, before = time.perf_counter(), os.times()
            subprocess.run([sys.executable, "-c", code], env=environment, check=True, capture_output=True)
            after = os.times()
            cpu = after.children_user + after.children_system - before.children_user - before.children_system
            print(f"first result in Python, new home, {attempt}: {time.perf_counter() - began:.3f} s, CPU {cpu:.3f} s")


def share() -> None:
    """Which scenarios of the catalogue can be FMUs without Python."""
    with tempfile.TemporaryDirectory() as folder:
        done = 0
        for name in names():
            try:
                path = export_fmu(load(name), Path(folder, "x.fmu"), native=True)
            except ExportError as error:
                print(f"{name}: {error}")
            else:
                done += 1
                print(f"{name}: {path.stat().st_size / 1024:.0f} KiB", flush=True)
        print(f"{done} of {len(names())}")


def main() -> None:
    """The command."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("scenarios", nargs="*", default=list(USUAL))
    parser.add_argument("--share", action="store_true", help="go through the catalogue instead")
    given = parser.parse_args()
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    if given.share:
        share()
    else:
        first_result()
        costs(given.scenarios)


if __name__ == "__main__":
    main()
