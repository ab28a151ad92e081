"""What an FMU leaves behind: memory over a million communication steps, and over a thousand instances made and freed.

Run: python benchmarks/fmu_memory.py [--json out.json] [--steps 1000000] [--instances 1000]

The functions of the binary are called without the wrappers of fmpy, which keep objects of their own. Memory is what the
process has in RAM, after a warm-up of half as many instances and a tenth of the steps; every tenth step sets a new
input, every tenth reads outputs.
"""

import one_thread  # isort: skip  # noqa: F401

import argparse
import gc
import json
import os
import tempfile
from ctypes import CDLL, CFUNCTYPE, Structure, c_char_p, c_double, c_int, c_size_t, c_uint32, c_void_p, cast
from pathlib import Path
from time import perf_counter

import fmpy
from tlismni.fmu_wrapper import export_fmu
from tlismni.models import load

STEP = 1e-5
"""s."""
Logger = CFUNCTYPE(None, c_void_p, c_char_p, c_int, c_char_p, c_char_p)


class Callbacks(Structure):
    """What a host of FMI 2.0 hands to an instance."""

    _fields_ = tuple((name, c_void_p) for name in ("logger", "allocate", "free", "finished", "environment"))


class Host:
    """The functions of a binary for FMI 2.0."""

    def __init__(self, path: Path, folder: Path) -> None:
        unzipped = fmpy.extract(str(path), unzipdir=str(folder / "unzipped"))
        description = fmpy.read_model_description(unzipped, validate=False)
        self.vr = {v.name: v.valueReference for v in description.modelVariables}
        self.token = description.guid.encode()
        self.resources = (Path(unzipped) / "resources").as_uri().encode()
        identifier = description.coSimulation.modelIdentifier
        self.dll = CDLL(str(Path(unzipped) / "binaries" / fmpy.platform / (identifier + fmpy.sharedLibraryExtension)))
        self.dll.fmi2Instantiate.restype = c_void_p
        self.logger = Logger(lambda environment, name, status, category, message: print(message.decode()))
        self.callbacks = Callbacks(cast(self.logger, c_void_p))

    def instance(self) -> c_void_p:
        """A new instance in step mode."""
        instance = c_void_p(
            self.dll.fmi2Instantiate(b"it", 1, self.token, self.resources, c_void_p(id_of(self.callbacks)), 0, 0)
        )
        check(self.dll.fmi2SetupExperiment(instance, 0, c_double(0.0), c_double(0.0), 0, c_double(0.0)))
        check(self.dll.fmi2EnterInitializationMode(instance))
        check(self.dll.fmi2ExitInitializationMode(instance))
        return instance

    def free(self, instance: c_void_p) -> None:
        """Free it."""
        self.dll.fmi2FreeInstance(instance)

    def steps(self, instance: c_void_p, first: int, last: int) -> None:
        """Steps, with inputs and outputs at every tenth."""
        dll, one, three = self.dll, c_size_t(1), c_size_t(3)
        torque = (c_uint32 * 1)(self.vr["torque"])
        outputs = (c_uint32 * 3)(*(self.vr[n] for n in ("pendulum.angle", "stop.normal_force", "energy.balance")))
        value, values, h = (c_double * 1)(), (c_double * 3)(), c_double(STEP)
        for k in range(first, last):
            if k % 10 == 0:
                value[0] = 1e-3 * (k % 7)
                check(dll.fmi2SetReal(instance, torque, one, value))
            check(dll.fmi2DoStep(instance, c_double(k * STEP), h, 1))
            if k % 10 == 5:
                check(dll.fmi2GetReal(instance, outputs, three, values))


def id_of(structure: Structure) -> int:
    """Its address."""
    from ctypes import addressof

    return addressof(structure)


def check(status: int) -> None:
    """Raises if a call was refused."""
    if status > 1:
        raise RuntimeError(f"status {status}")


def memory() -> float:
    """What this process has in RAM, kB."""
    gc.collect()
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE") / 1024.0


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--json", type=Path)
    parser.add_argument("--steps", type=int, default=1_000_000)
    parser.add_argument("--instances", type=int, default=1000)
    chosen = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        host = Host(export_fmu(load("pendulum_stop"), folder / "x.fmu", "2.0"), folder)
        warm = chosen.instances // 2
        for _ in range(warm):
            host.free(host.instance())
        before = memory()
        started = perf_counter()
        for _ in range(chosen.instances):
            host.free(host.instance())
        each = (memory() - before) / chosen.instances
        seconds = perf_counter() - started
        print(f"{chosen.instances} instances made and freed in {seconds:.0f} s: {each:.2f} kB each left behind")
        instance = host.instance()
        host.steps(instance, 0, chosen.steps // 10)
        before = memory()
        started = perf_counter()
        host.steps(instance, chosen.steps // 10, chosen.steps + chosen.steps // 10)
        growth, seconds = memory() - before, perf_counter() - started
        print(f"{chosen.steps} steps in {seconds:.0f} s ({1e6 * seconds / chosen.steps:.1f} us each): {growth:+.0f} kB")
        host.free(instance)
    if chosen.json:
        chosen.json.write_text(json.dumps({"instances_kB": each, "steps_kB": growth}, indent=1))


if __name__ == "__main__":
    main()
