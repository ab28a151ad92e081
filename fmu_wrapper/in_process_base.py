"""What the in-process instances of fmpy share for FMI 2.0 and 3.0: calls that go to a slave instead of a binary."""

from pathlib import Path
from typing import Any, ClassVar, Self

from .calls import Calls
from .embedded import read_slave
from .errors import Status
from .extras import require
from .slave import Slave

require("driving an FMU's slave through fmpy", "fmpy")

# after the line above, which says what to install
from fmpy.fmi1 import FMICallException  # noqa: E402
from fmpy.fmi2 import FMU2Slave  # noqa: E402
from fmpy.fmi3 import FMU3Slave  # noqa: E402

__all__ = ["Direct", "FMU2Slave", "FMU3Slave"]

WARNING = int(Status.WARNING)


class Direct:
    """Replaces fmpy's calls into a binary; its higher methods (getReal, doStep ...) work as they are."""

    calls: ClassVar[type[Calls]]

    def __init__(self, slave: Slave) -> None:
        # not super().__init__(), which loads a binary
        self.instanceName = slave.name
        self.modelIdentifier = slave.model.name
        self.component = None
        self.slave = slave
        self._fmi: Any = self.calls(slave)
        self._strings: list[bytes] = []

    @classmethod
    def of(cls, unzipped: str | Path, **arguments: Any) -> Self:
        """The instance of an unzipped FMU; `arguments` (name, on_log, logging_on ...) go to `Slave`."""
        return cls(read_slave(Path(unzipped) / "resources", **arguments))

    def instantiate(self, *arguments: Any, **named: Any) -> None:
        """Nothing to do: the instance exists."""

    def freeInstance(self) -> None:
        """Drop the slave's data."""
        self._fmi.free()

    def _call(self, fname: str, *arguments: Any) -> int:
        """Make the call `fname`, as fmpy does into a binary; `arguments` start with the component."""
        adapt = getattr(self, f"_{fname}", None) or self._adapted(fname)
        call = getattr(self._fmi, fname, None)
        status = adapt(*arguments[1:]) if adapt else call(*arguments[1:]) if call else int(Status.ERROR)
        if status > WARNING:
            error = FMICallException(function=fname, status=status)
            error.add_note(self.slave.log.last_problem)
            raise error
        return int(status)

    def _adapted(self, fname: str) -> Any:
        """How to make a call that has no method of its own here, or None."""
        return None

    def _get_strings(self, call: Any, vr: Any, value: Any) -> int:
        strings = call(vr)
        if strings is None:
            return int(Status.ERROR)
        value[:] = self._strings = strings
        return int(Status.OK)

    @staticmethod
    def _free(call: Any, state: Any) -> int:
        status = int(call(state._obj.value or 0))
        state._obj.value = None
        return status

    @staticmethod
    def _size(call: Any, state: Any, size: Any) -> int:
        count = call(state.value or 0)
        size._obj.value = max(count, 0)
        return int(Status.OK if count >= 0 else Status.ERROR)

    @staticmethod
    def _new_handle(state: Any, handle: int) -> int:
        if not handle:
            return int(Status.ERROR)
        state._obj.value = handle
        return int(Status.OK)
