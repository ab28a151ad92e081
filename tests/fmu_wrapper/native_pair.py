"""An FMU without Python beside the same with it, for tests."""

import fmpy
import numpy as np
from fmpy.fmi2 import FMU2Slave
from fmpy.fmi3 import FMU3Slave
from fmpy.validation import validate_fmu
from tlismni.fmu_wrapper import Slave, export_fmu
from tlismni.models import load

TAKE_PYTHON = ("split_wall", "four_bar")
"""Scenarios that cannot be FMUs without Python."""


class Pair:
    """An FMU without Python and the same with it."""

    def __init__(self, source, folder, version, **settings):
        self.version, self.sides = version, []
        for native in (True, False):
            path = export_fmu(source, folder / f"{native}.fmu", version, native=native, **settings)
            unzipped = fmpy.extract(str(path), unzipdir=str(folder / str(native)))
            description = fmpy.read_model_description(unzipped)
            self.sides.append((path, unzipped, description))

    def instances(self, **how):
        """One of each."""
        return [Side(self.version, unzipped, description, **how) for _, unzipped, description in self.sides]


class Side:
    """An instance, and its variables by name."""

    def __init__(self, version, unzipped, description, **how):
        self.three = version == "3.0"
        kind = FMU3Slave if self.three else FMU2Slave
        identifier = description.coSimulation.modelIdentifier
        self.fmu = kind(guid=description.guid, unzipDirectory=unzipped, modelIdentifier=identifier)
        self.fmu.instantiate(**how)
        self.event_mode = how.get("eventModeUsed", False)
        self.by_name = {v.name: v for v in description.modelVariables}
        outputs = [v for v in description.modelVariables if v.causality == "output"]
        self.reals = [v.valueReference for v in outputs if v.type in ("Real", "Float64")]
        self.wholes = [v.valueReference for v in outputs if v.type in ("Integer", "Int32")]
        self.flags = [v.valueReference for v in outputs if v.type == "Boolean"]
        self.choices = [v.valueReference for v in outputs if v.type == "Enumeration"]
        self.time = 0.0

    def begin(self, start=0.0, /, **inputs):
        if not self.three:
            self.fmu.setupExperiment(startTime=start)
        self.set(**inputs)
        if self.three:
            self.fmu.enterInitializationMode(startTime=start)
        else:
            self.fmu.enterInitializationMode()
        self.fmu.exitInitializationMode()
        self.time = start
        if self.event_mode:
            self.leave_event_mode()

    def set(self, **inputs):
        for name, value in inputs.items():
            reference = [self.by_name[name].valueReference]
            (self.fmu.setFloat64 if self.three else self.fmu.setReal)(reference, [value])

    def read(self):
        """All outputs, as what can be compared bit by bit."""
        fmu = self.fmu
        if self.three:
            parts = (fmu.getFloat64(self.reals), fmu.getInt32(self.wholes), fmu.getBoolean(self.flags),
                     fmu.getInt64(self.choices))  # fmt: skip
        else:
            parts = (fmu.getReal(self.reals), fmu.getInteger(self.wholes + self.choices), fmu.getBoolean(self.flags))
        return [np.array(part, dtype=float).tobytes() for part in parts]

    def step(self, h):
        """How the step ends."""
        if not self.three:
            self.fmu.doStep(self.time, h)
            self.time += h
            return (self.time,)
        due, terminate, early, self.time = self.fmu.doStep(self.time, h)
        return bool(due), bool(terminate), bool(early), self.time

    def leave_event_mode(self):
        seen = []
        while True:
            seen.append(bool(self.fmu.updateDiscreteStates()[0]))
            if not seen[-1]:
                break
        self.fmu.enterStepMode()
        return seen


def scenario_pair(name, folder, version, **parameters):
    scenario = load(name, **parameters)
    return Pair(scenario, folder, version, t_end=scenario.t_end)


def step_alike(sides, steps, h):
    """So many steps of both sides, which end alike and leave the same bits."""
    for _ in range(steps):
        assert sides[0].step(h) == sides[1].step(h)
        assert sides[0].read() == sides[1].read()


def steps_of_the_same_bits(model, folder, steps, step):
    """An FMU of the model beside a slave in this process: that one after each step, when both have the same bits."""
    settings = {"t_end": steps * step, "communication_step": step}
    path = export_fmu(model, folder / "python.fmu", "3.0", **settings)
    assert validate_fmu(str(path)) == []
    unzipped = fmpy.extract(str(path), unzipdir=str(folder / "python"))
    side, slave = Side("3.0", unzipped, fmpy.read_model_description(unzipped)), Slave(model, **settings)
    slave.setup()
    slave.enter_initialization()
    slave.exit_initialization()
    side.begin()
    names = [v.name for v in side.by_name.values() if v.valueReference in side.reals]
    references, time = [side.by_name[name].valueReference for name in names], 0.0
    for _ in range(steps):
        slave.do_step(time, step)
        time += step
        side.step(step)
        found = side.fmu.getFloat64(references)
        assert np.array([slave[name] for name in names]).tobytes() == np.array(found).tobytes()
        yield slave
