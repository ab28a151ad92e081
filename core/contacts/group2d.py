"""Contacts between groups of shapes, instead of pairs listed by hand.

Which pairs can touch follows from the shapes (`pair_table.py`). Pairs on one body are left out. Pairs that are far from
touching cost nothing during a run: contacts sleep until their margin is used up
(`event_detection/contact_sleeping.py`).
"""

from collections.abc import Iterable
from itertools import combinations, product
from typing import Literal

from ..errors import ModelError
from ..laws import ContactLaw
from ..laws.friction import Friction, TurningFriction
from ..model.base import Name, Positive, Record, Vector3
from ..model.signals import Signal
from . import CONTACTS
from .contact2d import Contact2D, Disk2D, HalfPlane2D
from .contact3d import Contact3D
from .disk_on_box2d import Box2D
from .group_surfaces import with_surface
from .groups import ContactGroup
from .pair_table import Make, body_of, contacts_of, in_plane
from .polygon2d import Polygon2D
from .ring2d import Ring2D
from .segment2d import Segment2D
from .shape import AnyShape2D

MOST_PAIRS = 200_000


def contacts_between(
    name: str,
    shapes: Iterable[Record],
    others: Iterable[Record] | None = None,
    *,
    law: ContactLaw,
    friction: Friction | None = None,
    turning: TurningFriction | None = None,
    except_bodies: Iterable[tuple[str, str]] = (),
    pass_through: Iterable[tuple[str, str]] = (),
    surface_speed: float | Signal | None = None,
    surface_direction: Vector3 | None = None,
    surface_body: str | None = None,
    compliance: float = 1.0,
) -> tuple[Contact2D | Contact3D, ...]:
    """Contacts of all pairs of `shapes` with each other, or of `shapes` with `others`, for a model's `contacts`.

    Parameters
    ----------
    name : the contacts are called name_body1_body2, with a number behind where two bodies have several.
    law, friction : of all of them.
    turning : friction against rolling and spinning, of those in space.
    except_bodies : pairs of bodies that do not touch, such as those that a joint holds together.
    pass_through : pairs of kinds of shapes that have no contact, and pass through each other: ("Box3D", "Cylinder3D").
    surface_speed, surface_direction, surface_body : speed of the surface of one of the bodies, as that of a belt, m/s;
        in space along a direction in the frame of that body (`group_surfaces.py`).
    compliance : of each of them, relative to other contacts.

    Raises
    ------
    ModelError : for more than MOST_PAIRS pairs, shapes of which no pair can touch, two that have no contact and are not
        said to pass through each other, kinds of `pass_through` that are not among the shapes, and a pair declared
        with a class that is neither a contact of the plane nor of space.
    """
    first = tuple(shapes)
    second = None if others is None else tuple(others)
    count = len(first) * (len(first) - 1) // 2 if second is None else len(first) * len(second)
    if count > MOST_PAIRS:
        raise ModelError(
            f"group '{name}' has {count} pairs of shapes, more than {MOST_PAIRS}: "
            "make smaller groups, or give a group of spheres `most_contacts`"
        )
    pairs = combinations(first, 2) if second is None else product(first, second)
    apart = {frozenset(pair) for pair in except_bodies}
    through = _kinds_apart(name, pass_through, (*first, *(second or ())))
    len(CONTACTS)  # all are imported, so that the table is complete
    named: dict[str, list[tuple[bool, Make]]] = {}
    for a, b in pairs:
        bodies = body_of(a), body_of(b)
        if bodies[0] == bodies[1] or frozenset(bodies) in apart:
            continue
        if frozenset((type(a).__name__, type(b).__name__)) in through:
            continue
        found = [(in_plane(a), make) for make in contacts_of(a, b)]
        named.setdefault(f"{name}_{bodies[0]}_{bodies[1]}", []).extend(found)
    made: list[Contact2D | Contact3D] = []
    for label, touching in named.items():
        for k, (planar, make) in enumerate(touching):
            own = label if len(touching) == 1 else f"{label}_{k + 1}"
            more = {} if planar else {"turning": turning}
            contact = make(name=own, law=law, friction=friction, compliance=compliance, **more)
            if not isinstance(contact, Contact2D | Contact3D):
                raise ModelError(
                    f"group '{name}': the contact of two shapes must inherit Contact2D or Contact3D, and "
                    f"{type(contact).__name__} does not: use such a class where the pair is declared (pair, touching)"
                )
            made.append(contact)
    if not made:
        raise ModelError(
            f"group '{name}' has no two shapes that can touch: disks touch all shapes, boxes touch boxes and "
            "half-planes, and shapes of one body never touch each other"
        )
    return with_surface(name, made, surface_speed, surface_direction, surface_body)


