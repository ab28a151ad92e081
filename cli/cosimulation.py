"""An FMU driven by fmpy beside the same slave in process, on one grid of communication points."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..core import simulate
from ..fmu_wrapper import Slave
from ..models import Scenario
from .errors import Failure

GETTERS = {
    "2.0": {"Real": "getReal", "Integer": "getInteger", "Enumeration": "getInteger", "Boolean": "getBoolean"},
    "3.0": {"Float64": "getFloat64", "Int32": "getInt32", "Enumeration": "getInt64", "Boolean": "getBoolean"},
}
"""By FMI version and type of variable, fmpy's method that asks for values."""
SHORTEST, LONGEST = 0.2, 1.8
"""Bounds of irregular communication steps, as multiples of the nominal one."""

Columns = dict[str, NDArray[np.float64]]


@dataclass(frozen=True)
class Comparison:
    """FMU and slave, value by value.

    Attributes
    ----------
    times : communication points, s.
    fmu, slave : all outputs at these points, by name.
    different : names of the outputs that are not bit for bit the same; `first` the time and name of the first.
    uninterrupted : outputs of one run without communication points, at the same times; by name.
    units : of the channels, by name.
    """

    times: NDArray[np.float64]
    fmu: Columns
    slave: Columns
    different: tuple[str, ...]
    first: tuple[float, str] | None
    uninterrupted: Columns
    units: dict[str, str]

    @property
    def identical(self) -> bool:
        return not self.different

    @property
    def values(self) -> int:
        """How many numbers were compared."""
        return len(self.times) * len(self.fmu)


def communication_points(t_end: float, step: float, irregular: bool) -> NDArray[np.float64]:
    """Communication points from 0 to `t_end`, s; irregular ones are drawn, the same in every run."""
    if not irregular:
        count = max(int(np.ceil(t_end / step * (1.0 - 1e-12))), 1)
        return np.append(np.arange(count) * step, t_end)
    steps = np.random.default_rng(0).uniform(SHORTEST * step, LONGEST * step, int(2.0 * t_end / step) + 20)
    inner = np.cumsum(steps)
    return np.concatenate([[0.0], inner[inner < t_end * (1.0 - 1e-9)], [t_end]])


def compare(
    scenario: Scenario, fmu: Path, unzipped: Path, times: NDArray[np.float64], say: Callable[[str], None]
) -> Comparison:
    """Drive `fmu` and a slave of `scenario` over `times`, and one run without communication points."""
    say(f"driving the FMU with fmpy over {len(times) - 1} communication steps")
    outer = drive_fmu(fmu, unzipped, times)
    say("driving the slave in process")
    inner = drive_slave(scenario, times, list(outer))
    say("running without communication points")
    free = simulate(
        scenario.model, scenario.t_end, scenario.method, scenario.rtol, scenario.atol, t_eval=times, **scenario.options
    )
    unequal = {name: _unequal(outer[name], inner[name]) for name in outer}
    different = tuple(name for name, places in unequal.items() if places.any())
    first = min(((float(times[np.argmax(unequal[name])]), name) for name in different), default=None)
    uninterrupted = {name: free[name] for name in scenario.compare if name in outer}
    units = {channel.name: channel.unit for channel in free.channel_records}
    return Comparison(times, outer, inner, different, first, uninterrupted, units)


def _unequal(a: NDArray[np.float64], b: NDArray[np.float64]) -> NDArray[np.bool_]:
    """True where the bits differ (so -0.0 is not 0.0, and a NaN equals itself)."""
    return a.view(np.int64) != b.view(np.int64)


def drive_slave(scenario: Scenario, times: NDArray[np.float64], names: list[str]) -> Columns:
    """The outputs `names` of a slave in this process at the communication points."""
    slave = Slave(scenario)
    slave.setup(stop_time=float(times[-1]))
    slave.enter_initialization()
    slave.exit_initialization()
    rows = [[float(slave[name]) for name in names]]
    for t, h in zip(times[:-1], np.diff(times), strict=True):
        slave.do_step(float(t), float(h))
        rows.append([float(slave[name]) for name in names])
    return _columns(names, rows)


def drive_fmu(fmu: Path, unzipped: Path, times: NDArray[np.float64]) -> Columns:
    """All outputs of an FMU at the communication points, driven by fmpy through its binary.

    Raises
    ------
    Failure : if a call fails, with the FMU's own message.
    """
    import fmpy

    from ..fmu_wrapper.master.listening import instantiate

    description = fmpy.read_model_description(str(fmu))
    fmpy.extract(str(fmu), unzipdir=str(unzipped))
    messages: list[str] = []
    getters = GETTERS[description.fmiVersion]
    outputs = [v for v in description.modelVariables if v.causality == "output" and v.type in getters]
    experiment = {"startTime": float(times[0]), "stopTime": float(times[-1])}
    try:
        instance = instantiate(str(unzipped), description, messages.append)
        try:
            if description.fmiVersion == "2.0":
                instance.setupExperiment(**experiment)
                instance.enterInitializationMode()
            else:
                instance.enterInitializationMode(**experiment)
            instance.exitInitializationMode()
            rows = [_read(instance, outputs, getters)]
            for t, h in zip(times[:-1], np.diff(times), strict=True):
                instance.doStep(currentCommunicationPoint=float(t), communicationStepSize=float(h))
                rows.append(_read(instance, outputs, getters))
            instance.terminate()
        finally:
            instance.freeInstance()
    except Exception as error:
        # fmpy says which call failed, the FMU says why
        raise Failure(f"FMU '{fmu.name}': {messages[-1] if messages else error}") from error
    return _columns([v.name for v in outputs], rows)


def _read(instance: Any, outputs: list[Any], getters: dict[str, str]) -> list[float]:
    values: dict[str, float] = {}
    for kind, getter in getters.items():
        of_kind = [v for v in outputs if v.type == kind]
        if of_kind:
            found = getattr(instance, getter)([v.valueReference for v in of_kind])
            values.update((v.name, float(x)) for v, x in zip(of_kind, found, strict=True))
    return [values[v.name] for v in outputs]


def _columns(names: list[str], rows: list[list[float]]) -> Columns:
    table = np.array(rows)
    return {name: np.ascontiguousarray(table[:, k]) for k, name in enumerate(names)}
