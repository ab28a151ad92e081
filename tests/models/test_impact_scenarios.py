"""Scenarios with impacts in mechanisms: closed forms by energy, statics and momentum."""

import cmath
import math
from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from tlismni.core import Simulation, simulate
from tlismni.models import load

G = 9.81
TIGHT = {"rtol": 1e-10, "atol": 1e-12}

# ---- two rods and a wall


def test_tip_strikes_the_wall_six_times_with_newtons_law_and_a_closed_ledger() -> None:
    """Between the impacts energy is kept; each takes the loss (1 - e) P v / 2 of its own impulse."""
    scenario = load("double_pendulum_wall")
    result = simulate(scenario.model, scenario.t_end, **TIGHT)
    impacts = [e for e in result.events if e.kind == "impact"]
    assert len(impacts) >= 5 and len(impacts) == len(result.events)
    assert min(b.t - a.t for a, b in pairwise(impacts)) > 0.3
    for impact in impacts:
        assert impact.approach_speed > 1.0
        assert impact.separation_speed == pytest.approx(0.8 * impact.approach_speed, rel=1e-12)
        assert impact.energy_loss == pytest.approx(0.1 * impact.impulse * impact.approach_speed, rel=1e-12)
    assert result["wall.gap"].min() > -1e-12
    tip = result["lower.x"] + 0.25 * np.cos(result["lower.angle"])
    assert np.abs(result["wall.gap"] - tip).max() < 1e-12
    assert np.abs(result["energy.balance"]).max() < 1e-8
    lost = sum(impact.energy_loss for impact in impacts)
    assert result["energy.impact_loss"][-1] == pytest.approx(lost, rel=1e-12)


def test_impulse_on_the_wall_is_that_of_the_reduced_mass() -> None:
    """In minimal coordinates, with the angles that the rods have at the touch."""
    scenario = load("double_pendulum_wall", upper_angle=-1.5, lower_angle=-1.5, restitution=0.6)
    result = simulate(scenario.model, 1.0, **TIGHT)
    first = result.events[0]
    at = int(np.searchsorted(result.t, first.t))
    a, b = result["upper.angle"][at], result["lower.angle"][at]
    c = 0.125 * math.cos(a - b)
    mass = np.array([[4.0 / 3.0 * 0.25, c], [c, 0.25 / 3.0]])
    gradient = np.array([-0.5 * math.sin(a), -0.5 * math.sin(b)])
    effective = 1.0 / (gradient @ np.linalg.solve(mass, gradient))
    assert first.impulse == pytest.approx(1.6 * effective * first.approach_speed, rel=1e-9)


# ---- a slider-crank and a stop

R, L, CRANK, ROD, SLIDER, FLYWHEEL = 0.15, 0.3, 0.36, 0.15, 0.075, 0.01


def crank_state(angle: float) -> tuple[float, float, float]:
    """(twice the kinetic energy at unit rate, potential energy, slider's dx/d angle), rates by the complex step."""
    z = complex(angle, 1e-30)
    phi = -cmath.asin(R / L * cmath.sin(z))
    points = {
        "crank": (0.5 * R * cmath.cos(z), 0.5 * R * cmath.sin(z)),
        "rod": (R * cmath.cos(z) + 0.5 * L * cmath.cos(phi), R * cmath.sin(z) + 0.5 * L * cmath.sin(phi)),
        "slider": (R * cmath.cos(z) + L * cmath.cos(phi), 0j),
    }
    masses = {"crank": CRANK, "rod": ROD, "slider": SLIDER}
    moving = FLYWHEEL + CRANK * R**2 / 12.0 + ROD * L**2 / 12.0 * (phi.imag / 1e-30) ** 2
    moving += sum(masses[name] * ((x.imag / 1e-30) ** 2 + (y.imag / 1e-30) ** 2) for name, (x, y) in points.items())
    weight = sum(masses[name] * G * y.real for name, (x, y) in points.items())
    return moving, weight, points["slider"][0].imag / 1e-30


