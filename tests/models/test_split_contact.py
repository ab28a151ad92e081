"""The two halves of split_whole against it: each alone with the other's exact signals, and both coupled."""

from itertools import pairwise

import numpy as np
import pytest
from tlismni.core import Simulation, simulate
from tlismni.models import ScenarioError, load

T_END = 0.05
"""s; the first blow, from 9.9 to 21 ms, and the flight after it."""


def whole(times=None):
    return simulate(load("split_whole").model, T_END, rtol=1e-10, atol=1e-12, t_eval=times)


def half(name):
    return Simulation(load(name).model, rtol=1e-9, atol=1e-11)


def values(sim):
    return dict(zip((c.name for c in sim.channels), sim.values(), strict=True))


def test_the_wall_led_by_the_exact_motion_gives_the_force_of_the_whole():
    """Position and velocity at every 0.1 ms, with the acceleration as derivative: the force follows to third order."""
    errors = []
    for count in (250, 500):
        times = np.linspace(0.0, T_END, count + 1)
        exact = whole(times)
        wall, seen = half("split_wall"), []
        for k in range(count):
            x, v, a = (float(exact[f"hammer.{name}"][k]) for name in ("x", "vx", "ax"))
            wall.set_inputs({"hammer_x": x, "hammer_vx": v}, {"hammer_vx": (a,)})
            wall.advance(float(times[k + 1]))
            seen.append(values(wall)["blow.normal_force"])
        errors.append(np.max(np.abs(seen - exact["blow.normal_force"][1:])) / np.max(exact["blow.normal_force"]))
        kinds = [event.kind for event in wall.events]
        assert kinds == ["close", "open"]
    assert errors[1] < 0.3 * errors[0] and errors[1] < 1e-2


def test_the_striker_pushed_by_the_exact_force_moves_as_in_the_whole():
    """The force, held over each step at its mean, gives the momentum of the whole."""
    count = 1000
    times = np.linspace(0.0, T_END, count + 1)
    exact = whole(times)
    mean = np.diff(exact["blow.impulse"]) / np.diff(times)
    striker = half("split_striker")
    for k in range(count):
        striker.set_inputs({"contact_force": float(mean[k])})
        striker.advance(float(times[k + 1]))
    found = values(striker)
    assert found["hammer.vx"] == pytest.approx(exact["hammer.vx"][-1], abs=1e-6)
    assert found["hammer.x"] == pytest.approx(exact["hammer.x"][-1], abs=1e-6)


def test_coupled_halves_converge_to_the_whole():
    """Exchanged at equal instants (Jacobi), the force held: first order in the communication step."""
    exact = whole([T_END])
    errors = []
    for count in (200, 400, 800):
        striker, wall = half("split_striker"), half("split_wall")
        for k in range(count):
            motion, force = values(striker), values(wall)["blow.normal_force"]
            striker.set_inputs({"contact_force": force})
            wall.set_inputs({"hammer_x": motion["hammer.x"], "hammer_vx": motion["hammer.vx"]})
            for sim in (striker, wall):
                sim.advance(T_END * (k + 1) / count)
        errors.append(abs(values(striker)["hammer.vx"] - exact["hammer.vx"][0]))
    assert errors[0] < 0.1
    assert all(1.6 < a / b < 2.6 for a, b in pairwise(errors)), errors


def test_an_impulse_does_not_pass_through_a_port():
    with pytest.raises(ScenarioError, match="newton"):
        load("split_wall", law="newton")
