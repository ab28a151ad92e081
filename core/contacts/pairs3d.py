"""Which shapes in space touch each other, and the contacts that say so."""

from collections.abc import Sequence
from typing import Any

from ..errors import ModelError
from ..laws import ForceLaw
from ..model.markers import GROUND
from ..model.words import an
from .ball_on_round3d import SphereOnCylinder3D, SphereOnRing3D, SphereOnSmooth3D
from .contact3d import Contact3D, HalfSpace3D, Sphere3D, SphereOnHalfSpace3D, SphereOnSphere3D
from .cornered3d import Box3D, Capsule3D, ConvexPolyhedron3D, Cornered3D, Cylinder3D
from .edges3d import EdgesOnEdges3D, EdgesPart, contacts_of_edged
from .hull_faces import faces_of
from .mesh3d import TriangleMesh3D
from .on_cable3d import CableLine3D, CableOnHalfSpace3D, CableSpot, SphereOnCable3D
from .on_mesh3d import MeshPart, SphereOnMesh3D, mesh_parts
from .rings3d import Torus3D
from .round3d import CapsuleOnCapsule3D, Crossing, SmoothOnHalfSpace3D, capsule_contacts
from .support3d import SmoothShape3D

SpatialShape = Sphere3D | HalfSpace3D | Cornered3D | SmoothShape3D | CableLine3D
SpatialPart = CableSpot | Crossing | EdgesPart | MeshPart
SpatialPair = tuple[SpatialShape, SpatialShape | SpatialPart]


def body_of(shape: Any) -> str:
    """Name of the body, or cable, that a shape belongs to."""
    return shape.cable if isinstance(shape, CableLine3D) else str(shape.marker.body)


def no_contact(a: Any, b: Any, remedy: str) -> ModelError:
    """What is raised for two shapes that have no contact."""
    one, other = (f"{an(type(shape).__name__)} on '{body_of(shape)}'" for shape in (a, b))
    return ModelError(f"{one} and {other} have no contact: {remedy}")


def open_contacts(a: SpatialShape, b: SpatialShape) -> Sequence[SpatialPair]:
    """Pairs of shapes and parts of them, each of which is one contact.

    Raises
    ------
    ModelError : for two shapes that have no contact.
    """
    for one, other in ((a, b), (b, a)):
        if isinstance(one, HalfSpace3D) and not isinstance(other, HalfSpace3D):
            return _on_half_space(one, other)
    for one, other in ((a, b), (b, a)):
        if isinstance(other, Sphere3D):
            return _by_sphere(one, other)
    if isinstance(a, Capsule3D) and isinstance(b, Capsule3D):
        return capsule_contacts(a, b)
    if body_of(a) == body_of(b) == GROUND:
        return ()
    edged = (Box3D, ConvexPolyhedron3D, Capsule3D)
    if isinstance(a, edged) and isinstance(b, edged):
        return contacts_of_edged(a, b)
    if isinstance(a, HalfSpace3D) and isinstance(b, HalfSpace3D):
        raise no_contact(a, b, "both reach to infinity; take a box for the one that moves")
    kinds = type(a).__name__, type(b).__name__
    raise no_contact(
        a, b, "in space all shapes touch spheres and half-spaces, and boxes, convex polyhedra and capsules each other. "
        "Give one of them such shapes in its place; or, if they shall pass through each other, say so: "
        f'pass_through=[("{kinds[0]}", "{kinds[1]}")]',
    )  # fmt: skip


def _on_half_space(plane: HalfSpace3D, shape: SpatialShape) -> Sequence[SpatialPair]:
    if isinstance(shape, Cylinder3D | Torus3D):
        return tuple((plane, part) for part in shape.touching())
    if isinstance(shape, CableLine3D):
        return tuple((plane, CableSpot(shape, place)) for place in shape.places)
    if isinstance(shape, Cornered3D):
        return tuple((plane, corner) for corner in shape.corners())
    return ((plane, shape),)


def _by_sphere(shape: SpatialShape, ball: Sphere3D) -> Sequence[SpatialPair]:
    if isinstance(shape, Sphere3D):
        # two points never touch
        return ((shape, ball),) if shape.radius + ball.radius > 0.0 else ()
    if isinstance(shape, TriangleMesh3D):
        return tuple((ball, MeshPart(shape, k)) for k in range(len(mesh_parts(shape))))
    if isinstance(shape, Box3D | ConvexPolyhedron3D):
        return ((ball, MeshPart(faces_of(shape), 0, shape.rounding())),)
    return ((shape, ball),)


def contact_in_space(a: SpatialShape, other: SpatialShape | SpatialPart, more: dict[str, Any]) -> Contact3D:
    """The contact of a pair that `open_contacts` found; `more` are the fields that those of all pairs have."""
    name, law = more["name"], more["law"]
    if isinstance(other, MeshPart) and isinstance(a, Sphere3D):
        return SphereOnMesh3D(mesh=other.mesh, part=other.part, rounding=other.rounding, sphere=a, **more)
    if isinstance(other, EdgesPart) and isinstance(a, Box3D | ConvexPolyhedron3D | Capsule3D):
        if other.made_round and isinstance(law, ForceLaw):
            raise ModelError(
                f"contact '{name}' is of sharp shapes, which a {type(law).__name__} lets sink into each other: edges "
                "pass through one another where they sink in by more than both are rounded. Give one of them a radius "
                "that is larger (`edge_radius` of a box), or take a law such as NewtonImpact"
            )
        return EdgesOnEdges3D(a=a, b=other.shape, sort_a=other.sort_a, sort_b=other.sort_b, **more)
    if isinstance(other, CableSpot) and isinstance(a, HalfSpace3D):
        on = other.line
        return CableOnHalfSpace3D(plane=a, cable=on.cable, thickness=on.thickness, place=other.place, **more)
    if isinstance(a, CableLine3D) and isinstance(other, Sphere3D):
        return SphereOnCable3D(cable=a.cable, thickness=a.thickness, sphere=other, **more)
    if isinstance(other, Sphere3D) and (isinstance(a, Cylinder3D) or (isinstance(a, Torus3D) and a.rim_radius == 0.0)):
        return SphereOnCylinder3D(shape=a, sphere=other, **more)
    if isinstance(a, Torus3D) and isinstance(other, Sphere3D):
        return SphereOnRing3D(ring=a, sphere=other, **more)
    if isinstance(a, SmoothShape3D) and isinstance(other, Sphere3D):
        return SphereOnSmooth3D(shape=a, sphere=other, **more)
    if isinstance(a, Capsule3D) and isinstance(other, Crossing):
        return CapsuleOnCapsule3D(a=a, b=other.capsule, parallel_tilt=other.tilt, **more)
    if isinstance(a, Capsule3D) and isinstance(other, Sphere3D):
        return CapsuleOnCapsule3D(a=a, b=other, **more)
    if isinstance(a, HalfSpace3D) and isinstance(other, SmoothShape3D):
        return SmoothOnHalfSpace3D(plane=a, shape=other, **more)
    if isinstance(a, HalfSpace3D) and isinstance(other, Sphere3D):
        return SphereOnHalfSpace3D(plane=a, sphere=other, **more)
    if isinstance(a, Sphere3D) and isinstance(other, Sphere3D):
        return SphereOnSphere3D(a=a, b=other, **more)
    raise TypeError(f"{type(a).__name__} and {type(other).__name__} are no pair")
