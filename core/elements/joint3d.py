"""Joints in space: lists of primitives between two markers, and the force and torque that they carry."""

from collections.abc import Mapping, Sequence
from typing import ClassVar

import numpy as np

from ..model.derived import Derived
from ..model.frame3d import Frame3D
from ..model.markers import GROUND, Marker3D
from ..model.signals import Constant, Signal
from .base import BodyElement, JointElement, Numbering, Part
from .joint_coordinates3d import JointAngle, JointPosition
from .joint_load3d import JointLoad
from .primitive3d import AXIS, Axis, Primitive
from .spatial_body import angle_between, start_of_marker
from .turn3d import turn_part

NO_MIRROR = 0.5
"""Cosine of the angle between axes that must point the same way, below which a joint starts mirrored or askew."""


class Joint3D(JointElement):
    """Base of the joints in space, a user's own too: a subclass says its `primitives`.

    Its channels are the force (N) and the torque (N m) on body b at the point of marker b, along the axes of marker a.
    Class attribute `aligned`: pairs of axes of markers a and b that point the same way, which dot products alone do not
    say.
    """

    aligned: ClassVar[Sequence[tuple[Axis, Axis]]] = ()

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

    def parts(self, numbering: Numbering) -> Sequence[Part]:
        parts = [primitive.part(self.a, self.b, numbering) for primitive in self.primitives()]
        return [*parts, turn_part(self.name, self.a, self.b, numbering)] if self.turns else parts

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
        axes = [start_of_marker(marker, bodies)[1] for marker in (self.a, self.b)]
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
        a, b = (Frame3D.of(marker, numbering.own_frame(marker)) for marker in (self.a, self.b))
        left, shares = list(rows), []
        for primitive in self.primitives():
            count = primitive.form.constraint_rows
            shares.append((primitive, left[:count]))
            left = left[count:]
        found: list[Derived] = []
        if self.turns:
            found.append(JointAngle(self.name, a, b, angle_between(self.a, self.b, numbering.bodies)))
        if self.slides:
            found.append(JointPosition(self.name, a, b))
        return [*found, JointLoad(self.name, a, b, shares)]
