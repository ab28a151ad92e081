"""What a fine communication grid costs: an FMU of a chain stepped once in each natural step of the solver, a hundred
times in each, and a hundred times with an input that changes at every tenth point.

Run: python benchmarks/fmu_grid.py [--json out.json] [--links 1 10 100]

The FMU's binary, called from a loop in C (`fmu_peers/grid.c`; wants a C compiler): a call from Python costs more than a
step that only moves the clock. Times are CPU time, the best of several runs from one stored state. "asked" reads two
outputs at every point, the others at every natural step. Results are compared at the end: on both grids with each
other, with the changing input against a run of the solver alone at a thousandth of the tolerance.
"""

import one_thread  # isort: skip  # noqa: F401

import argparse
import json
import math
import subprocess
import sys
import tempfile
from ctypes import CDLL, Structure, byref, c_double, c_long, c_uint32, c_void_p, cast
from dataclasses import asdict, dataclass
from pathlib import Path

import fmpy
from fmpy.fmi2 import FMU2Slave
from tlismni.core import Simulation
from tlismni.fmu_wrapper import export_fmu

sys.path.insert(0, str(Path(__file__).parent / "fmu_peers"))

from case import OUTPUTS, chain

FINE = 100
"""Points in a natural step."""
CHANGE = 10
"""Points between two changes of the input."""
SPAN = 0.25
"""s."""
TOLERANCE = 1e-6
REPEATS = 5


@dataclass(frozen=True)
class Row:
    """CPU times, s, and angles of the first link at the end, rad."""

    method: str
    links: int
    natural_steps: int
    coarse: float
    fine: float
    asked: float
    changing: float
    difference: float
    error: float

    def __str__(self) -> str:
        ratios = "".join(f"{x / self.coarse:9.2f}" for x in (self.fine, self.asked, self.changing))
        return (
            f"{self.method:<6}{self.links:>6}{self.natural_steps:>8}{1e6 * self.coarse / self.natural_steps:>11.0f}"
            f"{ratios}{self.difference:>13.1e}{self.error:>11.1e}"
        )


class Master(Structure):
    """What the loop in C works on."""

    _fields_ = (
        ("component", c_void_p), ("do_step", c_void_p), ("get", c_void_p), ("set", c_void_p),
        ("input", c_uint32), ("outputs", c_uint32 * len(OUTPUTS)),
    )  # fmt: skip


def compiled_loop(folder: Path) -> CDLL:
    """The loop in C."""
    source, library = Path(__file__).parent / "fmu_peers" / "grid.c", folder / "grid.so"
    subprocess.run(["cc", "-O2", "-shared", "-fPIC", str(source), "-o", str(library), "-lm"], check=True)
    loop = CDLL(str(library))
    loop.run.restype = loop.torque.restype = c_double
    loop.torque.argtypes = [c_double]
    loop.run.argtypes = [c_void_p, c_long, c_double, c_long, c_long, c_void_p]
    return loop


class Instance:
    """An FMU 2.0 instance, with the calls that a master makes at every step."""

    def __init__(self, unzipped: str, loop: CDLL) -> None:
        description = fmpy.read_model_description(unzipped, validate=False)
        references = {v.name: v.valueReference for v in description.modelVariables}
        self.fmu = FMU2Slave(
            guid=description.guid, unzipDirectory=unzipped, modelIdentifier=description.coSimulation.modelIdentifier
        )
        self.fmu.instantiate()
        self.fmu.setupExperiment()
        self.fmu.enterInitializationMode()
        self.fmu.exitInitializationMode()
        functions = (self.fmu.dll.fmi2DoStep, self.fmu.dll.fmi2GetReal, self.fmu.dll.fmi2SetReal)
        self.master = Master(
            self.fmu.component, *(cast(f, c_void_p) for f in functions), references["torque"],
            (c_uint32 * len(OUTPUTS))(*(references[name] for name in OUTPUTS)),
        )  # fmt: skip
        self.loop, self.values = loop, (c_double * len(OUTPUTS))()
        self.start = self.fmu.getFMUState()

    def run(self, points: int, ask: int, change: int) -> tuple[float, float]:
        """CPU time, s, and last angle, rad, of a run over SPAN with so many points; outputs are read at every `ask`-th,
        the input is set at every `change`-th (0: never)."""
        self.fmu.setFMUState(self.start)
        seconds = self.loop.run(byref(self.master), points, SPAN / points, ask, change, self.values)
        if seconds < 0.0:
            raise RuntimeError("a call of the FMU failed: its log says why")
        return seconds, float(self.values[0])


def alone(links: int, method: str, points: int, loop: CDLL) -> float:
    """Last angle, rad, with the changing input, by the solver alone at a tolerance a thousand times finer."""
    simulation, h = Simulation(chain(links), method, rtol=1e-3 * TOLERANCE, atol=1e-12), SPAN / points
    for k in range(0, points, CHANGE):
        simulation.set_inputs({"torque": loop.torque(k * h)})
        simulation.advance(min(k + CHANGE, points) * h)
    column = [c.name for c in simulation.channels].index(OUTPUTS[0])
    return float(simulation.values()[column])


def measure(method: str, links: int, folder: Path, loop: CDLL) -> Row:
    """One line of the table."""
    plain = Simulation(chain(links), method, rtol=TOLERANCE)
    plain.advance(SPAN)
    natural = int(plain.stats["steps"])
    path = export_fmu(chain(links), folder / f"{method}{links}.fmu", t_end=10.0, method=method, rtol=TOLERANCE)
    instance = Instance(fmpy.extract(str(path), unzipdir=str(folder / path.stem)), loop)
    runs = {
        "coarse": (natural, 1, 0),
        "fine": (FINE * natural, FINE, 0),
        "asked": (FINE * natural, 1, 0),
        "changing": (FINE * natural, FINE, CHANGE),
    }
    times, angles = dict.fromkeys(runs, math.inf), {}
    for _ in range(REPEATS):
        for name, run in runs.items():
            seconds, angles[name] = instance.run(*run)
            times[name] = min(times[name], seconds)
    reference = alone(links, method, FINE * natural, loop)
    difference, error = abs(angles["fine"] - angles["coarse"]), abs(angles["changing"] - reference)
    return Row(method, links, natural, **times, difference=difference, error=error)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--json", type=Path)
    parser.add_argument("--links", type=int, nargs="+", default=[1, 10, 100])
    chosen = parser.parse_args()
    print("method links   steps  us a step     fine    asked changing   difference      error")
    rows = []
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        loop = compiled_loop(folder)
        for method in ("ebdf", "irk"):
            for links in chosen.links:
                rows.append(measure(method, links, folder, loop))
                print(rows[-1], flush=True)
    if chosen.json:
        chosen.json.write_text(json.dumps([asdict(row) for row in rows], indent=1))


if __name__ == "__main__":
    main()
