"""A slave as an FMU instance of fmpy, without a binary: for masters written with fmpy, and for debugging.

    unzipped = fmpy.extract("ball.fmu")
    result = fmpy.simulate_fmu(unzipped, fmu_instance=InProcess.of(unzipped), fmi_type="CoSimulation")

`fmi_type` must be given: fmpy finds out the type by comparing classes, and this is a subclass.
"""

from collections.abc import Sequence
from ctypes import c_double, c_int
from typing import Any

import numpy as np

from .calls import numbers_in
from .fmi2_calls import Fmi2Calls
from .in_process_base import Direct, FMU2Slave


class InProcess(Direct, FMU2Slave):
    """An FMI 2.0 instance of fmpy whose calls go straight to a slave.

    fmpy's higher methods (getReal, doStep ...) work as they are: this class replaces the calls into a binary.
    Errors raise fmpy's FMICallException with the slave's message as a note.
    """

    calls = Fmi2Calls

    # where a call into C differs from `Fmi2Calls`: counts, pointers, strings

    def _fmi2SetDebugLogging(self, on: int, count: int, categories: Sequence[bytes]) -> int:
        return self._fmi.fmi2SetDebugLogging(on, list(categories)[:count])

    def _fmi2DoStep(self, t: float, h: float, no_set_state: int) -> int:
        return self._fmi.fmi2DoStep(t, h)

    def _fmi2GetReal(self, vr: Any, count: int, value: Any) -> int:
        return self._fmi.fmi2GetReal(vr, value)

    def _fmi2GetInteger(self, vr: Any, count: int, value: Any) -> int:
        return self._fmi.fmi2GetInteger(vr, value)

    def _fmi2GetBoolean(self, vr: Any, count: int, value: Any) -> int:
        return self._fmi.fmi2GetBoolean(vr, value)

    def _fmi2SetReal(self, vr: Any, count: int, value: Any) -> int:
        return self._fmi.fmi2SetReal(vr, value)

    def _fmi2SetInteger(self, vr: Any, count: int, value: Any) -> int:
        return self._fmi.fmi2SetInteger(vr, value)

    def _fmi2SetBoolean(self, vr: Any, count: int, value: Any) -> int:
        return self._fmi.fmi2SetBoolean(vr, value)

    def _fmi2GetString(self, vr: Any, count: int, value: Any) -> int:
        return self._get_strings(self._fmi.fmi2GetString, vr, value)

    def _fmi2SetString(self, vr: Any, count: int, value: Any) -> int:
        return self._fmi.fmi2SetString(vr, list(value))

    def _fmi2GetFMUstate(self, state: Any) -> int:
        return self._new_handle(state, self._fmi.fmi2GetFMUstate(state._obj.value or 0))

    def _fmi2SetFMUstate(self, state: Any) -> int:
        return self._fmi.fmi2SetFMUstate(state.value or 0)

    def _fmi2FreeFMUstate(self, state: Any) -> int:
        return self._free(self._fmi.fmi2FreeFMUstate, state)

    def _fmi2SerializedFMUstateSize(self, state: Any, size: Any) -> int:
        return self._size(self._fmi.fmi2SerializedFMUstateSize, state, size)

    def _fmi2SerializeFMUstate(self, state: Any, buffer: Any, size: Any) -> int:
        return self._fmi.fmi2SerializeFMUstate(state.value or 0, buffer)

    def _fmi2DeSerializeFMUstate(self, buffer: Any, size: int, state: Any) -> int:
        return self._new_handle(state, self._fmi.fmi2DeSerializeFMUstate(buffer, state._obj.value or 0))

    def _fmi2GetRealStatus(self, kind: int, value: Any) -> int:
        return self._status(self._fmi.fmi2GetRealStatus, kind, value, c_double)

    def _fmi2GetBooleanStatus(self, kind: int, value: Any) -> int:
        return self._status(self._fmi.fmi2GetBooleanStatus, kind, value, c_int)

    @staticmethod
    def _status(call: Any, kind: int, value: Any, ctype: Any) -> int:
        buffer = (ctype * 1)()
        status = int(call(kind, buffer))
        value._obj.value = numbers_in(buffer, np.dtype(ctype))[0].item()
        return status

    def _fmi2GetStringStatus(self, kind: int, value: Any) -> int:
        return self._fmi.fmi2GetStringStatus(kind)

    def _fmi2GetDirectionalDerivative(
        self, unknowns: Any, n: int, knowns: Any, m: int, seed: Any, sensitivity: Any
    ) -> int:
        return self._fmi.fmi2GetDirectionalDerivative(unknowns, knowns, seed, sensitivity)

    def _fmi2SetRealInputDerivatives(self, vr: Any, n: int, order: Any, value: Any) -> int:
        return self._fmi.fmi2SetRealInputDerivatives(vr, order, value)

    def _fmi2GetRealOutputDerivatives(self, vr: Any, n: int, order: Any, value: Any) -> int:
        return self._fmi.fmi2GetRealOutputDerivatives(vr, order, value)
