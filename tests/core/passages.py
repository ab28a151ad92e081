"""Random passages whose first touch is known in closed form: arms, pairs of disks, bullets, blades, stops, tables."""

import math

import numpy as np
from helpers import G, on
from tlismni.core import (
    Constant,
    CoordinateContact,
    CoordinateDriver,
    CoordinateTerm,
    CoulombFriction,
    Disk2D,
    DiskOnDisk2D,
    DiskOnHalfPlane2D,
    DiskOnSegment2D,
    EquationSystem,
    GapContact,
    HalfPlane2D,
    Marker2D,
    Model,
    NewtonImpact,
    PointMass2D,
    Revolute2D,
    RigidBody2D,
    Segment2D,
    Sine,
)

BOUNCE, PLASTIC = NewtonImpact(restitution=0.5), NewtonImpact(restitution=0.0)


def _turning(rng, way):
    """A body pinned at its centre that turns evenly by `way` before its contact: (body, pin, rate, angle)."""
    rate, angle = rng.choice([-1.0, 1.0]) * rng.uniform(1.0, 20.0), rng.uniform(-math.pi, math.pi)
    body = RigidBody2D(name="arm", mass=1.0, inertia=1.0, angle=angle, angular_velocity=rate)
    return body, Revolute2D(name="pin", a=Marker2D(), b=on("arm")), rate, angle + math.copysign(way, rate)


def arm(rng):
    """A disk at the end of an arm meets a free one: |d|^2 = L^2 + l^2 - 2 L l cos(angle between) = (r_1 + r_2)^2."""
    length, way = 10.0 ** rng.uniform(0.0, 1.3), rng.uniform(1.0, 6.0)
    r = length * rng.uniform(0.005, 0.1, 2)
    both = float(r.sum())
    at = length + rng.uniform(-0.98, 0.98) * both
    body, pin, rate, angle = _turning(rng, way)
    free = RigidBody2D(name="b", mass=1.0, inertia=1.0, position=(at * math.cos(angle), at * math.sin(angle)))
    pair = DiskOnDisk2D(
        name="c", a=Disk2D(marker=on("arm", length), radius=r[0]), b=Disk2D(marker=on("b"), radius=r[1]), law=BOUNCE
    )
    model = Model(gravity=(0.0, 0.0), bodies=[body, free], joints=[pin], contacts=[pair])
    before = math.acos((length**2 + at**2 - both**2) / (2.0 * length * at))
    return model, (way - before) / abs(rate)


def blade(rng):
    """A thin blade turns into a small disk at rest: sin(angle between) = R/l."""
    length, way, both = rng.uniform(1.0, 10.0), rng.uniform(1.0, 3.0), 10.0 ** rng.uniform(-3.0, -1.5)
    body, pin, rate, angle = _turning(rng, way)
    at = rng.uniform(0.2, 0.95) * length
    free = PointMass2D(name="b", mass=1.0, position=(at * math.cos(angle), at * math.sin(angle)))
    contact = DiskOnSegment2D(
        name="c", segment=Segment2D(marker=on("arm"), length=length, radius=0.3 * both),
        disk=Disk2D(marker=on("b"), radius=0.7 * both), law=BOUNCE,
    )  # fmt: skip
    model = Model(gravity=(0.0, 0.0), bodies=[body, free], joints=[pin], contacts=[contact])
    return model, (way - math.asin(both / at)) / abs(rate)


def pair(rng):
    """Two disks that fly past one another, in any frame that falls with them."""
    r = 10.0 ** rng.uniform(-2.0, -0.5, 2)
    both, ahead, speed = float(r.sum()), rng.uniform(1.0, 5.0), 10.0 ** rng.uniform(0.0, 2.0)
    beside, direction = rng.uniform(-0.98, 0.98) * both, rng.uniform(0.0, 2.0 * math.pi)
    u = np.array([math.cos(direction), math.sin(direction)])
    common = rng.normal(size=2)
    place = -ahead * u + beside * np.array([-u[1], u[0]])
    bodies = [
        PointMass2D(name="a", mass=1.0, position=tuple(place), velocity=tuple(common + speed * u)),
        PointMass2D(name="b", mass=2.0, velocity=tuple(common)),
    ]
    contact = DiskOnDisk2D(
        name="c", a=Disk2D(marker=on("a"), radius=r[0]), b=Disk2D(marker=on("b"), radius=r[1]), law=BOUNCE
    )
    return Model(bodies=bodies, contacts=[contact]), (ahead - math.sqrt(both**2 - beside**2)) / speed