def test_first_blow_on_the_stop_has_the_speed_that_the_torque_gives() -> None:
    scenario = load("slider_crank_stop", torque=0.8)
    result = simulate(scenario.model, 0.5, **TIGHT)
    start, stop = crank_state(-0.75 * math.pi), crank_state(-0.25 * math.pi)
    rate = math.sqrt(2.0 * (0.8 * 0.5 * math.pi + start[1] - stop[1]) / stop[0])
    first = result.events[0]
    assert first.kind == "impact"
    assert first.approach_speed == pytest.approx(rate * stop[2], rel=1e-9)
    assert first.impulse == pytest.approx(1.5 * stop[0] / stop[2] ** 2 * first.approach_speed, rel=1e-9)


def test_slider_comes_to_rest_against_the_stop_and_presses_as_statics_says() -> None:
    scenario = load("slider_crank_stop")
    result = simulate(scenario.model, scenario.t_end, rtol=1e-9, atol=1e-11)
    (rest,) = [e for e in result.events if e.kind == "rest"]
    assert rest.t < scenario.t_end - 0.1
    d = 1e-6
    moment = 1.0 - (crank_state(-0.25 * math.pi + d)[1] - crank_state(-0.25 * math.pi - d)[1]) / (2.0 * d)
    force = moment / crank_state(-0.25 * math.pi)[2]
    late = result.t > rest.t
    assert result["stop.normal_force"][late] == pytest.approx(force, rel=1e-6)
    assert np.abs(result["crank.angle"][late] + 0.25 * math.pi).max() < 1e-9
    assert np.abs(result["energy.balance"]).max() < 1e-7


def test_stop_lets_go_when_the_torque_turns_back() -> None:
    sim = Simulation(load("slider_crank_stop").model)
    sim.advance(1.2)
    assert sim.events[-1].kind == "rest"
    sim.set_inputs({"torque": -1.0})
    sim.advance(1.3)
    assert sim.events[-1].kind == "open" and sim.events[-1].t == pytest.approx(1.2, abs=1e-9)
    values = dict(zip([c.name for c in sim.channels], sim.values(), strict=True))
    assert values["stop.gap"] > 0.01 and values["stop.normal_force"] == 0.0


@pytest.mark.parametrize("law", ["kelvin_voigt", "gonthier"])
def test_force_laws_at_the_stop_give_the_restitution_they_promise(law: str) -> None:
    scenario = load("slider_crank_stop", law=law, stiffness=1e8, restitution=0.7)
    result = simulate(scenario.model, 0.3, rtol=1e-8, atol=1e-11)
    opened = next(e for e in result.events if e.kind == "open")
    assert opened.separation_speed / opened.approach_speed == pytest.approx(0.7, rel=2e-3)


# ---- Newton's cradle


@pytest.mark.parametrize("balls, released", [(3, 1), (5, 1), (5, 2), (4, 3)])
@pytest.mark.parametrize("parameters", [{"gap": 1e-7}, {"gap": 1e-7, "propagation": "simultaneous"}])
def test_as_many_balls_fly_off_as_were_released(balls: int, released: int, parameters: dict) -> None:
    """With a gap each pair strikes in turn and exchanges its velocities (e = 1, equal masses)."""
    scenario = load("newtons_cradle", balls=balls, released=released, **parameters)
    quarter = 0.25 * scenario.t_end
    result = simulate(scenario.model, 1.3 * quarter, rtol=1e-9, atol=1e-11)
    impacts = [e for e in result.events if e.kind == "impact"]
    assert len(impacts) == released * (balls - released)
    speed = math.sqrt(2.0 * G * 0.2 * (1.0 - math.cos(0.5)))
    assert impacts[0].approach_speed == pytest.approx(speed, rel=1e-4)
    for k in range(1, balls + 1):
        last = result[f"ball{k}.vx"][-1]
        moves = k > balls - released
        assert (last > 0.5 * speed) if moves else (abs(last) < 1e-3 * speed)
    assert np.abs(result["energy.balance"]).max() < 1e-8


