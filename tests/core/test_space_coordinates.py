"""Coordinates of joints in space: their channels, and stops, springs and servos on them."""

import math

import numpy as np
import pytest
from tlismni.core import (
    AngleDriver3D,
    AngleStop3D,
    AxisAngles,
    Cylindrical3D,
    DistanceStop3D,
    Marker3D,
    Model,
    ModelError,
    NewtonImpact,
    Planar3D,
    PointMass3D,
    RigidBody3D,
    RotationVector,
    Screw3D,
    Sine,
    SlideStop3D,
    Spherical3D,
    TorsionSpring3D,
    Universal3D,
    simulate,
)

HARD = NewtonImpact(restitution=0.6)
TIGHT = {"rtol": 1e-10, "atol": 1e-12}
TURN = RotationVector(vector=(0.4, -0.3, 0.8))


def cross_pendulum(first, second, rates=(0.0, 0.0), **parts):
    """A rod below a universal joint, turned by `first` about x and `second` about y."""
    c, s = math.cos(first), math.sin(first)
    attitude = AxisAngles(sequence="xyz", angles=(first, second, 0.0))
    axes = Marker3D(attitude=attitude).axes()
    w = np.array([rates[0], 0.0, 0.0]) + rates[1] * np.array([0.0, c, s])
    place = axes @ np.array([0.0, 0.0, -0.5])
    rod = RigidBody3D(
        name="rod", mass=1.0, inertia=(0.1, 0.12, 0.05), position=tuple(place), attitude=attitude,
        velocity=tuple(np.cross(w, place)), angular_velocity=tuple(w), angular_velocity_in="space",
    )  # fmt: skip
    joint = Universal3D(name="joint", a=Marker3D(), b=Marker3D(body="rod", point=(0.0, 0.0, 0.5)))
    made = {kind: [make(joint) for make in makes] for kind, makes in parts.items()}
    return Model(gravity=(0.0, 3.0, -9.81), bodies=[rod], joints=[joint], **made)


def test_angles_of_a_universal_joint():
    """They are those of which the body's attitude is made, and their rates those that make its angular velocity."""
    result = simulate(cross_pendulum(0.4, -0.7, (2.0, -1.5)), 0.7, **TIGHT)
    for k in range(len(result.t)):
        first, second = result["joint.angle_1"][k], result["joint.angle_2"][k]
        axes = Marker3D(attitude=AxisAngles(sequence="xyz", angles=(first, second, 0.0))).axes()
        place = [result[f"rod.{c}"][k] for c in "xyz"]
        assert place == pytest.approx(axes @ np.array([0.0, 0.0, -0.5]), abs=1e-9)
        w = np.array([result["joint.angular_velocity_1"][k], 0.0, 0.0])
        w += result["joint.angular_velocity_2"][k] * np.array([0.0, math.cos(first), math.sin(first)])
        assert [result[f"rod.angular_velocity_{c}"][k] for c in "xyz"] == pytest.approx(w, abs=1e-8)
    assert result["joint.angle_1"][0] == pytest.approx(0.4) and result["joint.angle_2"][0] == pytest.approx(-0.7)


@pytest.mark.parametrize("coordinate, side, limit", [("angle_1", "upper", 0.5), ("angle_2", "lower", -0.75)])
def test_a_stop_on_a_universal_joint(coordinate, side, limit):
    def stop(joint):
        return AngleStop3D(name="stop", **joint.ends_of(coordinate), limit=limit, side=side, law=HARD)

    result = simulate(cross_pendulum(0.4, -0.7, (2.5, -1.5), contacts=[stop]), 1.0, **TIGHT)
    sign = 1.0 if side == "upper" else -1.0
    assert result["stop.gap"] == pytest.approx(sign * (limit - result[f"joint.{coordinate}"]), abs=1e-9)
    assert any(e.kind == "impact" for e in result.events) and result["stop.gap"].min() > -1e-9
    assert np.abs(result["energy.balance"]).max() < 1e-7


def test_a_spring_about_an_arm_of_the_cross():
    def spring(joint):
        return TorsionSpring3D(name="spring", **joint.ends_of("angle_2"), stiffness=5.0, damping=0.3)

    result = simulate(cross_pendulum(0.3, 0.5, forces=[spring]), 2.0, **TIGHT)
    assert np.abs(result["energy.balance"]).max() < 1e-8
    given = 0.5 * 5.0 * result["joint.angle_2"] ** 2
    assert result["energy.strain"] == pytest.approx(given, abs=1e-8)


