"""A body thrown at many points of two planes: the laws of impact, of its state before and after, with own matrices."""

import itertools
import logging
import math
from dataclasses import dataclass, field

import numpy as np
import pytest
from scipy.optimize import linprog
from tlismni.core import (
    Axes,
    CoulombFriction,
    Disk2D,
    DiskOnHalfPlane2D,
    EulerParameters,
    HalfPlane2D,
    HalfSpace3D,
    Marker2D,
    Marker3D,
    Model,
    NewtonImpact,
    RigidBody2D,
    RigidBody3D,
    SimulationError,
    Sphere3D,
    SphereOnHalfSpace3D,
    simulate,
)

ANYTHING = 1e9
CLOSE = 1e-7
IN_PLANE = ("vx", "vy", "angular_velocity")
IN_SPACE = ("vx", "vy", "vz", "angular_velocity_x", "angular_velocity_y", "angular_velocity_z")


@dataclass
class Throw:
    """A body about the origin that touches the planes at some of its points, at t = 0.

    mass : of each coordinate, (n,). before : velocities, (n,). e, mu : restitution and friction of all contacts.
    normals : (k, n). tangents : (k, 1 or 2, n).
    """

    mass: np.ndarray
    before: np.ndarray
    e: float
    mu: float
    channels: tuple[str, ...]
    bodies: list = field(default_factory=list)
    contacts: list = field(default_factory=list)
    normals: np.ndarray | list = field(default_factory=list)
    tangents: np.ndarray | list = field(default_factory=list)

    def strike(self):
        """The blow: the result, velocities after it, normal impulses and friction."""
        model = Model(gravity=(0.0,) * (2 if len(self.before) == 3 else 3), bodies=self.bodies, contacts=self.contacts)
        result = simulate(model, 1e-9, first_step=1e-9, start_tolerance=ANYTHING)
        last = np.flatnonzero(result.t == 0.0)[-1]
        hits = {event.contact: event for event in result.events if event.kind == "impact"}
        impulses = [(hits[c.name].impulse, hits[c.name].friction_impulse) if c.name in hits else (0.0, 0.0)
                    for c in self.contacts]  # fmt: skip
        return result, np.array([result[f"b.{name}"][last] for name in self.channels]), *np.array(impulses).T

    def gain(self, after):
        """Of kinetic energy, J."""
        return 0.5 * float(self.mass @ (after**2 - self.before**2))

    def wanted(self, velocities):
        """Normal speeds less those that the law of restitution asks for at least, (k,)."""
        return self.normals @ velocities - self.e * np.maximum(-self.normals @ self.before, 0.0)

    def broken(self, after, normal, rub):
        """Which laws of impact the velocities and impulses do not fulfil."""
        found, size = set(), 1.0 + normal.max()
        wanted, slides = self.wanted(after), np.einsum("kij,j->ki", self.tangents, after)
        if wanted.min() < -CLOSE:
            found.add("restitution")
        if (self.normals @ after).min() < -CLOSE:
            found.add("penetration")
        if np.abs(wanted * normal).max() > CLOSE * size:
            found.add("complementarity")
        if (np.abs(rub) - self.mu * normal).max() > CLOSE * size:
            found.add("cone")
        # what slides has all its friction against it; with what sticks the momentum is that of forces at the contacts
        speed = np.linalg.norm(slides, axis=1)
        moves = speed > 1e-6
        against = -(self.mu * normal * moves / np.maximum(speed, 1e-300))[:, None] * slides
        left = self.mass * (after - self.before) - self.normals.T @ normal
        left -= np.einsum("ki,kij->j", against, self.tangents)
        across = self.tangents[~moves].reshape(-1, len(self.before)).T
        if across.size:
            left = left - across @ np.linalg.lstsq(across, left, rcond=None)[0]
        if np.abs(left).max() > 10.0 * CLOSE * size:
            found.add("friction")
        return found


