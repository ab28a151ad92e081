"""Outputs of markers: their motion is that of a point of a body, at all levels."""

import math

import numpy as np
import pytest
from tlismni.core import (
    Cable2D,
    Clamp2D,
    Marker2D,
    MarkerOutput2D,
    MaterialPoint2D,
    Model,
    ModelError,
    PointMass2D,
    Revolute2D,
    RigidBody2D,
    Simulation,
    simulate,
)

ANGLE = 0.7


def pendulum(*outputs, **given):
    """A bar hung up at its left end, with markers on it."""
    bar = RigidBody2D(name="bar", mass=1.0, inertia=1.0 / 12.0, position=(0.5, 0.0), **given)
    pin = Revolute2D(name="pin", a=Marker2D(), b=Marker2D(body="bar", point=(-0.5, 0.0)))
    return Model(name="pendulum", bodies=[bar], joints=[pin], outputs=outputs)


def test_a_point_of_a_turning_body():
    """The tip is on a circle about the pin: x = cos(angle), and so on for velocity and acceleration."""
    tip = MarkerOutput2D(name="tip", marker=Marker2D(body="bar", point=(0.5, 0.0), angle=ANGLE))
    pin = MarkerOutput2D(name="held", marker=Marker2D(body="bar", point=(-0.5, 0.0)))
    result = simulate(pendulum(tip, pin), 1.0, rtol=1e-9, atol=1e-11)
    angle, w, growth = (result[f"bar.{name}"] for name in ("angle", "angular_velocity", "angular_acceleration"))
    c, s = np.cos(angle), np.sin(angle)
    wanted = {
        "x": c, "y": s, "angle": angle + ANGLE, "vx": -s * w, "vy": c * w, "angular_velocity": w,
        "ax": -s * growth - c * w * w, "ay": c * growth - s * w * w, "angular_acceleration": growth,
    }  # fmt: skip
    for name, values in wanted.items():
        np.testing.assert_allclose(result[f"tip.{name}"], values, atol=1e-10)
    for name in ("x", "y", "vx", "vy", "ax", "ay"):
        np.testing.assert_allclose(result[f"held.{name}"], 0.0, atol=1e-10)
    assert [c.unit for c in result.channel_records if c.name.startswith("tip.")] == [
        "m", "m", "rad", "m/s", "m/s", "rad/s", "m/s2", "m/s2", "rad/s2"
    ]  # fmt: skip


def test_one_sample_gives_the_same_bits_as_a_column():
    outputs = [
        MarkerOutput2D(name=f"m{k}", marker=Marker2D(body="bar", point=(0.1 * k, -0.03 * k), angle=0.2 * k))
        for k in range(7)
    ]
    model = pendulum(*outputs)
    times = [0.1, 0.27, 0.4]
    result = simulate(model, 0.4, t_eval=times)
    sim = Simulation(model)
    for i, t in enumerate(times):
        sim.run_to(0.4, until=t)
        assert sim.values().tolist() == [result[name][i] for name in result.channels]


def test_markers_on_point_masses_the_ground_and_flexible_bodies():
    """A marker beyond the end of a cable, in the frame of its last cross-section; by hand from the cable's slope."""
    cable = Cable2D(
        name="cable", elements=2, length=1.0, mass_per_length=1.0, axial_stiffness=1e3, bending_stiffness=1.0
    )
    root, end = (MaterialPoint2D(name=n, body="cable", point=(s, 0.0)) for n, s in (("root", 0.0), ("end", 1.0)))
    model = Model(
        name="all",
        bodies=[PointMass2D(name="p", mass=1.0, position=(2.0, 3.0), velocity=(1.0, 0.0)), cable, root, end],
        joints=[Clamp2D(name="wall", a=Marker2D(), b=Marker2D(body="root"))],
        outputs=[
            MarkerOutput2D(name="mass", marker=Marker2D(body="p")),
            MarkerOutput2D(name="fixed", marker=Marker2D(point=(4.0, 5.0))),
            MarkerOutput2D(name="beyond", marker=Marker2D(body="end", point=(0.5, 0.0))),
        ],
    )
    result = simulate(model, 0.2)
    np.testing.assert_array_equal(result["mass.vy"], result["p.vy"])
    assert "mass.angle" not in result.channels and "fixed.angle" not in result.channels
    assert np.all(result["fixed.x"] == 4.0) and np.all(result["fixed.ay"] == 0.0)
    slope = np.array([result["cable.slope_x2"], result["cable.slope_y2"]])
    tip = np.array([result["cable.x2"], result["cable.y2"]]) + 0.5 * slope / np.hypot(*slope)
    np.testing.assert_allclose([result["beyond.x"], result["beyond.y"]], tip, atol=1e-9)


def test_what_cannot_be_shown_is_refused():
    with pytest.raises(ModelError, match="body 'bat', which does not exist"):
        pendulum(MarkerOutput2D(name="tip", marker=Marker2D(body="bat")))
    with pytest.raises(ModelError, match="used more than once: \\['bar'\\]"):
        pendulum(MarkerOutput2D(name="bar", marker=Marker2D(body="bar")))
    model = pendulum(MarkerOutput2D(name="tip", marker=Marker2D(body="bar", point=(math.pi, 0.0))))
    assert Model.from_json(model.to_json()) == model
