"""Each capability flag in modelDescription.xml against what the binary does (on the fake simulation)."""

import ctypes
import zipfile
from collections.abc import Callable

import fmpy
import pytest
from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import FMU2Slave, fmi2CallbackFunctions, fmi2CallbackLoggerTYPE
from fmpy.fmi3 import FMU3Slave
from lxml import etree
from tlismni.core.elements import CoordinateDriver, PointMass2D
from tlismni.core.model.channels import Input
from tlismni.core.model.signals import InputSignal
from tlismni.core.multibody_model import Model
from tlismni.fmu_wrapper import export_fmu


def works(call: Callable[..., object], *arguments: object) -> bool:
    """Whether a call answers OK."""
    try:
        status = call(*arguments)
    except FMICallException:
        return False
    return not isinstance(status, int) or status == 0


class Exported:
    """An FMU on disk, with its flags."""

    def __init__(self, path, folder):
        self.unzipped = fmpy.extract(str(path), unzipdir=str(folder / "unzipped"))
        self.description = fmpy.read_model_description(self.unzipped)
        with zipfile.ZipFile(path) as archive:
            interface = etree.fromstring(archive.read("modelDescription.xml")).find("CoSimulation")
        self.flags = {k: v for k, v in interface.attrib.items() if k != "modelIdentifier"}
        self.output, self.input = (
            next(
                v.valueReference
                for v in self.description.modelVariables
                if v.causality == causality and "Int" not in v.type
            )
            for causality in ("output", "input")
        )
        self.quiet = fmi2CallbackFunctions()
        self.quiet.logger = fmi2CallbackLoggerTYPE(lambda *message: None)
        self.kind = FMU2Slave if self.description.fmiVersion == "2.0" else FMU3Slave

    def instance(self, **arguments):
        fmu = self.kind(
            guid=self.description.guid, unzipDirectory=self.unzipped,
            modelIdentifier=self.description.coSimulation.modelIdentifier,
        )  # fmt: skip
        if self.kind is FMU2Slave:
            # a logger of its own: the default one is, for all FMUs of the process, what fmpy was given last
            arguments.setdefault("callbacks", self.quiet)
        fmu.instantiate(**arguments)
        return fmu

    def started(self, **arguments):
        fmu = self.instance(**arguments)
        fmu.enterInitializationMode()
        fmu.exitInitializationMode()
        if arguments.get("eventModeUsed"):
            fmu.enterStepMode()
        return fmu


def stateful(fmu, y, serialize):
    """Whether a state can be stored, also as bytes, and leads back."""
    get, put, *rest = (
        (fmu.getFMUstate, fmu.setFMUstate, fmu.serializeFMUstate, fmu.deSerializeFMUstate)
        if isinstance(fmu, FMU2Slave)
        else (fmu.getFMUState, fmu.setFMUState, fmu.serializeFMUState, fmu.deserializeFMUState)
    )
    read = fmu.getReal if isinstance(fmu, FMU2Slave) else fmu.getFloat64
    try:
        state = get()
        if serialize:
            state = rest[1](rest[0](state))
        before = read([y])
        fmu.doStep(0.0, 0.1)
        after = read([y])
        put(state)
        return read([y]) == before and before != after
    except FMICallException:
        return False


def irregular(fmu):
    return works(fmu.doStep, 0.0, 0.125) and works(fmu.doStep, 0.125, 0.01)


def order_of_outputs(get):
    """The highest order of output derivatives that can be asked, up to 4."""
    return max((order for order in range(5) if order == 0 or works(get, order)), default=0)


def asked2(exported):
    """What an FMI 2.0 FMU does, by flag."""
    new = exported.started
    fmu = new()

    def without_memory_functions():
        callbacks = fmi2CallbackFunctions()  # no logger, and nothing to get memory from
        other = exported.kind(
            guid=exported.description.guid, unzipDirectory=exported.unzipped,
            modelIdentifier=exported.description.coSimulation.modelIdentifier,
        )  # fmt: skip
        other.instantiate(callbacks=callbacks)
        return works(other.enterInitializationMode) and works(other.exitInitializationMode)

    return {
        "needsExecutionTool": True,  # a Python
        "canHandleVariableCommunicationStepSize": irregular(new()),
        "canInterpolateInputs": works(fmu.setRealInputDerivatives, [exported.input], [1], [0.0]),
        "maxOutputDerivativeOrder": order_of_outputs(
            lambda order: fmu.getRealOutputDerivatives([exported.output], [order])
        ),
        "canRunAsynchronuously": not works(new().doStep, 0.0, 0.1),
        "canBeInstantiatedOnlyOncePerProcess": not irregular(new()),
        "canNotUseMemoryManagementFunctions": without_memory_functions(),
        "canGetAndSetFMUstate": stateful(new(), exported.output, False),
        "canSerializeFMUstate": stateful(new(), exported.output, True),
        "providesDirectionalDerivative": works(
            fmu.getDirectionalDerivative, [exported.output], [exported.input], [1.0]
        ),
    }


