"""What an element is: a record, one kernel, and how its record becomes a row of the kernel's tables."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, Protocol

from ..model.base import Name, Record
from ..model.channels import Channel
from ..model.markers import Marker2D
from ..model.signals import Signal


class Numbering(Protocol):
    """What an element may ask while its tables are built."""

    @property
    def gravity(self) -> tuple[float, float]: ...

    def coordinates(self, body: str) -> tuple[int, int, int]:
        """Indices of (x, y, theta) of a body; missing ones are the ground's, which stay zero."""
        ...

    def initial(self, body: str) -> tuple[float, float, float]:
        """Given initial (x, y, theta) of a body."""
        ...

    def signal(self, signal: Signal) -> int:
        """Offset of a time function in the pool."""
        ...

    def contact(self, name: str) -> int:
        """Number of the contact `name`."""
        ...

    def law_address(self, law: Any) -> int:
        """Machine address of a force law's formula."""
        ...

    def friction_address(self, law: Any) -> int:
        """Machine address of a regularised friction law's formula."""
        ...

    def work(self, name: str) -> int:
        """Index of the work account `name` in the extended vectors."""
        ...


@dataclass(frozen=True)
class Row:
    """One element in the tables of its kernel."""

    parameters: Sequence[float]
    coordinates: Sequence[int]
    extra: Sequence[int] = ()


@dataclass(frozen=True)
class Form:
    """What an element looks like to the assembly; elements of one kernel and one size share a batch."""

    kernel: Any
    """numba function of KERNEL_SIGNATURE."""
    constraint_rows: int
    """Number of rows of Phi."""
    tangent_pattern: Sequence[tuple[int, int]]
    """Local (i, j) pairs where d r_i / d q_j may be nonzero."""
    jacobian_pattern: Sequence[tuple[int, int]]
    """Local (row, j) pairs where Phi_q may be nonzero."""


class Element(Record):
    """Base of everything in a model that has a kernel.

    Class attributes: those of `Form`, for elements of which all look alike; the others define `form`.
    """

    kernel: ClassVar[Any]
    constraint_rows: ClassVar[int] = 0
    tangent_pattern: ClassVar[Sequence[tuple[int, int]]] = ()
    jacobian_pattern: ClassVar[Sequence[tuple[int, int]]] = ()

    name: Name

    def form(self) -> Form:
        """Kernel, number of constraint rows and patterns of this element."""
        kind = type(self)
        return Form(kind.kernel, kind.constraint_rows, kind.tangent_pattern, kind.jacobian_pattern)

    def row(self, numbering: Numbering) -> Row:
        """This element's row in the tables of its kernel."""
        raise NotImplementedError(f"{type(self).__name__} must say how it becomes a row of its kernel's tables")

    def markers(self) -> Sequence[Marker2D]:
        """The markers it uses (their bodies must exist)."""
        return ()

    def moved_coordinates(self) -> Sequence[tuple[str, str]]:
        """(body, coordinate name) pairs that it acts on by name (they must exist)."""
        return ()

    def signals(self) -> Sequence[Signal]:
        """The time functions it uses."""
        return ()

    def multiplier_channels(self) -> Sequence[Channel]:
        """One channel for each constraint row: what its multiplier means."""
        return ()
