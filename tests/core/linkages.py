"""Planar linkages for the tests of partitions, redundant constraints and singular positions.

The parallel ones have one freedom: all cranks have the angle theta, couplers only translate. With cranks (slender rods)
of mass m and length 1 and couplers of total mass M: theta'' = -g cos(theta) (n m / 2 + M) / (n m / 3 + M).
"""

import math

from helpers import GROUND, G, on
from tlismni.core import Marker2D, Model, Prismatic2D, Revolute2D, RigidBody2D


def rod(name, start, angle, rate=0.0, velocity=(0.0, 0.0), length=1.0, mass=1.0):
    """Slender rod from `start`, which moves with `velocity`."""
    x, y = 0.5 * length * math.cos(angle), 0.5 * length * math.sin(angle)
    return RigidBody2D(
        name=name, mass=mass, inertia=mass * length**2 / 12.0, position=(start[0] + x, start[1] + y), angle=angle,
        velocity=(velocity[0] - rate * y, velocity[1] + rate * x), angular_velocity=rate,
    )  # fmt: skip


def stiffness(cranks, couplers, gravity=G):
    """k of theta'' = -k cos(theta)."""
    return gravity * (cranks / 2.0 + couplers) / (cranks / 3.0 + couplers)


def four_bar(loops=2, theta=math.pi / 2, rate=-1.0, length=1.0, gravity=G):
    """`loops` parallelograms in a row (IFToMM benchmark A02: 2, upright, -1 rad/s)."""
    bodies, joints = [], []
    tip = (length * math.cos(theta), length * math.sin(theta))
    velocity = (-rate * tip[1], rate * tip[0])
    for k in range(loops + 1):
        bodies.append(rod(f"v{k}", (k * length, 0.0), theta, rate, length=length))
        joints.append(Revolute2D(name=f"a{k}", a=Marker2D(point=(k * length, 0.0)), b=on(f"v{k}", -0.5 * length)))
    for k in range(loops):
        bodies.append(rod(f"h{k}", (k * length + tip[0], tip[1]), 0.0, 0.0, velocity, length))
        joints.append(Revolute2D(name=f"b{k}", a=on(f"v{k}", 0.5 * length), b=on(f"h{k}", -0.5 * length)))
        joints.append(Revolute2D(name=f"c{k}", a=on(f"v{k + 1}", 0.5 * length), b=on(f"h{k}", 0.5 * length)))
    return Model(gravity=(0.0, -gravity), bodies=bodies, joints=joints)


def three_cranks(theta=1.0, rate=-1.0, third=(2.0, 0.0), gravity=G):
    """One coupler (mass 1) on three parallel cranks: one crank too many. Off the line of the other pivots (`third`) it
    leads the coupler through the positions in which the others are in line."""
    tip = (math.cos(theta), math.sin(theta))
    pivots = [(0.0, 0.0), (1.0, 0.0), third]
    bodies = [rod(f"v{k}", pivot, theta, rate) for k, pivot in enumerate(pivots)]
    bodies.append(
        RigidBody2D(name="c", mass=1.0, inertia=0.5, position=tip, velocity=(-rate * tip[1], rate * tip[0]))
    )  # fmt: skip
    joints = []
    for k, pivot in enumerate(pivots):
        joints.append(Revolute2D(name=f"a{k}", a=Marker2D(point=pivot), b=on(f"v{k}", -0.5)))
        joints.append(Revolute2D(name=f"b{k}", a=on(f"v{k}", 0.5), b=on("c", *pivot)))
    return Model(gravity=(0.0, -gravity), bodies=bodies, joints=joints)


def slider_crank(theta=0.5, rate=5.0, crank=0.5, rod_length=1.0, gravity=0.0, slider_mass=1.0, scale=1.0):
    """Crank on a pin at the origin, connecting rod, slider on the x axis; lengths times `scale`."""
    r, l = scale * crank, scale * rod_length
    tip = (r * math.cos(theta), r * math.sin(theta))
    tip_velocity = (-rate * tip[1], rate * tip[0])
    phi = -math.asin(tip[1] / l) if tip[1] < l else -theta
    if crank == rod_length:
        phi = -theta
    phi_rate = -tip_velocity[1] / (l * math.cos(phi))
    x = tip[0] + l * math.cos(phi)
    x_rate = tip_velocity[0] - phi_rate * l * math.sin(phi)
    bodies = [
        rod("crank", (0.0, 0.0), theta, rate, length=r),
        rod("rod", tip, phi, phi_rate, tip_velocity, l),
        RigidBody2D(name="slider", mass=slider_mass, inertia=0.1 * scale**2, position=(x, 0.0), velocity=(x_rate, 0.0)),
    ]
    joints = [
        Revolute2D(name="pin", a=GROUND, b=on("crank", -0.5 * r)),
        Revolute2D(name="big_end", a=on("crank", 0.5 * r), b=on("rod", -0.5 * l)),
        Revolute2D(name="small_end", a=on("rod", 0.5 * l), b=on("slider")),
        Prismatic2D(name="guide", a=GROUND, b=on("slider"), relative_angle=0.0),
    ]
    return Model(gravity=(0.0, -gravity * scale), bodies=bodies, joints=joints)