def test_cradle_keeps_its_momentum_at_every_impact() -> None:
    result = simulate(load("newtons_cradle", restitution=0.9, gap=1e-6).model, 0.25, rtol=1e-9, atol=1e-11)
    momentum = sum(result[f"ball{k}.vx"] for k in range(1, 6))
    first, last = (next(e.t for e in events) for events in (result.events, result.events[::-1]))
    before, after = np.flatnonzero(result.t < first)[-1], np.flatnonzero(result.t > last)[0]
    assert len([e for e in result.events if e.kind == "impact"]) >= 4
    assert momentum[after] == pytest.approx(momentum[before], rel=1e-2)
    jumps = np.flatnonzero(np.diff(result.t) == 0.0)
    assert len(jumps) >= 4
    assert np.abs(np.diff(momentum)[jumps]).max() < 1e-7


def cradle_after_first_blow(**parameters) -> tuple[np.ndarray, float]:  # type: ignore[no-untyped-def]
    """Velocities right after the first blow, relative to the speed of the released balls before it."""
    scenario = load("newtons_cradle", **parameters)
    result = simulate(scenario.model, 0.3 * scenario.t_end, rtol=1e-9, atol=1e-11)
    speed = math.sqrt(2.0 * G * 0.2 * (1.0 - math.cos(0.5)))
    first = result.events[0].t
    assert {e.t for e in result.events if e.kind == "impact"} == {first}
    after = np.flatnonzero(result.t == first)[-1]
    balls = len(scenario.model.bodies)
    return np.array([result[f"ball{k}.vx"][after] for k in range(1, balls + 1)]) / speed, result["energy.impact_loss"][
        -1
    ]


@pytest.mark.parametrize("balls, released", [(3, 1), (5, 1), (5, 2), (5, 4)])
def test_sequential_blow_through_touching_balls_comes_out_at_the_other_end(balls: int, released: int) -> None:
    found, loss = cradle_after_first_blow(balls=balls, released=released)
    assert found == pytest.approx([0.0] * (balls - released) + [1.0] * released, abs=1e-7)
    assert abs(loss) < 1e-15


@pytest.mark.parametrize("balls", [3, 5])
@pytest.mark.parametrize("e", [0.0, 0.5, 1.0])
def test_simultaneous_blow_on_touching_balls_is_newtons_law_at_all_contacts(balls: int, e: float) -> None:
    """v2 - v1 = e, the struck balls stay together, momentum is kept: v1 = (1 - (n - 1) e)/n, v2 = ... = (1 + e)/n."""
    found, loss = cradle_after_first_blow(balls=balls, propagation="simultaneous", restitution=e)
    exact = [(1.0 - (balls - 1) * e) / balls] + [(1.0 + e) / balls] * (balls - 1)
    assert found == pytest.approx(exact, abs=1e-7)
    kinetic = 0.03 * G * 0.2 * (1.0 - math.cos(0.5))
    assert loss == pytest.approx(kinetic * (1.0 - sum(x**2 for x in exact)), rel=1e-6, abs=1e-12)


def test_hertzian_cradle_passes_the_blow_on_as_a_wave() -> None:
    """Of three balls in contact with F = K d^1.5 most of the blow comes out at the end, and all recoil a little:
    -0.071, 0.076, 0.995 of the speed by scipy (Herrmann and Seitz 1982 find the like)."""
    result = simulate(load("newtons_cradle", balls=3, law="hertz").model, 0.24, rtol=1e-8, atol=1e-11)
    speed = math.sqrt(2.0 * G * 0.2 * (1.0 - math.cos(0.5)))
    last = max(e.t for e in result.events if e.kind == "open")
    after = int(np.searchsorted(result.t, last, side="right")) - 1
    found = np.array([result[f"ball{k}.vx"][after] for k in (1, 2, 3)]) / speed
    assert found == pytest.approx(three_balls(), abs=2e-3)


def three_balls() -> np.ndarray:
    """Velocities of three equal free balls, touching, after a blow of speed 1, with F = d^1.5 between them."""

    def motion(t: float, y: np.ndarray) -> np.ndarray:
        f = np.maximum([y[0] - y[1], y[1] - y[2]], 0.0) ** 1.5
        return np.array([*y[3:], -f[0], f[0] - f[1], f[1]])

    found = solve_ivp(
        motion, (0.0, 40.0), [0.0, 0.0, 0.0, 1.0, 0.0, 0.0], "DOP853", rtol=1e-10, atol=1e-12, max_step=0.1
    )
    return np.asarray(found.y[3:, -1])