def bullet(rng):
    """A small disk shot at a thin segment: its height over it falls evenly to both radii."""
    length, both, speed = rng.uniform(0.5, 3.0), 10.0 ** rng.uniform(-4.0, -2.0), 10.0 ** rng.uniform(0.0, 3.0)
    angle, height, side = rng.uniform(-math.pi, math.pi), rng.uniform(0.5, 3.0), rng.choice([-1.0, 1.0])
    slant = rng.uniform(-1.0, 1.0)
    along, across = np.array([math.cos(angle), math.sin(angle)]), np.array([-math.sin(angle), math.cos(angle)])
    hit = rng.uniform(0.1, 0.9) * length
    velocity = speed * (math.sin(slant) * along - side * math.cos(slant) * across)
    t = (height - both) / (speed * math.cos(slant))
    place = hit * along + side * both * across - t * velocity
    ball = PointMass2D(name="b", mass=1.0, position=tuple(place), velocity=tuple(velocity))
    contact = DiskOnSegment2D(
        name="c", segment=Segment2D(marker=Marker2D(angle=angle), length=length, radius=0.5 * both),
        disk=Disk2D(marker=on("b"), radius=0.5 * both), law=BOUNCE,
    )  # fmt: skip
    return Model(gravity=(0.0, 0.0), bodies=[ball], contacts=[contact]), t


def stop(rng):
    """Thrown up against a stop of its coordinate that lies a little below the top of the flight."""
    speed = rng.uniform(1.0, 10.0)
    top, below = speed**2 / (2.0 * G), 10.0 ** rng.uniform(-8.0, -1.0)
    term = CoordinateTerm(body="b", coordinate="y", factor=-1.0)
    contact = CoordinateContact(name="c", offset=top * (1.0 - below), terms=[term], law=BOUNCE)
    ball = PointMass2D(name="b", mass=1.0, velocity=(0.3, speed))
    return Model(bodies=[ball], contacts=[contact]), (speed - math.sqrt(2.0 * G * top * below)) / G


def equations(rng):
    """The arm as equations of a user, with a gap function of which nothing else is known."""
    length, way, rate = rng.uniform(1.0, 10.0), rng.uniform(1.0, 6.0), rng.uniform(1.0, 20.0)
    both = length * rng.uniform(0.02, 0.2)
    at = length + rng.uniform(-0.98, 0.98) * both

    def gap(t, q):
        return np.sqrt((q[1] - length * np.cos(q[0])) ** 2 + (q[2] - length * np.sin(q[0])) ** 2) - both

    system = EquationSystem(
        mass=np.eye(3), force=np.zeros(3), contacts=[GapContact("c", gap, BOUNCE)],
        q0=[0.0, at * math.cos(way), at * math.sin(way)], v0=[rate, 0.0, 0.0],
    )  # fmt: skip
    return system, (way - math.acos((length**2 + at**2 - both**2) / (2.0 * length * at))) / rate


PASSAGES = {"arm": arm, "blade": blade, "pair": pair, "bullet": bullet, "stop": stop, "equations": equations}


def shaken_table(excess, frequency, phase, friction=None):
    """A block on a table that moves by A sin(omega t + phase), A omega^2 = (1 + excess) g: it lifts off once a period,
    when sin = 1/(1 + excess). With a coefficient of `friction` mu the table moves sideways, A omega^2 =
    (1 + excess) mu g, and the block slips twice a period, when |sin| = 1/(1 + excess)."""
    amplitude = (1.0 + excess) * (1.0 if friction is None else friction) * G / frequency**2
    shaken, axis = Sine(amplitude=amplitude, angular_frequency=frequency, phase=phase), 1 if friction is None else 0
    motions = {name: shaken if k == axis else Constant(value=0.0) for k, name in enumerate(("x", "y", "angle"))}
    start = {"position": [0.0, 0.0], "velocity": [0.0, 0.0]}
    start["position"][axis] = amplitude * math.sin(phase)
    start["velocity"][axis] = amplitude * frequency * math.cos(phase)
    table = RigidBody2D(name="table", mass=1.0, inertia=1.0, **start)
    block = PointMass2D(name="block", mass=1.0, **start)
    drivers = [
        CoordinateDriver(name=f"d{name}", body="table", coordinate=name, motion=motion)
        for name, motion in motions.items()
    ]
    contact = DiskOnHalfPlane2D(
        name="c", plane=HalfPlane2D(marker=on("table")), disk=Disk2D(marker=on("block")), law=PLASTIC,
        friction=None if friction is None else CoulombFriction(coefficient=friction),
    )  # fmt: skip
    return Model(bodies=[table, block], joints=drivers, contacts=[contact])


def lift_offs(excess, frequency, phase, count, period=2.0 * math.pi):
    """Times of the first lift-offs of `shaken_table`; with `period` pi, of its slips."""
    first = (math.asin(1.0 / (1.0 + excess)) - phase) % period
    return (first + period * np.arange(count)) / frequency
