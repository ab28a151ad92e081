"""Smooth motion is predicted so well by `newmark` and `hht` that one increment a step is enough, without harm."""

import numpy as np
import pytest
from tlismni.core import Marker3D, Model, RigidBody3D, Simulation, Spherical3D
from tlismni.models import load

LINKS, STEP, STEPS = 5, 5e-4, 1000


def spatial_chain() -> Model:
    """Rods of 1 m on ball joints, that turn about z and fall."""
    bodies, joints = [], []
    for k in range(LINKS):
        x = k + 0.5
        body = RigidBody3D(
            name=f"rod{k}", mass=1.0, inertia=(0.00125, 0.084, 0.084), position=(x, 0.0, 0.0),
            velocity=(0.0, 0.1 * x, 0.0), angular_velocity=(0.0, 0.0, 0.1),
        )  # fmt: skip
        place = (float(k), 0.0, 0.0)
        before = bodies[-1].marker_at(place) if bodies else Marker3D()
        joints.append(Spherical3D(name=f"ball{k}", a=before, b=body.marker_at(place)))
        bodies.append(body)
    return Model(name="chain", gravity=(0.0, 0.0, -9.81), bodies=bodies, joints=joints)


def run(method: str, **settings: float) -> tuple[np.ndarray, dict]:
    """Coordinates at the end, and the statistics."""
    simulation = Simulation(spatial_chain(), method, step=STEP, record=False, **settings)
    simulation.run_to(STEPS * STEP)
    return simulation.sample()[simulation.table.layout.q].copy(), simulation.stats


@pytest.mark.parametrize("method", ["newmark", "hht"])
def test_one_increment_of_smooth_motion(method: str) -> None:
    """And matrices that stay, since dependent coordinates are predicted too."""
    q, stats = run(method)
    assert stats["outer_iterations"] < 1.3 * STEPS
    assert stats["factorizations"] < 0.3 * STEPS
    assert stats["residual_evaluations"] < 6.0 * STEPS
    # the formula's equations are solved as they were
    exact, _ = run(method, newton_tolerance=1e-13)
    assert np.abs(q - exact).max() < 1e-9


def test_one_increment_of_stiff_parts_sees_the_constraints_met() -> None:
    """What they leave open would go into an elastic beam's accelerations, and so into the estimate of the error."""
    simulation = Simulation(load("hub_beam_stop").model, "hht", rtol=1e-5, record=False)
    simulation.run_to(0.5)
    assert simulation.stats["rejected"] < 0.2 * simulation.stats["steps"]
