"""A slave's whole state as one value: for rollback inside a process and, as bytes, across processes."""

import hashlib
import json
import math
import zlib
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from ..core.model.own_types import own_classes, place_of
from ..core.model.signals import MOST_DERIVATIVES
from ..core.multibody_model import Model
from .errors import FmuValueError, SnapshotError
from .origin import Origin
from .phases import Phase
from .settings import Settings
from .values import Values
from .variables import VariableTable
from .version import package_version

FORMAT = 2
MAGIC = b"tlismni-slave-state\n"
LENGTHS = 4 * 8
"""Bytes of the lengths of head, values and simulation state and of the checksum: 8 each, little endian."""


@dataclass(frozen=True)
class Snapshot:
    """Everything that decides a slave's future.

    Attributes
    ----------
    phase : phase of the slave.
    start_time, stop_time : experiment, s; no stop time is None.
    time : the slave's own time, s.
    rtol_given : whether `solver.rtol` was set, so that the experiment's tolerance does not replace it.
    values : values of all variables.
    applied : courses of the inputs that the simulation has been told.
    simulation : the solver's state (its bytes if the snapshot came from bytes), or None before it exists.
    identity : hash of model, settings and variables; a snapshot fits only a slave with the same.
    """

    phase: Phase
    start_time: float
    stop_time: float | None
    time: float
    rtol_given: bool
    values: Values
    applied: list[list[float]]
    simulation: Any
    identity: str

    @cached_property
    def data(self) -> bytes:
        """The snapshot as bytes, with format version, identity and checksum."""
        head = json.dumps(
            {
                "format": FORMAT,
                "tlismni": package_version(),
                "identity": self.identity,
                "phase": self.phase.value,
                "start_time": self.start_time,
                "stop_time": self.stop_time,
                "time": self.time,
                "rtol_given": self.rtol_given,
                "applied": self.applied,
            }
        ).encode()
        state = self.simulation
        if not isinstance(state, bytes):
            state = b"" if state is None else bytes(state.to_bytes())
        parts = (head, self.values.to_bytes(), state)
        body = b"".join(parts)
        numbers = [*(len(part) for part in parts), zlib.crc32(body)]
        return MAGIC + b"".join(n.to_bytes(8, "little") for n in numbers) + body

    @classmethod
    def from_data(cls, data: bytes, table: VariableTable, identity: str) -> "Snapshot":
        """The snapshot in `data`, for a slave with `table` and `identity`.

        Raises
        ------
        SnapshotError : if the bytes are no snapshot, damaged, or of another version or model.
        """
        if not isinstance(data, bytes | bytearray):
            raise SnapshotError(f"the bytes of a stored state are needed, not {type(data).__name__}")
        if not data.startswith(MAGIC):
            raise SnapshotError(f"these {len(data)} bytes are no stored state of a tlismni slave")
        start = len(MAGIC) + LENGTHS
        numbers = [int.from_bytes(data[i : i + 8], "little") for i in range(len(MAGIC), start, 8)]
        *lengths, checksum = numbers
        body = bytes(data[start : start + sum(lengths)])
        if len(body) != sum(lengths) or zlib.crc32(body) != checksum:
            raise SnapshotError(f"the stored state is damaged or cut off ({len(data)} bytes): store it again")
        if len(data) > start + len(body):
            raise SnapshotError(
                f"{len(data) - start - len(body)} bytes follow the stored state: give back exactly its own"
            )
        a, b = lengths[0], lengths[0] + lengths[1]
        try:
            return cls._from_parts(json.loads(body[:a]), body[a:b], body[b:], table, identity)
        except (ValueError, TypeError, KeyError, RecursionError, OverflowError) as error:
            raise SnapshotError(
                f"the stored state is none of a slave, though its checksum fits: {error or repr(error)}; store it again"
            ) from None

    @classmethod
    def _from_parts(cls, head: Any, values: bytes, state: bytes, table: VariableTable, identity: str) -> "Snapshot":
        # another version may solve the same in another way: its state would be taken for something it is not
        stored, here = (head["format"], head["tlismni"]), (FORMAT, package_version())
        if stored != here:
            raise SnapshotError(
                f"the state was stored by tlismni {stored[1]} (format {stored[0]}), this is {here[1]} (format "
                f"{here[0]}): restore it with the version that stored it"
            )
        if head["identity"] != identity:
            raise SnapshotError(
                "the stored state belongs to another model or other settings (identity "
                f"{head['identity'][:12]}, this slave has {identity[:12]}): use the FMU that stored it"
            )
        snapshot = cls(
            phase=Phase(head["phase"]),
            start_time=_number("start_time", head["start_time"]),
            stop_time=None if head["stop_time"] is None else _number("stop_time", head["stop_time"]),
            time=_number("time", head["time"]),
            rtol_given=bool(head["rtol_given"]),
            values=Values.from_bytes(table, values),
            applied=[[_number("applied", x) for x in level] for level in head["applied"]],
            simulation=state or None,
            identity=identity,
        )
        snapshot._check(len(table.block("input")))
        return snapshot

    def _check(self, inputs: int) -> None:
        """Refuse with FmuValueError what does not fit together."""
        begun = self.phase not in (Phase.INSTANTIATED, Phase.INITIALIZATION)
        if self.phase in (Phase.FAILED, Phase.INTERMEDIATE) or (begun and self.simulation is None):
            raise FmuValueError(f"nothing can be stored in phase '{self.phase}' like this")
        if self.time < self.start_time or (self.stop_time is not None and self.stop_time < self.start_time):
            raise FmuValueError(f"the times {self.start_time!r}, {self.time!r}, {self.stop_time!r} s are out of order")
        levels = [len(level) for level in self.applied]
        if any(n != inputs for n in levels) or len(levels) > 1 + MOST_DERIVATIVES or (self.simulation and not levels):
            raise FmuValueError(f"there are {inputs} inputs, and courses of {levels}")


def _number(name: str, value: Any) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        raise FmuValueError(f"'{name}' is {value!r}, no finite number")
    return float(value)


def identity(model: Model, settings: Settings, variables: VariableTable, origin: Origin | None = None) -> str:
    """Hash of everything that makes an FMU what it is."""
    content: list[Any] = [model.model_dump(mode="json"), settings.as_arguments(), variables.to_data()]
    content += [] if origin is None else [origin.to_data()]
    own = own_classes(model)
    # the modules in an FMU have names made of their content: a state of other code is none of this one's
    content += [{name: place_of(kind) for name, kind in own.items()}] if own else []
    return hashlib.sha256(json.dumps(content, sort_keys=True, default=repr).encode()).hexdigest()
