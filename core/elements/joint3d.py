"""Joints in space: lists of primitives between two markers, and the force and torque that they carry."""

from collections.abc import Mapping, Sequence
from typing import ClassVar

import numpy as np

from ..errors import ModelError
from ..model.derived import Derived
from ..model.frame3d import Frame3D
from ..model.markers import GROUND, Marker3D
from ..model.said_angle import CountedAngle, SaidAngle
from ..model.signals import Constant, Signal
from ..model.words import an
from .base import BodyElement, JointElement, Numbering, Part
from .joint_coordinates3d import JointAngle, JointCoordinate, JointPosition
from .joint_load3d import JointLoad
from .primitive3d import AXIS, Axis, Primitive
from .spatial_body import start_of_marker
from .start_angle3d import check_start_angle
from .turn3d import account_of, turn_part
from .turning_bodies import refuse_points

NO_MIRROR = 0.5
"""Cosine of the angle between axes that must point the same way, below which a joint starts mirrored or askew."""


class Joint3D(JointElement):
    """Base of the joints in space, a user's own too: a subclass says its `primitives`.

    Its channels are the force (N) and the torque (N m) on body b at the point of marker b, along the axes of marker a.
    Class attribute `aligned`: pairs of axes of markers a and b that point the same way, which dot products alone do not
    say.
    """

    aligned: ClassVar[Sequence[tuple[Axis, Axis]]] = ()
    across: ClassVar[Sequence[tuple[Axis, Axis]]] = ()
    """Pairs of axes that must stand across each other: where they start parallel, nothing says which way to turn."""

    symbol: ClassVar[str] = "ball"
    """What it looks like: "ball", "pin", "cross", "block", "sleeve", "slider" or "bead" on a bar, "pane", "rod"."""
    arrow: ClassVar[str] = "components"
    turns: ClassVar[bool] = False
    """Whether it turns about the z axis of its markers: channels `angle`, whole turns counted, `angular_velocity`."""
    slides: ClassVar[bool] = False
    """Whether it slides along that axis: channels `position`, `velocity`."""

    a: Marker3D
    """The first marker."""
    b: Marker3D
    """The second marker."""

    def primitives(self) -> Sequence[Primitive]:
        """What it is made of."""
        raise NotImplementedError(f"{type(self).__name__} must say the primitives that it is made of")

    def markers(self) -> Sequence[Marker3D]:
        return (self.a, self.b)

    def coordinates(self) -> Sequence[JointCoordinate]:
        """The ways in which it moves that have channels."""
        found: list[JointCoordinate] = []
        if self.turns:
            found.append(JointCoordinate("angle", "angular_velocity", "angle", self.a, self.b, "angle", self.name))
        if self.slides:
            found.append(JointCoordinate("position", "velocity", "place", self.a, self.b, "place of b along the axis"))
        return found

    def ends_of(self, coordinate: str) -> dict[str, Marker3D]:
        """Markers `a` and `b` of one of its coordinates, a channel such as "angle" or "position": what a stop, spring,
        servo or driver takes that acts on it.

        Raises
        ------
        ModelError : for a coordinate that it does not have.
        """
        return ends_of(self.name, type(self).__name__, self.coordinates(), coordinate)

    def counted_angles(self) -> Sequence[CountedAngle]:
        """Those of its coordinates that are angles."""
        return [CountedAngle(f"{self.name}.{c.name}", c.a, c.b) for c in self.coordinates() if c.kind == "angle"]

    def parts(self, numbering: Numbering) -> Sequence[Part]:
        parts = [primitive.part(self.a, self.b, numbering) for primitive in self.primitives()]
        turning = [turn_part(c.account, c.a, c.b, numbering) for c in self.coordinates() if c.kind == "angle"]
        return [*parts, *turning]

    def force_rows(self) -> Sequence[int]:
        first = 0
        found: list[int] = []
        for primitive in self.primitives():
            count = primitive.form.constraint_rows
            found += range(first, first + count) if primitive.carries_force else ()
            first += count
        return found

    def signals(self) -> Sequence[Signal]:
        return [s for primitive in self.primitives() for s in primitive.signals() if not isinstance(s, Constant)]

    def check_in(self, bodies: Mapping[str, BodyElement]) -> None:
        if self.a.body == self.b.body:
            raise ValueError(
                f"both markers of '{self.name}' are on '{self.a.body}': a joint holds two bodies; put one of them on "
                "another body or on the ground"
            )
        if not all(name == GROUND or name in bodies for name in (self.a.body, self.b.body)):
            return  # the model says which name is unknown
        if any(primitive.holds_axes for primitive in self.primitives()):
            refuse_points(self.name, self.markers(), bodies, "use a joint of points (Spherical3D), or a RigidBody3D")
        axes = [start_of_marker(marker, bodies)[1] for marker in (self.a, self.b)]
        for of_a, of_b in self.across:
            cosine = float(axes[0][:, AXIS[of_a]] @ axes[1][:, AXIS[of_b]])
            if abs(cosine) > NO_MIRROR:
                angle = np.degrees(np.arccos(np.clip(cosine, -1.0, 1.0)))
                raise ValueError(
                    f"'{self.name}' starts with the {of_b} axis of marker b {angle:.4g} degrees from the {of_a} axis "
                    f"of marker a: they must be perpendicular, and are {abs(angle - 90.0):.4g} degrees off. Turn the "
                    "`attitude` of one of the markers, or of a body"
                )
        for of_a, of_b in self.aligned:
            cosine = float(axes[0][:, AXIS[of_a]] @ axes[1][:, AXIS[of_b]])
            if cosine < NO_MIRROR:
                angle = np.degrees(np.arccos(np.clip(cosine, -1.0, 1.0)))
                raise ValueError(
                    f"'{self.name}' starts with the {of_b} axis of marker b {angle:.4g} degrees from the {of_a} axis "
                    "of marker a, which must point the same way: it is assembled mirrored or askew. Turn the "
                    "`attitude` of one of the markers, or of a body"
                )

    def derived_channels(self, numbering: Numbering, rows: Sequence[int]) -> Sequence[Derived]:
        left, shares = list(rows), []
        for primitive in self.primitives():
            count = primitive.form.constraint_rows
            shares.append((primitive, left[:count]))
            left = left[count:]
        a, b = (Frame3D.of(marker, numbering.own_frame(marker)) for marker in (self.a, self.b))
        return [*channels_of(self.name, self.coordinates(), numbering), JointLoad(self.name, a, b, shares)]


