"""Variations over events: what neighbouring runs give by central differences."""

import logging
import math

import numpy as np
import pytest
from helpers import GROUND, on
from tlismni.core import (
    AppliedForce2D,
    AppliedTorque2D,
    Bushing2D,
    Constant,
    CoordinateDriver,
    Disk2D,
    DiskOnDisk2D,
    EquationSystem,
    GapContact,
    Marker2D,
    Model,
    NewtonImpact,
    PointMass2D,
    Ramp,
    Revolute2D,
    RigidBody2D,
    Simulation,
    Sine,
    Step,
    simulate,
)
from tlismni.core.analysis import lyapunov_exponents
from tlismni.core.analysis.layout import Layout, rates_from_tangents
from tlismni.core.analysis.variation import Variation


def carried(system, t_end):
    """Variations at the start (n, columns) of q and v, at the end (2n, columns), and the `Variation`."""
    sim = Simulation(system, "irk", tableau="gauss3", rtol=1e-11, atol=1e-13)
    variation = Variation(sim, factors=True)
    start = variation.dq.copy(), variation.dv.copy()
    product = np.eye(len(variation.exponents))
    while sim.t_internal < t_end:
        variation.advance(t_end)
        product = variation.last @ product
    return start, np.vstack([variation.dq, variation.dv]) @ product, variation


def differences(make, start, t_end, size=1e-6):
    """What `carried` should give, by central differences of whole runs; make(dq, dv) builds the system."""
    columns = []
    for dq, dv in zip(start[0].T, start[1].T, strict=True):
        ends = []
        for sign in (size, -size):
            run = simulate(make(sign * dq, sign * dv), t_end, "irk", 1e-12, 1e-14, tableau="gauss3", record=False)
            ends.append(np.concatenate([run.q[-1], run.v[-1]]))
        columns.append((ends[0] - ends[1]) / (2.0 * size))
    return np.array(columns).T


def test_impacts_of_a_double_pendulum_on_a_moving_round_wall():
    """M depends on q, the gap is curved and depends on time: every term of the saltation matrix counts."""

    def mass(t, q):
        c = 0.56 * np.cos(q[0] - q[1])
        return np.array([[1.7, c], [c, 0.448]])

    def force(t, q, v):
        s = 0.56 * np.sin(q[0] - q[1])
        return np.array(
            [
                -s * v[1] ** 2 - 16.677 * np.sin(q[0]) - 0.1 * v[0] + 2.0 * np.cos(3.0 * t),
                s * v[0] ** 2 - 5.4936 * np.sin(q[1]) - 0.2 * v[1] ** 3,
            ]
        )

    def gap(t, q):
        x, y = np.sin(q[0]) + 0.8 * np.sin(q[1]), -np.cos(q[0]) - 0.8 * np.cos(q[1])
        return np.sqrt((x - 1.5 - 0.1 * np.sin(5.0 * t)) ** 2 + (y + 0.9 + 0.05 * t) ** 2) - 1.0

    def make(dq, dv):
        wall = GapContact("wall", gap, NewtonImpact(restitution=0.7))
        return EquationSystem(mass, force, q0=np.add(dq, (0.3, -0.5)), v0=np.add(dv, (1.5, 2.0)), contacts=[wall])

    start, last, variation = carried(make(np.zeros(2), np.zeros(2)), 0.5)
    assert variation.impacts == 1
    assert np.sum(variation.growth) == pytest.approx(variation.volume, abs=1e-10)
    expected = differences(make, start, 0.5)
    assert last == pytest.approx(expected, abs=1e-6 * np.max(np.abs(expected)))


