"""Regularised friction of spherical joints: an ObjectGenericODE2 on the bodies' nodes, with a user function."""

import math
from operator import add, mul

import numpy as np

from ...core.elements import SphericalFriction3D
from .bushings3d import Deflection
from .registry import Build, translates
from .scalar_forces import transition_of
from .space_contacts import check_bodies
from .user_gaps import Nodes, Numbers


@translates(SphericalFriction3D)
def spherical_friction(record: SphericalFriction3D, build: Build) -> None:
    """T tanh(|w|/w_s) against w. Raises NotTranslatable for a set-valued one."""
    size, width = record.torque, transition_of(record)
    check_bodies(record, build)
    nodes = Nodes(build, (record.a.body, record.b.body))
    if not nodes.nodes:
        return  # between two markers on the ground nothing moves
    deflection = Deflection(build, record, nodes)

    def force(mbs: object, t: float, item: int, q: Numbers, v: Numbers) -> list[float]:
        about = np.array(deflection(list(map(add, nodes.reference, q)))[2][3:])
        w = np.array([sum(map(mul, row, v)) for row in about])
        speed = math.hypot(*w)
        over = size * math.tanh(speed / width) / speed if speed > 0.0 else size / width
        return [float(x) for x in -over * w @ about]

    build.add("ObjectGenericODE2", nodeNumbers=list(nodes.nodes), forceUserFunction=force)
