"""Groups of shapes in space of which each may touch each other."""

from typing import Literal

from pydantic import PositiveInt

from ..errors import ModelError
from ..laws import ContactLaw
from ..laws.friction import Friction, TurningFriction
from ..model.base import Name, Positive, Vector3
from ..model.signals import Signal
from ..model.words import an
from .contact2d import Contact2D
from .contact3d import Contact3D, HalfSpace3D, Sphere3D
from .cornered3d import Box3D, Capsule3D, ConvexPolyhedron3D, Cylinder3D
from .group2d import contacts_between
from .groups import ContactGroup
from .mesh3d import TriangleMesh3D
from .on_cable3d import CableLine3D
from .pooled3d import PooledShapes3D, pooled_contacts
from .round3d import Smooth3D
from .shape import AnyShape3D


class ContactGroup3D(ContactGroup):
    """Shapes in space of which each may touch each other: one record for all their contacts.

    A model makes the contacts of all pairs that can touch, as `contacts_between` does, and calls them
    name_body1_body2. They sleep while they are far apart. Law and friction are changed here, for all of them.
    """

    type: Literal["ContactGroup3D"] = "ContactGroup3D"
    spheres: tuple[Sphere3D, ...] = ()
    """They touch all shapes."""
    boxes: tuple[Box3D, ...] = ()
    """They touch spheres, boxes, polyhedra and capsules, and half-spaces by their corners."""
    polyhedra: tuple[ConvexPolyhedron3D, ...] = ()
    """They touch spheres, boxes, polyhedra and capsules, and half-spaces by their corners."""
    capsules: tuple[Capsule3D, ...] = ()
    """They touch spheres, boxes, polyhedra, capsules and half-spaces."""
    cylinders: tuple[Cylinder3D, ...] = ()
    """They touch spheres, and half-spaces by their rims."""
    meshes: tuple[TriangleMesh3D, ...] = ()
    """They touch spheres, and half-spaces by the corners of their hulls."""
    smooth: tuple[Smooth3D, ...] = ()
    """Ellipsoids, tori and own smooth shapes; they touch spheres and half-spaces."""
    cables: tuple[CableLine3D, ...] = ()
    """They touch spheres anywhere, and half-spaces by points."""
    half_spaces: tuple[HalfSpace3D, ...] = ()
    """They touch all shapes but half-spaces."""
    shapes: tuple[AnyShape3D, ...] = ()
    """Shapes of any kind, own ones too."""
    law: ContactLaw
    """What happens when a gap closes."""
    friction: Friction | None = None
    """What resists sliding; left out: nothing."""
    turning: TurningFriction | None = None
    """What resists rolling and spinning; left out: nothing."""
    except_bodies: tuple[tuple[str, str], ...] = ()
    """Pairs of bodies that do not touch, such as those that a joint holds together."""
    pass_through: tuple[tuple[str, str], ...] = ()
    """Pairs of kinds of shapes that pass through each other, such as "Box3D" and "Cylinder3D", which have no
    contact."""
    surface_speed: float | Signal | None = None
    """Speed of the surface of `surface_body`, a belt, m/s, a number or over time."""
    surface_direction: Vector3 | None = None
    """Direction in which it goes, dimensionless, in the frame of that body; of any length but zero."""
    surface_body: Name | None = None
    """Name of the body whose surface moves, or "ground"; left out: none."""
    compliance: Positive = 1.0
    """How far each of its contacts gives way over how far others do, dimensionless."""
    most_contacts: PositiveInt | None = None
    """Room for so many contacts at once, in place of a contact for each pair of shapes: pairs that come near take one
    and leave it when they part. For many spheres in fixed half-spaces, about eight times as many as there are spheres.
    The group's channels are sums over all of its contacts. Left out: a contact for each pair."""

    def contacts(self) -> tuple[Contact2D | Contact3D, ...]:
        """Its contacts. Raises ModelError as `contacts_between` does, for pairs too that have no contact, such as a
        box and a cylinder, if `pass_through` does not name them, and with `most_contacts` for shapes that have no
        pool."""
        if self.most_contacts is not None:
            return self._pooled(self.most_contacts)
        return contacts_between(
            self.name, self.all_shapes(), law=self.law, friction=self.friction,
            turning=self.turning, except_bodies=self.except_bodies, pass_through=self.pass_through,
            surface_speed=self.surface_speed, surface_direction=self.surface_direction, surface_body=self.surface_body,
            compliance=self.compliance,
        )  # fmt: skip

    def _pooled(self, most: int) -> tuple[Contact3D, ...]:
        spheres = tuple(shape for shape in self.all_shapes() if isinstance(shape, Sphere3D))
        half_spaces = tuple(shape for shape in self.all_shapes() if isinstance(shape, HalfSpace3D))
        others = [
            an(type(shape).__name__) for shape in self.all_shapes() if not isinstance(shape, Sphere3D | HalfSpace3D)
        ]
        if others or self.pass_through or self.surface_speed is not None or self.surface_body is not None:
            given = others or ["pass_through" if self.pass_through else "a surface that moves"]
            raise ModelError(
                f"group '{self.name}' has `most_contacts` and {given[0]}: such a group has spheres and half-spaces "
                "that are fixed to the ground and do not move; put the others into a group without `most_contacts`"
            )
        pool = PooledShapes3D(spheres=spheres, half_spaces=half_spaces, except_bodies=self.except_bodies)
        return pooled_contacts(
            self.name, pool, most, law=self.law, friction=self.friction, turning=self.turning,
            compliance=self.compliance,
        )  # fmt: skip