def test_joints_drivers_and_steps_of_a_force():
    """A rod on a driven base: the driver's rate jumps twice, a follower-free force jumps, a round stop is struck."""
    logging.disable(logging.WARNING)  # drivers that jump warn

    def make(dq, dv):
        angle = 0.2
        rod = RigidBody2D(
            name="rod", mass=1.0, inertia=0.1, angle=angle + dq[2],
            position=(0.5 * math.cos(angle) + dq[0], 0.5 * math.sin(angle) + dq[1]),
            velocity=(dv[0], dv[1]), angular_velocity=dv[2],
        )  # fmt: skip
        wave = Sine(amplitude=0.05, angular_frequency=7.0, phase=0.5 * math.pi, offset=-0.05)
        motions = {"x": Ramp(start=0.3, duration=0.4, after=0.3), "y": wave, "angle": Constant(value=0.0)}
        drivers = [CoordinateDriver(name=f"d{c}", body="base", coordinate=c, motion=f) for c, f in motions.items()]
        stop = DiskOnDisk2D(
            name="stop",
            a=Disk2D(marker=Marker2D(point=(0.5, -1.0)), radius=0.2),
            b=Disk2D(marker=on("rod", 0.5), radius=0.05),
            law=NewtonImpact(restitution=0.6),
        )
        return Model(
            bodies=[rod, RigidBody2D(name="base", mass=1.0, inertia=1.0)],
            joints=[Revolute2D(name="pin", a=on("base"), b=on("rod", -0.5)), *drivers],
            forces=[
                AppliedTorque2D(name="torque", body="rod", torque=Sine(amplitude=2.0, angular_frequency=3.0)),
                AppliedForce2D(name="push", marker=on("rod", 0.2, 0.1), force_x=Step(time=0.55, after=3.0)),
            ],
            contacts=[stop],
        )

    try:
        start, last, variation = carried(make(np.zeros(3), np.zeros(3)), 1.1)
        expected = differences(make, start, 1.1)
    finally:
        logging.disable(logging.NOTSET)
    assert variation.impacts == 1
    assert np.sum(variation.growth) == pytest.approx(variation.volume, abs=1e-10)
    # the joint's own part of dv is not carried: the angle's says it all
    assert last[[0, 1, 2, 8]] == pytest.approx(expected[[0, 1, 2, 8]], abs=1e-6 * np.max(np.abs(expected)))


def test_closing_and_opening_of_a_lasting_contact():
    """A point falls on a round dome without rebound, slides down it, and leaves it where the force ends: two directions
    are lost for good, the others go on."""

    def make(dq, dv):
        dome = DiskOnDisk2D(
            name="dome", a=Disk2D(marker=GROUND, radius=0.8), b=Disk2D(marker=on("ball"), radius=0.2),
            law=NewtonImpact(restitution=0.0),
        )  # fmt: skip
        ball = PointMass2D(
            name="ball", mass=1.3, position=(0.1 + dq[0], 1.3 + dq[1]), velocity=(0.3 + dv[0], 0.0 + dv[1])
        )
        spring = Bushing2D(name="spring", a=Marker2D(point=(0.5, 0.5)), b=on("ball"), stiffness=2.0, damping=0.3)
        push = AppliedForce2D(name="push", marker=on("ball"), force_x=Sine(amplitude=1.0, angular_frequency=4.0))
        return Model(bodies=[ball], forces=[spring, push], contacts=[dome])

    start, last, variation = carried(make(np.zeros(2), np.zeros(2)), 1.2)
    assert [event.kind for event in variation.sim.events] == ["impact", "close", "open"]
    assert np.isneginf(variation.growth).sum() == 2
    expected = differences(make, start, 1.2)
    assert last == pytest.approx(expected, abs=1e-6 * np.max(np.abs(expected)))
    assert np.linalg.matrix_rank(last, tol=1e-6) == 2
    found = lyapunov_exponents(make(np.zeros(2), np.zeros(2)), 1.2)
    assert np.all(np.isneginf(found.exponents[2:])) and np.all(np.isfinite(found.exponents[:2]))
    assert found.volume_rate == -math.inf and math.isnan(found.sum_residual)


def test_rate_of_the_mass_matrix_from_the_tangents_is_that_of_the_functions():
    def mass(t, q):
        c = 0.5 * np.cos(q[0] - q[1])
        return np.array([[2.0 + q[0] ** 2, c], [c, 1.0]])

    system = EquationSystem(mass, lambda t, q, v: -q, q0=[0.3, -0.5], v0=[1.5, 2.0])
    sim = Simulation(system, "irk")
    (found,) = rates_from_tangents(sim, Layout.of(sim), np.array([0.0]))
    assert found == pytest.approx(system.functions.mass_rate(0.0, system.q0, system.v0), abs=1e-13)
