"""What an element is: a record, one kernel, and how its record becomes a row of the kernel's tables."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from types import MappingProxyType
from typing import Any, ClassVar, Protocol

from ..model.base import Name, Positive, Vector3
from ..model.channels import Channel
from ..model.derived import Derived
from ..model.markers import Marker, Marker2D, Marker3D
from ..model.open_union import OpenRecord
from ..model.signals import Signal
from ..model.words import an
from .coordinate import Coordinate

NO_INPUTS: Mapping[str, float] = MappingProxyType({})
MOST_ELEMENTS = 100_000
"""Of one flexible body: a number in a model file that would take all memory is refused before anything is built."""


class Numbering(Protocol):
    """What an element may ask while its tables are built."""

    @property
    def gravity(self) -> Vector3:
        """m/s^2; planar elements feel its first two components."""
        ...

    @property
    def length(self) -> float:
        """Size of the mechanism, m."""
        ...

    @property
    def bodies(self) -> "Mapping[str, BodyElement]":
        """The model's bodies by name."""
        ...

    @property
    def joints(self) -> "Mapping[str, JointElement]":
        """The model's joints by name."""
        ...

    def coordinates(self, body: str) -> tuple[int, ...]:
        """Indices of the coordinates of a body. Of one that carries markers: of those that place its frame; for those
        that it lacks (the angle of a point mass) a place that stays zero. Of the ground: as if it were planar."""
        ...

    def frame(self, marker: Marker) -> tuple[int, ...]:
        """Indices of the coordinates that place the frame of a marker's body; for those that it lacks, and all of the
        ground's, a place that stays zero."""
        ...

    def coordinate(self, body: str, name: str) -> int:
        """Index of the coordinate `name` of a body, which has it (the model has checked that)."""
        ...

    def own_frame(self, marker: Marker) -> tuple[int, ...]:
        """The same as `frame`, with -1 for what the body lacks."""
        ...

    def at_rest(self, marker: Marker) -> tuple[float, ...]:
        """What is to be added to those coordinates: nothing to the body's own, `Marker.rest` to those that it lacks."""
        ...

    def initial(self, body: str) -> tuple[float, ...]:
        """Given initial coordinates of a body that carries markers, (x, y, theta) of a planar one; what it lacks is
        `Marker.rest`."""
        ...

    def start(self, marker: Marker) -> tuple[float, ...]:
        """Those of a marker's body."""
        ...

    def start_angle(self, a: Marker3D, b: Marker3D, user: str | None = None) -> float:
        """Angle of marker b about the z axis of marker a at the start, rad, whole turns included (`start_angle3d`);
        `user` is the name of an element that acts on it."""
        ...

    def signal(self, signal: Signal) -> int:
        """Offset of a time function in the pool."""
        ...

    def motion(self, signal: Signal) -> int:
        """Offset in the pool of a time function that a constraint follows, for `evaluate_motion`."""
        ...

    def internal(self, name: str) -> tuple[int, ...]:
        """Indices of the internal coordinates of the element `name`."""
        ...

    def contact(self, name: str) -> int:
        """Number of the contact `name`."""
        ...

    def constraint_rows(self, name: str) -> Sequence[int]:
        """Constraint rows of the joint `name`; known once the tables of joints are built."""
        ...

    def law_address(self, law: Any) -> int:
        """Machine address of a force law's formula."""
        ...

    def friction_address(self, law: Any) -> int:
        """Machine address of a regularised friction law's formula."""
        ...

    def work(self, name: str, size: float | None = None) -> int:
        """Index of the work account `name` in the extended vectors; `size` is how large its values typically are, for
        the error control, left out of energies."""
        ...


def no_account(numbering: Numbering) -> int:
    """Index of a place that stays zero, in place of an account that is not needed."""
    return numbering.frame(Marker3D())[0]


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
    rate_rows: Sequence[int] = ()
    """Local rows that hold at velocity level only, W(q) v = w(t), without a position form (nonholonomic). Their kernel
    writes 0 to phi, W v - w to phid and its time derivative to phidd; W stands in the rows of Phi_q, W^T lambda in r,
    and the tangent of r has d(W^T lambda)/dq."""


