"""The C host of native_cost.py and native_peers.py, and the same steps through fmpy."""

import subprocess
import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import fmpy
from fmpy.fmi2 import FMU2Slave

HERE = Path(__file__).parent
STEPS = 2000


def host(folder: Path, fmi: int = 2) -> Path:
    """The host, compiled."""
    program = folder / f"native_host{fmi}"
    headers = Path(fmpy.__file__).parent / "c-code"
    command = ["cc", "-O2", f"-DFMI={fmi}", f"-I{headers}", "-o", str(program), str(HERE / "native_host.c")]
    subprocess.run([*command, "-ldl", "-lpthread"], check=True)
    return program


def figures(program: Path, arguments: Sequence[Any], environment: Mapping[str, str] | None = None) -> dict[str, float]:
    """What the host prints for one FMU."""
    command = [program, *map(str, arguments)]
    done = subprocess.run(command, capture_output=True, text=True, check=False, env=environment)
    if done.returncode:
        print(f"  the host ends with {done.returncode}: {done.stderr.strip()[-300:]}")
    return {line.split()[0]: float(line.split()[1]) for line in done.stdout.splitlines()}


def under_fmpy(library: Path, resources: Path, guid: str, inputs: list[int], outputs: list[int], h: float) -> float:
    """CPU time, us, of set + doStep + get through fmpy, of steps of h (s)."""
    fmu = FMU2Slave(guid=guid, unzipDirectory=str(resources.parent), modelIdentifier="x", libraryPath=str(library))
    fmu.instantiate()
    fmu.setupExperiment(startTime=0.0)
    fmu.enterInitializationMode()
    fmu.exitInitializationMode()
    t, best = 0.0, float("inf")
    fmu.doStep(t, 0.01)
    t += 0.01
    for _ in range(5):
        began = time.process_time()
        for _ in range(STEPS):
            if inputs:
                fmu.setReal(inputs, [0.0])
            fmu.doStep(t, h)
            fmu.getReal(outputs)
            t += h
        best = min(best, time.process_time() - began)
    return 1e6 * best / STEPS
