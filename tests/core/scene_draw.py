"""Bodies, feet and loads of random scenes, drawn from a random generator, alike in the plane and in space."""

import numpy as np
from tlismni.core import (
    AppliedForce2D,
    AppliedForce3D,
    AppliedTorque2D,
    AppliedTorque3D,
    Box2D,
    Box3D,
    Constant,
    CoulombFriction,
    Disk2D,
    DiskOnHalfPlane2D,
    HalfPlane2D,
    HalfSpace3D,
    Marker2D,
    Marker3D,
    Model,
    NewtonImpact,
    RigidBody2D,
    RigidBody3D,
    Sphere3D,
    SphereOnHalfSpace3D,
    contacts_between,
)

G = 9.81
LAW = NewtonImpact(restitution=0.0)


class SceneDraw:
    """What scenes of the plane and of space have in common."""

    def __init__(self, rng, space):
        self.rng, self.space, self.static = rng, space, 1.0
        if rng.random() < 0.4:
            self.static = rng.uniform(1.05, 1.5)
        self.mu, self.uneven = rng.uniform(0.1, 0.55), rng.random() < 0.3
        self.bodies, self.joints, self.forces, self.contacts = [], [], [], []
        self.made = 0

    def friction(self):
        mu = self.mu * (self.rng.uniform(0.6, 1.3) if self.uneven else 1.0)
        return CoulombFriction(coefficient=mu, static_coefficient=self.static * mu if self.static > 1.0 else None)

    def marker(self, body, point, **more):
        return (
            Marker3D(body=body, point=tuple(map(float, point)), **more)
            if self.space
            else Marker2D(body=body, point=(float(point[0]), float(point[-1])), **more)
        )

    def body(self, name, size, place, velocity=(0.0, 0.0, 0.0), spin=0.0, mass=None):
        """A body of the size (x, y, z) of a block; in the plane x and z."""
        mass = float(self.rng.uniform(0.5, 3.0)) if mass is None else mass
        x, y, z = (mass / 12.0 * side**2 for side in size)
        if self.space:
            made = RigidBody3D(
                name=name, mass=mass, inertia=(y + z, x + z, x + y), position=tuple(map(float, place)),
                velocity=tuple(map(float, velocity)), angular_velocity=(0.0, 0.0, float(spin)),
            )  # fmt: skip
        else:
            made = RigidBody2D(
                name=name, mass=mass, inertia=x + z, position=(float(place[0]), float(place[2])),
                velocity=(float(velocity[0]), float(velocity[2])),
            )  # fmt: skip
        self.bodies.append(made)
        return mass

    def ball(self, body, point, radius):
        marker = self.marker(body, point)
        return Sphere3D(marker=marker, radius=radius) if self.space else Disk2D(marker=marker, radius=radius)

    def foot(self, body, point, radius=0.0, plane=None):
        """A foot whose lowest point is `point`, on the floor; or a ball at `point` on another plane."""
        name = f"foot{self.made}"
        self.made += 1
        if plane is None:
            point = (point[0], point[1], point[2] + radius)
        ball = self.ball(body, point, radius)
        if self.space:
            self.contacts.append(
                SphereOnHalfSpace3D(
                    name=name, plane=plane or HalfSpace3D(), sphere=ball, law=LAW, friction=self.friction()
                )
            )
        else:
            self.contacts.append(
                DiskOnHalfPlane2D(name=name, plane=plane or HalfPlane2D(), disk=ball, law=LAW, friction=self.friction())
            )

    def between(self, name, first, second=None):
        """Contacts of shapes, with a friction of their own."""
        self.contacts += contacts_between(name, first, second, law=LAW, friction=self.friction())

    def box(self, body, point, size):
        marker = self.marker(body, point)
        if self.space:
            return Box3D(marker=marker, size=tuple(map(float, size)))
        return Box2D(marker=marker, width=float(size[0]), height=float(size[2]))

    def feet_places(self, size, count=None):
        """Places of feet (x, y) under a block: in a line or over an area, evenly or not."""
        rng = self.rng
        count = count or int(rng.integers(2, 9))
        evenly, line = rng.random() < 0.5, not self.space or rng.random() < 0.2
        if line:
            x = np.linspace(-0.5, 0.5, count) if evenly else np.sort(rng.uniform(-0.5, 0.5, count))
            x += 0.0 if evenly else 0.02 * np.arange(count)
            return [(size[0] * a, 0.0) for a in x]
        count = max(count, 3)
        if evenly:
            angle = 2.0 * np.pi * (np.arange(count) + rng.choice([0.0, 0.5])) / count
            return [(0.5 * size[0] * np.cos(a), 0.5 * size[1] * np.sin(a)) for a in angle]
        corners = [(-0.5, -0.4), (0.5, -0.4), (0.0, 0.5)]
        more = rng.uniform(-0.5, 0.5, (count, 2))[: max(0, count - 3)].tolist()
        return [(size[0] * a, size[1] * b) for a, b in [*corners, *more]]

    def push(self, body, size, weight, most=1.8):
        """A load on a body: within friction or beyond it, along the floor and up or down, and a torque."""
        rng = self.rng
        if rng.random() < 0.25:
            return
        name, along = f"push{self.made}", rng.uniform(0.0, most) * self.mu * weight
        self.made += 1
        way = rng.uniform(0.0, 2.0 * np.pi) if self.space else np.pi * rng.integers(2)
        up = rng.uniform(-0.6, 0.3) * weight if rng.random() < 0.5 else 0.0
        x, y, z = (float(value) for value in (along * np.cos(way), along * np.sin(way), up))
        point = [side * rng.uniform(-0.5, 0.5) for side in size]
        if not self.space:
            force = AppliedForce2D(
                name=name, marker=self.marker(body, point), force_x=Constant(value=x), force_y=Constant(value=z)
            )
        else:
            parts = {f"force_{axis}": Constant(value=value) for axis, value in zip("xyz", (x, y, z), strict=True)}
            force = AppliedForce3D(name=name, marker=self.marker(body, point), **parts)
        self.forces.append(force)
        if rng.random() < 0.3:
            torque = Constant(value=float(rng.uniform(-0.3, 0.3) * self.mu * weight * size[0]))
            marker = self.marker(body, (0.0, 0.0, 0.0))
            self.forces.append(
                AppliedTorque3D(name=f"{name}_t", marker=marker, torque_z=torque)
                if self.space
                else AppliedTorque2D(name=f"{name}_t", body=body, torque=torque)
            )

    def sliding(self):
        """A velocity along the floor, or rest."""
        if self.rng.random() < 0.6:
            return np.zeros(3)
        way = self.rng.uniform(0.0, 2.0 * np.pi) if self.space else np.pi * self.rng.integers(2)
        return self.rng.uniform(0.2, 2.0) * np.array([np.cos(way), np.sin(way), 0.0])

    def size(self):
        """Of a block, low enough not to tip over its own friction."""
        x, y = self.rng.uniform(0.5, 1.0, 2)
        return np.array([x, y, self.rng.uniform(0.1, 0.5) * min(x, y)])

    def model(self):
        """On a floor that may be a slope."""
        slope = self.rng.uniform(-0.4, 0.4) if self.rng.random() < 0.4 else 0.0
        way = self.rng.uniform(0.0, 2.0 * np.pi) if self.space else 0.0
        x, y, z = np.sin(slope) * np.cos(way), np.sin(slope) * np.sin(way), -np.cos(slope)
        gravity = (G * x, G * y, G * z) if self.space else (G * x, G * z)
        return Model(
            gravity=gravity, bodies=self.bodies, joints=self.joints, forces=self.forces, contacts=self.contacts
        )
