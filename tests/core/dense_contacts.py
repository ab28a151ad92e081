"""The contact problem of a model of rigid bodies at its start, dense, from the records of the model alone.

Nothing of the solver is used: places and velocities are those of the records, joints and contacts are written down as
rows of a dense matrix, and all is calculated with 80-bit numbers (`numpy.longdouble`), whose rounding stays below the
compliances of `regularised_contacts`.
"""

from dataclasses import dataclass

import numpy as np
from extended_numbers import REAL, independent_rows, solve
from tlismni.core import (
    AppliedForce2D,
    AppliedForce3D,
    AppliedTorque2D,
    AppliedTorque3D,
    DiskOnBox2D,
    DiskOnHalfPlane2D,
    Fixed3D,
    Prismatic2D,
    Prismatic3D,
    Revolute2D,
    Revolute3D,
    RigidBody2D,
    SphereOnHalfSpace3D,
    SphereOnMesh3D,
)
from tlismni.core.model.attitude import rotation_matrix

GROUND = "ground"
TOUCHES = 1e-9
"""Gaps below this are closed, m, in a model whose bodies are about 1 m large."""
MOVES = 1e-9
"""Sliding velocities above this are some, m/s."""


@dataclass
class ContactProblem:
    """w = b + A P for the accelerations w of closed contacts and their forces P, each (contacts, 3): along the normal
    and two tangents."""

    names: list[str]
    matrix: np.ndarray
    """A, (3 contacts, 3 contacts), 1/kg, contact by contact."""
    free: np.ndarray
    """b, (3 contacts,), m/s^2."""
    static: np.ndarray
    kinetic: np.ndarray
    ways: np.ndarray
    """(contacts, 2): unit vector of the sliding velocity along both tangents; 0 where the contact is at rest."""
    tangents: int
    """How many a contact has: 1 in the plane, where the second one has no row, and 2 in space."""
    responses: np.ndarray
    """Accelerations of the bodies for unit forces, (bodies * 6, 3 contacts)."""
    without: np.ndarray
    """Accelerations of the bodies without contact forces, (bodies * 6,)."""
    bodies: list[str]
    compliance: np.ndarray
    """C, (contacts,): of the normal and the tangents of each."""

    def motion(self, forces: np.ndarray) -> dict[str, np.ndarray]:
        """Acceleration (6,) of each body, translation and rotation, for contact forces (contacts, 3)."""
        found = self.without + self.responses @ forces.reshape(-1)
        return {name: found[6 * i : 6 * i + 6] for i, name in enumerate(self.bodies)}


def _matrix(attitude) -> np.ndarray:
    return np.array(rotation_matrix(attitude.parameters()), REAL)


class _Frame:
    """A body at the start, in space: the plane is z = 0."""

    def __init__(self, body=None, number=-1):
        self.number, self.place, self.axes = number, np.zeros(3, REAL), np.eye(3, dtype=REAL)
        self.speed, self.spin = np.zeros(3, REAL), np.zeros(3, REAL)
        if body is None:
            return
        planar = len(body.position) == 2
        self.place[: len(body.position)] = body.position
        self.speed[: len(body.velocity)] = body.velocity
        if planar:
            self.axes, self.spin[2] = _planar_axes(body.angle), body.angular_velocity
            self.inertia = np.diag(np.array([1.0, 1.0, body.inertia], REAL))
        else:
            self.axes = _matrix(body.attitude)
            self.spin = self.axes @ np.array(body.angular_velocity, REAL)
            self.inertia = self.axes @ np.diag(np.array(body.inertia, REAL)) @ self.axes.T
        self.mass = REAL(body.mass)

    def at(self, marker) -> np.ndarray:
        """Place of a marker's point."""
        return self.place + self.axes @ _in_space(marker.point)

    def axes_of(self, marker) -> np.ndarray:
        """Axes of a marker, as columns."""
        own = _planar_axes(marker.angle) if len(marker.point) == 2 else _matrix(marker.attitude)
        return self.axes @ own

    def velocity(self, place) -> np.ndarray:
        return self.speed + np.cross(self.spin, place - self.place)

    def centripetal(self, place) -> np.ndarray:
        return np.cross(self.spin, np.cross(self.spin, place - self.place))


def _in_space(point) -> np.ndarray:
    return np.array([*point, 0.0][:3], REAL)


def _planar_axes(angle) -> np.ndarray:
    c, s = np.cos(REAL(angle)), np.sin(REAL(angle))
    return np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]], REAL)


