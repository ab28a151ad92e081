"""What the shim calls at every step: without arguments, which stand in memory that both sides share."""

import numpy as np
import numpy.typing as npt

from .errors import Status
from .phases import Phase
from .shared import (
    ASKED,
    BEHIND,
    EARLY,
    EVENT_DUE,
    FRESH,
    HORIZON,
    LAYOUT,
    POINT,
    REACHED,
    READING,
    SETTABLE,
    STEP,
    TIME,
    TOLD,
    Shared,
)
from .slave import Slave

OK = int(Status.OK)


class SharedCalls:
    """Base of `Calls`. The shim takes its promises (horizon, settable, fresh) back before it calls anything that may
    change the slave; `step` and `look` give them."""

    slave: Slave
    get_name, step_name = "get reals", "do step"
    """What the FMI version calls these, for the log."""

    def report(self, function: str, error: Exception) -> Status:
        """Log `error` and give the status that it means."""
        raise NotImplementedError

    def share(self, layout: int) -> int:
        """The address of what is shared from now on; 0, and nothing is, if the binary's layout is another."""
        if layout != LAYOUT:
            return 0
        self._shared = Shared(len(self.slave.reals))
        return self._shared.address

    def get_places(self, references: npt.NDArray[np.uint32]) -> bytes:
        """Places among the reals of what is got by these references, as int32; nothing if that is no output, or a
        parameter too, which may follow from others."""
        plan = self.slave.variables.plan("real", np.frombuffer(references, dtype=np.uint32))
        shown = "output" in plan.roles and "parameter" not in plan.roles
        return plan.positions.astype(np.int32).tobytes() if shown else b""

    def set_places(self, references: npt.NDArray[np.uint32]) -> bytes:
        """Places among the reals of what is set by these references; nothing unless it is inputs that may take any
        finite value."""
        plan = self.slave.variables.plan("real", np.frombuffer(references, dtype=np.uint32))
        return plan.positions.astype(np.int32).tobytes() if plan.roles == {"input"} and plan.unbounded else b""

    def settle(self, read: bool = False) -> None:
        """Tell the slave of the steps and inputs that it has not been told of; `read`: outputs are asked next."""
        shared, slave = self._shared, self.slave
        flags = shared.flags
        if flags[BEHIND]:
            flags[BEHIND] = 0
            try:
                slave.catch_up(shared.numbers[TIME], read and bool(flags[TOLD]))
            except Exception as error:
                self.report("catch_up", error)
        if not flags[TOLD]:
            flags[TOLD] = 1
            slave.take_inputs(shared.values)

    def step(self) -> int:
        """The step that is asked; the outputs too if those of the last one were read at once."""
        shared, slave = self._shared, self.slave
        numbers, flags = shared.numbers, shared.flags
        try:
            if flags[BEHIND] or not flags[TOLD]:
                self.settle()
            if flags[ASKED]:
                slave.expect_questions(flags[ASKED] == READING)
                flags[ASKED] = 0
            numbers[REACHED] = slave.time
            end = slave.do_step(numbers[POINT], numbers[STEP])
            numbers[TIME] = numbers[REACHED] = end.time
            if end.event_due or end.early:
                flags[EVENT_DUE], flags[EARLY] = end.event_due, end.early
            if slave.fresh:
                shared.values[:] = slave.reals
                flags[FRESH] = 1
            else:
                slave.give_inputs(shared.values)
            if slave.steady:
                flags[SETTABLE] = 1
                numbers[HORIZON] = slave.horizon
        except Exception as error:
            return int(self.report(self.step_name, error))
        return OK

    def look(self) -> int:
        """Make the values those of now."""
        shared, slave = self._shared, self.slave
        flags = shared.flags
        try:
            if flags[BEHIND] or not flags[TOLD]:
                self.settle(read=True)
            slave.look()
            shared.values[:] = slave.reals
            flags[FRESH] = slave.phase is not Phase.INTERMEDIATE  # where the slave goes on without telling the shim
        except Exception as error:
            return int(self.report(self.get_name, error))
        return OK
