"""Assembly: a model's elements as batches of flat tables, independent of which contacts are closed."""

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..compiled.kernels import kernel_address
from ..contacts.element import ContactElement
from ..contacts.geometry_kinds import EQUATIONS, kind_of
from ..contacts.pooled3d import PooledContact3D
from ..elements.base import Element, Form, Row
from ..elements.coordinate import Coordinate
from ..elements.internal import internal_coordinates_kernel
from ..elements.spatial_body import EULER, rigid_body3d_kernel
from ..errors import ModelError
from ..laws import ForceLaw, ImpactLaw
from ..laws.friction import CoulombFriction, Friction, LuGreFriction
from ..model.channels import Channel
from ..model.derived import Derived
from ..model.motion import InputMotion
from ..model.outputs import MarkerOutput
from .contact_pool import ContactPool, pool_of
from .numbering import AT_REST, NO_START, ModelNumbering
from .parts import Parts

LARGEST_RIGID = 7
"""Coordinates of a rigid body in space: place and Euler parameters."""


@dataclass
class Batch:
    """All elements that share a kernel, as its tables."""

    address: int
    par: NDArray[np.float64]
    coord: NDArray[np.int64]
    row: NDArray[np.int64]
    extra: NDArray[np.int64]
    tangent_pattern: Sequence[tuple[int, int]]
    jacobian_pattern: Sequence[tuple[int, int]]
    contact: NDArray[np.int64]
    """Number of the contact that each element is, or -1."""


@dataclass
class ContactInfo:
    """What the handling of events knows of a contact."""

    name: str
    row: int
    law: ImpactLaw | ForceLaw
    impulse_account: int
    dissipation_account: int
    extent: float = np.inf
    """Distance over which the shapes could pass through each other within a step, m."""
    slide_row: int = -1
    """Row of the sliding distance; -1: without friction."""
    tangents: int = 1
    """How many rows of tangents there are from `slide_row` on, with Coulomb friction: 1 in the plane, 2 in space."""
    friction: Friction | None = None
    bristles: tuple[tuple[int, str], ...] = ()
    """Index and name of each component of the deflection of its friction's bristles, which is the velocity of an
    internal coordinate: one in the plane."""
    kind: int = EQUATIONS
    """What is known of its geometry."""
    units: tuple[str, str] = ("m", "m")
    """Of gap and sliding distance."""
    size: float = 1.0
    """Sliding distance in the tables by a unit of that in `units`."""
    has_shapes: bool = True
    """False: the friction of a joint, whose gap and normal force mean nothing."""
    companion: int = 0
    """How far on the contact stands with which it has three tangents together; 0: there is none."""
    resists_turning: bool = False
    """Whether it has friction against rolling or spinning."""
    pooled: bool = False
    """Whether it is a slot of a pool, which pairs take and leave (`contact_pool.py`)."""

    @property
    def coulomb(self) -> CoulombFriction | None:
        """Its friction if the contact is a constraint."""
        return self.friction if isinstance(self.friction, CoulombFriction) else None

    @property
    def second_row(self) -> int:
        """Row of the second tangent; -1: it has none."""
        return self.slide_row + 1 if self.tangents > 1 else -1


