"""Open chains and trees in space at random: links of any mass, five kinds of joints along axes of any direction."""

import numpy as np
from scipy.spatial.transform import Rotation
from tlismni.core import (
    Cylindrical3D,
    Marker3D,
    Model,
    Prismatic3D,
    Revolute3D,
    RigidBody3D,
    RotationVector,
    Spherical3D,
    Universal3D,
)

KINDS = {"R": Revolute3D, "S": Spherical3D, "U": Universal3D, "P": Prismatic3D, "C": Cylindrical3D}


def vector(x):
    return tuple(float(y) for y in x)


def relative_motion(rng, kind, axes, rate, size):
    """Angular velocity and velocity that a joint of this kind allows, in space."""
    turn, slide = np.zeros(3), np.zeros(3)
    if kind in "RC":
        turn = axes[:, 2] * rng.uniform(-rate, rate)
    if kind == "S":
        turn = rng.uniform(-rate, rate, 3)
    if kind == "U":
        turn = axes[:, 0] * rng.uniform(-rate, rate) + axes[:, 1] * rng.uniform(-rate, rate)
    if kind in "PC":
        slide = axes[:, 2] * rng.uniform(-rate, rate) * size
    return turn, slide


def space_tree(seed):
    """A model of 2 to 12 bodies, each on the ground or on one before it, and the letters of its joints."""
    rng = np.random.default_rng(seed)
    n, bodies, joints, kinds = int(rng.integers(2, 13)), [], [], ""
    velocities, turns = [np.zeros(3)], [np.zeros(3)]
    moves, rate = rng.random() < 0.7, 10.0 ** rng.uniform(-0.5, 1.2)
    size = 10.0 ** rng.uniform(-1, 0.5)
    light_end, share = rng.random() < 0.4, rng.random()
    for k in range(n):
        parent = -1 if k == 0 else (k - 1 if rng.random() < 0.6 else int(rng.integers(-1, k)))
        hub = np.zeros(3) if parent < 0 else np.array(bodies[parent].position)
        place = hub + size * rng.uniform(-0.5, 0.5, 3)
        centre = place + size * rng.uniform(-0.5, 0.5, 3) * (rng.random() > 0.15)
        mass = 10.0 ** rng.uniform(-1, 1) * (0.01 if light_end and k == n - 1 else 1.0)
        inertia = mass * size**2 * 10.0 ** rng.uniform(-2.5, -0.5)
        inertia = inertia * np.array([1.0, rng.uniform(0.6, 1.4), rng.uniform(0.6, 1.4)])
        kind = "RSUPC"[rng.choice(5, p=[0.25, 0.2, 0.25, 0.3 * share, 0.3 * (1 - share)])]
        direction = rng.uniform(-2, 2, 3)
        axes = Rotation.from_rotvec(direction).as_matrix()
        turn, slide = relative_motion(rng, kind, axes, rate, size) if moves else (np.zeros(3), np.zeros(3))
        w = turns[parent + 1] + turn
        v = velocities[parent + 1] + np.cross(turns[parent + 1], place - hub) + slide + np.cross(w, centre - place)
        velocities.append(v)
        turns.append(w)
        body = RigidBody3D(
            name=f"b{k}",
            mass=float(mass),
            inertia=vector(inertia),
            position=vector(centre),
            attitude=RotationVector(vector=vector(rng.uniform(-2, 2, 3))),
            velocity=vector(v),
            angular_velocity=vector(w),
            angular_velocity_in="space",
        )
        bodies.append(body)
        attitude, point = RotationVector(vector=vector(direction)), vector(place)
        a = Marker3D(point=point, attitude=attitude) if parent < 0 else bodies[parent].marker_at(point, attitude)
        joints.append(KINDS[kind](name=f"j{k}{kind}", a=a, b=body.marker_at(point, attitude)))
        kinds += kind
    gravity = vector(rng.uniform(-10, 10, 3)) if rng.random() < 0.8 else (0.0, 0.0, 0.0)
    return Model(gravity=gravity, bodies=bodies, joints=joints), kinds
