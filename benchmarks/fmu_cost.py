"""What an FMU costs: set + doStep + get of a chain of ten links, against the same step of the solver without FMI, and
against slaves of pythonfmu and pythonfmu3 that wrap the same solver; through fmpy, and in a native host.

Run: python benchmarks/fmu_cost.py [--json out.json] [--steps 4000] (wants pythonfmu, pythonfmu3 and a C compiler)

Contenders take turns in batches, each with its own run of the same motion, so that what else the machine does hits all
alike; a step costs the CPU time of the faster half of its batches. Once with an input that changes every step (the run
starts anew there), once with one that holds (most steps lie within the solver's newest one). All must end at equal
angles.
"""

import one_thread  # isort: skip  # noqa: F401

import argparse
import json
import math
import os
import shutil
import subprocess
import sys
import sysconfig
import tempfile
from collections.abc import Callable
from pathlib import Path
from time import perf_counter, process_time
from typing import Any

import fmpy
import numpy as np
from fmpy.fmi2 import FMU2Slave
from fmpy.fmi3 import FMU3Slave
from tlismni.fmu_wrapper import Slave, export_fmu

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE / "fmu_peers"))

from case import OUTPUTS, SOLVER, STEP, Stepper, chain  # noqa: E402

BATCH = 200
CHANGING = 1e-3
"""N m, amplitude of the input that changes."""
HEADERS = Path(fmpy.__file__).parent / "c-code"

StepCall = Callable[[float, float, float], Any]


class Fmu:
    """An exported FMU."""

    def __init__(self, path: Path, folder: Path, names: tuple[str, str, str]) -> None:
        self.unzipped = fmpy.extract(str(path), unzipdir=str(folder / path.stem))
        self.description = fmpy.read_model_description(self.unzipped, validate=False)
        self.identifier = self.description.coSimulation.modelIdentifier
        self.version = int(self.description.fmiVersion[0])
        self.token = self.description.guid if self.version == 2 else self.description.instantiationToken
        references = {v.name: v.valueReference for v in self.description.modelVariables}
        self.vr = [references[name] for name in names]

    @property
    def library(self) -> Path:
        """The binary."""
        system = "linux64" if self.version == 2 else "x86_64-linux"
        return Path(self.unzipped) / "binaries" / system / f"{self.identifier}.so"

    def stepper(self) -> tuple[StepCall, float]:
        """Set + doStep + get through fmpy, and the time to instantiate and initialize, s."""
        started = perf_counter()
        kind = FMU2Slave if self.version == 2 else FMU3Slave
        fmu = kind(guid=self.token, unzipDirectory=self.unzipped, modelIdentifier=self.identifier)
        fmu.instantiate()
        if self.version == 2:
            fmu.setupExperiment()
            set_real, get_real = fmu.setReal, fmu.getReal
        else:
            set_real, get_real = fmu.setFloat64, fmu.getFloat64
        fmu.enterInitializationMode()
        fmu.exitInitializationMode()
        ready = perf_counter() - started
        given, asked = self.vr[:1], self.vr[1:]

        def step(value: float, t: float, h: float) -> list[float]:
            set_real(given, [value])
            fmu.doStep(t, h)
            return get_real(asked)

        return step, ready


def slave_step() -> StepCall:
    """Our slave in this process, without FMI calls."""
    slave = Slave(chain(), **SOLVER)
    slave.enter_initialization()
    slave.exit_initialization()
    reference = {name: v.reference for name, v in slave.variables.by_name.items()}
    given = np.array([reference["torque"]], dtype=np.uint32)
    asked = np.array([reference[name] for name in OUTPUTS], dtype=np.uint32)

    def step(value: float, t: float, h: float) -> Any:
        slave.set("real", given, np.array([value]))
        slave.do_step(t, h)
        return slave.get("real", asked)

    return step


def peers(folder: Path) -> dict[str, Fmu]:
    """The FMUs of the other exporters."""
    from pythonfmu import FmuBuilder as Builder2
    from pythonfmu3 import FmuBuilder as Builder3

    found = {}
    for name, builder, file in (("pythonfmu", Builder2, "chain_fmi2.py"), ("pythonfmu3", Builder3, "chain_fmi3.py")):
        path = Path(builder.build_FMU(str(HERE / "fmu_peers" / file), dest=str(folder)) or "")
        path = path if path.is_file() else next(folder.glob(f"ChainFmi{file[-4]}.fmu"))
        found[name] = Fmu(path, folder, ("torque", "angle", "rate"))
    return found


