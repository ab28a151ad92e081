"""Springs and dampers in space."""

import numpy as np

from ...core.elements import (
    Cylindrical3D,
    PIDController3D,
    RelativeLoad3D,
    Revolute3D,
    RevoluteFriction3D,
    Servo3D,
    SlideFriction3D,
    SpringDamper3D,
    TableSpring3D,
    TorsionSpring3D,
)
from ...core.model.markers import Marker3D
from ...core.tables.numbering import ModelNumbering
from ..errors import NotTranslatable
from .registry import Build, no_equal, translates
from .space import placed

no_equal(
    "the planar element of the same name, where the motion is planar", PIDController3D, RelativeLoad3D,
    RevoluteFriction3D, Servo3D, SlideFriction3D, TableSpring3D,
)  # fmt: skip

PARALLEL = 1e-9
"""Distance of unit vectors that are one."""


@translates(SpringDamper3D)
def spring_damper(record: SpringDamper3D, build: Build) -> None:
    """ObjectConnectorSpringDamper. Raises NotTranslatable for a natural length over time."""
    if not isinstance(record.natural_length, float | int):
        raise NotTranslatable(
            f"the natural length of '{record.name}' is driven: no translation to exudyn is written for that"
        )
    markers = [placed(marker, build, record.name) for marker in (record.a, record.b)]
    build.add(
        "ObjectConnectorSpringDamper", markerNumbers=markers, stiffness=record.stiffness, damping=record.damping,
        referenceLength=record.natural_length,
    )  # fmt: skip


@translates(TorsionSpring3D)
def torsion_spring(record: TorsionSpring3D, build: Build) -> None:
    """ObjectConnectorTorsionalSpringDamper, which counts turns by a node of its own. Its torque is about the z axes of
    both markers, so raises NotTranslatable unless a hinge keeps these together."""
    if not any(keeps_axes(joint, record.a, record.b) for joint in build.model.joints):
        raise NotTranslatable(
            f"the axes of '{record.name}' are not held together by a Revolute3D or a Cylindrical3D about them: "
            "exudyn's torsion spring is that of a hinge"
        )
    markers = [placed(marker, build, record.name, marker.axes()) for marker in (record.a, record.b)]
    start = ModelNumbering(build.model).start_angle(record.a, record.b, record.name)
    turns = build.add("NodeGenericData", numberOfDataCoordinates=1, initialCoordinates=[start])
    build.add(
        "ObjectConnectorTorsionalSpringDamper", markerNumbers=markers, nodeNumber=turns, stiffness=record.stiffness,
        damping=record.damping, offset=record.natural_angle,
    )  # fmt: skip


def keeps_axes(joint: object, a: Marker3D, b: Marker3D) -> bool:
    """Whether the joint holds the z axes of two markers together."""
    if not isinstance(joint, Revolute3D | Cylindrical3D):
        return False
    of_body = {marker.body: marker.axes()[:, 2] for marker in (joint.a, joint.b)}
    wanted = {marker.body: marker.axes()[:, 2] for marker in (a, b)}
    if of_body.keys() != wanted.keys():
        return False
    return any(
        all(np.linalg.norm(of_body[body] - sign * axis) < PARALLEL for body, axis in wanted.items())
        for sign in (1.0, -1.0)
    )
