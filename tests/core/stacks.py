"""Stacks of blocks: corners are small disks, faces are segments, and each pair of blocks touches both ways round."""

import math

from tlismni.core import (
    AppliedForce2D,
    CoulombFriction,
    Disk2D,
    DiskOnHalfPlane2D,
    DiskOnSegment2D,
    HalfPlane2D,
    Marker2D,
    Model,
    NewtonImpact,
    Ramp,
    RigidBody2D,
    Segment2D,
)

WIDTH, HEIGHT, CORNER, START = 0.4, 0.2, 2e-3, 0.1
"""Of a block and of its corners, m; when the pull begins, s."""


def stack(blocks, pulled, rate, friction=0.3, restitution=0.0, force=None):
    """A stack of blocks of 1 kg; block number `pulled` is pulled sideways by a force that grows by `rate` N/s."""
    inertia = (WIDTH**2 + HEIGHT**2) / 12.0
    bodies = [
        RigidBody2D(name=f"block{i}", mass=1.0, inertia=inertia, position=(0.0, HEIGHT * (i + 0.5)))
        for i in range(blocks)
    ]
    how = {"law": NewtonImpact(restitution=restitution), "friction": CoulombFriction(coefficient=friction)}

    def corner(block, side, upwards):
        point = (side * (0.5 * WIDTH - CORNER), upwards * (0.5 * HEIGHT - CORNER))
        return Disk2D(marker=Marker2D(body=f"block{block}", point=point), radius=CORNER)

    def face(block, upwards):
        start, angle = (-upwards * 0.5 * WIDTH, upwards * 0.5 * HEIGHT), 0.0 if upwards > 0 else math.pi
        return Segment2D(marker=Marker2D(body=f"block{block}", point=start, angle=angle), length=WIDTH)

    contacts = []
    for side, name in ((-1, "left"), (1, "right")):
        contacts.append(DiskOnHalfPlane2D(name=f"ground_{name}", plane=HalfPlane2D(), disk=corner(0, side, -1), **how))
        for i in range(1, blocks):
            contacts.append(
                DiskOnSegment2D(name=f"lower{i}_{name}", segment=face(i - 1, 1), disk=corner(i, side, -1), **how)
            )
            contacts.append(
                DiskOnSegment2D(name=f"upper{i}_{name}", segment=face(i, -1), disk=corner(i - 1, side, 1), **how)
            )
    pull = force or Ramp(start=START, duration=10.0, after=10.0 * rate)
    load = AppliedForce2D(name="pull", marker=Marker2D(body=f"block{pulled}"), force_x=pull)
    return Model(name="stack", bodies=bodies, contacts=contacts, forces=[load])
