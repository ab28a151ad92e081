"""The joints in space, each as its primitives. The axis of a joint is the z axis of its markers, unless said otherwise.

Haug, Computer Aided Kinematics and Dynamics of Mechanical Systems (1989), section 9.4, has the same table.
"""

from collections.abc import Mapping, Sequence
from typing import ClassVar, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import model_validator

from ..model.markers import GROUND
from ..model.said_angle import SaidAngle
from ..model.signals import Constant, Signal, Step
from .base import BodyElement
from .distance3d import Separation
from .dot1_3d import Dot1
from .dot2_3d import Dot2
from .joint3d import Joint3D, TurningJoint3D
from .joint_coordinates3d import JointCoordinate, turned_marker
from .point3d import Point
from .primitive3d import Axis, Primitive
from .spatial_body import start_of_marker
from .start_angle3d import value_at_start
from .twist3d import Twist

_PARALLEL = (Dot1("z", "x"), Dot1("z", "y"))
"""The z axes are parallel."""
_NO_TURN = Dot1("x", "y")
"""About parallel z axes."""
_ON_AXIS = (Dot2("x"), Dot2("y"))
"""The point of b is on the z axis of a."""
_Z: tuple[tuple[Axis, Axis], ...] = (("z", "z"),)
_ALL: tuple[tuple[Axis, Axis], ...] = (("x", "x"), ("z", "z"))
MOST_BEND = 150.0
"""Degrees; of a constant velocity joint at the start. At 180 its equation depends on the others."""


class Spherical3D(Joint3D):
    """Ball joint: the points of both markers are one (3 rows)."""

    type: Literal["Spherical3D"] = "Spherical3D"

    def primitives(self) -> Sequence[Primitive]:
        return (Point(),)


class Revolute3D(TurningJoint3D):
    """Hinge: the points and the z axes of both markers are one (5 rows)."""

    type: Literal["Revolute3D"] = "Revolute3D"
    symbol: ClassVar[str] = "pin"
    aligned: ClassVar[Sequence[tuple[Axis, Axis]]] = _Z

    def primitives(self) -> Sequence[Primitive]:
        return (Point(), *_PARALLEL)


class Universal3D(Joint3D):
    """Cardan joint: the points are one, and the x axis of marker a stays across the y axis of marker b (4 rows).

    Coordinates: `angle_1` of the cross about the x axis of marker a, `angle_2` of b about its y axis, the cross's other
    arm; b's axes are those of a turned by the first about x and then by the second about y.
    """

    type: Literal["Universal3D"] = "Universal3D"
    symbol: ClassVar[str] = "cross"
    across: ClassVar[Sequence[tuple[Axis, Axis]]] = (("x", "y"),)

    def coordinates(self) -> Sequence[JointCoordinate]:
        first, second, name = "angle about x of marker a", "angle about y of marker b", self.name
        return (
            JointCoordinate(
                "angle_1", "angular_velocity_1", "angle", turned_marker(self.a, "x"), turned_marker(self.b, "x"),
                first, f"{name}.1",
            ),
            # seen from b, about its y axis backwards
            JointCoordinate(
                "angle_2", "angular_velocity_2", "angle", turned_marker(self.b, "-y"), turned_marker(self.a, "-y"),
                second, f"{name}.2",
            ),
        )  # fmt: skip

    def primitives(self) -> Sequence[Primitive]:
        return (Point(), _NO_TURN)


class ConstantVelocity3D(Joint3D):
    """Homokinetic joint: the points are one and the joint bends without twisting, so that the spin about the z axes is
    the same on both sides (4 rows). It may start bent by up to 150 degrees."""

    type: Literal["ConstantVelocity3D"] = "ConstantVelocity3D"

    def primitives(self) -> Sequence[Primitive]:
        return (Point(), Twist(("x", "y"), ("y", "x")))

    def check_in(self, bodies: Mapping[str, BodyElement]) -> None:
        super().check_in(bodies)
        if all(marker.body == GROUND or marker.body in bodies for marker in self.markers()):
            _check_bend(self.name, *(start_of_marker(marker, bodies)[1] for marker in self.markers()))


