"""Base of all contacts: a gap between two shapes, a law along the normal, and friction."""

import math
from collections.abc import Mapping, Sequence
from typing import Any, ClassVar, cast

from pydantic import model_validator

from ..elements.base import BodyElement, Element, Numbering, Row
from ..laws import ContactLaw, ForceLaw
from ..laws.friction import CoulombFriction, Friction, LuGreFriction
from ..model.base import Positive, Record, Vector3
from ..model.markers import GROUND
from ..model.signals import Constant, Signal
from .moving_surface import Numbers


class ContactElement(Element):
    """What may stand in a model's `contacts`, in the plane or in space."""

    has_shapes: ClassVar[bool] = True
    """False: the friction of a joint."""
    touch: ClassVar[str] = "none"
    """Where the arrow of its force is: a name of `viewer/forces.py` or `viewer/space/forces.py`, which find the fields
    that they need: "half-plane" a `plane` and a `disk`; "gap": where the formula's gradient says; "none": unseen."""
    companion: ClassVar[int] = 0
    """How far on in the tables the contact stands with which it has three tangents together; 0: there is none."""
    surface_sign: ClassVar[float] = 1.0
    """-1 where the sliding distance in the plane grows against `surface_speed`, counter-clockwise round the shape."""

    law: ContactLaw
    """What happens when the gap closes."""
    friction: Friction | None = None
    """What resists sliding: Coulomb's for contacts as constraints, a regularised law or LuGre's for forces."""
    surface_speed: float | Signal | None = None
    """Speed of a belt, m/s: at which the surface of a shape goes along past the body that carries it, a number or over
    time. In the plane along the first shape's outward normal turned by -90 degrees: to the right on a floor, clockwise
    round a disk or a box. Left out: the surface is fixed to its body."""
    compliance: Positive = 1.0
    """How far it gives way under a force over how far others do, dimensionless: where rigid contacts repeat each other,
    normal forces and static friction are shared in that measure."""

    @model_validator(mode="after")
    def _friction_fits(self) -> "ContactElement":
        if self.friction is None:
            return self
        coulomb = isinstance(self.friction, CoulombFriction)
        if coulomb and isinstance(self.law, ForceLaw):
            raise ValueError(
                f"contact '{self.name}': Coulomb friction is set-valued and needs a constraint law such as "
                f"NewtonImpact, not {type(self.law).__name__}; give a regularised law such as Tanh or BrownMcPhee"
            )
        if not coulomb and not isinstance(self.law, ForceLaw):
            raise ValueError(
                f"contact '{self.name}': friction '{self.friction.type}' is regularised and belongs to a force law; "
                f"a contact with {type(self.law).__name__} is a constraint: give it Coulomb friction"
            )
        return self

    @model_validator(mode="after")
    def _compliance_shares(self) -> "ContactElement":
        if self.compliance != 1.0 and isinstance(self.law, ForceLaw):
            raise ValueError(
                f"contact '{self.name}' has a compliance of {self.compliance:g}, which says how contacts that are "
                f"rigid share a load; with {type(self.law).__name__} its own stiffness does: change that, or leave "
                "`compliance` out"
            )
        return self

    @model_validator(mode="after")
    def _surface_rubs(self) -> "ContactElement":
        if self.surface_speed is not None and self.friction is None:
            raise ValueError(
                f"contact '{self.name}' has a surface_speed, but without friction a surface that moves pulls nothing: "
                "give it `friction` too, or leave the speed out"
            )
        return self

    @property
    def resists_turning(self) -> bool:
        """Whether it has friction against rolling or spinning."""
        return False

    def signals(self) -> Sequence[Signal]:
        speed = self._surface_signal()
        return () if speed is None else (speed,)

    def _surface_signal(self) -> Signal | None:
        """Speed of its surface over time."""
        speed = self.surface_speed
        return Constant(value=speed) if isinstance(speed, float | int) else speed

    def _surface_direction(self) -> tuple[float, int, Vector3]:
        """(sign of its surface's speed in the sliding velocity, where the Euler parameters of the body that carries it
        are among its coordinates, and its direction in the frame of that body); in the plane zeros but for the sign."""
        return self.surface_sign, 0, (0.0, 0.0, 0.0)

    def _surface(self, numbering: Numbering) -> int:
        """Column `SURFACE` of the extra indices."""
        speed = self._surface_signal()
        if speed is None:
            return 0
        account, (sign, first, direction) = numbering.work("input"), self._surface_direction()
        numbers = (float(numbering.signal(speed)), sign, float(account), float(first), *direction)
        return numbering.signal(cast(Signal, Numbers(numbers))) + 1

    def size_in(self, length: float) -> float:
        """Sliding distance in the tables by a unit of that in `units_in`, in a model of this length, m."""
        return 1.0

    def reach(self) -> Sequence[tuple[float, ...]]:
        """Of what is fixed to the ground only the nearest: how far a road goes on says nothing of the wheel."""
        points = [marker.point for marker in self.markers() if marker.body != GROUND]
        fixed = [marker.point for marker in self.markers() if marker.body == GROUND]
        return [*points, *sorted(fixed, key=lambda point: max(abs(x) for x in point))[:1]]

    def extent(self) -> float:
        """Distance over which the shapes could pass through each other, m; infinite for a half-plane."""
        return math.inf

    def geometry(self) -> Any:
        """What says how its gap moves with the shapes (`geometry_kinds.py`): its kernel."""
        return self.form().kernel

    def shapes(self) -> Sequence[Record]:
        """The shapes that it brings in touch: its fields that have a marker."""
        values = (getattr(self, name) for name in type(self).model_fields)
        return [value for value in values if isinstance(value, Record) and hasattr(value, "marker")]

    def disks(self) -> Sequence[Any]:
        """The planar disks (`Disk2D`) among its shapes."""
        return ()

    def units_in(self, bodies: Mapping[str, BodyElement]) -> tuple[str, str]:
        """Units of gap and sliding distance in a model with these bodies."""
        return "m", "m"

    def _law_columns(self, numbering: Numbering) -> Row:
        """What every contact's row has: columns 7 to 15 of the parameters, and the extra indices."""
        if isinstance(self.law, ForceLaw):
            parameters = self.law.formula_parameters()
            address = numbering.law_address(self.law)
        else:
            parameters, address = (0.0, 0.0, 0.0, 0.0), 0
        friction, friction_address = self._friction(numbering)
        return Row(
            (*parameters, *friction),
            (),
            (
                numbering.contact(self.name),
                address,
                numbering.work(f"{self.name}.impulse"),
                numbering.work(f"{self.name}.dissipation"),
                self._surface(numbering),
                friction_address,
            ),
        )

    def _friction(self, numbering: Numbering) -> tuple[tuple[float, ...], int]:
        """Its numbers in the table of parameters, and the address of its formula (0: Coulomb's, or none)."""
        if self.friction is None:
            return (0.0,) * 5, 0
        if isinstance(self.friction, CoulombFriction):
            return (self.friction.coefficient, 0.0, 0.0, 0.0, 0.0), 0
        if isinstance(self.friction, LuGreFriction):
            return self.friction.parameters()[:-1], 0
        return self.friction.formula_parameters(), numbering.friction_address(self.friction)