class _Rows:
    """Rows of a matrix over the velocities of all bodies, and what their rates have besides accelerations."""

    def __init__(self, count):
        self.width, self.rows, self.rates = 6 * count, [], []

    def add(self, parts, rate):
        """A row of (frame, place, direction, turn): direction . velocity of the place + turn . spin."""
        row = np.zeros(self.width, REAL)
        for frame, place, direction, turn in parts:
            if frame.number >= 0:
                k = 6 * frame.number
                row[k : k + 3] += direction
                row[k + 3 : k + 6] += np.cross(place - frame.place, direction) + turn
        self.rows.append(row)
        self.rates.append(rate)

    def arrays(self):
        return np.array(self.rows, REAL).reshape(-1, self.width), np.array(self.rates, REAL)


def is_planar(model) -> bool:
    """Whether the bodies of a model are those of the plane."""
    return isinstance(model.bodies[0], RigidBody2D)


def contact_problem(model) -> ContactProblem:
    """The contacts of a model that are closed at the start. Raises TypeError for records that are not known here."""
    frames = {body.name: _Frame(body, i) for i, body in enumerate(model.bodies)}
    frames[GROUND] = _Frame()
    planar = is_planar(model)
    mass, force = _inertia_and_loads(model, frames)
    joints, rates = _joint_rows(model, frames, planar)
    rows, names, static, kinetic, ways = _contact_rows(model, frames, planar)
    held, drift = rows.arrays()
    keep = independent_rows(joints)
    joints, rates = joints[keep], rates[keep]
    n, m = len(mass), len(joints)
    system = np.zeros((n + m, n + m), REAL)
    system[:n, :n], system[:n, n:], system[n:, :n] = mass, joints.T, joints
    right = np.zeros((n + m, len(held) + 1), REAL)
    right[:n, :-1], right[:n, -1], right[n:, -1] = held.T, force, -rates
    found = solve(system, right)[:n]
    matrix = held @ found[:, :-1]
    given = {contact.name: contact.compliance for contact in model.contacts}
    return ContactProblem(
        names, 0.5 * (matrix + matrix.T), held @ found[:, -1] + drift, np.array(static, REAL), np.array(kinetic, REAL),
        np.array(ways, REAL), 1 if planar else 2, found[:, :-1], found[:, -1], [body.name for body in model.bodies],
        np.array([given[name] for name in names], REAL),
    )  # fmt: skip


def _inertia_and_loads(model, frames):
    count = len(model.bodies)
    mass, force = np.zeros((6 * count, 6 * count), REAL), np.zeros(6 * count, REAL)
    for body in model.bodies:
        frame, k = frames[body.name], 6 * frames[body.name].number
        mass[k : k + 3, k : k + 3], mass[k + 3 : k + 6, k + 3 : k + 6] = frame.mass * np.eye(3), frame.inertia
        force[k : k + 3] = frame.mass * _in_space(model.gravity)
        force[k + 3 : k + 6] = -np.cross(frame.spin, frame.inertia @ frame.spin)
    for load in model.forces:
        if isinstance(load, AppliedForce2D | AppliedForce3D):
            frame = frames[load.marker.body]
            push = _components(load, "force")
            k = 6 * frame.number
            force[k : k + 3] += push
            force[k + 3 : k + 6] += np.cross(frame.at(load.marker) - frame.place, push)
        elif isinstance(load, AppliedTorque2D):
            force[6 * frames[load.body].number + 5] += REAL(load.torque.value)
        elif isinstance(load, AppliedTorque3D):
            k = 6 * frames[load.marker.body].number
            force[k + 3 : k + 6] += _components(load, "torque")
        else:
            raise TypeError(f"no dense load of a {type(load).__name__}")
    return mass, force


def _components(load, what) -> np.ndarray:
    names = [f"{what}_{axis}" for axis in "xyz"]
    return np.array([getattr(load, name).value if name in type(load).model_fields else 0.0 for name in names], REAL)


def _joint_rows(model, frames, planar):
    rows, nothing = _Rows(len(model.bodies)), np.zeros(3, REAL)
    x, y, z = np.eye(3, dtype=REAL)
    if planar:
        for body in model.bodies:
            frame = frames[body.name]
            rows.add([(frame, frame.place, z, nothing)], 0.0)
            for turn in (x, y):
                rows.add([(frame, frame.place, nothing, turn)], 0.0)
    for joint in model.joints:
        a, b = frames[joint.a.body], frames[joint.b.body]
        place_a, place_b, axes = a.at(joint.a), b.at(joint.b), a.axes_of(joint.a)
        if isinstance(joint, Revolute2D | Revolute3D | Fixed3D):
            moved, turned = (x, y, z), {Fixed3D: axes.T, Revolute3D: axes.T[:2]}.get(type(joint), ())
        elif isinstance(joint, Prismatic3D):
            moved, turned = axes.T[:2], axes.T
        elif isinstance(joint, Prismatic2D):
            moved, turned = (axes.T[1],), (z,)
        else:
            raise TypeError(f"no dense rows of a {type(joint).__name__}")
        if isinstance(joint, Prismatic2D | Prismatic3D) and (a.spin.any() or b.spin.any()):
            raise TypeError("sliders are taken for such that do not turn")
        for way in moved:
            rate = way @ (b.centripetal(place_b) - a.centripetal(place_a))
            rows.add([(b, place_b, way, nothing), (a, place_a, -way, nothing)], rate)
        for turn in turned:
            rate = np.cross(a.spin, turn) @ (b.spin - a.spin)
            rows.add([(b, place_b, nothing, turn), (a, place_a, nothing, -turn)], rate)
    return rows.arrays()


