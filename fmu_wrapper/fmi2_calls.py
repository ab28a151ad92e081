"""The calls of FMI 2.0 co-simulation, named as in the standard, for the C shim and for fmpy in process.

Arrays come as buffers and counts are left out: `fmi2GetReal(c, vr, nvr, value)` is `fmi2GetReal(vr, value)`.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np

from .calls import Calls, fmi_call, given, numbers_in, references_in, texts_in
from .errors import DiscardError, UnavailableError
from .variables import Kind

LAST_SUCCESSFUL_TIME, TERMINATED = 2, 3  # fmi2StatusKind


class Fmi2Calls(Calls):
    """FMI 2.0 calls of one instance. Each answers with a status unless its text says otherwise."""

    get_name, step_name = "fmi2GetReal", "fmi2DoStep"

    @fmi_call()
    def fmi2SetDebugLogging(self, on: int, categories: Sequence[bytes]) -> None:
        """Turn logging on or off, for some categories or (none given) all."""
        self.slave.log.choose(bool(on), texts_in(categories, "a log category"))

    @fmi_call()
    def fmi2SetupExperiment(
        self, tolerance_defined: int, tolerance: float, start: float, stop_defined: int, stop: float
    ) -> None:
        """Times and tolerance of the experiment."""
        self.slave.setup(start, stop if stop_defined else None, tolerance if tolerance_defined else None)

    @fmi_call()
    def fmi2EnterInitializationMode(self) -> None:
        """Enter initialization mode."""
        self.slave.enter_initialization()

    @fmi_call()
    def fmi2ExitInitializationMode(self) -> None:
        """Leave initialization mode for step mode."""
        self.slave.exit_initialization()

    @fmi_call()
    def fmi2Terminate(self) -> None:
        """End the run."""
        self.slave.terminate()

    @fmi_call()
    def fmi2Reset(self) -> None:
        """Back to a new instance; stored states stay."""
        self.slave.reset()

    @fmi_call()
    def fmi2DoStep(self, t: float, h: float) -> None:
        """One communication step."""
        self.slave.do_step(t, h)

    @fmi_call()
    def fmi2CancelStep(self) -> None:
        """Refused: steps never run in the background."""
        raise UnavailableError("steps never run in the background (canRunAsynchronuously = false)")

    # values

    def _get(self, kind: Kind, vr: Any, value: Any, dtype: Any) -> None:
        numbers_in(value, dtype)[:] = self.slave.get(kind, references_in(vr))

    @fmi_call()
    def fmi2GetReal(self, vr: Any, value: Any) -> None:
        """Real values into the buffer `value`."""
        self._get("real", vr, value, np.float64)

    @fmi_call()
    def fmi2GetInteger(self, vr: Any, value: Any) -> None:
        """Integer values into the buffer `value`."""
        self._get("integer", vr, value, np.int32)

    @fmi_call()
    def fmi2GetBoolean(self, vr: Any, value: Any) -> None:
        """Boolean values, as int, into the buffer `value`."""
        self._get("boolean", vr, value, np.int32)

    @fmi_call(on_error=None)
    def fmi2GetString(self, vr: Any) -> list[bytes]:
        """Answers with the strings, or None after an error."""
        return [text.encode() for text in self.slave.get("string", references_in(vr))]

    @fmi_call()
    def fmi2SetReal(self, vr: Any, value: Any) -> None:
        """Set Real variables."""
        self.slave.set("real", references_in(vr), numbers_in(value, np.float64))

    @fmi_call()
    def fmi2SetInteger(self, vr: Any, value: Any) -> None:
        """Set Integer variables."""
        self.slave.set("integer", references_in(vr), numbers_in(value, np.int32))

    @fmi_call()
    def fmi2SetBoolean(self, vr: Any, value: Any) -> None:
        """Set Boolean variables, given as int."""
        self.slave.set("boolean", references_in(vr), numbers_in(value, np.int32) != 0)

    @fmi_call()
    def fmi2SetString(self, vr: Any, value: Sequence[bytes | None]) -> None:
        """Set String variables."""
        self.slave.set("string", references_in(vr), texts_in(value, "a string value"))

    # state

    @fmi_call(on_error=0)
    def fmi2GetFMUstate(self, handle: int) -> int:
        """Answers with the handle of the stored state, or 0 after an error."""
        return self.keep(self.slave.snapshot(), handle)

    @fmi_call()
    def fmi2SetFMUstate(self, handle: int) -> None:
        """Take over a stored state."""
        self.slave.restore(self.kept(handle))

    @fmi_call()
    def fmi2FreeFMUstate(self, handle: int) -> None:
        """Forget a stored state; 0 is allowed."""
        self.drop(handle)

    @fmi_call(on_error=-1)
    def fmi2SerializedFMUstateSize(self, handle: int) -> int:
        """Answers with the number of bytes, or -1 after an error."""
        return len(self.kept(handle).data)

    @fmi_call()
    def fmi2SerializeFMUstate(self, handle: int, buffer: Any) -> None:
        """Write a stored state's bytes into `buffer`."""
        self.write_state(handle, buffer)

    @fmi_call(on_error=0)
    def fmi2DeSerializeFMUstate(self, buffer: Any, handle: int) -> int:
        """Answers with the handle of the stored state made from bytes, or 0 after an error."""
        return self.keep(self.slave.snapshot_from_bytes(bytes(given(buffer, "the bytes"))), handle)

    @fmi_call()
    def fmi2GetDirectionalDerivative(self, unknowns: Any, knowns: Any, seed: Any, sensitivity: Any) -> None:
        """Derivatives of outputs along a direction of inputs, into the buffer `sensitivity`."""
        self.directional_derivative(unknowns, knowns, seed, sensitivity)

    @fmi_call()
    def fmi2SetRealInputDerivatives(self, vr: Any, order: Any, value: Any) -> None:
        """Time derivatives with which inputs go on from the present time."""
        self.slave.set_input_derivatives(
            references_in(vr), numbers_in(order, np.int32).tolist(), numbers_in(value, np.float64).tolist()
        )

    @fmi_call()
    def fmi2GetRealOutputDerivatives(self, vr: Any, order: Any, value: Any) -> None:
        """Time derivatives of outputs at the present time, into the buffer `value`."""
        self.output_derivatives(vr, order, value)

    # status

    def _no_status(self, kind: int) -> DiscardError:
        return DiscardError(f"status kind {kind} is not available: steps are never asynchronous")

    @fmi_call()
    def fmi2GetStatus(self, kind: int, value: Any) -> None:
        """Discard: there is no asynchronous step."""
        raise self._no_status(kind)

    @fmi_call()
    def fmi2GetRealStatus(self, kind: int, value: Any) -> None:
        """The last successful time, s."""
        if kind != LAST_SUCCESSFUL_TIME:
            raise self._no_status(kind)
        numbers_in(value, np.float64)[0] = self.slave.time

    @fmi_call()
    def fmi2GetIntegerStatus(self, kind: int, value: Any) -> None:
        """Discard: FMI 2.0 defines no integer status."""
        raise self._no_status(kind)

    @fmi_call()
    def fmi2GetBooleanStatus(self, kind: int, value: Any) -> None:
        """Whether the slave wants to end the run: never."""
        if kind != TERMINATED:
            raise self._no_status(kind)
        numbers_in(value, np.int32)[0] = 0

    @fmi_call()
    def fmi2GetStringStatus(self, kind: int) -> None:
        """Discard: there is no asynchronous step."""
        raise self._no_status(kind)
