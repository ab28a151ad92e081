"""From Python exceptions to FMI statuses: what the calls of FMI 2.0 and 3.0 have in common."""

import functools
import traceback
from collections.abc import Callable
from typing import Any

import numpy as np
import numpy.typing as npt

from . import log as logs
from .errors import FmuError, FmuValueError, SnapshotError, Status
from .shared_calls import SharedCalls
from .slave import Slave
from .snapshot import Snapshot
from .variables import Kind

Function = Callable[..., Any]
THE_STATUS = object()
CATEGORY_OF = {Status.WARNING: logs.WARNING, Status.DISCARD: logs.DISCARD}


def fmi_call(on_error: Any = THE_STATUS) -> Callable[[Function], Function]:
    """Make a method an FMI call: no exception leaves it; each becomes a status and one line in the log.

    A method that returns None answers Status.OK. `on_error` is the answer after an error, for a call that
    does not answer with a status.
    """

    def decorate(method: Function) -> Function:
        @functools.wraps(method)
        def call(self: "Calls", *arguments: Any) -> Any:
            try:
                result = method(self, *arguments)
            except Exception as error:
                status = self.report(method.__name__, error)
                return int(status) if on_error is THE_STATUS else on_error
            return int(Status.OK) if result is None else result

        return call

    return decorate


class Calls(SharedCalls):
    """The FMI calls of one instance. Buffers come by the buffer protocol and live only for the call."""

    token_name = "guid"
    """What the FMI version calls the text that ties description and binary together."""

    def __init__(self, slave: Slave) -> None:
        self.slave = slave
        self._states: dict[int, Snapshot] = {}
        self._last_handle = 0

    def report(self, function: str, error: Exception) -> Status:
        """Log `error` as "function: Type: message" and give the status that it means."""
        status = error.status if isinstance(error, FmuError) else Status.ERROR
        text = " ".join(str(error).split()) or "no message"
        category = CATEGORY_OF.get(status, logs.ERROR)
        self.slave.log.write(status, category, f"{function}: {type(error).__name__}: {text}")
        if self.slave.log.wants(logs.TRACEBACK):
            self.slave.log.write(status, logs.TRACEBACK, "".join(traceback.format_exception(error)))
        return status

    def keep(self, snapshot: Snapshot, handle: int) -> int:
        """Keep a snapshot under `handle` if that is one of ours, else under a new one. Gives the handle."""
        if handle not in self._states:
            # handles are numbers, not addresses: a state freed twice is an error, not a crash
            self._last_handle += 1
            handle = self._last_handle
        self._states[handle] = snapshot
        return handle

    def kept(self, handle: int) -> Snapshot:
        """The snapshot under `handle`. Raises SnapshotError if there is none."""
        try:
            return self._states[handle]
        except KeyError:
            raise SnapshotError(
                f"FMU state {handle:#x} is unknown to instance '{self.slave.name}': it was freed, or belongs "
                "to another instance (serialise it to carry it over)"
            ) from None

    def drop(self, handle: int) -> None:
        """Forget the snapshot under `handle`; 0 is none. Raises SnapshotError if there is none."""
        if handle:
            self.kept(handle)
            del self._states[handle]

    def check_room(
        self, room: npt.NDArray[Any], what: str, kind: Kind, references: npt.NDArray[np.uint32], of: str
    ) -> None:
        """Refuse, with FmuValueError, room for another number of values than `references` have variables of `kind`,
        before the slave is asked, which would tell the simulation its inputs."""
        count = len(self.slave.variables.plan(kind, references).variables)  # an array has several
        if len(room) != count:
            raise FmuValueError(f"room for {len(room)} {what} was given for {count} {of}")

    def directional_derivative(self, unknowns: Any, knowns: Any, seed: Any, sensitivity: Any) -> None:
        """The derivatives of `unknowns` along `seed` in `knowns` into the buffer `sensitivity`."""
        outputs, room = references_in(unknowns), numbers_in(sensitivity, np.float64)
        self.check_room(room, "sensitivities", "real", outputs, "unknowns")
        room[:] = self.slave.directional_derivative(outputs, references_in(knowns), numbers_in(seed, np.float64))

    def output_derivatives(self, references: Any, orders: Any, values: Any) -> None:
        """The time derivatives of outputs into the buffer `values`."""
        outputs, room = references_in(references), numbers_in(values, np.float64)
        self.check_room(room, "derivatives", "real", outputs, "outputs")
        room[:] = self.slave.output_derivatives(outputs, numbers_in(orders, np.int32).tolist())

    def write_state(self, handle: int, buffer: Any) -> None:
        """Write the bytes of the snapshot under `handle` into `buffer`. Raises SnapshotError if it is too small."""
        data = self.kept(handle).data
        if len(given(buffer, "the bytes")) < len(data):
            raise SnapshotError(f"the buffer holds {len(buffer)} bytes, the stored state needs {len(data)}")
        numbers_in(buffer, np.uint8)[: len(data)] = np.frombuffer(data, dtype=np.uint8)

    def free(self) -> None:
        """Drop what the instance holds."""
        self._states.clear()
        self.slave.reset()


def given(array: Any, what: str) -> Any:
    """`array`, which the shim makes None of where a host gave NULL (or a length beyond all memory), or raises
    FmuValueError."""
    if array is None:
        raise FmuValueError(f"NULL was given for {what}: pass its address, and its length")
    return array


def texts_in(array: Any, what: str) -> list[str]:
    """Texts in a list of bytes from C. Raises FmuValueError for NULL or for what is not UTF-8."""
    return [text_of(text, what) for text in given(array, f"an array whose items are each {what}")]


def references_in(buffer: Any) -> npt.NDArray[np.uint32]:
    """Value references in a buffer. Raises FmuValueError for NULL."""
    buffer = given(buffer, "the value references")
    return np.frombuffer(buffer, dtype=np.uint32) if len(buffer) else np.empty(0, dtype=np.uint32)


def numbers_in(buffer: Any, dtype: Any) -> npt.NDArray[Any]:
    """Numbers in a buffer, as a view that writes through if that can be written. Raises FmuValueError for NULL."""
    buffer = given(buffer, "an array")
    return np.frombuffer(buffer, dtype=dtype) if len(buffer) else np.empty(0, dtype=dtype)


def put(buffer: Any, code: str, value: Any, place: int = 0) -> None:
    """Write one number into a buffer; `code` is its type as in the module struct. Raises FmuValueError for NULL."""
    buffer = given(buffer, "what the call answers with")
    memoryview(buffer).cast("B").cast(code)[place] = value  # type: ignore[call-overload]


def text_of(data: bytes | None, what: str) -> str:
    """Text in bytes from C. Raises FmuValueError for NULL or for what is not UTF-8."""
    if data is None:
        raise FmuValueError(f"{what} is NULL: a string is needed")
    try:
        return data.decode("utf-8")
    except UnicodeDecodeError as error:
        raise FmuValueError(f"{what} is not UTF-8: {error}") from None
