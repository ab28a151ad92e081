"""Runs without Python of mechanisms in space: stops, springs, drives, coordinates of joints; the bits of Python's."""

import math

import numpy as np
import pytest
from tlismni.core import (
    AngleStop3D,
    Axes,
    Bushing3D,
    Cylindrical3D,
    DistanceStop3D,
    HuntCrossley,
    Input,
    InputSignal,
    Marker3D,
    Model,
    NewtonImpact,
    PIDController3D,
    Planar3D,
    RelativeLoad3D,
    Revolute3D,
    RevoluteFriction3D,
    RigidBody3D,
    Screw3D,
    Servo3D,
    Simulation,
    Sine,
    SlideFriction3D,
    Spherical3D,
    SphericalFriction3D,
    SpringDamper3D,
    TableSpring3D,
    TorsionSpring3D,
    Universal3D,
)
from tlismni.core.compiled.library import LIBRARY
from tlismni.core.native import image_of

pytestmark = pytest.mark.skipif(LIBRARY is None, reason="needs the library of machine code (tlismni.core.aot)")

ENDS = {"a": Marker3D(), "b": Marker3D(body="body", point=(-0.5, 0.0, 0.0))}
HINGE = Revolute3D(name="joint", **ENDS)
LAWS = {"hard": NewtonImpact(restitution=0.5), "soft": HuntCrossley(stiffness=1e4, restitution=0.5)}
SINE = Sine(amplitude=0.7, angular_frequency=2.0, phase=0.3, offset=0.2)
TABLE = {"lengths_table": (-4.0, 0.2, 1.0, 3.0), "forces": (-1.0, 0.2, 1.5, 4.0), "damping": 0.3}
AXES = Axes(z=(1.0, 0.0, 0.0), x=(0.0, 1.0, 0.0))
CROSS = Universal3D(name="joint", a=Marker3D(), b=Marker3D(body="body", point=(0.0, 0.0, 0.5)))
CASES = {
    **{
        f"{kind.__name__} and a {law} stop": {
            "joints": [kind(name="joint", **ENDS)],
            "contacts": [AngleStop3D(name="stop", **ENDS, limit=-1.0, side="lower", law=LAWS[law])],
        }
        for kind in (Revolute3D, Cylindrical3D, Planar3D)
        for law in LAWS
    },
    "two stops": {
        "joints": [HINGE],
        "contacts": [
            AngleStop3D(name="low", **ENDS, limit=-1.0, side="lower", law=LAWS["hard"]),
            AngleStop3D(name="high", **ENDS, limit=0.1, law=LAWS["soft"]),
        ],
    },
    "stop and springs about the cross": {
        "joints": [CROSS],
        "forces": [TorsionSpring3D(name="spring", **CROSS.ends_of("angle_2"), stiffness=3.0)],
        "contacts": [AngleStop3D(name="stop", **CROSS.ends_of("angle_1"), limit=-0.2, side="lower", law=LAWS["hard"])],
    },
    "screw": {"joints": [Cylindrical3D(name="joint", **ENDS), Screw3D(name="screw", **ENDS, lead=0.2)]},
    "distance": {
        "contacts": [
            DistanceStop3D(
                name="stop", a=Marker3D(point=(0.0, -2.0, 0.0)), b=Marker3D(body="body"), limit=1.8, side="lower",
                law=LAWS["hard"],
            )
        ]
    },
    "turns that are said": {
        "joints": [Revolute3D(name="joint", **ENDS, start_angle=-2.0 * math.pi)],
        "forces": [TorsionSpring3D(name="spring", **ENDS, stiffness=1.0, natural_angle=-7.0)],
    },
    "forces": {
        "joints": [HINGE],
        "forces": [
            TableSpring3D(name="table", **ENDS, measure="angle", **TABLE),
            RevoluteFriction3D(name="friction", **ENDS, torque=0.8, transition_rate=0.5),
            Servo3D(name="servo", **ENDS, target=InputSignal(channel="u"), gain=3.0, rate_gain=0.3, largest=4.0),
            RelativeLoad3D(name="load", **ENDS, load=SINE),
            PIDController3D(name="pid", **ENDS, target=SINE, gain=2.0, integral_gain=1.0, rate_gain=0.2),
        ],
        "inputs": [Input(name="u", unit="rad", start=0.3)],
    },
    "friction that stops": {
        "joints": [HINGE],
        "forces": [
            RevoluteFriction3D(
                name="friction", **ENDS, torque=1.2, joint="joint", coefficient=0.2, radius=0.1, static_ratio=1.1
            ),
            TorsionSpring3D(name="spring", **ENDS, stiffness=3.0),
        ],
    },
    "friction of a ball that stops": {
        "joints": [Spherical3D(name="joint", **ENDS)],
        "forces": [
            SphericalFriction3D(
                name="friction", **ENDS, torque=1.2, joint="joint", coefficient=0.2, radius=0.1, static_ratio=1.1
            ),
        ],
    },
    "forces along": {
        "forces": [
            SlideFriction3D(name="friction", a=Marker3D(attitude=AXES), b=ENDS["b"], force=0.8, transition_speed=0.5),
            SpringDamper3D(
                name="spring", a=Marker3D(point=(0.0, 1.0, 0.0)), b=ENDS["b"], stiffness=30.0, natural_length=SINE
            ),
            Bushing3D(name="bushing", a=Marker3D(), b=Marker3D(body="body"), stiffness=(1.0,) * 6),
        ],
    },
}  # fmt: skip


@pytest.mark.parametrize("case", CASES)
def test_the_same_bits_at_other_times(case):
    from tlismni.core.native.in_process import NativeModel, NativeRun

    upright, still = case == "stop and springs about the cross", case == "screw"
    body = RigidBody3D(
        name="body", mass=1.0, inertia=(0.1, 0.2, 0.25), position=(0.0, 0.0, -0.5) if upright else (0.5, 0.0, 0.0),
        angular_velocity=(0.0, 0.0, 0.0 if upright or still else -3.0),
        velocity=(0.0, 0.0 if upright or still else -1.5, 0.0),
    )  # fmt: skip
    model = Model(gravity=(0.0, -9.81, -9.81 * (upright or still)), bodies=[body], **CASES[case])
    run, sim = NativeRun(NativeModel(image_of(model, 0.8), LIBRARY)), Simulation(model)
    inputs = [x.start for x in sim.system.inputs]
    for t in np.sort(np.random.default_rng(3).uniform(0.0, 0.8, 20)):
        found = run.step(float(t), inputs)
        sim.advance(float(t))
        assert found.tobytes() == sim.values().tobytes(), t
    assert (run.events, run.steps) == (len(sim.events), sim.stats["steps"])
    assert bool(sim.events) == ("stop" in case or case == "distance")
