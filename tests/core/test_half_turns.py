"""What holds or damps turns does so at any angle: bushings through half a turn, constant velocity joints bent far."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tlismni.core import (
    Axes,
    Bushing3D,
    ConstantVelocity3D,
    Cylindrical3D,
    Marker3D,
    Model,
    ModelError,
    Revolute3D,
    RigidBody3D,
    RotationVector,
    simulate,
)
from tlismni.core.model.attitude import rotation_matrix

NO_WEIGHT = (0.0, 0.0, 0.0)
quick = settings(deadline=None, max_examples=15, derandomize=True)
vectors = st.tuples(*[st.floats(-3.0, 3.0)] * 3)


def test_a_bushing_damps_like_a_linear_damper_through_many_turns():
    """J w' = -c w: exponential decay, over three turns."""
    inertia, damping, speed = 1.0, 1.0, 20.0
    body = RigidBody3D(name="b", mass=1.0, inertia=(inertia,) * 3, angular_velocity=(0.0, 0.0, speed))
    ends = {"a": Marker3D(), "b": Marker3D(body="b")}
    damper = Bushing3D(name="d", **ends, stiffness=(0.0,) * 6, damping=(0.0,) * 5 + (damping,))
    model = Model(gravity=NO_WEIGHT, bodies=[body], joints=[Revolute3D(name="h", **ends)], forces=[damper])
    result = simulate(model, 2.0, rtol=1e-9, atol=1e-11)
    assert result["h.angle"][-1] > 5.0 * math.pi
    assert result["h.angular_velocity"] == pytest.approx(speed * np.exp(-damping / inertia * result.t), abs=1e-6)
    assert np.abs(result["energy.balance"]).max() < 1e-6


@quick
@given(vectors, vectors, vectors, vectors, st.integers(0, 10**6))
def test_its_torque_is_that_of_the_angular_velocity_at_any_attitude(first, second, own, spin, seed):
    """-A C A^T w of a body with equal inertias, A the axes of marker a; half turns among them."""
    root = np.random.default_rng(seed).normal(size=(3, 3))
    c = root @ root.T
    damping = np.zeros((6, 6))
    damping[3:, 3:] = c
    a, b = (RotationVector(vector=v) for v in (first, own))
    body = RigidBody3D(
        name="b", mass=1.0, inertia=(2.0,) * 3, attitude=RotationVector(vector=second), angular_velocity=spin
    )
    bushing = Bushing3D(
        name="d", a=Marker3D(attitude=a), b=Marker3D(body="b", attitude=b), stiffness=(0.0,) * 6,
        damping=tuple(map(tuple, damping)),
    )  # fmt: skip
    result = simulate(Model(gravity=NO_WEIGHT, bodies=[body], forces=[bushing]), 1e-6)
    axes = rotation_matrix(a.parameters())
    w = np.array([result[f"b.angular_velocity_{k}"][0] for k in "xyz"])
    found = np.array([result[f"b.angular_acceleration_{k}"][0] for k in "xyz"])
    assert found == pytest.approx(-0.5 * axes @ c @ axes.T @ w, rel=1e-9, abs=1e-9 * (1.0 + np.abs(c).max()))


def test_two_free_bodies_in_a_damping_bushing_keep_their_angular_momentum():
    """While they turn by more than half a turn against each other; what they lose is in the ledger."""
    one = RigidBody3D(name="one", mass=2.0, inertia=(0.3, 0.4, 0.5), angular_velocity=(1.0, -2.0, 9.0))
    two = RigidBody3D(name="two", mass=1.0, inertia=(0.2, 0.3, 0.1), attitude=RotationVector(vector=(0.0, 0.3, 3.0)))
    bushing = Bushing3D(
        name="d", a=Marker3D(body="one"), b=Marker3D(body="two"), stiffness=(50.0,) * 3 + (0.1,) * 3,
        damping=(1.0, 2.0, 3.0, 0.02, 0.05, 0.03),
    )  # fmt: skip
    result = simulate(Model(gravity=NO_WEIGHT, bodies=[one, two], forces=[bushing]), 1.0, rtol=1e-9, atol=1e-11)
    assert np.abs(result["energy.balance"]).max() < 1e-6
    assert result["energy.dissipation"][-1] > 1.0
    start, end = (_momentum(result, k) for k in (0, -1))
    assert end == pytest.approx(start, abs=1e-7)


def _momentum(result, k):
    total = np.zeros(3)
    for name, mass, inertia in (("one", 2.0, (0.3, 0.4, 0.5)), ("two", 1.0, (0.2, 0.3, 0.1))):
        place, speed = (np.array([result[f"{name}.{p}{x}"][k] for x in "xyz"]) for p in ("", "v"))
        w = np.array([result[f"{name}.body_angular_velocity_{x}"][k] for x in "xyz"])
        turn = rotation_matrix([result[f"{name}.e{i}"][k] for i in range(4)])
        total += np.cross(place, mass * speed) + turn @ (np.array(inertia) * w)
    return total


@pytest.mark.parametrize("degrees", [30.0, 59.0, 61.0, 85.0, 120.0, 149.0])
def test_a_constant_velocity_joint_passes_spin_on_through_any_bend(degrees):
    bend, shafts, joints = math.radians(degrees), [], []
    for name, axis in (("first", (1.0, 0.0, 0.0)), ("second", (math.cos(bend), math.sin(bend), 0.0))):
        turn = Axes(z=axis, x=(0.0, 0.0, 1.0))
        shafts.append(
            RigidBody3D(name=name, mass=1.0, inertia=(0.3, 0.3, 0.2), attitude=turn, angular_velocity=(0.0, 0.0, 5.0))
        )
        joints.append(Cylindrical3D(name=f"bearing_{name}", a=Marker3D(attitude=turn), b=Marker3D(body=name)))
    joints.append(ConstantVelocity3D(name="joint", a=Marker3D(body="first"), b=Marker3D(body="second")))
    result = simulate(Model(gravity=NO_WEIGHT, bodies=shafts, joints=joints), 2.0, rtol=1e-9)
    assert result["bearing_second.angle"] == pytest.approx(result["bearing_first.angle"], abs=1e-8)
    assert result["bearing_first.angular_velocity"] == pytest.approx(5.0, abs=1e-6)


@pytest.mark.parametrize(
    "vector, words",
    [((math.radians(155.0), 0.0, 0.0), "bent by 155 degrees"), ((0.0, 0.0, 3.0), "twisted by half a turn")],
)
def test_a_constant_velocity_joint_is_refused_where_its_equation_says_nothing(vector, words):
    body = RigidBody3D(name="b", mass=1.0, inertia=(1.0, 1.0, 0.5), attitude=RotationVector(vector=vector))
    joint = ConstantVelocity3D(name="cv", a=Marker3D(), b=Marker3D(body="b"))
    with pytest.raises(ModelError, match=words):
        simulate(Model(bodies=[body], joints=[joint]), 0.1)