@cache
def full_pattern(n: int) -> Sequence[tuple[int, int]]:
    """All pairs of n local coordinates."""
    return tuple((i, j) for i in range(n) for j in range(n))


@dataclass(frozen=True)
class Part:
    """Rows of one kernel that an element brings; they share its constraint rows."""

    form: Form
    rows: Sequence[Row]
    felt_rows: Sequence[int] = ()
    """Constraint rows of other elements whose multipliers its kernel takes: they stand behind its own in the table of
    rows, and in the pattern of its Jacobian."""
    massless: int = -1
    """Coordinate without mass that the constraint row holds; a closed contact that moves it takes the row's place."""


class Element(OpenRecord):
    """Base of everything in a model that has a kernel, a user's own too.

    Class attributes: those of `Form`, for elements of which all look alike; the others define `form`.
    """

    kernel: ClassVar[Any]
    constraint_rows: ClassVar[int] = 0
    tangent_pattern: ClassVar[Sequence[tuple[int, int]]] = ()
    jacobian_pattern: ClassVar[Sequence[tuple[int, int]]] = ()
    rate_rows: ClassVar[Sequence[int]] = ()
    symbol: ClassVar[str] = "none"
    """What it looks like: a name of those that drawings know, in the plane "spring", "rod", "actuator" and others
    (`viewer/fixtures.py`), in space also "ball" or "pin" (`viewer/space/fixtures.py`); "none": it is not seen."""
    arrow: ClassVar[str] = "none"
    """Which arrow shows its force: "components", its channels force_x, force_y, in space force_z, on marker b (in space
    along the axes of marker a); "tension", its channel of that name, from marker b to a; "signals", its time functions
    force_x and so on, at `marker`; "none"."""

    name: Name
    """Unique in its model; channels begin with it."""

    @property
    def linear(self) -> bool:
        """True if its residuals are linear in (q, v, a, multipliers) with constant coefficients."""
        return False

    def form(self) -> Form:
        """Kernel, number of constraint rows and patterns of this element."""
        kind = type(self)
        return Form(kind.kernel, kind.constraint_rows, kind.tangent_pattern, kind.jacobian_pattern, kind.rate_rows)

    def form_in(self, bodies: "Mapping[str, BodyElement]") -> Form:
        """Its form in a model with these bodies, for elements whose size depends on another."""
        return self.form()

    def check_in(self, bodies: "Mapping[str, BodyElement]") -> None:
        """Raise ValueError if it does not fit the model's bodies; bodies of markers and of moved coordinates need no
        check here."""

    def row(self, numbering: Numbering) -> Row:
        """This element's row in the tables of its kernel."""
        raise NotImplementedError(f"{type(self).__name__} must say how it becomes a row of its kernel's tables")

    def rows(self, numbering: Numbering) -> Sequence[Row]:
        """Its rows, one after another in the tables, for elements that have several; they share its constraints."""
        return (self.row(numbering),)

    def parts(self, numbering: Numbering) -> Sequence["Part"]:
        """All that it brings into the tables, for elements with rows of several kernels."""
        return (Part(self.form_in(numbering.bodies), self.rows(numbering)),)

    def internal_coordinates(self) -> Sequence[str]:
        """Names of its internal coordinates: states z of its own, each the velocity of a coordinate of unit mass,
        1 a = z'. They come after those of the bodies; their positions mean nothing."""
        return ()

    def markers(self) -> Sequence[Marker]:
        """The markers it uses (their bodies must exist)."""
        return ()

    def reach(self) -> Sequence[tuple[float, ...]]:
        """Points on its bodies that tell the size of the mechanism, m."""
        return [marker.point for marker in self.markers()]

    def lengths(self) -> Sequence[float]:
        """Its lengths that tell the size of a mechanism whose points do not, m."""
        return ()

    def felt_joints(self) -> Sequence[str]:
        """Names of the joints whose forces it feels (they must exist, and have forces)."""
        return ()

    def moved_coordinates(self) -> Sequence[tuple[str, str]]:
        """(body, coordinate name) pairs that it acts on by name (they must exist)."""
        return ()

    def acts_on(self) -> frozenset[str]:
        """Names of the bodies whose motion it feels or changes, its own if it is one; the ground may be among them."""
        return frozenset((*(marker.body for marker in self.markers()), *(body for body, _ in self.moved_coordinates())))

    def signals(self) -> Sequence[Signal]:
        """The time functions it uses."""
        return ()

    def motions(self) -> Sequence[Signal]:
        """Those among them that its constraint rows follow, one a row; Phi_k = q_k - f(t)."""
        return ()

    def placed(self, numbering: Numbering) -> Sequence[int]:
        """The coordinates that start where its constraint rows say, one a row; the model gives them no start of their
        own."""
        return ()

    def multiplier_channels(self) -> Sequence[Channel]:
        """One channel for each constraint row: what its multiplier means. None at all if they are not shown."""
        return ()

    def derived_channels(self, numbering: Numbering, rows: Sequence[int]) -> Sequence[Derived]:
        """Channels that follow from coordinates and from the multipliers of its constraint rows."""
        return ()


