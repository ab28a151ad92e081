"""Derivatives of all channels by inputs against extrapolated differences of the channels, in every contact state."""

import math

import numpy as np
import pytest
from tlismni.core import (
    AppliedForce2D,
    AppliedTorque2D,
    AxialRod,
    BrownMcPheeFriction,
    Cable2D,
    Clamp2D,
    CoordinateContact,
    CoordinateLoad,
    CoordinateTerm,
    CoulombFriction,
    Disk2D,
    DiskOnHalfPlane2D,
    HalfPlane2D,
    Hertz,
    KelvinVoigt,
    LuGreFriction,
    MarkerOutput2D,
    MaterialPoint2D,
    Model,
    NewtonImpact,
    PointMass2D,
    Revolute2D,
    RigidBody2D,
    Simulation,
)
from tlismni.core.model.channels import Input
from tlismni.core.model.markers import Marker2D
from tlismni.core.model.signals import InputSignal

INPUTS = tuple(Input(name=name, unit=unit) for name, unit in (("fx", "N"), ("fy", "N"), ("torque", "N.m")))
FORCES = ("fx", "fy", "torque")


def extrapolated(sim, name, size):
    """Central differences of all channels at two steps, extrapolated to order 4; the simulation stays as it was."""
    k = sim.assembly.input_names.index(name)
    u, state = float(sim.workspace.arrays["inputs"][k, 0]), sim.state()

    def at(value):
        sim.set_inputs({name: value})
        found = np.array(sim.values())
        sim.restore(state)
        return found

    slopes = [(at(u + d) - at(u - d)) / (2.0 * d) for d in (size, 2.0 * size)]
    return (4.0 * slopes[0] - slopes[1]) / 3.0


def check(sim, names, size):
    """Each input's derivatives, relative to the largest of the channels of one unit, and those of a direction."""
    present = np.abs(sim.values())
    before = sim.state().to_bytes()
    real = np.array([c.kind == "real" for c in sim.channels])
    units = np.array([c.unit for c in sim.channels])
    total, along = 0.0, {}
    for k, name in enumerate(names):
        found, wanted = sim.input_derivatives({name: 1.0}), extrapolated(sim, name, size)
        for unit in set(units[real]):
            here = real & (units == unit)
            level = max(np.max(np.abs(wanted[here])), np.max(present[here]) * 1e-7, 1e-9)
            np.testing.assert_allclose(found[here], wanted[here], rtol=1e-7, atol=1e-7 * level)
        along[name] = float(k + 1)
        total = total + (k + 1) * found
    together = sim.input_derivatives(along)
    np.testing.assert_allclose(together, total, rtol=1e-10, atol=1e-12 * np.max(np.abs(total)))
    assert sim.state().to_bytes() == before
    return {c.name: x for c, x in zip(sim.channels, sim.input_derivatives({names[0]: 1.0}), strict=True)}


def block(law, friction=None, height=0.0, speed=0.0, feet=1):
    """A block above or on the floor, loaded by a force off its centre and a torque; a marker on its corner."""
    body = RigidBody2D(name="block", mass=2.0, inertia=0.4, position=(0.0, 0.5 + height), velocity=(speed, 0.0))
    corner = Marker2D(body="block", point=(0.4, 0.3))
    places = [(0.0, -0.4)] if feet == 1 else [(-0.3, -0.4), (0.3, -0.4)]
    return Model(
        name="block",
        bodies=[body],
        forces=[
            AppliedForce2D(name="push", marker=Marker2D(body="block", point=(0.02, 0.1)),
                           force_x=InputSignal(channel="fx"), force_y=InputSignal(channel="fy")),
            AppliedTorque2D(name="turn", body="block", torque=InputSignal(channel="torque")),
        ],
        contacts=[
            DiskOnHalfPlane2D(name=f"foot{k}", plane=HalfPlane2D(), law=law, friction=friction,
                              disk=Disk2D(marker=Marker2D(body="block", point=place), radius=0.1))
            for k, place in enumerate(places)
        ],
        inputs=INPUTS,
        outputs=[MarkerOutput2D(name="corner", marker=corner)],
    )  # fmt: skip