def in_plane(seed, points, most=0.9):
    rng = np.random.default_rng(seed)
    mass, inertia = rng.uniform(0.2, 5.0, 2)
    before, first = rng.normal(size=3), rng.uniform(0.0, 2.0 * math.pi)
    turned = first + 0.5 * math.pi + 0.1 * rng.normal()
    throw = Throw(np.array([mass, mass, inertia]), before, rng.uniform(0.8, 1.0), rng.uniform(0.0, most), IN_PLANE)
    throw.bodies = [
        RigidBody2D(name="b", mass=mass, inertia=inertia, velocity=tuple(before[:2]), angular_velocity=before[2])
    ]
    places = -rng.uniform(0.0, 2.0, 2)
    for k in range(points):
        angle, place = (first, turned)[k % 2], places[k % 2]
        n, t = np.array([math.cos(angle), math.sin(angle)]), np.array([math.sin(angle), -math.cos(angle)])
        p = place * n + rng.uniform(-1.0, 1.0) * t
        plane = HalfPlane2D(marker=Marker2D(point=tuple(place * n), angle=angle - 0.5 * math.pi))
        throw.contacts.append(
            DiskOnHalfPlane2D(
                name=f"c{k}", plane=plane, disk=Disk2D(marker=Marker2D(body="b", point=tuple(p))),
                law=NewtonImpact(restitution=throw.e), friction=CoulombFriction(coefficient=throw.mu),
            )
        )  # fmt: skip
        rows = [[*d, d[1] * p[0] - d[0] * p[1]] for d in (n, t)]
        throw.normals.append(rows[0])
        throw.tangents.append(rows[1:])
    throw.normals, throw.tangents = np.array(throw.normals), np.array(throw.tangents)
    return throw


def in_space(seed, points):
    rng = np.random.default_rng(seed)
    mass, parts = rng.uniform(0.3, 4.0), rng.uniform(0.2, 1.5, 3)
    inertia, before = parts.sum() - parts, rng.normal(size=6)
    throw = Throw(np.array([mass] * 3 + list(inertia)), before, rng.uniform(0.8, 1.0), rng.uniform(0.0, 0.9), IN_SPACE)
    throw.bodies = [
        RigidBody3D(
            name="b", mass=mass, inertia=tuple(inertia), attitude=EulerParameters(), velocity=tuple(before[:3]),
            angular_velocity=tuple(before[3:]),
        )
    ]  # fmt: skip
    first = rng.normal(size=3)
    first /= np.linalg.norm(first)
    angle, places = 0.5 * math.pi + 0.1 * rng.normal(), -rng.uniform(0.0, 2.0, 2)
    side = np.linalg.svd(first[None])[2][1]
    for k in range(points):
        n = (first, math.cos(angle) * first + math.sin(angle) * side)[k % 2]
        t, s = np.linalg.svd(n[None])[2][1:]
        p = places[k % 2] * n + rng.uniform(-1.0, 1.0) * t + rng.uniform(-1.0, 1.0) * s
        plane = HalfSpace3D(marker=Marker3D(point=tuple(places[k % 2] * n), attitude=Axes(z=tuple(n))))
        throw.contacts.append(
            SphereOnHalfSpace3D(
                name=f"c{k}", plane=plane, sphere=Sphere3D(marker=Marker3D(body="b", point=tuple(p))),
                law=NewtonImpact(restitution=throw.e), friction=CoulombFriction(coefficient=throw.mu),
            )
        )  # fmt: skip
        throw.normals.append([*n, *np.cross(p, n)])
        throw.tangents.append([[*d, *np.cross(p, d)] for d in (t, s)])
    throw.normals, throw.tangents = np.array(throw.normals), np.array(throw.tangents)
    return throw


@pytest.mark.sampled(1)
@pytest.mark.parametrize(("throw", "points"), [(in_plane, 8), (in_plane, 16), (in_space, 8)])
def test_a_blow_fulfils_all_laws_or_says_that_it_does_not(throw, points, caplog):
    """Restitution e near 1 and friction. Many points separate beforehand, and are struck all the same, by the others:
    velocities fulfil the laws of all at once, or the run says that there are rounds, and energy does not grow by them
    (where it does, that is said as well)."""
    in_rounds, shared = 0, 0
    for seed in range(120):
        caplog.clear()
        thrown = throw(seed, points)
        try:
            result, after, normal, rub = thrown.strike()
        except SimulationError as error:
            assert "find forces of the contacts" in str(error)
            continue
        said = " ".join(record.getMessage() for record in caplog.records)
        if "steps of impulses" in said:
            continue  # no blow has been found, which a warning says
        rounds = result.stats["impacts_in_rounds"]
        assert ("are struck in rounds" in said) == (rounds > 0)
        assert bool(thrown.broken(after, normal, rub)) == (rounds > 0), seed
        assert thrown.gain(after) <= CLOSE or "raises the energy" in said
        assert (thrown.normals @ after).min() >= -CLOSE
        in_rounds += rounds > 0
        shared += rounds == 0 and bool(np.any(normal[thrown.normals @ thrown.before > 0.0] > 0.0))
    assert in_rounds <= 12 < shared


