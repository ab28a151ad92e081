"""Applied forces and torques in space, and what of space exudyn has no equal of, by name."""

import numpy as np

from ...core.elements import AppliedForce3D, AppliedTorque3D, CableClamp3D
from ...core.model.markers import GROUND
from ...core.shapes.stop3d import AngleStop3D, DistanceStop3D, Rope3D, SlideStop3D
from .registry import Build, no_equal, translates
from .signals import time_function
from .space import placed

no_equal(
    "a ball on the cable's end point, with an ObjectConnectorCoordinate for each slope that it holds", CableClamp3D
)
no_equal("the planar AngleStop2D or Rope2D, where the motion is planar", AngleStop3D, DistanceStop3D, Rope3D)
no_equal("a SphereOnHalfSpace3D in closed form, or a planar model with a DiskOnHalfPlane2D", SlideStop3D)


@translates(AppliedForce3D, AppliedTorque3D)
def applied_load(record: AppliedForce3D | AppliedTorque3D, build: Build) -> None:
    """LoadForceVector or LoadTorqueVector as a user function; along the body's axes if it follows them."""
    if record.marker.body == GROUND:
        return  # a load on the ground moves nothing
    force = isinstance(record, AppliedForce3D)
    names = ("force_x", "force_y", "force_z") if force else ("torque_x", "torque_y", "torque_z")
    parts = [time_function(getattr(record, name), build.model) for name in names]
    axes = record.marker.axes() if record.follower else np.eye(3)

    def vector(t: float) -> list[float]:
        return [float(x) for x in axes @ np.array([part.value(t) for part in parts])]

    build.add(
        "LoadForceVector" if force else "LoadTorqueVector",
        # the vector given with a user function is only a stand-in, but must not be zero
        markerNumber=placed(record.marker, build, record.name), loadVector=[1.0, 1.0, 1.0], bodyFixed=record.follower,
        loadVectorUserFunction=lambda mbs, t, load: vector(t),
    )  # fmt: skip