def interleaved(steppers: dict[str, StepCall], steps: int, amplitude: float) -> dict[str, tuple[float, float]]:
    """us a step and the last angle of each contender."""
    times: dict[str, list[float]] = {name: [] for name in steppers}
    last = {}
    for first in range(0, steps, BATCH):
        for name, step in steppers.items():
            started = process_time()
            for i in range(first, first + BATCH):
                values = step(amplitude if i % 2 else -amplitude, i * STEP, STEP)
            times[name].append((process_time() - started) / BATCH)
            last[name] = float(values[0])
    return {name: (1e6 * float(np.mean(sorted(t)[: len(t) // 2])), last[name]) for name, t in times.items()}


def native(fmu: Fmu, folder: Path, steps: int, amplitude: float) -> tuple[float, float, float]:
    """us a step, s to the first step, and the last angle, of a host without Python."""
    host = folder / f"host{fmu.version}"
    if not host.exists():
        include = f"-I{HEADERS}"
        subprocess.run(
            ["cc", "-O2", f"-DFMI={fmu.version}", include, str(HERE / "fmu_peers" / "host.c"), "-o", str(host), "-ldl"],
            check=True,
        )
    resources = Path(fmu.unzipped) / "resources"
    location = resources.as_uri() if fmu.version == 2 else f"{resources}{os.sep}"
    variables = sysconfig.get_config_vars()
    library = Path(variables["LIBDIR"]) / variables["LDLIBRARY"]
    # pythonfmu's binary wants libpython in the host already, and to be told where its packages are
    packages = sysconfig.get_path("purelib")
    peers = {"PYTHONPATH": os.pathsep.join((str(HERE / "fmu_peers"), packages)), "PEER_SITE": packages}
    environment = {**os.environ, **({} if fmu.identifier == "chain" else {"LD_PRELOAD": str(library), **peers})}
    answer = subprocess.run(
        [str(host), str(fmu.library), location, fmu.token, *map(str, fmu.vr), str(STEP), str(steps), str(amplitude)],
        capture_output=True, text=True, env=environment, check=False,
    )  # fmt: skip
    if answer.returncode:
        print(f"  {fmu.identifier} fails in the native host ({answer.returncode}): {answer.stderr[-200:].strip()}")
        return math.nan, math.nan, math.nan
    cost, ready, angle = map(float, answer.stdout.split())
    return cost, ready, angle


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--json", type=Path)
    parser.add_argument("--steps", type=int, default=4000)
    chosen = parser.parse_args()
    found: list[dict[str, Any]] = []
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        fmus = {
            f"FMU {version}": Fmu(
                export_fmu(chain(), folder / f"own{version[0]}.fmu", version, t_end=10.0, **SOLVER),
                folder,
                ("torque", *OUTPUTS),
            )
            for version in ("2.0", "3.0")
        } | peers(folder)
        for what, amplitude in (("input changes at every step", CHANGING), ("input holds", 0.0)):
            bare, once = Stepper(), Stepper()
            steppers: dict[str, StepCall] = {
                "solver": lambda u, t, h, s=bare: s.step(u, t + h),
                "in one call": lambda u, t, h, s=once: s.exchange(u, t + h),
                "slave": slave_step(),
            }
            starts = {}
            for label, fmu in fmus.items():
                steppers[label], starts[label] = fmu.stepper()
            costs = interleaved(steppers, chosen.steps, amplitude)
            print(f"\n{what}: us a step; beside the solver alone")
            for label, (cost, angle) in costs.items():
                if abs(angle - costs["solver"][1]) > 1e-9:
                    raise RuntimeError(f"{label} ends at {angle!r} rad, the solver at {costs['solver'][1]!r}")
                over = cost - costs["solver"][0]
                row: dict[str, Any] = {"case": what, "contender": label, "us": cost, "over": over}
                line = f"  {label:<12} {cost:8.1f} {over:+8.1f}"
                if label in fmus and shutil.which("cc"):
                    row["native"], row["native_start"], angle = native(fmus[label], folder, chosen.steps, amplitude)
                    line += f"   native host {row['native']:8.1f}   first step after {row['native_start']:.2f} s"
                    if abs(angle - costs["solver"][1]) > 1e-9:
                        raise RuntimeError(f"{label} ends at {angle!r} rad in the native host")
                if label in starts:
                    row["start"] = starts[label]
                    line += f"   instantiated within {1e3 * starts[label]:.0f} ms"
                print(line, flush=True)
                found.append(row)
    if chosen.json:
        chosen.json.write_text(json.dumps(found, indent=1))


if __name__ == "__main__":
    main()