class TurningJoint3D(Joint3D):
    """Base of the joints that turn about the z axis of their markers."""

    turns: ClassVar[bool] = True

    start_angle: float | None = None
    """Angle of the x axis of marker b about z from that of marker a at the start, rad, whole turns included, which the
    attitudes do not tell; left out: as a driver or another element about the same axis says, or the turns by which
    attitudes are given, else between -pi and pi."""

    def check_in(self, bodies: Mapping[str, BodyElement]) -> None:
        super().check_in(bodies)
        check_start_angle(self.name, self.a, self.b, self.start_angle, bodies)

    def said_angles(self, inputs: Mapping[str, float], t: float) -> Sequence[SaidAngle]:
        """What it says of the angle at the start."""
        return () if self.start_angle is None else (SaidAngle(self.a, self.b, self.start_angle, f"'{self.name}'"),)


def ends_of(name: str, kind: str, coordinates: Sequence[JointCoordinate], coordinate: str) -> dict[str, Marker3D]:
    """Markers of that one of an element's coordinates. Raises ModelError if it is none of them."""
    for found in coordinates:
        if found.name == coordinate:
            return {"a": found.a, "b": found.b}
    have = [found.name for found in coordinates]
    raise ModelError(f"'{name}' has no coordinate '{coordinate}': {an(kind)} has {have or 'none'}")


def channels_of(name: str, coordinates: Sequence[JointCoordinate], numbering: Numbering) -> list[Derived]:
    """The channels of an element's coordinates."""
    found: list[Derived] = []
    for of in coordinates:
        a, b = (Frame3D.of(marker, numbering.own_frame(marker)) for marker in (of.a, of.b))
        if of.kind == "angle":
            start = numbering.start_angle(of.a, of.b)
            found.append(JointAngle(name, of, a, b, start, account_of(of.account)))
        else:
            found.append(JointPosition(name, of, a, b))
    return found