def gains_of_all_solutions(thrown):
    """Gain of energy, J, of all motions after the blow in which each point is open, sticks, or slides to a side, and
    that fulfil all laws: a linear programme each."""
    count, gains = len(thrown.normals), []
    normals, tangents = thrown.normals, thrown.tangents[:, 0]
    response = np.vstack([normals, tangents]).T / thrown.mass[:, None]  # velocities by P_N and P_T
    least = thrown.e * np.maximum(-normals @ thrown.before, 0.0)
    for modes in itertools.product(("open", "stick", 1.0, -1.0), repeat=count):
        equal, sums, above, bounds = [], [], [], []
        for k, mode in enumerate(modes):
            along, across = normals[k] @ response, tangents[k] @ response
            u_n, u_t = least[k] - normals[k] @ thrown.before, -tangents[k] @ thrown.before
            one = np.eye(2 * count)
            if mode == "open":
                above.append((-along, -u_n))
                equal += [one[k], one[count + k]]
                sums += [0.0, 0.0]
                continue
            equal.append(along)
            sums.append(u_n)
            if mode == "stick":
                equal.append(across)
                sums.append(u_t)
                above += [(sign * one[count + k] - thrown.mu * one[k], 0.0) for sign in (1.0, -1.0)]
            else:
                equal.append(one[count + k] + mode * thrown.mu * one[k])
                sums.append(0.0)
                above.append((-mode * across, -mode * u_t))
        bounds = [(0.0, None)] * count + [(None, None)] * count
        found = linprog(
            np.ones(2 * count), A_eq=np.array(equal), b_eq=sums, bounds=bounds,
            A_ub=np.array([row for row, _ in above]) if above else None, b_ub=[b for _, b in above] or None,
        )  # fmt: skip
        if found.status == 0:
            gains.append(thrown.gain(thrown.before + response @ found.x))
    return gains


def test_rounds_are_for_blows_without_another_solution():
    """Where the run says that four points are struck in rounds, all motions that fulfil the laws at once gain energy,
    or there are none."""
    in_rounds = 0
    for seed in range(200):
        thrown = in_plane(seed, 4, most=0.8)
        result, after, normal, rub = thrown.strike()
        if result.stats["impacts_in_rounds"]:
            in_rounds += 1
            assert min(gains_of_all_solutions(thrown), default=1.0) > 0.0, seed
        else:
            assert not thrown.broken(after, normal, rub)
            # the solver's motion is among them
            if in_rounds < 2 and seed < 3:
                gains = np.array(gains_of_all_solutions(thrown))
                assert np.abs(gains - thrown.gain(after)).min() < CLOSE
    assert in_rounds > 0


def test_a_ball_between_two_walls_is_struck_in_rounds(caplog):
    """Each wall throws it at the other at one instant: no velocities fulfil both laws of restitution."""
    ball = RigidBody2D(name="b", mass=1.0, inertia=1.0, velocity=(-1.0, 0.0))
    contacts = [
        DiskOnHalfPlane2D(
            name=name, plane=HalfPlane2D(marker=Marker2D(point=(x, 0.0), angle=angle)),
            disk=Disk2D(marker=Marker2D(body="b"), radius=1.0), law=NewtonImpact(restitution=0.5),
        )
        for name, x, angle in (("left", -1.0, -0.5 * math.pi), ("right", 1.0, 0.5 * math.pi))
    ]  # fmt: skip
    with caplog.at_level(logging.WARNING):
        result = simulate(Model(gravity=(0.0, 0.0), bodies=[ball], contacts=contacts), 0.1)
    assert result.stats["impacts_in_rounds"] >= 1
    (said,) = [record.getMessage() for record in caplog.records if "rounds" in record.getMessage()]
    assert "'left'" in said and "'right'" in said
    assert abs(result["b.vx"][-1]) < 1e-12