class ContactGroup2D(ContactGroup):
    """Shapes of which each may touch each other: one record for all their contacts.

    A model makes the contacts of all pairs that can touch, as `contacts_between` does, and calls them
    name_body1_body2. They sleep while they are far apart. Law and friction are changed here, for all of them.
    """

    type: Literal["ContactGroup2D"] = "ContactGroup2D"
    disks: tuple[Disk2D, ...] = ()
    """They touch all shapes."""
    boxes: tuple[Box2D, ...] = ()
    """They touch boxes, polygons and half-planes by their corners, and disks."""
    polygons: tuple[Polygon2D, ...] = ()
    """They touch what boxes touch."""
    segments: tuple[Segment2D, ...] = ()
    """They touch disks."""
    half_planes: tuple[HalfPlane2D, ...] = ()
    """They touch disks, boxes and polygons."""
    rings: tuple[Ring2D, ...] = ()
    """They hold disks in them, every one of the group."""
    shapes: tuple[AnyShape2D, ...] = ()
    """Shapes of any kind, own ones too."""
    law: ContactLaw
    """What happens when a gap closes."""
    friction: Friction | None = None
    """What resists sliding; left out: nothing."""
    except_bodies: tuple[tuple[str, str], ...] = ()
    """Pairs of bodies that do not touch, such as those that a joint holds together."""
    pass_through: tuple[tuple[str, str], ...] = ()
    """Pairs of kinds of shapes that pass through each other, such as "Box2D" and "Segment2D", which have no contact."""
    surface_speed: float | Signal | None = None
    """Speed of the surface of `surface_body`, a belt, m/s, a number or over time: along the outward normal turned by
    -90 degrees, to the right on top of a box."""
    surface_body: Name | None = None
    """Name of the body whose surface moves, or "ground"; left out: none."""
    compliance: Positive = 1.0
    """How far each of its contacts gives way over how far others do, dimensionless."""

    def contacts(self) -> tuple[Contact2D | Contact3D, ...]:
        """Its contacts. Raises ModelError as `contacts_between` does."""
        return contacts_between(
            self.name, self.all_shapes(), law=self.law, friction=self.friction, except_bodies=self.except_bodies,
            pass_through=self.pass_through, surface_speed=self.surface_speed, surface_body=self.surface_body,
            compliance=self.compliance,
        )  # fmt: skip


def _kinds_apart(name: str, pairs: Iterable[tuple[str, str]], shapes: Iterable[Record]) -> set[frozenset[str]]:
    """The pairs of kinds that pass through each other. Raises ModelError for a kind that is not there."""
    there, found = sorted({type(shape).__name__ for shape in shapes}), [tuple(pair) for pair in pairs]
    missing = next((kind for pair in found for kind in pair if kind not in there), None)
    if missing is not None:
        raise ModelError(
            f"group '{name}' lets '{missing}' pass through others, but has no such shape: it has "
            f"{', '.join(there) or 'none'}; mend the name in pass_through or leave the pair out"
        )
    return {frozenset(pair) for pair in found}
