"""State is a value: everything that decides the future of a run, to copy, compare, store and restore bit for bit."""

import hashlib
import io
import json
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .errors import ModelError
from .events import Event

FORMAT = "tlismni-state-5"


@dataclass(frozen=True, eq=False)
class State:
    """A state of a `Simulation`.

    Attributes
    ----------
    arrays : copies of the deciding arrays, by name.
    facts : the deciding scalars and lists (JSON data).
    model_hash : of the model and the method's settings; a state fits only its own.
    events : the events so far; states of one run share the tuple while none is added.
    """

    arrays: dict[str, NDArray[Any]]
    facts: dict[str, Any]
    model_hash: str
    events: tuple[Event, ...] = ()

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, State):
            return NotImplemented
        return (
            self.model_hash == other.model_hash
            and json.dumps(self._all_facts(), sort_keys=True) == json.dumps(other._all_facts(), sort_keys=True)
            and self.arrays.keys() == other.arrays.keys()
            and all(x.tobytes() == other.arrays[name].tobytes() for name, x in self.arrays.items())
        )

    def __hash__(self) -> int:
        return hash(self.to_bytes())

    def _all_facts(self) -> dict[str, Any]:
        return {**self.facts, "events": [event.to_dict() for event in self.events]}

    def to_bytes(self) -> bytes:
        """The state as bytes, with a checksum."""
        buffer = io.BytesIO()
        header = json.dumps({"format": FORMAT, "model": self.model_hash, "facts": self._all_facts()})
        np.savez(
            buffer,
            allow_pickle=False,
            **{
                "header": np.frombuffer(header.encode(), dtype=np.uint8),
                **{f"a_{k}": v for k, v in self.arrays.items()},
            },
        )
        payload = buffer.getvalue()
        return hashlib.sha256(payload).digest() + payload

    @classmethod
    def from_bytes(cls, data: bytes) -> "State":
        """The state in `data`. Raises ModelError if the bytes are cut short, changed, or of another version."""
        if not isinstance(data, bytes | bytearray | memoryview):
            raise ModelError(f"the bytes of a solver state are needed, not {type(data).__name__}")
        digest, payload = bytes(data[:32]), bytes(data[32:])
        if len(payload) == 0 or hashlib.sha256(payload).digest() != digest:
            raise ModelError(
                f"these {len(data)} bytes are no complete solver state: the checksum does not fit; store and give "
                "back exactly the bytes of State.to_bytes()"
            )
        with np.load(io.BytesIO(payload), allow_pickle=False) as stored:
            header = json.loads(stored["header"].tobytes().decode())
            if header["format"] != FORMAT:
                raise ModelError(f"the state has format '{header['format']}', this version reads '{FORMAT}'")
            arrays = {name[2:]: stored[name] for name in stored.files if name.startswith("a_")}
        facts = header["facts"]
        events = tuple(Event(**event) for event in facts.pop("events"))
        return cls(arrays, facts, header["model"], events)
