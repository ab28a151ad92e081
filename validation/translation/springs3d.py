"""Springs and dampers in space."""

import numpy as np

from ...core.assembly.numbering import ModelNumbering
from ...core.elements import AxialSpring3D, Cylindrical3D, Prismatic3D, Revolute3D, SpringDamper3D, TorsionSpring3D
from ...core.model.markers import GROUND, Marker3D
from ..errors import NotTranslatable
from .registry import Build, translates
from .scalar_forces import add_effort
from .signals import time_function
from .space import placed

PARALLEL = 1e-9
"""Distance of unit vectors that are one."""


@translates(SpringDamper3D)
def spring_damper(record: SpringDamper3D, build: Build) -> None:
    """ObjectConnectorSpringDamper; a user function for a natural length over time."""
    k, c, length = record.stiffness, record.damping, record.natural_length
    if not isinstance(length, float | int):
        free = time_function(length, build.model)
        add_effort(record, build, "distance", lambda x, rate, t: k * (x - free.value(t)) + c * rate)
        return
    markers = [placed(marker, build, record.name) for marker in (record.a, record.b)]
    build.add(
        "ObjectConnectorSpringDamper", markerNumbers=markers, stiffness=k, damping=c, referenceLength=length,
    )  # fmt: skip


@translates(AxialSpring3D)
def axial_spring(record: AxialSpring3D, build: Build) -> None:
    """ObjectConnectorLinearSpringDamper on the ground's axes, or where a joint keeps b on the axis of a.

    Elsewhere a user function: exudyn's leaves out how the axis turns in its rate, and the moment of a force at b on a.
    """
    k, c, free = record.stiffness, record.damping, record.natural_position
    if record.a.body == GROUND or any(keeps_on_axis(joint, record.a, record.b) for joint in build.model.joints):
        markers = [placed(record.a, build, record.name, record.a.axes()), _with_axes(record.b, build, record.name)]
        build.add(
            "ObjectConnectorLinearSpringDamper", markerNumbers=markers, stiffness=k, damping=c, offset=free,
            axisMarker0=[0.0, 0.0, 1.0],
        )  # fmt: skip
    else:
        add_effort(record, build, "slide", lambda x, rate, t: k * (x - free) + c * rate)


def _with_axes(marker: Marker3D, build: Build, user: str) -> int:
    point = marker.body != GROUND and not build.bodies[marker.body].rigid
    return placed(marker, build, user, None if point else marker.axes())


def keeps_on_axis(joint: object, a: Marker3D, b: Marker3D) -> bool:
    """Whether the joint has these markers and lets b move along the z axis of a only."""
    return isinstance(joint, Prismatic3D | Cylindrical3D) and (joint.a, joint.b) == (a, b)


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