class JointElement(Element):
    """Base of what may stand in a model's `joints`: a user's own needs no more than to inherit from it."""

    compliance: Positive = 1.0
    """How far it gives way under a load over how far others do, dimensionless: where joints repeat each other, they
    share forces and moments in that measure."""

    def force_rows(self) -> Sequence[int]:
        """Which of its constraint rows have the force between its bodies as their multipliers, by components along
        directions at right angles, N."""
        return ()


class ForceElement(Element):
    """The same for its `forces`."""


class PairElement2D(Element):
    """Base of what acts between two markers of planar bodies: its coordinates are the six of their bodies."""

    a: Marker2D
    """The first marker."""
    b: Marker2D
    """The second marker."""

    def markers(self) -> Sequence[Marker2D]:
        return (self.a, self.b)

    def coordinates(self, numbering: Numbering) -> Sequence[int]:
        """Indices of (x, y, theta) of the body of `a`, then of that of `b`."""
        return (*numbering.frame(self.a), *numbering.frame(self.b))


class BodyElement(Element):
    """Base of what has coordinates of its own."""

    carries: ClassVar[type[Marker] | None] = None
    """The kind of markers that can be put on it; None: none, it has no points."""

    def check_marker(self, user: str, marker: Marker) -> None:
        """Raise ValueError if the element `user` cannot have this marker on it."""
        kind = type(self).__name__
        if self.carries is None:
            raise ValueError(
                f"'{user}' needs a point of '{self.name}', but {an(kind)} has only its coordinates "
                f"{list(self.coordinate_names[:12])}: act on one of these by name (CoordinateDriver, "
                "CoordinateLoad), on a MaterialPoint2D of a flexible body, or use a RigidBody2D"
            )
        if not isinstance(marker, self.carries):
            raise ValueError(
                f"'{user}' puts {an(type(marker).__name__)} on '{self.name}', but {an(kind)} carries "
                f"{self.carries.__name__}s: elements of the plane (2D) go with planar bodies, those of space (3D) with "
                "spatial ones"
            )

    def coordinate_records(self) -> Sequence[Coordinate]:
        """Its coordinates, in the order of `initial_state`."""
        raise NotImplementedError(f"{type(self).__name__} must name its coordinates")

    def acts_on(self) -> frozenset[str]:
        return super().acts_on() | {self.name}

    @property
    def coordinate_names(self) -> tuple[str, ...]:
        """Names of its coordinates."""
        return tuple(coordinate.name for coordinate in self.coordinate_records())

    def initial_state(self) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """(q0, v0)."""
        raise NotImplementedError(f"{type(self).__name__} must say where it starts")

    def start_in(
        self, bodies: "Mapping[str, BodyElement]", inputs: Mapping[str, float] = NO_INPUTS
    ) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """(q0, v0) in a model with these bodies and start values of the inputs, for bodies that start where another one
        or an input is."""
        return self.initial_state()

    def extent(self) -> Sequence[tuple[float, ...]]:
        """Points where it starts that tell the size of the mechanism, m."""
        return ()

    def typical_mass(self) -> float:
        """Its mass, kg; of generalised coordinates, the largest of those in m. 0 without a mass."""
        return 0.0
