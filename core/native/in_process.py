"""Runs of images in this process, by the library's C functions (`tlismni.h`): to prove an image, and to test it."""

import ctypes
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ..compiled.library import Library
from ..errors import SimulationError
from ..state.workspace_records import COUNTERS_SIZE
from .errors import NativeError

_ROOM = 500
NOTED = 8 * (1 + COUNTERS_SIZE + 2)
"""Bytes of a saved state before what decides: its size, counters, and the two numbers of `Noted` (state.c)."""
_POINTER, _SIZE, _TEXT = ctypes.c_void_p, ctypes.c_size_t, ctypes.c_char_p
_SIGNATURES = {
    "tlismni_read_image": (_POINTER, _TEXT, _SIZE, _TEXT, _SIZE),
    "tlismni_close": (None, _POINTER),
    "tlismni_count": (_SIZE, _POINTER, ctypes.c_int),
    "tlismni_name": (_TEXT, _POINTER, ctypes.c_int, _SIZE),
    "tlismni_start": (_POINTER, _POINTER),
    "tlismni_end": (None, _POINTER),
    "tlismni_time": (ctypes.c_double, _POINTER),
    "tlismni_inputs": (_POINTER, _POINTER),
    "tlismni_channels": (_POINTER, _POINTER),
    "tlismni_step": (ctypes.c_int, _POINTER, ctypes.c_double, ctypes.c_bool),
    "tlismni_step_to_event": (ctypes.c_int, _POINTER, ctypes.c_double, _POINTER),
    "tlismni_happen": (ctypes.c_int, _POINTER, _POINTER),
    "tlismni_parameter": (ctypes.c_double, _POINTER, _SIZE),
    "tlismni_set_parameter": (ctypes.c_int, _POINTER, _SIZE, ctypes.c_double),
    "tlismni_start_at": (ctypes.c_int, _POINTER, ctypes.c_double),
    "tlismni_set_rates": (ctypes.c_int, _POINTER, _SIZE, ctypes.c_double, ctypes.c_double),
    "tlismni_next_point": (ctypes.c_int, _POINTER, ctypes.c_double, _POINTER),
    "tlismni_derivatives": (ctypes.c_int, _POINTER, _POINTER, _POINTER, _POINTER),
    "tlismni_rates": (ctypes.c_int, _POINTER, _POINTER, _POINTER),
    "tlismni_look": (ctypes.c_int, _POINTER),
    "tlismni_restart": (None, _POINTER),
    "tlismni_want": (ctypes.c_bool, _POINTER, _SIZE),
    "tlismni_want_none": (None, _POINTER),
    "tlismni_event_count": (ctypes.c_int64, _POINTER),
    "tlismni_steps": (ctypes.c_int64, _POINTER),
    "tlismni_limit_steps": (None, _POINTER, ctypes.c_int64),
    "tlismni_why": (_TEXT, ctypes.c_int),
    "tlismni_state_size": (_SIZE, _POINTER),
    "tlismni_saved_size": (_SIZE, _POINTER),
    "tlismni_packed_size": (_SIZE, _POINTER),
    "tlismni_save": (None, _POINTER, _POINTER),
    "tlismni_restore": (ctypes.c_int, _POINTER, _POINTER),
    "tlismni_pack": (ctypes.c_int, _POINTER, _POINTER, _POINTER),
    "tlismni_unpack": (ctypes.c_int, _POINTER, _POINTER, _SIZE, _POINTER),
}


class NativeModel:
    """An image in memory.

    Raises
    ------
    NativeError : if the library refuses it.
    """

    def __init__(self, image: bytes, library: Library) -> None:
        self.library = ctypes.CDLL(str(library.path))
        for name, (result, *arguments) in _SIGNATURES.items():
            function = getattr(self.library, name)
            function.restype, function.argtypes = result, arguments
        why = ctypes.create_string_buffer(_ROOM)
        self.address = self.library.tlismni_read_image(image, len(image), why, _ROOM)
        if not self.address:
            raise NativeError(f"the image is refused: {why.value.decode()}")

    def names(self, kind: int) -> tuple[str, ...]:
        """Names of the inputs (0), channels (1), contacts (2) or parameters (3)."""
        count = self.library.tlismni_count(self.address, kind)
        return tuple(self.library.tlismni_name(self.address, kind, k).decode() for k in range(count))

    def __del__(self) -> None:
        if getattr(self, "address", None):
            self.library.tlismni_close(self.address)