def asked3(exported):
    """What an FMI 3.0 FMU does, by flag."""
    new = exported.started
    fmu = new()

    def updates():
        """Whether a host's callback is called during a step."""
        from fmpy.fmi3 import fmi3IntermediateUpdateCallback

        calls = []

        def heard(*arguments):
            calls.append(arguments)

        callback = fmi3IntermediateUpdateCallback(heard)
        other = new(intermediateUpdate=callback)
        other.doStep(0.0, 0.1)
        return bool(calls)

    def ends_when_asked():
        from fmpy.fmi3 import fmi3IntermediateUpdateCallback

        def ask(environment, time, set_requested, get_allowed, finished, can_return, wanted, end):
            wanted[0], end[0] = True, time

        callback = fmi3IntermediateUpdateCallback(ask)
        other = new(intermediateUpdate=callback, earlyReturnAllowed=True)
        return other.doStep(0.0, 0.1)[2]

    def returns_early():
        other = new(earlyReturnAllowed=True)
        return other.doStep(0.0, 1.5)[2]  # the ball strikes before

    def dependencies():
        count = ctypes.c_size_t()
        return works(fmu.fmi3GetNumberOfVariableDependencies, fmu.component, exported.output, ctypes.byref(count))

    def evaluates():
        other = exported.instance(eventModeUsed=True)
        other.enterInitializationMode()
        other.exitInitializationMode()
        return works(other.fmi3EvaluateDiscreteStates, other.component)

    return {
        "needsExecutionTool": True,  # a Python
        "canBeInstantiatedOnlyOncePerProcess": not irregular(new()),
        "canGetAndSetFMUState": stateful(new(), exported.output, False),
        "canSerializeFMUState": stateful(new(), exported.output, True),
        "providesPerElementDependencies": dependencies(),
        "canHandleVariableCommunicationStepSize": irregular(new()),
        "maxOutputDerivativeOrder": order_of_outputs(
            lambda order: fmu.getOutputDerivatives([exported.output], [order])
        ),
        "providesIntermediateUpdate": updates(),
        "mightReturnEarlyFromDoStep": returns_early(),
        "canReturnEarlyAfterIntermediateUpdate": ends_when_asked(),
        "hasEventMode": works(lambda: new(eventModeUsed=True)),
        "providesEvaluateDiscreteStates": evaluates(),
        "providesDirectionalDerivatives": works(
            fmu.getDirectionalDerivative, [exported.output], [exported.input], [1.0]
        ),
        "providesAdjointDerivatives": works(fmu.getAdjointDerivative, [exported.output], [exported.input], [1.0], 1),
    }


def truth(text):
    return {"true": True, "false": False}.get(text) if not text.isdigit() else int(text)


@pytest.mark.parametrize(("version", "asked"), [("2.0", asked2), ("3.0", asked3)])
def test_flags_are_true_to_behaviour(fake_fmu, tmp_path, version, asked):
    exported = Exported(fake_fmu(fmi_version=version), tmp_path)
    found = asked(exported)
    claimed = {name: truth(text) for name, text in exported.flags.items() if found.get(name, False) is not None}
    assert claimed == {name: value for name, value in found.items() if value is not None}


@pytest.mark.parametrize(("version", "asked"), [("2.0", asked2), ("3.0", asked3)])
def test_derivatives_with_respect_to_a_motion(tmp_path, version, asked):
    """The flags say yes, and there are some: zero, since the next step meets the motion."""
    model = Model(
        name="driven",
        bodies=[PointMass2D(name="cart", mass=1.0)],
        joints=[CoordinateDriver(name="motor", body="cart", coordinate="x", motion=InputSignal(channel="u"))],
        inputs=[Input(name="u", unit="m")],
    )
    exported = Exported(export_fmu(model, tmp_path / "d.fmu", version, t_end=2.0), tmp_path)
    fmu = exported.started()
    names = [name for name in exported.flags if name.startswith(("providesDirectional", "providesAdjoint"))]
    assert names
    call = fmu.getDirectionalDerivative
    assert {truth(exported.flags[name]) for name in names} == {works(call, [exported.output], [exported.input], [1.0])}
