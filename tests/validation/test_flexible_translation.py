"""Rods, cables, clamps and points of flexible bodies in exudyn, against closed forms and against the solver."""

import math
from typing import Any

import numpy as np
import pytest
from tlismni.core import AxialRod, Cable2D, Marker2D, MaterialPoint2D, Model, simulate
from tlismni.core.elements import AppliedForce2D, Clamp2D, CoordinateDriver, RigidBody2D
from tlismni.core.model.signals import Constant, Polynomial
from tlismni.models import load
from tlismni.validation import ExudynSettings, NotTranslatable, run_exudyn
from tlismni.validation.exudyn_import import exudyn_available

pytestmark = pytest.mark.skipif(not exudyn_available(), reason="exudyn cannot be imported")
FLEXIBLE = ExudynSettings(modified_newton=True, absolute_tolerance=1e-8)


def rod(**fields: Any) -> AxialRod:
    given = {"elements": 8, "length": 2.0, "axial_stiffness": 50.0, "mass_per_length": 0.5, **fields}
    return AxialRod(name="rod", **given)


@pytest.mark.parametrize("mass_matrix", ["consistent", "lumped"])
def test_a_hanging_rod_swings_about_its_statical_stretch(mass_matrix: str) -> None:
    """Released unstrained the free end swings about q L^2/(2 EA), with the frequencies of the same elements."""
    gravity = 4.0
    clamp = CoordinateDriver(name="wall", body="rod", coordinate="x0", motion=Constant(value=0.0))
    body = rod(mass_matrix=mass_matrix)
    model = Model(gravity=(gravity, 0.0), bodies=(body,), joints=(clamp,))
    r = run_exudyn(model, 1.0, 1e-3, FLEXIBLE)
    mass, stiffness = (matrix[1:, 1:] for matrix in body.matrices())
    squares, modes = np.linalg.eigh(np.linalg.solve(np.linalg.cholesky(mass), np.linalg.solve(
        np.linalg.cholesky(mass), stiffness).T))  # fmt: skip
    modes = np.linalg.solve(np.linalg.cholesky(mass).T, modes)
    still = np.linalg.solve(stiffness, body.weight(gravity)[1:])
    exact = still[-1] - modes[-1] @ (np.cos(np.sqrt(squares)[:, None] * r.t) * (modes.T @ (mass @ still))[:, None])
    assert still[-1] == pytest.approx(body.mass_per_length * gravity * body.length**2 / (2.0 * body.axial_stiffness))
    # the elements' shortest waves are too fast for these steps
    assert np.abs(r["rod.x8"] - body.length - exact).max() < 0.01 * still[-1]


def test_a_loaded_rod_that_is_dragged_along() -> None:
    """A node driven with constant speed: the damped rod follows with it, unstrained in the end."""
    drive = CoordinateDriver(name="drag", body="rod", coordinate="x8", motion=Polynomial(coefficients=(2.0, 0.3)))
    model = Model(gravity=(0.0, 0.0), bodies=(rod(damping_time=0.05, velocity=0.3),), joints=(drive,))
    r = run_exudyn(model, 1.0, 1e-3, FLEXIBLE)
    assert np.allclose(r["rod.x0"], 0.3 * r.t, atol=1e-9)
    assert np.allclose(r["rod.vx3"], 0.3, atol=1e-9)


def cantilever(**cable: Any) -> Model:
    beam = Cable2D(
        name="beam", elements=4, length=1.0, mass_per_length=0.3, axial_stiffness=4e3, bending_stiffness=0.7,
        bending_damping=0.02, axial_damping=20.0, **cable,
    )  # fmt: skip
    root = MaterialPoint2D(name="root", body="beam", point=(0.0, 0.0))
    tip = MaterialPoint2D(name="tip", body="beam", point=(1.0, 0.0))
    middle = MaterialPoint2D(name="middle", body="beam", point=(0.6, 0.0))
    return Model(
        bodies=(beam, root, tip, middle),
        joints=(Clamp2D(name="clamp", a=Marker2D(), b=Marker2D(body="root")),),
        forces=(AppliedForce2D(name="load", marker=Marker2D(body="tip"), force_y=Constant(value=-0.4)),),
    )