def mode(sim, k=0):
    names = [c.name for c in sim.channels]
    return int(sim.values()[names.index(f"foot{k}.mode")])


RIGID = NewtonImpact(restitution=0.0)


def test_in_the_air():
    sim = Simulation(block(RIGID, height=1.0))
    sim.set_inputs({"fx": 1.0, "torque": 0.3})
    sim.advance(0.2)
    found = check(sim, FORCES, 0.5)
    assert found["block.ax"] == pytest.approx(0.5, rel=1e-13) and found["foot0.normal_force"] == 0.0


@pytest.mark.parametrize("feet", [1, 2])
def test_closed_without_friction(feet):
    sim = Simulation(block(RIGID, speed=0.3, feet=feet))
    sim.set_inputs({"fx": 1.0, "torque": 0.01})
    sim.advance(0.05)
    assert mode(sim) == 1
    check(sim, FORCES, 0.05)


@pytest.mark.parametrize("feet", [1, 2])
def test_closed_and_sticking(feet):
    """With two feet that stick one row is redundant."""
    sim = Simulation(block(RIGID, CoulombFriction(coefficient=0.6), feet=feet))
    sim.set_inputs({"fx": 1.0, "torque": 0.01})
    sim.advance(0.05)
    assert mode(sim) == 1
    check(sim, FORCES, 0.05)


@pytest.mark.parametrize("feet", [1, 2])
@pytest.mark.parametrize("speed", [1.0, -1.0])
def test_closed_and_sliding(feet, speed):
    """Friction grows with the normal force: pushing down slows a block that slides."""
    mu = 0.3
    sim = Simulation(block(RIGID, CoulombFriction(coefficient=mu), speed=speed, feet=feet))
    sim.set_inputs({"fx": 0.3, "torque": 0.01})
    sim.advance(0.05)
    check(sim, FORCES, 0.05)
    down = dict(zip((c.name for c in sim.channels), sim.input_derivatives({"fy": -1.0}), strict=True))
    normal = sum(down[f"foot{k}.normal_force"] for k in range(feet))
    assert normal == pytest.approx(1.0, rel=0.5 if feet == 1 else 1e-9)
    assert 2.0 * down["block.ax"] == pytest.approx(-math.copysign(mu, speed) * normal, rel=1e-9)


@pytest.mark.parametrize(
    "law, friction",
    [
        (Hertz(stiffness=1e5), None),
        (KelvinVoigt(stiffness=1e4, damping=20.0), None),
        (Hertz(stiffness=1e5), BrownMcPheeFriction(coefficient=0.3, static_coefficient=0.4, transition_speed=0.01)),
        (Hertz(stiffness=1e5), LuGreFriction(coefficient=0.3, stribeck_speed=0.01, bristle_stiffness=1e4)),
    ],
)  # fmt: skip
def test_force_laws_act_and_let_go(law, friction):
    """The forces depend on coordinates and velocities only, so that they are held."""
    sim = Simulation(block(law, friction, height=0.01, speed=0.5))
    sim.set_inputs({"fx": 1.0, "fy": -2.0})
    modes = set()
    for k in range(1, 40):
        sim.advance(0.004 * k)
        if mode(sim) not in modes or k % 8 == 0:
            found = check(sim, FORCES, 0.05)
            assert found["foot0.normal_force"] == 0.0
        modes.add(mode(sim))
    assert len(modes) >= 2


def test_released_by_a_force_law_that_would_pull():
    """Kelvin-Voigt at zero force, gap still closed: the state between release and parting."""
    law = KelvinVoigt(stiffness=1e3, damping=20.0)
    sim = Simulation(block(law, height=0.2))
    seen = set()
    for k in range(1, 400):
        sim.advance(0.0015 * k)
        if mode(sim) not in seen:
            check(sim, FORCES, 0.05)
        seen.add(mode(sim))
    assert len(seen) >= 3


