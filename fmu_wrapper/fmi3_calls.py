"""The calls of FMI 3.0 co-simulation, named as in the standard, for the C shim and for fmpy in process.

Arrays come as buffers and counts are left out: `fmi3GetFloat64(c, vr, nvr, value, n)` is `fmi3GetFloat64(vr, value)`;
what a call gives back through pointers comes as buffers of length 1.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np

from .calls import Calls, fmi_call, given, numbers_in, put, references_in, texts_in
from .errors import FmuValueError, UnavailableError
from .variables import Kind

NO_TYPE = (
    "this FMU has no variables of this type: its variables are of type Float64, Int32, Boolean, String and Enumeration"
)
NO_CLOCKS = "this FMU has no clocks"
NO_STRUCTURE = "this FMU has no structural parameters, and no dependencies per element"
NO_MODEL_EXCHANGE = "this FMU does co-simulation only"

_TYPES = ("Float32", "Int8", "UInt8", "Int16", "UInt16", "UInt32", "UInt64", "Binary")
_CLOCKS = (
    "GetClock", "SetClock", "GetIntervalDecimal", "GetIntervalFraction", "GetShiftDecimal", "GetShiftFraction",
    "SetIntervalDecimal", "SetIntervalFraction", "SetShiftDecimal", "SetShiftFraction", "ActivateModelPartition",
)  # fmt: skip
_STRUCTURE = (
    "EnterConfigurationMode", "ExitConfigurationMode", "GetNumberOfVariableDependencies", "GetVariableDependencies",
)  # fmt: skip
_MODEL_EXCHANGE = (
    "EnterContinuousTimeMode", "CompletedIntegratorStep", "SetTime", "SetContinuousStates",
    "GetContinuousStateDerivatives", "GetEventIndicators", "GetContinuousStates", "GetNominalsOfContinuousStates",
    "GetNumberOfEventIndicators", "GetNumberOfContinuousStates",
)  # fmt: skip

REFUSED: dict[str, str] = {
    **{f"fmi3{way}{name}": NO_TYPE for name in _TYPES for way in ("Get", "Set")},
    **{f"fmi3{name}": NO_CLOCKS for name in _CLOCKS},
    **{f"fmi3{name}": NO_STRUCTURE for name in _STRUCTURE},
    **{f"fmi3{name}": NO_MODEL_EXCHANGE for name in _MODEL_EXCHANGE},
    "fmi3EvaluateDiscreteStates": "providesEvaluateDiscreteStates = false: use fmi3UpdateDiscreteStates",
}
"""Functions that this FMU has not, and why."""


class Fmi3Calls(Calls):
    """FMI 3.0 calls of one instance. Each answers with a status unless its text says otherwise."""

    token_name = "instantiation token"
    get_name, step_name = "fmi3GetFloat64", "fmi3DoStep"

    def refuse(self, function: str) -> int:
        """Answer a function that this FMU has not."""
        return int(self.report(function, UnavailableError(REFUSED[function])))

    @fmi_call()
    def fmi3SetDebugLogging(self, on: int, categories: Sequence[bytes]) -> None:
        """Turn logging on or off, for some categories or (none given) all."""
        self.slave.log.choose(bool(on), texts_in(categories, "a log category"))

    @fmi_call()
    def fmi3EnterInitializationMode(
        self, tolerance_defined: int, tolerance: float, start: float, stop_defined: int, stop: float
    ) -> None:
        """Enter initialization mode, with times and tolerance of the experiment."""
        self.slave.setup(start, stop if stop_defined else None, tolerance if tolerance_defined else None)
        self.slave.enter_initialization()

    @fmi_call()
    def fmi3ExitInitializationMode(self) -> None:
        """Leave initialization mode for step mode or, with event mode, for that."""
        self.slave.exit_initialization()

    @fmi_call()
    def fmi3Terminate(self) -> None:
        """End the run."""
        self.slave.terminate()

    @fmi_call()
    def fmi3Reset(self) -> None:
        """Back to a new instance; stored states stay."""
        self.slave.reset()

    # steps and events

    @fmi_call()
    def fmi3DoStep(self, t: float, h: float, event_due: Any, terminate: Any, early: Any, last_time: Any) -> None:
        """One communication step; an event in it may end it, as the instance was made."""
        for flag in (event_due, terminate, early):
            put(flag, "?", False)
        put(last_time, "d", self.slave.time)
        end = self.slave.do_step(t, h)
        put(event_due, "?", end.event_due)
        put(early, "?", end.early)
        put(last_time, "d", end.time)

    @fmi_call()
    def fmi3EnterEventMode(self) -> None:
        """Enter event mode."""
        self.slave.enter_event_mode()

    @fmi_call()
    def fmi3UpdateDiscreteStates(
        self, again: Any, terminate: Any, nominals: Any, values: Any, next_defined: Any, next_time: Any
    ) -> None:
        """Let the event at the present time happen. The next one is not known before it comes."""
        for flag in (again, terminate, nominals, values, next_defined):
            numbers_in(flag, np.bool_)[:] = False
        numbers_in(next_time, float)[:] = 0.0
        numbers_in(again, np.bool_)[:] = self.slave.update_discrete_states()

    @fmi_call()
    def fmi3EnterStepMode(self) -> None:
        """Leave event mode for step mode."""
        self.slave.enter_step_mode()

    # values

    def _get(self, kind: Kind, vr: Any, value: Any, dtype: Any) -> None:
        references, room = references_in(vr), numbers_in(value, dtype)
        self.check_room(room, "values", kind, references, "scalar variables")
        room[:] = self.slave.get(kind, references)

    def _check_type(self, vr: Any, enumerations: bool) -> None:
        """Refuse Int32 variables among enumerations, and the other way round: their functions differ."""
        plan = self.slave.variables.plan("integer", references_in(vr))
        if (not enumerations) in plan.enumerations:
            names = [v.name for v in plan.variables if (v.enumeration is not None) != enumerations]
            own = "Int32, not enumerations: use the functions for Int32" if enumerations else "enumerations: use Int64"
            raise FmuValueError(f"{names} are {own}")

    @fmi_call()
    def fmi3GetFloat64(self, vr: Any, value: Any) -> None:
        """Float64 values into the buffer `value`."""
        self._get("real", vr, value, np.float64)

    @fmi_call()
    def fmi3GetInt32(self, vr: Any, value: Any) -> None:
        """Int32 values into the buffer `value`."""
        self._check_type(vr, False)
        self._get("integer", vr, value, np.int32)

    @fmi_call()
    def fmi3GetInt64(self, vr: Any, value: Any) -> None:
        """Values of enumerations into the buffer `value`."""
        self._check_type(vr, True)
        self._get("integer", vr, value, np.int64)

    @fmi_call()
    def fmi3GetBoolean(self, vr: Any, value: Any) -> None:
        """Boolean values into the buffer `value`."""
        self._get("boolean", vr, value, np.bool_)

    @fmi_call(on_error=None)
    def fmi3GetString(self, vr: Any) -> list[bytes]:
        """Answers with the strings, or None after an error."""
        return [text.encode() for text in self.slave.get("string", references_in(vr))]

    @fmi_call()
    def fmi3SetFloat64(self, vr: Any, value: Any) -> None:
        """Set Float64 variables."""
        self.slave.set("real", references_in(vr), numbers_in(value, np.float64))

    @fmi_call()
    def fmi3SetInt32(self, vr: Any, value: Any) -> None:
        """Set Int32 variables."""
        self._check_type(vr, False)
        self.slave.set("integer", references_in(vr), numbers_in(value, np.int32))

    @fmi_call()
    def fmi3SetInt64(self, vr: Any, value: Any) -> None:
        """Set enumerations."""
        self._check_type(vr, True)
        self.slave.set("integer", references_in(vr), numbers_in(value, np.int64))

    @fmi_call()
    def fmi3SetBoolean(self, vr: Any, value: Any) -> None:
        """Set Boolean variables."""
        self.slave.set("boolean", references_in(vr), numbers_in(value, np.bool_))

    @fmi_call()
    def fmi3SetString(self, vr: Any, value: Sequence[bytes | None]) -> None:
        """Set String variables."""
        self.slave.set("string", references_in(vr), texts_in(value, "a string value"))

    @fmi_call()
    def fmi3GetDirectionalDerivative(self, unknowns: Any, knowns: Any, seed: Any, sensitivity: Any) -> None:
        """Derivatives of outputs along a direction of inputs, into the buffer `sensitivity`."""
        self.directional_derivative(unknowns, knowns, seed, sensitivity)

    @fmi_call()
    def fmi3GetOutputDerivatives(self, vr: Any, order: Any, value: Any) -> None:
        """Time derivatives of outputs at the present time, into the buffer `value`."""
        self.output_derivatives(vr, order, value)

    @fmi_call()
    def fmi3GetAdjointDerivative(self, unknowns: Any, knowns: Any, seed: Any, sensitivity: Any) -> None:
        """Derivatives with respect to each input of the outputs' sum with weights `seed`, into `sensitivity`."""
        outputs, inputs = references_in(unknowns), references_in(knowns)
        weights, room = numbers_in(seed, np.float64), numbers_in(sensitivity, np.float64)
        unknown = len(self.slave.variables.plan("real", outputs).variables)  # an array has several
        if len(weights) != unknown or len(room) != len(inputs):
            raise FmuValueError(
                f"a seed of {len(weights)} numbers and room for {len(room)} sensitivities were given for "
                f"{unknown} unknowns and {len(inputs)} knowns"
            )
        room[:] = [
            weights @ self.slave.directional_derivative(outputs, inputs[i : i + 1], np.ones(1))
            for i in range(len(room))
        ]

    # state

    @fmi_call(on_error=0)
    def fmi3GetFMUState(self, handle: int) -> int:
        """Answers with the handle of the stored state, or 0 after an error."""
        return self.keep(self.slave.snapshot(), handle)

    @fmi_call()
    def fmi3SetFMUState(self, handle: int) -> None:
        """Take over a stored state."""
        self.slave.restore(self.kept(handle))

    @fmi_call()
    def fmi3FreeFMUState(self, handle: int) -> None:
        """Forget a stored state; 0 is allowed."""
        self.drop(handle)

    @fmi_call(on_error=-1)
    def fmi3SerializedFMUStateSize(self, handle: int) -> int:
        """Answers with the number of bytes, or -1 after an error."""
        return len(self.kept(handle).data)

    @fmi_call()
    def fmi3SerializeFMUState(self, handle: int, buffer: Any) -> None:
        """Write a stored state's bytes into `buffer`."""
        self.write_state(handle, buffer)

    @fmi_call(on_error=0)
    def fmi3DeserializeFMUState(self, buffer: Any, handle: int) -> int:
        """Answers with the handle of the stored state made from bytes, or 0 after an error."""
        return self.keep(self.slave.snapshot_from_bytes(bytes(given(buffer, "the bytes"))), handle)