class NativeRun:
    """A run of an image."""

    def __init__(self, model: NativeModel) -> None:
        self.model, self._library = model, model.library
        self.address = self._library.tlismni_start(model.address)
        self._inputs = self._array(self._library.tlismni_inputs(self.address), len(model.names(0)))
        self._channels = self._array(self._library.tlismni_channels(self.address), len(model.names(1)))

    def __del__(self) -> None:
        if getattr(self, "address", None):
            self._library.tlismni_end(self.address)

    @staticmethod
    def _array(address: int, count: int) -> NDArray[np.float64]:
        return np.ctypeslib.as_array((ctypes.c_double * count).from_address(address)) if count else np.zeros(0)

    @property
    def t(self) -> float:
        """Present time, s."""
        return float(self._library.tlismni_time(self.address))

    @property
    def events(self) -> int:
        """Events since the start."""
        return int(self._library.tlismni_event_count(self.address))

    @property
    def steps(self) -> int:
        """Steps of the solver since the start."""
        return int(self._library.tlismni_steps(self.address))

    @property
    def parameters(self) -> list[float]:
        """Values of the parameters."""
        return [self._library.tlismni_parameter(self.address, k) for k in range(len(self.model.names(3)))]

    def set_parameter(self, number: int, value: float) -> None:
        """Give a parameter another value; before the run goes on. Raises SimulationError."""
        self._check(self._library.tlismni_set_parameter(self.address, number, value))

    def start_at(self, t: float) -> None:
        """Begin at time `t` (s); before the run goes on. Raises SimulationError."""
        self._check(self._library.tlismni_start_at(self.address, t))

    def set_rates(self, number: int, first: float, second: float = 0.0) -> None:
        """Let an input go on with these time derivatives. Raises SimulationError."""
        self._check(self._library.tlismni_set_rates(self.address, number, first, second))

    def limit_steps(self, steps: int) -> None:
        """Most steps in one call; 0: no bound."""
        self._library.tlismni_limit_steps(self.address, steps)

    def _check(self, status: int) -> None:
        if status:
            raise SimulationError(
                f"at t = {self.t:.9g} s: {self._library.tlismni_why(status).decode()}", t=self.t, loop="native"
            )

    def step(self, t: float, inputs: Sequence[float] = ()) -> NDArray[np.float64]:
        """Go on to `t` (s) with these inputs; the channels there. Raises SimulationError."""
        self._inputs[:] = inputs
        self._check(self._library.tlismni_step(self.address, t, True))
        return self._channels.copy()

    def step_to_event(self, t: float, inputs: Sequence[float] = ()) -> bool:
        """Go on to `t` (s), or to the first event; True if there is one. Raises SimulationError."""
        self._inputs[:] = inputs
        event = ctypes.c_bool(False)
        self._check(self._library.tlismni_step_to_event(self.address, t, ctypes.byref(event)))
        return event.value

    def happen(self) -> bool:
        """Let the event that is due happen; True if another one is due at once. Raises SimulationError."""
        again = ctypes.c_bool(False)
        self._check(self._library.tlismni_happen(self.address, ctypes.byref(again)))
        return again.value

    def look(self) -> NDArray[np.float64]:
        """The channels at the present time. Raises SimulationError."""
        self._check(self._library.tlismni_look(self.address))
        return self._channels.copy()

    def want(self, channels: Sequence[int]) -> None:
        """Read these channels alone from now on."""
        self._library.tlismni_want_none(self.address)
        for k in channels:
            self._library.tlismni_want(self.address, k)

    def restart(self) -> None:
        """Back to the point at which the image was made."""
        self._library.tlismni_restart(self.address)

    def next_point(self, t: float) -> float:
        """Where the newest step ends, s, at most `t`. Raises SimulationError."""
        point = ctypes.c_double()
        self._check(self._library.tlismni_next_point(self.address, t, ctypes.byref(point)))
        return point.value

    def derivatives(self, direction: Sequence[float]) -> NDArray[np.float64]:
        """Of all channels along a direction of the inputs. Raises SimulationError."""
        given, found = np.array(direction, dtype=np.float64), np.zeros(len(self._channels))
        room = ctypes.create_string_buffer(self._library.tlismni_state_size(self.model.address))
        self._check(self._library.tlismni_derivatives(self.address, given.ctypes.data, found.ctypes.data, room))
        return found

    def rates(self) -> NDArray[np.float64]:
        """Time derivatives of all channels, NaN where they are not known. Raises SimulationError."""
        found = np.zeros(len(self._channels))
        room = ctypes.create_string_buffer(self._library.tlismni_state_size(self.model.address))
        self._check(self._library.tlismni_rates(self.address, found.ctypes.data, room))
        return found

    def save(self) -> bytes:
        """The state, for this run."""
        room = ctypes.create_string_buffer(self._library.tlismni_saved_size(self.address))
        self._library.tlismni_save(self.address, room)
        return room.raw

    def restore(self, saved: bytes) -> None:
        """Go back to what `save` has given. Raises SimulationError for what is none of this run's."""
        self._check(self._library.tlismni_restore(self.address, saved))

    def deciding_bytes(self) -> bytes:
        """Bytes that two runs of this image have in common exactly if their futures are the same."""
        return self.save()[NOTED:]

    def pack(self) -> bytes:
        """The state, for any run of this image."""
        saved = self.save()
        room = ctypes.create_string_buffer(self._library.tlismni_packed_size(saved))
        self._check(self._library.tlismni_pack(self.address, saved, room))
        return room.raw

    def unpack(self, packed: bytes) -> None:
        """Go to a state that `pack` has given, of any run of this image. Raises SimulationError."""
        room = ctypes.create_string_buffer(self._library.tlismni_state_size(self.model.address))
        self._check(self._library.tlismni_unpack(self.address, packed, len(packed), room))
        self.restore(room.raw)
