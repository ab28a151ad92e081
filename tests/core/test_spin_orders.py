"""Observed orders of Runge-Kutta formulas in turning frames, which are there under error control only: a body with
three moments of inertia that tumbles with a weak torque on it, which leaves something to integrate in the frame of a
free body. Steps are of one size by their greatest one; the tolerance holds none."""

import numpy as np
import pytest
from helpers import order
from scipy.integrate import solve_ivp
from tlismni.core import AppliedTorque3D, Constant, Marker3D, Model, RigidBody3D, simulate

MOMENTS, RATE, T_END = np.array([0.1, 0.2, 0.25]), np.array([20.0, -20.0, 30.0]), 0.4
TORQUE = 1.0
"""About the x axis of space, N m: a hundredth of J w^2."""
STEPS = (120, 240)


def equations(t: float, y: np.ndarray) -> np.ndarray:
    """Euler parameters and angular velocity in the body."""
    p, w = y[:4], y[4:]
    e0, e1, e2, e3 = p
    torque = TORQUE * np.array([1.0 - 2.0 * (e2 * e2 + e3 * e3), 2.0 * (e1 * e2 - e0 * e3), 2.0 * (e1 * e3 + e0 * e2)])
    change = 0.5 * np.concatenate([[-p[1:] @ w], p[0] * w + np.cross(p[1:], w)])
    return np.concatenate([change, (torque - np.cross(w, MOMENTS * w)) / MOMENTS])


@pytest.fixture(scope="module")
def exact() -> np.ndarray:
    start = np.concatenate([[1.0, 0.0, 0.0, 0.0], RATE])
    return solve_ivp(equations, (0.0, T_END), start, method="DOP853", rtol=1e-13, atol=1e-15).y[:4, -1]


@pytest.mark.parametrize("tableau, expected", [("radau3", 5), ("gauss2", 4), ("sdirk4", 4)])
def test_stages_in_turning_frames_have_their_order(exact: np.ndarray, tableau: str, expected: int) -> None:
    body = RigidBody3D(name="body", mass=1.0, inertia=tuple(MOMENTS), angular_velocity=tuple(RATE))
    load = AppliedTorque3D(name="load", marker=Marker3D(body="body"), torque_x=Constant(value=TORQUE))
    model = Model(gravity=(0.0, 0.0, 0.0), bodies=[body], forces=[load])
    errors, in_space = [], 0.0
    for count in STEPS:
        h = T_END / count
        turning = {"rtol": 1e-2, "atol": 1e-2, "max_step": h, "first_step": h}
        for steps in (turning, {"step": h}):
            result = simulate(model, T_END, "irk", tableau=tableau, newton_tolerance=1e-11, record=False, **steps)
            p = result.q[-1, 3:7]
            error = np.abs(p * np.sign(p @ exact) - exact).max()
            if steps is turning:
                assert result.stats["steps"] == count
                errors.append(error)
            else:
                in_space = error
    assert order(errors) > expected - 0.3
    # else they would not have been in frames
    assert errors[-1] < 0.05 * in_space