@pytest.mark.sampled(1)
@pytest.mark.parametrize("cable", [{}, {"integration": "reduced"}, {"reference_curvature": 0.4}])
def test_a_cantilever_with_points_clamp_and_load_follows_the_solver(cable: dict[str, Any]) -> None:
    model = cantilever(**cable)
    ours = simulate(model, 0.25, "irk", 1e-8, 1e-10, t_eval=np.linspace(0.0, 0.25, 26))
    coarse, fine = (run_exudyn(model, 0.25, h, FLEXIBLE) for h in (5e-4, 2.5e-4))
    for channel in ("tip.x", "tip.y", "middle.y", "middle.angle", "clamp.force_y", "clamp.torque"):
        values = [np.interp(ours.t[1:], r.t, r[channel]) for r in (coarse, fine)]
        limit = values[1] + (values[1] - values[0]) / 3.0
        scale = np.ptp(ours[channel])
        # the start from rest under a sudden load excites all frequencies: exudyn's own error goes with its step
        own = np.abs(values[1] - values[0]).max()
        assert np.abs(limit - ours[channel][1:]).max() < 2.0 * own + 1e-4 * scale, channel
    assert np.allclose(fine["middle.vy"][1:-1], np.gradient(fine["middle.y"], fine.t)[1:-1], atol=2e-2)


def test_a_clamp_turns_with_its_bodies() -> None:
    """Two rigid bodies welded at an angle fly as one: momentum and the relative angle are kept, forces are global."""
    a = RigidBody2D(name="a", mass=2.0, inertia=0.3, angle=0.4, angular_velocity=2.0)
    b = RigidBody2D(name="b", mass=1.0, inertia=0.1, position=(math.cos(0.4), math.sin(0.4)), angle=1.1,
                    velocity=(-2.0 * math.sin(0.4), 2.0 * math.cos(0.4)), angular_velocity=2.0)  # fmt: skip
    weld = Clamp2D(name="weld", a=Marker2D(body="a", point=(1.0, 0.0)), b=Marker2D(body="b"))
    model = Model(bodies=(a, b), joints=(weld,))
    r = run_exudyn(model, 0.5, 5e-4)
    ours = simulate(model, 0.5, "ebdf", 1e-10, 1e-12, t_eval=r.t)
    assert np.allclose(r["b.angle"] - r["a.angle"], 0.7, atol=1e-9)
    settled = r.t > 0.1  # exudyn's first multipliers ring
    for channel in ("a.x", "b.y", "weld.force_x", "weld.force_y", "weld.torque"):
        assert np.abs(r[channel] - ours[channel])[settled].max() < 1e-4, channel


def test_a_disk_on_a_cable_point_strikes_a_wall_in_exudyn_too() -> None:
    scenario = load("hub_beam_stop", formulation="ancf", contact="ccfm", elements=4)
    r = run_exudyn(scenario.model, 0.03, 1e-5, FLEXIBLE)
    ours = simulate(scenario.model, 0.03, "ebdf", 1e-7, 1e-10, t_eval=r.t, k=2)
    assert np.abs(r["stop.gap"] - ours["stop.gap"]).max() < 1e-5 * np.ptp(ours["stop.gap"]) + 1e-8
    assert r["stop.impulse"][-1] == pytest.approx(ours["stop.impulse"][-1], rel=1e-3)


def test_what_a_point_of_a_rod_cannot_do_in_exudyn_is_said() -> None:
    point = MaterialPoint2D(name="p", body="rod", point=(1.0, 0.0))
    with pytest.raises(NotTranslatable, match="take a coordinate of one of its nodes"):
        run_exudyn(Model(bodies=(rod(), point)), 0.1, 1e-2)
    beyond = AppliedForce2D(name="load", marker=Marker2D(body="tip", point=(0.1, 0.0)), force_y=Constant(value=1.0))
    with pytest.raises(NotTranslatable, match="put a MaterialPoint2D there"):
        run_exudyn(cantilever().model_copy(update={"forces": (beyond,)}), 0.1, 1e-2)