def test_redundant_joints():
    """A bar in three pins in line, of which one direction is left out of the equations."""
    bar = RigidBody2D(name="bar", mass=1.0, inertia=0.1, position=(0.0, 0.0))
    pins = [
        Revolute2D(name=f"pin{k}", a=Marker2D(point=(x, 0.0)), b=Marker2D(body="bar", point=(x, 0.0)))
        for k, x in enumerate((-0.5, 0.5))
    ]
    arm = RigidBody2D(name="arm", mass=0.5, inertia=0.02, position=(0.7, -0.2), angle=-0.8)
    joint = Revolute2D(
        name="elbow", a=Marker2D(body="bar", point=(0.5, 0.0)),
        b=Marker2D(body="arm", point=tuple(np.array([[math.cos(0.8), -math.sin(0.8)], [math.sin(0.8), math.cos(0.8)]])
                                           @ (-0.2, 0.2))),
    )  # fmt: skip
    load = AppliedForce2D(
        name="push", marker=Marker2D(body="arm", point=(0.2, 0.0)), force_x=InputSignal(channel="fx"),
        force_y=InputSignal(channel="fy"), follower=True,
    )  # fmt: skip
    model = Model(name="bars", bodies=[bar, arm], joints=[*pins, joint], forces=[load], inputs=INPUTS[:2])
    sim = Simulation(model)
    assert sim.redundant
    for t in (0.0, 0.1, 0.37):
        sim.advance(t)
        check(sim, ("fx", "fy"), 0.5)


def test_flexible_bodies():
    """A cable with a load at its end, and a rod with an end without mass on a wall."""
    cable = Cable2D(
        name="cable", elements=4, length=1.0, mass_per_length=1.0, axial_stiffness=1e3, bending_stiffness=1.0
    )
    root, end = (MaterialPoint2D(name=n, body="cable", point=(s, 0.0)) for n, s in (("root", 0.0), ("end", 1.0)))
    model = Model(
        name="cable", bodies=[cable, root, end],
        joints=[Clamp2D(name="wall", a=Marker2D(), b=Marker2D(body="root"))],
        forces=[
            AppliedForce2D(name="pull", marker=Marker2D(body="end"), force_x=InputSignal(channel="fx"),
                           force_y=InputSignal(channel="fy")),
            AppliedTorque2D(name="turn", body="end", torque=InputSignal(channel="torque")),
        ],
        inputs=INPUTS,
    )  # fmt: skip
    sim = Simulation(model)
    sim.advance(0.1)
    check(sim, FORCES, 0.5)


def test_a_massless_end_on_a_wall():
    rod = AxialRod(
        name="rod", elements=5, length=1.0, axial_stiffness=1e3, mass_per_length=1.0, massless_ends=("left",),
        position=0.01, velocity=-1.0,
    )  # fmt: skip
    model = Model(
        name="rod", gravity=(0.0, 0.0), bodies=[rod],
        forces=[CoordinateLoad(name="push", body="rod", coordinate="x5", load=InputSignal(channel="fx"))],
        contacts=[CoordinateContact(name="foot0", terms=(CoordinateTerm(body="rod", coordinate="x0"),), law=RIGID)],
        inputs=INPUTS[:1],
    )  # fmt: skip
    sim = Simulation(model)
    seen = set()
    for t in (0.0, 0.03, 0.3):
        sim.advance(t)
        check(sim, ("fx",), 0.5)
        seen.add(mode(sim))
    assert seen == {0, 1}


def test_one_channel_may_have_any_size():
    """Derivatives do not depend on the present input, nor on the size of the seed."""
    ball = PointMass2D(name="ball", mass=3.0)
    push = AppliedForce2D(name="push", marker=Marker2D(body="ball"), force_x=InputSignal(channel="fx"))
    sim = Simulation(Model(name="ball", bodies=[ball], forces=[push], inputs=INPUTS[:1]))
    names = [c.name for c in sim.channels]
    for value in (0.0, 1e-12, 1e9):
        sim.set_inputs({"fx": value})
        for seed in (1e-200, 1.0, 1e200):
            found = dict(zip(names, sim.input_derivatives({"fx": seed}), strict=True))
            assert found["ball.ax"] == pytest.approx(seed / 3.0, rel=1e-15)
            assert found["ball.ay"] == found["ball.vx"] == found["energy.kinetic"] == 0.0
    assert not sim.input_derivatives({"fx": 0.0}).any() and not sim.input_derivatives({}).any()