def _check_bend(name: str, of_a: NDArray[np.float64], of_b: NDArray[np.float64]) -> None:
    """Refuse a start of a constant velocity joint that is folded back, or twisted by half a turn.

    With (e0, e) the Euler parameters of b seen from a, its row a_x . b_y - a_y . b_x is -4 e0 e3: zero without twist
    (e3 = 0), but also on a branch of rotations by half a turn (e0 = 0), which meets the first where the joint is folded
    back by 180 degrees. 4 e0^2 = 1 + R11 + R22 + R33, 4 e3^2 = 1 - R11 - R22 + R33.
    """
    seen = of_a.T @ of_b
    bend = float(np.degrees(np.arccos(np.clip(seen[2, 2], -1.0, 1.0))))
    if bend > MOST_BEND:
        raise ValueError(
            f"'{name}' starts bent by {bend:.4g} degrees, nearly folded back on itself, where nothing tells its two "
            f"ways of going on apart: the z axes of its markers may be up to {MOST_BEND:g} degrees apart. Turn the "
            "`attitude` of one of the markers, or of a body"
        )
    if seen[0, 0] + seen[1, 1] <= 0.0:  # e0^2 <= e3^2
        raise ValueError(
            f"'{name}' starts twisted by half a turn or near it: along the bend, the x axes of its markers must point "
            "the same way. Turn the `attitude` of one of the markers about its z axis"
        )


class Fixed3D(Joint3D):
    """Weld: points and axes of both markers are one (6 rows)."""

    type: Literal["Fixed3D"] = "Fixed3D"
    symbol: ClassVar[str] = "block"
    aligned: ClassVar[Sequence[tuple[Axis, Axis]]] = _ALL

    def primitives(self) -> Sequence[Primitive]:
        return (Point(), *_PARALLEL, _NO_TURN)


class Cylindrical3D(TurningJoint3D):
    """The z axes of both markers are one line, along which and about which b moves (4 rows)."""

    type: Literal["Cylindrical3D"] = "Cylindrical3D"
    symbol: ClassVar[str] = "sleeve"
    slides: ClassVar[bool] = True
    aligned: ClassVar[Sequence[tuple[Axis, Axis]]] = _Z

    def primitives(self) -> Sequence[Primitive]:
        return (*_PARALLEL, *_ON_AXIS)


class Prismatic3D(Joint3D):
    """Slider: b moves along the z axis of marker a without turning (5 rows)."""

    type: Literal["Prismatic3D"] = "Prismatic3D"
    symbol: ClassVar[str] = "slider"
    slides: ClassVar[bool] = True
    aligned: ClassVar[Sequence[tuple[Axis, Axis]]] = _ALL

    def primitives(self) -> Sequence[Primitive]:
        return (*_PARALLEL, _NO_TURN, *_ON_AXIS)


class Planar3D(TurningJoint3D):
    """The xy planes of both markers are one, in which b moves and turns (3 rows). Coordinates: the place of b along
    the x and y axes of marker a, and its angle."""

    type: Literal["Planar3D"] = "Planar3D"
    symbol: ClassVar[str] = "pane"
    aligned: ClassVar[Sequence[tuple[Axis, Axis]]] = _Z

    def coordinates(self) -> Sequence[JointCoordinate]:
        x, y = turned_marker(self.a, "x"), turned_marker(self.a, "y")
        return (
            *super().coordinates(),
            JointCoordinate("x", "vx", "place", x, self.b, "place of b along x"),
            JointCoordinate("y", "vy", "place", y, self.b, "place of b along y"),
        )

    def primitives(self) -> Sequence[Primitive]:
        return (*_PARALLEL, Dot2("z"))