def test_coordinates_of_a_planar_joint_and_a_stop_there():
    axes = Marker3D(attitude=TURN).axes()
    velocity = axes @ np.array([1.0, -0.4, 0.0])
    body = RigidBody3D(
        name="body", mass=1.0, inertia=(1.0, 1.0, 1.0), attitude=TURN, velocity=tuple(velocity),
        angular_velocity=(0.0, 0.0, 3.0),
    )  # fmt: skip
    joint = Planar3D(name="joint", a=Marker3D(attitude=TURN), b=Marker3D(body="body"))
    stop = SlideStop3D(name="stop", **joint.ends_of("x"), limit=0.5, law=HARD)
    result = simulate(Model(gravity=(0.0, 0.0, 0.0), bodies=[body], joints=[joint], contacts=[stop]), 2.0, **TIGHT)
    t = result.t
    assert result["joint.x"] == pytest.approx(np.where(t < 0.5, t, 0.5 - 0.6 * (t - 0.5)), abs=1e-8)
    assert result["joint.y"] == pytest.approx(-0.4 * t, abs=1e-9)
    assert result["joint.vy"] == pytest.approx(-0.4 + 0.0 * t, abs=1e-9)
    assert result["joint.angle"] == pytest.approx(3.0 * t, abs=1e-7)
    assert result["joint.vx"][-1] == pytest.approx(-0.6, abs=1e-8)


def test_coordinates_of_a_screw_and_a_stop_there():
    nut = RigidBody3D(name="nut", mass=1.0, inertia=(1e-3, 1e-3, 1e-3))
    ends = {"a": Marker3D(), "b": Marker3D(body="nut")}
    screw = Screw3D(name="screw", **ends, lead=0.2)
    stop = AngleStop3D(name="stop", **screw.ends_of("angle"), limit=-6.0 * math.pi, side="lower", law=HARD)
    model = Model(
        gravity=(0.0, 0.0, -9.81), bodies=[nut], joints=[Cylindrical3D(name="guide", **ends), screw], contacts=[stop]
    )
    result = simulate(model, 1.0, **TIGHT)
    assert result["screw.angle"].min() == pytest.approx(-6.0 * math.pi, abs=0.3) and result.events
    assert result["screw.position"] == pytest.approx(0.2 / (2.0 * math.pi) * result["screw.angle"], abs=1e-9)
    assert result["screw.velocity"] == pytest.approx(result["guide.velocity"], abs=1e-9)
    assert result["screw.angular_velocity"] == pytest.approx(result["guide.angular_velocity"], abs=1e-8)


def test_a_distance_stays_above_its_limit():
    """Two masses on a line strike a strut of 1 m without mass: relative speed e times what it was."""
    masses = [
        PointMass3D(name="one", mass=1.0, position=(0.0, 0.0, 0.0), velocity=(0.0, 0.0, 1.0)),
        PointMass3D(name="two", mass=3.0, position=(0.0, 0.0, 2.0)),
    ]
    stop = DistanceStop3D(
        name="stop", a=Marker3D(body="one"), b=Marker3D(body="two"), limit=1.0, side="lower", law=HARD
    )
    result = simulate(Model(gravity=(0.0, 0.0, 0.0), bodies=masses, contacts=[stop]), 2.0, **TIGHT)
    (strike,) = [e for e in result.events if e.kind == "impact"]
    assert strike.t == pytest.approx(1.0, abs=1e-9) and strike.impulse == pytest.approx(0.75 * 1.6, rel=1e-9)
    assert result["two.vz"][-1] - result["one.vz"][-1] == pytest.approx(0.6, abs=1e-9)
    with pytest.raises(ModelError, match="meet at the start"):
        near = [m.model_copy(update={"position": (0.0, 0.0, 0.0)}) for m in masses]
        Model(bodies=near, contacts=[stop])


def test_coordinates_that_a_joint_does_not_have():
    joint = Spherical3D(name="ball", a=Marker3D(), b=Marker3D(body="rod"))
    with pytest.raises(ModelError, match="'ball' has no coordinate 'angle': a Spherical3D has none"):
        joint.ends_of("angle")
    joint = Universal3D(name="cross", a=Marker3D(), b=Marker3D(body="rod"))
    with pytest.raises(ModelError, match=r"a Universal3D has \['angle_1', 'angle_2'\]"):
        joint.ends_of("angle")


def test_a_driver_about_an_arm_of_the_cross():
    swing = Sine(amplitude=0.3, angular_frequency=4.0, offset=0.4)

    def model():
        base = cross_pendulum(0.4, -0.7, (1.2, 0.0))
        driver = AngleDriver3D(name="driver", **base.joints[0].ends_of("angle_1"), angle=swing)
        return base.model_copy(update={"joints": (*base.joints, driver)})

    result = simulate(model(), 2.0, **TIGHT)
    assert result["joint.angle_1"] == pytest.approx(0.4 + 0.3 * np.sin(4.0 * result.t), abs=1e-9)
    assert np.abs(result["energy.balance"]).max() < 1e-7
