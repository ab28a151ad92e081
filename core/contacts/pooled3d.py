"""Contacts of a pool: slots that near pairs of a group of shapes take while they are near."""

from collections.abc import Mapping, Sequence
from typing import ClassVar, Literal

from ..elements.base import BodyElement, Numbering, Row
from ..elements.measure3d import PLACE
from ..errors import ModelError
from ..laws.friction import LuGreFriction
from ..model.base import Record
from ..model.markers import Marker3D
from .contact3d import Contact3D, HalfSpace3D, Sphere3D

FAR = 1e3
"""Gap of a slot that no pair has, in lengths of the model."""


class PooledShapes3D(Record):
    """Shapes of which any two may touch."""

    spheres: tuple[Sphere3D, ...]
    """They touch each other and the half-spaces."""
    half_spaces: tuple[HalfSpace3D, ...] = ()
    """Fixed to the ground."""
    except_bodies: tuple[tuple[str, str], ...] = ()
    """Pairs of bodies that do not touch."""

    @property
    def shapes(self) -> tuple[Sphere3D | HalfSpace3D, ...]:
        """All of them: spheres, then half-spaces."""
        return (*self.spheres, *self.half_spaces)


class PooledContact3D(Contact3D):
    """A slot of a pool. Until a pair takes it, its gap is that of a fixed point far above a fixed plane: a valid
    contact that never closes."""

    type: Literal["PooledContact3D"] = "PooledContact3D"
    kind: ClassVar[int] = PLACE

    pool: PooledShapes3D
    """The shapes, which all slots of a group share."""
    slot: int
    """Its number in the group, from 0 on."""

    def row(self, numbering: Numbering) -> Row:
        plane, point = Marker3D(), Marker3D(point=(0.0, 0.0, FAR * numbering.length))
        return self._row_of(numbering, plane, point, 0.0, 0.0)

    def markers(self) -> Sequence[Marker3D]:
        """Those of all shapes; the first slot has them for the others."""
        return tuple(shape.marker for shape in self.pool.shapes) if self.slot == 0 else ()

    def lengths(self) -> Sequence[float]:
        return tuple(sphere.radius for sphere in self.pool.spheres) if self.slot == 0 else ()

    def extent(self) -> float:
        return 2.0 * min(sphere.radius for sphere in self.pool.spheres)

    def check_in(self, bodies: Mapping[str, BodyElement]) -> None:
        if self.slot == 0:
            super().check_in(bodies)


def pooled_contacts(
    name: str, pool: PooledShapes3D, most: int, **more: object
) -> tuple[PooledContact3D, ...]:  # fmt: skip
    """The slots of a group; more : fields that all contacts have, such as law and friction.

    Raises
    ------
    ModelError : for shapes or laws that no pool has.
    """
    moving = [shape.marker.body for shape in pool.half_spaces if shape.marker.body != "ground"]
    if moving:
        raise ModelError(
            f"group '{name}' has `most_contacts`, and a half-space on '{moving[0]}': half-spaces of such a group are "
            "fixed to the ground; leave `most_contacts` out, or take spheres for the shape that moves"
        )
    if isinstance(more.get("friction"), LuGreFriction):
        raise ModelError(
            f"group '{name}' has `most_contacts`, and LuGre friction, whose bristles belong to one pair for the whole "
            "run; take another law of friction, or leave `most_contacts` out"
        )
    if len(pool.spheres) < 1 or any(sphere.radius <= 0.0 for sphere in pool.spheres):
        raise ModelError(f"group '{name}' has `most_contacts`, which needs spheres, each with a radius above 0")
    return tuple(PooledContact3D(name=f"{name}_{k + 1}", pool=pool, slot=k, **more) for k in range(most))