def _contact_rows(model, frames, planar):
    rows, nothing = _Rows(len(model.bodies)), np.zeros(3, REAL)
    names, static, kinetic, ways = [], [], [], []
    for contact in model.contacts:
        a, b, gap, normal, middle, radius = _touching(contact, frames)
        if gap < -TOUCHES:
            raise ValueError(f"'{contact.name}' overlaps by {-gap} m")
        if gap > TOUCHES:
            continue
        place = middle - radius * normal
        # as the channels count: on boxes counter-clockwise along the outline
        side = -1.0 if isinstance(contact, DiskOnBox2D) else 1.0
        first = side * np.array([normal[1], -normal[0], 0.0], REAL) if planar else _across(normal)
        second = np.cross(normal, first)
        speed = b.velocity(place) - a.velocity(place)
        if abs(normal @ speed) > MOVES:
            raise ValueError(f"'{contact.name}' approaches or separates at the start")
        if (np.abs(np.cross(a.spin, normal)) > MOVES).any():
            raise TypeError(f"'{contact.name}': the face may not turn out of its plane")
        # the face moves on along itself; the sphere's middle turns about its body's centre of mass
        drift = b.centripetal(middle) - a.centripetal(place)
        for k, way in enumerate((normal, first, second)):
            parts = [] if planar and k == 2 else [(b, place, way, nothing), (a, place, -way, nothing)]
            rows.add(parts, way @ drift if parts else 0.0)
        names.append(contact.name)
        friction = contact.friction
        kinetic.append(0.0 if friction is None else friction.coefficient)
        other = None if friction is None else friction.static_coefficient
        static.append(kinetic[-1] if other is None else other)
        along = np.array([first @ speed, 0.0 if planar else second @ speed], REAL)
        size = np.sqrt(along @ along)
        ways.append(along / size if size > MOVES else 0.0 * along)
    return rows, names, static, kinetic, ways


def _touching(contact, frames):
    """(frame of the face, frame of the round one, gap, normal, middle of the round one, its radius)."""
    if isinstance(contact, DiskOnHalfPlane2D | SphereOnHalfSpace3D):
        ball = contact.disk if isinstance(contact, DiskOnHalfPlane2D) else contact.sphere
        a, b = frames[contact.plane.marker.body], frames[ball.marker.body]
        normal = a.axes_of(contact.plane.marker)[:, 1 if isinstance(contact, DiskOnHalfPlane2D) else 2]
        middle = b.at(ball.marker)
        return a, b, normal @ (middle - a.at(contact.plane.marker)) - ball.radius, normal, middle, REAL(ball.radius)
    if isinstance(contact, DiskOnBox2D | SphereOnMesh3D):
        planar = isinstance(contact, DiskOnBox2D)
        ball, box = (contact.disk, contact.shape) if planar else (contact.sphere, contact.mesh)
        a, b = frames[box.marker.body], frames[ball.marker.body]
        axes, middle = a.axes_of(box.marker), b.at(ball.marker)
        corners = ((0.5 * box.width, 0.5 * box.height, 0.0),) if planar else box.vertices
        half = np.max(np.array(corners, REAL), axis=0)
        away = axes.T @ (middle - a.at(box.marker))
        beyond = np.abs(away) - half
        if planar:
            beyond[2] = -1.0
        outside = np.maximum(beyond, 0.0)
        k = int(np.argmax(beyond))
        distance = np.sqrt(outside @ outside)
        normal = np.sign(away[k]) * axes[:, k]
        if abs(distance - ball.radius) < TOUCHES and np.sum(outside > 0.0) > 1:
            raise TypeError(f"'{contact.name}' is at a corner")
        return a, b, distance - ball.radius, normal, middle, REAL(ball.radius)
    raise TypeError(f"no dense rows of a {type(contact).__name__}")


def _across(normal) -> np.ndarray:
    """A unit vector across the normal."""
    along = np.eye(3, dtype=REAL)[int(np.argmin(np.abs(normal)))]
    found = along - (along @ normal) * normal
    return found / np.sqrt(found @ found)
