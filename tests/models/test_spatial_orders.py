"""The benchmarks in space by five methods with fixed steps: the order of each, observed against the known figures."""

import math

import numpy as np
import pytest
from test_spatial_scenarios import CRANK, HEAVY_TOP, PENDULUM, free_rotation
from tlismni.core import (
    CoulombFriction,
    HalfSpace3D,
    Marker3D,
    Model,
    NewtonImpact,
    RigidBody3D,
    Sphere3D,
    SphereOnHalfSpace3D,
    simulate,
)
from tlismni.models import load
from tlismni.models.rolling_disk import steady_spin

METHODS = {
    "hht": ({"alpha": -0.1}, 2),
    "bdf": ({"order": 4}, 4),
    "ebdf": ({"k": 3}, 4),
    "adams": ({"order": 4}, 4),
    "irk": ({"tableau": "radau3"}, 5),
}
NEAR = {"irk": 0.5}
"""Radau's accelerations and multipliers converge at other orders on the way, so that 5 is reached slowly."""
G = 9.81


def spin_of(result):
    return np.array([result[f"body.body_angular_velocity_{axis}"][-1] for axis in "xyz"])


BENCHMARKS = {
    "heavy_top": (0.2, lambda r: r.q[-1], np.concatenate(HEAVY_TOP[0.2])),
    "free_body": (2.0, spin_of, np.array([-1.161250059636, 4.863290891875, 0.670497750681])),
    "spatial_slider_crank": (0.5, lambda r: np.array([r["crank.angle"][-1], r["slider.x"][-1]]), np.array(CRANK[0.5])),
    "bricard": (1.0, lambda r: r["hinge0.angle"][-1:], np.array([1.03502845952])),
    "universal_pendulum": (1.0, lambda r: r.q[-1, :3], np.array(PENDULUM[1.0])),
}
STEPS = {
    "heavy_top": {"hht": 3200, "bdf": 1600, "ebdf": 1600, "adams": 800, "irk": 320},
    "free_body": {"hht": 400, "bdf": 400, "ebdf": 400, "adams": 400, "irk": 160},
    "spatial_slider_crank": {"hht": 400, "bdf": 800, "ebdf": 1600, "adams": 400, "irk": 80},
    "bricard": {"hht": 400, "bdf": 200, "ebdf": 200, "adams": 100, "irk": 20},
    "universal_pendulum": {"hht": 400, "bdf": 200, "ebdf": 200, "adams": 100, "irk": 80},
}
"""Steps of the coarser run: the error of the finer one is still far above the last digit of the figures."""


def errors(model, t_end, method, steps, value, exact):
    found = []
    for count in (steps, 2 * steps):
        run = simulate(model, t_end, method, step=t_end / count, newton_tolerance=1e-13, **METHODS[method][0])
        found.append(float(np.abs(value(run) - exact).max()))
    return found


def check_order(method, found):
    assert math.log2(found[0] / found[1]) == pytest.approx(METHODS[method][1], abs=NEAR.get(method, 0.3)), found


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("name", BENCHMARKS)
def test_order_against_the_figures(name, method):
    t_end, value, exact = BENCHMARKS[name]
    check_order(method, errors(load(name).model, t_end, method, STEPS[name][method], value, exact))


@pytest.mark.parametrize("method", METHODS)
def test_order_in_steady_precession_of_betschs_cone(method):
    """(A - C) W^2 cos t - C s W + m g l = 0 with the cone of Betsch: s = 135.6 rad/s, 60 degrees from the vertical."""
    radius, height, density, arm, tilt, precession = 0.05, 0.1, 2700.0, 0.075, math.pi / 3.0, 10.0
    mass = density * math.pi * radius**2 * height / 3.0
    axial, across = 0.3 * mass * radius**2, 0.15 * mass * radius**2 + 0.0375 * mass * height**2
    at_pivot = across + mass * arm**2
    spin = ((at_pivot - axial) * precession**2 * math.cos(tilt) + mass * G * arm) / (axial * precession)
    assert spin == pytest.approx(135.6, abs=0.05)
    model = load(
        "heavy_top", mass=mass, length=arm, axial_inertia=axial, transverse_inertia=across, spin=spin,
        precession=precession, tilt_x=0.5 * math.pi - tilt,
    ).model  # fmt: skip
    t_end, level = 0.2, arm * math.sin(tilt)
    turn = precession * t_end
    exact = np.array([-level * math.sin(turn), level * math.cos(turn), arm * math.cos(tilt)])
    steps = {"hht": 800, "bdf": 1600, "ebdf": 1600, "adams": 800, "irk": 400}[method]
    check_order(method, errors(model, t_end, method, steps, lambda r: r.q[-1, :3], exact))


