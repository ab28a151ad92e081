"""LuGre's friction for tests of plane and space, and models in space with it."""

from helpers import G
from tlismni.core import (
    AppliedForce3D,
    HalfSpace3D,
    KelvinVoigt,
    LuGreFriction,
    Marker3D,
    Model,
    PointMass3D,
    RigidBody3D,
    Sphere3D,
    SphereOnHalfSpace3D,
)

TIGHT = {"rtol": 1e-9, "atol": 1e-12}
MASS, STIFFNESS = 2.0, 1e5
NORMAL = MASS * G
LAW = KelvinVoigt(stiffness=STIFFNESS, damping=300.0)
MU, STATIC, STRIBECK, S0, S1, S2 = 0.3, 0.5, 0.01, 1e4, 60.0, 1.0
BRISTLES = LuGreFriction(
    coefficient=MU, static_coefficient=STATIC, stribeck_speed=STRIBECK, bristle_stiffness=S0, bristle_damping=S1,
    viscous_damping=S2,
)  # fmt: skip
DOWN = (0.0, 0.0, -G)


def sphere(name, radius=0.0):
    return Sphere3D(marker=Marker3D(body=name), radius=radius)


def resting(*forces, place=(0.0, 0.0), velocity=(0.0, 0.0), joints=()):
    """A block in static equilibrium on the floor."""
    block = PointMass3D(name="block", mass=MASS, position=(*place, -NORMAL / STIFFNESS), velocity=(*velocity, 0.0))
    floor = SphereOnHalfSpace3D(name="c", plane=HalfSpace3D(), sphere=sphere("block"), law=LAW, friction=BRISTLES)
    return Model(bodies=[block], contacts=[floor], forces=forces, joints=joints, gravity=DOWN)


def pull(signal, way):
    c, s = way
    parts = {
        "force_x": signal.model_copy(update=_scaled(signal, c)),
        "force_y": signal.model_copy(update=_scaled(signal, s)),
    }
    return AppliedForce3D(name="pull", marker=Marker3D(body="block"), **parts)


def _scaled(signal, by):
    names = [name for name in ("amplitude", "before", "after") if name in type(signal).model_fields]
    return {name: by * getattr(signal, name) for name in names}


def ball(**start):
    return RigidBody3D(name="ball", mass=MASS, inertia=(0.02, 0.02, 0.02), **start)
