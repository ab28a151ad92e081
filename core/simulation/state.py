"""State is a value: everything that decides the future of a run, to copy, compare, store and restore bit for bit.

Beside it goes what a run has counted and noted so far (events, statistics, fallbacks), which decides nothing: states
are equal exactly if their futures are.

As bytes: a checksum (32), the length of the header (8, little endian), the header (JSON: format, model, facts, what
goes beside, name, type and shape of each array), the arrays' numbers one after the other. Nothing may follow.
"""

import hashlib
import json
import math
from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from ..errors import ModelError
from ..events import Event

FORMAT = "tlismni-state-14"
TYPES = ("<f8", "<i8")


@dataclass(frozen=True, eq=False)
class State:
    """A state of a `Simulation`. Two are equal exactly if their futures are, whatever came before.

    Attributes
    ----------
    arrays : copies of the deciding arrays, by name.
    facts : the deciding scalars and lists (JSON data).
    model_hash : of the model and the method's settings; a state fits only its own.
    events : the events so far, beside the state; states of one run share the tuple while none is added.
    past : counters and fallbacks so far, beside the state (JSON data).
    """

    arrays: dict[str, NDArray[Any]]
    facts: dict[str, Any]
    model_hash: str
    events: tuple[Event, ...] = ()
    past: dict[str, Any] = field(default_factory=dict, compare=False)
    foreign: bool = field(default=False, compare=False)
    """Made from bytes, which anybody may have written: what it holds is looked at before it is used."""

    parts: ClassVar[Any] = None
    """As a simulation took it (`simulation/snapshot.py`): arrays and facts are made of this when they are asked for."""

    @classmethod
    def of_parts(cls, parts: Any, model_hash: str, events: tuple[Event, ...]) -> "State":
        """The state that a simulation hands out."""
        state = object.__new__(cls)
        state.__dict__.update(parts=parts, model_hash=model_hash, events=events, foreign=False)
        return state

    def __getattr__(self, name: str) -> Any:
        if self.parts is None or name not in ("arrays", "facts", "past"):
            raise AttributeError(f"a State has no attribute '{name}'")
        value = getattr(self.parts, name)()
        self.__dict__[name] = value
        return value

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, State):
            return NotImplemented
        return self.deciding_bytes() == other.deciding_bytes()

    def __hash__(self) -> int:
        return hash(self.deciding_bytes())

    def deciding_bytes(self) -> bytes:
        """Bytes that two states have in common exactly if their futures are the same."""
        return self._bytes({"format": FORMAT, "model": self.model_hash, "facts": self.facts})

    def _bytes(self, header: dict[str, Any]) -> bytes:
        arrays = {name: np.ascontiguousarray(x, x.dtype.newbyteorder("<")) for name, x in self.arrays.items()}
        listed = [[name, x.dtype.str, list(x.shape)] for name, x in arrays.items()]
        head = json.dumps({**header, "arrays": listed}).encode()
        return b"".join([len(head).to_bytes(8, "little"), head, *(x.tobytes() for x in arrays.values())])

    def to_bytes(self) -> bytes:
        """The state and what goes beside it as bytes, with a checksum."""
        past = {**self.past, "events": [event.to_dict() for event in self.events]}
        payload = self._bytes({"format": FORMAT, "model": self.model_hash, "facts": self.facts, "past": past})
        return hashlib.sha256(payload).digest() + payload

    @classmethod
    def from_bytes(cls, data: bytes) -> "State":
        """The state in `data`. Raises ModelError if bytes are missing, too many, changed, or of another version."""
        if not isinstance(data, bytes | bytearray | memoryview):
            raise ModelError(f"the bytes of a solver state are needed, not {type(data).__name__}")
        digest, payload = bytes(data[:32]), bytes(data[32:])
        if len(payload) == 0 or hashlib.sha256(payload).digest() != digest:
            raise ModelError(
                f"these {len(data)} bytes are no complete solver state: the checksum does not fit; store and give "
                "back exactly the bytes of State.to_bytes()"
            )
        start = 8 + int.from_bytes(payload[:8], "little")
        try:
            header = json.loads(payload[8:start])
            if header["format"] != FORMAT:
                raise ModelError(f"the state has format '{header['format']}', this version reads '{FORMAT}'")
            facts, model, listed = dict(header["facts"]), str(header["model"]), list(header["arrays"])
            past = dict(header["past"])
            events = tuple(Event(**event) for event in past.pop("events"))
            arrays = _arrays_in(payload, start, listed)
        except (ValueError, TypeError, KeyError, RecursionError) as error:
            if isinstance(error, ModelError):
                raise
            raise ModelError(f"this is no solver state, though its checksum fits: {error!r}; store it again") from None
        return cls(arrays, facts, model, events, past, foreign=True)


def _arrays_in(payload: bytes, at: int, listed: list[Any]) -> dict[str, NDArray[Any]]:
    """The arrays in `payload` from byte `at` on, to its end."""
    arrays: dict[str, NDArray[Any]] = {}
    for name, kind, shape in listed:
        sizes = [int(n) for n in shape]
        if kind not in TYPES or min(sizes, default=0) < 0 or name in arrays:
            raise ModelError(f"array '{name}' of type {kind!r} and shape {shape} does not belong to a solver state")
        count = math.prod(sizes)
        if at + 8 * count > len(payload):
            raise ModelError(f"array '{name}' of shape {shape} reaches beyond the end of the solver state")
        arrays[name] = np.frombuffer(payload, kind, count, at).reshape(sizes).astype(kind[1:])
        at += 8 * count
    if at != len(payload):
        raise ModelError(f"{len(payload) - at} bytes follow the solver state: give back exactly its own")
    return arrays
