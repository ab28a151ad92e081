"""A slave as an FMI 3.0 instance of fmpy, without a binary: for masters written with fmpy, and for debugging.

    unzipped = fmpy.extract("ball.fmu")
    instance = InProcess3.of(unzipped, event_mode=True, early_return=True)
    result = fmpy.simulate_fmu(
        unzipped, fmu_instance=instance, fmi_type="CoSimulation", use_event_mode=True, early_return_allowed=True
    )

`fmi_type` must be given: fmpy finds out the type by comparing classes, and this is a subclass.
"""

from collections.abc import Sequence
from ctypes import addressof, c_uint8
from typing import Any

from .errors import FmuValueError
from .fmi3_calls import REFUSED, Fmi3Calls
from .in_process_base import Direct, FMU3Slave


def _buffer(pointer: Any, size: Any) -> Any:
    """The bytes behind a pointer, as a buffer that writes through."""
    count = int(getattr(size, "value", size))
    return (c_uint8 * count).from_address(addressof(pointer.contents)) if count else b""


class InProcess3(Direct, FMU3Slave):
    """An FMI 3.0 instance of fmpy whose calls go straight to a slave.

    Errors raise fmpy's FMICallException with the slave's message as a note.
    """

    calls = Fmi3Calls

    # where a call into C differs from `Fmi3Calls`: counts, pointers, strings

    def _adapted(self, fname: str) -> Any:
        if fname in REFUSED:
            return lambda *arguments: self._fmi.refuse(fname)
        if fname in ("fmi3GetDirectionalDerivative", "fmi3GetAdjointDerivative"):
            return lambda *arguments: getattr(self._fmi, fname)(*arguments[::2])  # without the counts
        if fname == "fmi3GetOutputDerivatives":
            return lambda vr, count, order, value, values: self._fmi.fmi3GetOutputDerivatives(vr, order, value)
        if fname.startswith(("fmi3Get", "fmi3Set")):
            return lambda vr, count, value, values: getattr(self._fmi, fname)(vr, value)
        return None

    def _fmi3GetVersion(self) -> Any:
        return b"3.0"

    def getVersion(self) -> str:
        """Version of the standard."""
        return "3.0"

    def _fmi3SetDebugLogging(self, on: Any, count: int, categories: Sequence[bytes]) -> int:
        return int(self._fmi.fmi3SetDebugLogging(on.value, list(categories)[:count]))

    def _fmi3EnterInitializationMode(
        self, tolerance_defined: Any, tolerance: float, start: float, stop_defined: Any, stop: float
    ) -> int:
        flags = bool(tolerance_defined), bool(stop_defined)
        return int(self._fmi.fmi3EnterInitializationMode(flags[0], tolerance, start, flags[1], stop))

    def _fmi3DoStep(self, t: float, h: float, no_set_state: Any, *answers: Any) -> int:
        return int(self._fmi.fmi3DoStep(t, h, *(_one(answer) for answer in answers)))

    def _fmi3UpdateDiscreteStates(self, *answers: Any) -> int:
        return int(self._fmi.fmi3UpdateDiscreteStates(*(_one(answer) for answer in answers)))

    def _fmi3GetString(self, vr: Any, count: int, value: Any, values: int) -> int:
        if count != values:
            error = FmuValueError(f"room for {values} values was given for {count} scalar variables")
            return int(self._fmi.report("fmi3GetString", error))
        return self._get_strings(self._fmi.fmi3GetString, vr, value)

    def _fmi3SetString(self, vr: Any, count: int, value: Any, values: int) -> int:
        return int(self._fmi.fmi3SetString(vr, list(value)))

    def _fmi3GetFMUState(self, state: Any) -> int:
        return self._new_handle(state, self._fmi.fmi3GetFMUState(state._obj.value or 0))

    def _fmi3SetFMUState(self, state: Any) -> int:
        return int(self._fmi.fmi3SetFMUState(state.value or 0))

    def _fmi3FreeFMUState(self, state: Any) -> int:
        return self._free(self._fmi.fmi3FreeFMUState, state)

    def _fmi3SerializedFMUStateSize(self, state: Any, size: Any) -> int:
        return self._size(self._fmi.fmi3SerializedFMUStateSize, state, size)

    def _fmi3SerializeFMUState(self, state: Any, pointer: Any, size: Any) -> int:
        return int(self._fmi.fmi3SerializeFMUState(state.value or 0, _buffer(pointer, size)))

    def _fmi3DeserializeFMUState(self, pointer: Any, size: Any, state: Any) -> int:
        handle = self._fmi.fmi3DeserializeFMUState(_buffer(pointer, size), state._obj.value or 0)
        return self._new_handle(state, handle)


def _one(reference: Any) -> Any:
    """What a reference to one number refers to, as a buffer of length 1."""
    number = reference._obj
    return (type(number) * 1).from_address(addressof(number))