@pytest.mark.parametrize("method", METHODS)
def test_order_of_a_disk_that_rolls_in_a_circle(method):
    """The centre goes round with the precession on a circle of radius v/W."""
    scenario = load("rolling_disk")
    speed, rate, t_end = scenario.model.bodies[0].velocity[1], scenario.parameters["precession"], 0.5
    exact = speed / rate * np.array([math.cos(rate * t_end) - 1.0, math.sin(rate * t_end)])
    steps = {"hht": 200, "bdf": 200, "ebdf": 100, "adams": 100, "irk": 20}[method]
    check_order(method, errors(scenario.model, t_end, method, steps, lambda r: r.q[-1, :2], exact))


@pytest.mark.parametrize("method", METHODS)
def test_disk_that_spins_on_its_rim(method):
    """W^2 sin a = 4 g/r with the centre at rest, a the angle of the disk against the plane; unstable, so for a short
    time."""
    radius, lean = 0.3, 0.4
    precession = math.sqrt(4.0 * G / (radius * math.sin(lean)))
    spin = steady_spin(1.0, radius, 0.045, 0.0225, G, lean, precession)
    model = load("rolling_disk", tilt=lean, precession=precession, spin=spin).model
    options, _ = METHODS[method]
    result = simulate(model, 0.2, method, step=5e-4, newton_tolerance=1e-13, **options)
    most = 1e-4 if method == "hht" else 1e-7
    assert np.abs(result.q[:, :2]).max() < most
    assert np.ptp(result["disk.z"]) < most


@pytest.mark.parametrize("method", METHODS)
def test_blows_of_a_sphere_with_spin_and_its_rolling(method):
    """P_N = m (1 + e) |v_n|, P_T = min(mu P_N, (2/7) m |slip|); in the end it rolls with (5 v + 2 R w x n)/7."""
    radius, mass, mu, e, up = 0.1, 2.0, 0.3, 0.6, np.array([0.0, 0.0, 1.0])
    v, w, down = np.array([1.0, 0.7, 0.0]), np.array([6.0, 20.0, -10.0]), math.sqrt(2.0 * G * 0.4)
    rolls = (5.0 * v + 2.0 * radius * np.cross(w, up)) / 7.0
    ball = RigidBody3D(
        name="ball", mass=mass, inertia=(0.4 * mass * radius**2,) * 3, position=(0.0, 0.0, 0.4 + radius),
        velocity=tuple(v), angular_velocity=tuple(w),
    )  # fmt: skip
    floor = SphereOnHalfSpace3D(
        name="floor", plane=HalfSpace3D(), sphere=Sphere3D(marker=Marker3D(body="ball"), radius=radius),
        law=NewtonImpact(restitution=e), friction=CoulombFriction(coefficient=mu),
    )  # fmt: skip
    model = Model(gravity=(0.0, 0.0, -G), bodies=[ball], contacts=[floor])
    options, _ = METHODS[method]
    result = simulate(model, 3.0, method, rtol=1e-9, atol=1e-11, **({} if method == "adams" else options))
    blows = [event for event in result.events if event.kind == "impact"]
    assert len(blows) > 8
    most = 1e-4 if method == "hht" else 1e-7
    for blow in blows[:4]:
        slip = v - radius * np.cross(w, up)
        normal = mass * (1.0 + e) * down
        along = min(mu * normal, 2.0 / 7.0 * mass * float(np.linalg.norm(slip)))
        assert blow.impulse == pytest.approx(normal, rel=most)
        assert blow.friction_impulse == pytest.approx(along, abs=most)
        push = -along * slip / max(float(np.linalg.norm(slip)), 1e-300)
        v, w = v + push / mass, w + np.cross(-radius * up, push) / (0.4 * mass * radius**2)
        down *= e
    assert [result[f"ball.v{axis}"][-1] for axis in "xyz"] == pytest.approx(rolls, abs=10.0 * most)


@pytest.mark.parametrize(
    "method, steps, ends, whole",
    [
        ("ebdf", 20_000, 1e-9, 6e-8),
        ("adams", 4_000, 1e-8, 2e-6),
        ("irk", 8_000, 1e-8, 2e-6),
        ("bdf", 64_000, 1e-8, 1e-6),
    ],
)
def test_free_body_at_all_times_of_two_periods(method, steps, ends, whole):
    """While the body turns over errors are 200 times what they are at the ends of a period. At the highest orders what
    is left is the rounding of thousands of steps: ebdf comes to 1e-8 at all times (9e-9 with 20000 steps, up to 5e-8
    with others), the others to 1e-8 at the ends. hht, of order 2, would take 4e7 steps."""
    options = {"ebdf": {"k": 5}, "adams": {"order": 8}, "irk": {"tableau": "gauss3"}, "bdf": {"order": 5}}[method]
    t_end = 20.103716552
    result = simulate(load("free_body").model, t_end, method, step=t_end / steps, newton_tolerance=1e-14, **options)
    found = np.stack([result[f"body.body_angular_velocity_{axis}"] for axis in "xyz"], axis=1)
    off = np.abs(found - free_rotation(result.t, (1.0, 2.0, 3.0), (0.01, 5.0, 0.01))[0])
    assert off[[len(off) // 2, -1]].max() < ends and off.max() < whole