@dataclass
class Assembly:
    """A system as flat tables: what the workspace is built from."""

    n: int
    """Number of coordinates."""
    m: int
    """Number of rows of Phi: joints first, then one for each contact."""
    m_joints: int
    batches: list[Batch]
    q0: NDArray[np.float64]
    v0: NDArray[np.float64]
    row_names: list[str]
    """Name of the joint or contact that each row belongs to."""
    coordinate_names: list[str]
    contacts: list[ContactInfo]
    work_names: list[str]
    signals: NDArray[np.float64]
    input_names: list[str]
    input_start: NDArray[np.float64]
    breakpoints: list[float]
    multiplier_channels: dict[int, Channel]
    """Of those rows whose multiplier is shown."""
    body_columns: list[tuple[str, Coordinate, int]]
    """(body, coordinate, index)."""
    coordinate_scale: NDArray[np.float64]
    """Typical magnitude of each coordinate, so that units do not choose the partition."""
    work_sizes: dict[str, float] = field(default_factory=dict)
    """How large the values of work accounts are that are no energies."""
    length: float = 1.0
    """Size of the mechanism, m."""
    row_scale: NDArray[np.float64] | None = None
    """How large each row of Phi typically is, (m,); None: as far as the coordinates' scales move it."""
    compliance: NDArray[np.float64] | None = None
    """Of the contact or joint that each row of Phi is of, (m,), relative to others; None: all 1."""
    longest_step: float = np.inf
    """Step beyond which error control could miss what a time function does, s."""
    rate_rows: frozenset[int] = frozenset()
    """Rows that hold at velocity level only (`elements/base.Form.rate_rows`)."""
    replaced_rows: dict[int, frozenset[int]] = field(default_factory=dict)
    """Rows of massless ends, each with the contacts that take its place when they close."""
    derived: tuple[Derived, ...] = ()
    """Channels that follow from coordinates and multipliers."""
    motions: tuple[InputMotion, ...] = ()
    """Motions that are inputs."""
    pool: ContactPool | None = None
    """Pools of contacts; None: there are none."""
    placed: tuple[tuple[int, int], ...] = ()
    """(coordinate, row) pairs: it starts where that row of Phi says, Phi_row = q - f(t)."""
    linear: bool = False
    """All elements are linear with constant coefficients."""
    n_internal: int = 0
    """How many of the coordinates, the last ones, are internal ones of elements: states without a place, whose values
    are the velocities."""
    bind: Callable[[Any], None] | None = None
    """Called with the workspace that is built from this assembly (user-written equations read its arrays)."""
    user_error: list[BaseException] = field(default_factory=list)
    """An exception that a user's function raised inside the compiled loop."""

    @property
    def n_slots(self) -> int:
        """How many contacts are slots of pools."""
        return 0 if self.pool is None else len(self.pool.contacts)

    @property
    def massless_contacts(self) -> frozenset[int]:
        """Contacts at massless ends."""
        return frozenset().union(*self.replaced_rows.values())

    @property
    def leap(self) -> NDArray[np.float64]:
        """How far one error-controlled step may move each coordinate, (n,), where that is no polynomial of time: half
        its scale, so that the dense output between its ends is as good as these. Without contacts nothing limits it."""
        if not self.contacts:
            return np.full(self.n, np.inf)
        leap = 0.5 * self.coordinate_scale
        leap[self.n - self.n_internal :] = np.inf
        return leap

    @property
    def has_waves(self) -> bool:
        """Whether a body has more coordinates than a rigid one: those of a mesh or modes, with own vibrations."""
        counts = Counter(body for body, _, _ in self.body_columns)
        return max(counts.values(), default=0) > LARGEST_RIGID

    @property
    def attitudes(self) -> NDArray[np.int64]:
        """The first of the Euler parameters of each body that has some."""
        return np.array([index for _, coordinate, index in self.body_columns if coordinate == EULER[0]], dtype=np.int64)

    @property
    def attitude_bodies(self) -> NDArray[np.int64]:
        """Batch and element of the rigid body whose Euler parameters these are, (attitudes, 2); -1 for others."""
        address = kernel_address(rigid_body3d_kernel)
        places = {
            int(first): (k, element)
            for k, batch in enumerate(self.batches)
            if batch.address == address
            for element, first in enumerate(batch.coord[:, 3])
        }
        found = [places.get(int(first), (-1, -1)) for first in self.attitudes]
        return np.array(found, dtype=np.int64).reshape(-1, 2)

    @property
    def is_internal(self) -> NDArray[np.bool_]:
        """Which coordinates are internal ones."""
        return np.arange(self.n) >= self.n - self.n_internal

    @property
    def is_angle(self) -> NDArray[np.bool_]:
        """Which coordinates tell attitudes, (n,); the others count as lengths (m)."""
        angles = np.zeros(self.n, dtype=bool)
        angles[[index for _, coordinate, index in self.body_columns if coordinate.is_angle]] = True
        return angles

    @property
    def ground(self) -> int:
        """Index of what does not move in extended vectors."""
        return self.n

    @property
    def n_extended(self) -> int:
        """Length of extended vectors."""
        return self.n + AT_REST + len(self.work_names)

    def count_active(
        self, closed: frozenset[int], sticking: frozenset[int], dropped: frozenset[int], implied: frozenset[int]
    ) -> tuple[int, int]:
        """How many rows of Phi are constraints with these contacts (`tables/switch.key_of`), without the rows `dropped`
        and those that others imply, and how many of them have a position form."""
        count, contacts = len(self.contacts), self.contacts
        out = dropped | {row for row, by in self.replaced_rows.items() if by & closed}
        rows = {row for row in range(self.m_joints) if row not in out} | {contacts[k].row for k in closed}
        rows |= {contacts[k % count].slide_row + k // count for k in sticking}
        rows -= {contacts[k].row for k in implied if k < count}
        rows -= {contacts[k % count].slide_row + k // count - 1 for k in implied if k >= count}
        return len(rows), len(rows - self.rate_rows)

    def work_index(self, name: str) -> int:
        """Index of a work account in extended vectors."""
        return self.n + AT_REST + self.work_names.index(name)


def _bristles_of(contact: ContactElement, numbering: ModelNumbering) -> tuple[tuple[int, str], ...]:
    if not isinstance(contact.friction, LuGreFriction):
        return ()
    return tuple(zip(numbering.internal(contact.name), contact.internal_coordinates(), strict=True))


def _table(rows: Sequence[Sequence[float]], dtype: type) -> NDArray:
    return np.ascontiguousarray(np.array(rows, dtype=dtype).reshape(len(rows), -1))


def assemble(model: Parts, start: Mapping[str, float] = NO_START, t0: float = 0.0) -> Assembly:
    """The model as flat tables, for runs that start at t0, s; `start` are other values at the start than its own, by
    names of channels, of which only the turns of angles are taken here. Raises ModelError without bodies, and for a
    contact of a body with itself."""
    if not model.bodies:
        raise ModelError(f"model '{model.name}' has no bodies, so nothing can move: give it at least one in `bodies`")
    numbering = ModelNumbering(model, start, t0)
    contacts = numbering.tabulated.contacts
    for contact in contacts:
        bodies = [marker.body for marker in contact.markers()]
        if len(bodies) > 1 and len(set(bodies)) == 1:
            raise ModelError(
                f"both sides of contact '{contact.name}' are on '{bodies[0]}': nothing moves there; "
                "put them on two bodies"
            )
    grouped: dict[tuple[int, int, int], list[tuple[Element, Row, tuple[int, ...]]]] = {}
    forms: dict[tuple[int, int, int], Form] = {}
    row_names: list[str] = []
    multipliers: dict[int, Channel] = {}
    derived: list[Derived] = []
    contact_rows: dict[str, tuple[int, ...]] = {}
    massless: dict[int, int] = {}
    placed: list[tuple[int, int]] = []
    rate_rows: set[int] = set()
    contact_names = set(numbering.contact_numbers)
    for element in numbering.tabulated.all:
        own_rows = len(row_names)
        for part in element.parts(numbering):
            form = part.form
            rows = tuple(range(len(row_names), len(row_names) + form.constraint_rows))
            row_names += [element.name] * form.constraint_rows
            rate_rows |= {rows[k] for k in form.rate_rows}
            if element.name in contact_names:
                contact_rows[element.name] = rows
            if part.massless >= 0:
                massless[rows[0]] = part.massless
            placed += zip(element.placed(numbering), rows, strict=False)
            address = kernel_address(form.kernel)
            for row in part.rows:
                key = (address, len(row.coordinates), len(part.felt_rows))
                forms[key] = form
                grouped.setdefault(key, []).append((element, row, (*rows, *part.felt_rows)))
        own = numbering.rows[element.name] = range(own_rows, len(row_names))
        multipliers |= dict(zip(own, element.multiplier_channels(), strict=False))
        derived += element.derived_channels(numbering, own)
    derived += _of_outputs(model.outputs, numbering)
    batches = []
    for key, members in grouped.items():
        batches.append(
            Batch(
                key[0],
                _table([row.parameters for _, row, _ in members], np.float64),
                _table([row.coordinates for _, row, _ in members], np.int64),
                _table([rows for _, _, rows in members], np.int64),
                _table([row.extra for _, row, _ in members], np.int64),
                forms[key].tangent_pattern,
                forms[key].jacobian_pattern,
                np.array([numbering.contact_numbers.get(e.name, -1) for e, _, _ in members], dtype=np.int64),
            )
        )
    internal = np.arange(numbering.n - len(numbering.internal_names), numbering.n)
    if len(internal):
        batches.append(_internal_batch(internal))
    rest = ((0.0,) * len(internal),) * 2
    states: list[tuple[Sequence[float], Sequence[float]]] = [
        *(body.start_in(numbering.bodies, numbering.input_start) for body in model.bodies),
        rest,
    ]
    columns, names = [], []
    for body in model.bodies:
        for coordinate, index in zip(body.coordinate_records(), numbering.index[body.name], strict=False):
            columns.append((body.name, coordinate, index))
            names.append(f"{body.name}.{coordinate.name}")
    q0 = np.array([x for q, _ in states for x in q], dtype=np.float64)
    m_joints = len(row_names) - sum(len(rows) for rows in contact_rows.values())
    compliances = {joint.name: joint.compliance for joint in numbering.joints.values() if joint.compliance != 1.0}
    compliances |= {contact.name: contact.compliance for contact in contacts if contact.compliance != 1.0}
    return Assembly(
        n=numbering.n,
        m=len(row_names),
        m_joints=m_joints,
        batches=batches,
        q0=q0,
        v0=np.array([x for _, v in states for x in v], dtype=np.float64),
        row_names=row_names,
        coordinate_names=[*names, *numbering.internal_names],
        contacts=[
            ContactInfo(
                c.name,
                contact_rows[c.name][0],
                c.law,
                numbering.work(f"{c.name}.impulse"),
                numbering.work(f"{c.name}.dissipation"),
                c.extent(),
                contact_rows[c.name][1] if len(contact_rows[c.name]) > 1 else -1,
                max(len(contact_rows[c.name]) - 1, 1),
                c.friction,
                _bristles_of(c, numbering),
                kind=kind_of(c.geometry()),
                units=c.units_in(numbering.bodies),
                size=c.size_in(numbering.length),
                has_shapes=c.has_shapes,
                companion=c.companion,
                resists_turning=c.resists_turning,
                pooled=isinstance(c, PooledContact3D),
            )
            for c in contacts
        ],
        work_names=list(numbering.work_numbers),
        work_sizes=numbering.work_sizes,
        signals=np.array([*numbering.pool, 0.0]),
        input_names=[record.name for record in model.inputs],
        input_start=np.array([record.start for record in model.inputs], dtype=np.float64),
        breakpoints=sorted({t for e in model.elements() for s in e.signals() for t in s.breakpoints()}),
        multiplier_channels=multipliers,
        body_columns=columns,
        coordinate_scale=_coordinate_scale(numbering.length, columns, len(internal)),
        length=numbering.length,
        compliance=np.array([compliances.get(name, 1.0) for name in row_names]) if compliances else None,
        rate_rows=frozenset(rate_rows),
        replaced_rows=_replaced_rows(contacts, massless, batches),
        derived=tuple(derived),
        motions=tuple(numbering.motions),
        pool=pool_of(contacts, numbering),
        placed=tuple(placed),
        linear=all(element.linear for element in model.elements()),
        n_internal=len(internal),
        longest_step=min((s.longest_step() for e in model.elements() for s in e.signals()), default=np.inf),
    )


def _of_outputs(outputs: Sequence[MarkerOutput], numbering: ModelNumbering) -> list[Derived]:
    """The channels of outputs, all of one kind together."""
    kinds = dict.fromkeys(type(output) for output in outputs)
    return [k.derived([o for o in outputs if type(o) is k], numbering.own_frame) for k in kinds]


def _replaced_rows(
    contacts: Sequence[ContactElement], massless: Mapping[int, int], batches: Sequence[Batch]
) -> dict[int, frozenset[int]]:
    """Each massless end's row with the contacts that move its coordinate. Raises ModelError for contacts that need a
    mass there."""
    found = {}
    for row, coordinate in massless.items():
        moving = [b.contact[np.any(b.coord == coordinate, axis=1)] for b in batches if np.any(b.contact >= 0)]
        found[row] = frozenset(int(k) for k in np.concatenate([*moving, np.zeros(0, np.int64)]) if k >= 0)
    for k, contact in enumerate(contacts):
        ends = [row for row, moving in found.items() if k in moving]
        if not ends:
            continue
        restitution = getattr(contact.law, "restitution", 0.0)
        if isinstance(contact.law, ForceLaw) or restitution != 0.0 or contact.friction is not None:
            raise ModelError(
                f"contact '{contact.name}' is at a massless end, which takes no impulse: it must be a constraint "
                "without friction and with restitution 0 (NewtonImpact), or the end must have mass"
            )
        if len(ends) > 1:
            raise ModelError(
                f"contact '{contact.name}' is between two massless ends: nothing says where they are while it is "
                "closed; leave the mass at one of them"
            )
    return found


def _internal_batch(internal: NDArray[np.int64]) -> Batch:
    """The unit masses of internal coordinates."""
    count = len(internal)
    nothing, address = np.zeros((count, 0), dtype=np.int64), kernel_address(internal_coordinates_kernel)
    none = np.full(count, -1, dtype=np.int64)
    return Batch(address, np.zeros((count, 0)), internal[:, None].copy(), nothing, nothing, ((0, 0),), (), none)


def _coordinate_scale(
    length: float, columns: Sequence[tuple[str, Coordinate, int]], n_internal: int
) -> NDArray[np.float64]:
    """What the coordinates say, 1 for angles; for translations of bodies the size of the mechanism, so that m
    and mm give the same partition. Internal coordinates change no size: they have that of the mechanism."""
    scales = [length if coordinate.scale is None else coordinate.scale for _, coordinate, _ in columns]
    return np.array([*scales, *(length,) * n_internal])