class PointOnLine3D(Joint3D):
    """The point of marker b is on the z axis of marker a (2 rows)."""

    type: Literal["PointOnLine3D"] = "PointOnLine3D"
    symbol: ClassVar[str] = "bead"

    def primitives(self) -> Sequence[Primitive]:
        return _ON_AXIS


class PointOnPlane3D(Joint3D):
    """The point of marker b is in the xy plane of marker a (1 row)."""

    type: Literal["PointOnPlane3D"] = "PointOnPlane3D"
    symbol: ClassVar[str] = "pane"

    def primitives(self) -> Sequence[Primitive]:
        return (Dot2("z"),)


class _Driven(Joint3D):
    """Base of joints with a time function."""

    def motions(self) -> Sequence[Signal]:
        return [signal for signal in self.signals() if not isinstance(signal, Constant)]

    @model_validator(mode="after")
    def _check(self) -> "_Driven":
        for signal in self.motions():
            if isinstance(signal, Step):
                raise ValueError(
                    f"'{self.name}' follows a Step: a jump in position is no motion; use a Ramp, a Polynomial or a "
                    "Table"
                )
        return self


class Distance3D(_Driven):
    """Massless rod: the points of both markers are `length` apart (1 row). A time function drives the length."""

    type: Literal["Distance3D"] = "Distance3D"
    symbol: ClassVar[str] = "rod"
    length: float | Signal
    """m, positive."""

    @model_validator(mode="after")
    def _check_length(self) -> "Distance3D":
        if isinstance(self.length, float | int) and not self.length > 0.0:
            raise ValueError(
                f"'{self.name}' has length {self.length!r} m: a positive one is needed; where two points "
                "are one, use a Spherical3D"
            )
        return self

    def primitives(self) -> Sequence[Primitive]:
        length = self.length
        return (Separation(Constant(value=length) if isinstance(length, float | int) else length),)


class RevoluteSpherical3D(_Driven):
    """Composite of a rod: the point of marker b is `length` from that of marker a, in the xy plane of marker a, as by a
    rod with a hinge about z at a and a ball joint at b (2 rows)."""

    type: Literal["RevoluteSpherical3D"] = "RevoluteSpherical3D"
    symbol: ClassVar[str] = "rod"
    length: float
    """m, positive."""

    @model_validator(mode="after")
    def _check_length(self) -> "RevoluteSpherical3D":
        if not self.length > 0.0:
            raise ValueError(f"'{self.name}' has length {self.length!r} m: a positive one is needed")
        return self

    def primitives(self) -> Sequence[Primitive]:
        return (Separation(Constant(value=self.length)), Dot2("z"))


class AngleDriver3D(_Driven):
    """The x axis of marker b has the angle `angle` in the xy plane of marker a, counted from x to y (1 row).

    To drive a Revolute3D, a Cylindrical3D or a Planar3D give both the same markers.
    """

    type: Literal["AngleDriver3D"] = "AngleDriver3D"
    symbol: ClassVar[str] = "pin"
    angle: Signal
    """rad over time; its value at the start says whole turns for all that counts turns about the same axis."""

    def said_angles(self, inputs: Mapping[str, float], t: float) -> Sequence[SaidAngle]:
        """What it says of the angle at the start."""
        return (SaidAngle(self.a, self.b, value_at_start(self.angle, inputs, t), f"'{self.name}'", self.angle),)

    def primitives(self) -> Sequence[Primitive]:
        return (Twist(("x", "x"), ("y", "x"), self.angle),)


class PositionDriver3D(_Driven):
    """The point of marker b is `position` along the z axis of marker a from its point (1 row): drives a Prismatic3D or
    a Cylindrical3D with the same markers."""

    type: Literal["PositionDriver3D"] = "PositionDriver3D"
    symbol: ClassVar[str] = "none"
    position: Signal
    """m over time."""

    def primitives(self) -> Sequence[Primitive]:
        return (Dot2("z", self.position),)
