"""Motions that are inputs: position with velocity, jumps closed without impact; a wall that moves by them."""

import logging
import math

import numpy as np
import pytest
from scipy.optimize import brentq
from tlismni.core import (
    CoordinateDriver,
    Disk2D,
    DiskOnHalfPlane2D,
    HalfPlane2D,
    Hertz,
    Model,
    ModelError,
    MovingFrame2D,
    NewtonImpact,
    PointMass2D,
    Ramp,
    RigidBody2D,
    Simulation,
    SimulationError,
    SpringDamper2D,
    State,
    Step,
    simulate,
)
from tlismni.core.model.channels import Input
from tlismni.core.model.markers import Marker2D
from tlismni.core.model.motion import closing
from tlismni.core.model.signals import InputSignal, Polynomial

INPUTS = (Input(name="x", unit="m"), Input(name="v", unit="m/s"))
LED = InputSignal(channel="x", rate="v")


def values(sim):
    return {c.name: x for c, x in zip(sim.channels, sim.values(), strict=True)}


def wall(law, motion=LED, inputs=INPUTS, **ball):
    """A wall across x that moves by `motion`, and a ball of 2 kg to its right."""
    given = {"mass": 2.0, "position": (0.5, 0.0), "velocity": (-1.0, 0.0), **ball}
    return Model(
        name="wall",
        gravity=(0.0, 0.0),
        bodies=[MovingFrame2D(name="wall", x=motion), PointMass2D(name="ball", **given)],
        contacts=[
            DiskOnHalfPlane2D(
                name="blow",
                plane=HalfPlane2D(marker=Marker2D(body="wall", angle=-0.5 * math.pi)),
                disk=Disk2D(marker=Marker2D(body="ball"), radius=0.1),
                law=law,
            )
        ],
        inputs=inputs,
    )


def test_the_closing_polynomial_meets_its_conditions():
    """c(0) = c0, c'(0) = c1, c(T) = c'(T) = c''(T) = 0; c' and c'' are its derivatives."""
    c0, c1, duration = 0.3, -0.7, 0.2
    at = closing.py_func
    np.testing.assert_allclose(at(c0, c1, duration, 0.0)[:2], (c0, c1), rtol=1e-14)
    assert at(c0, c1, duration, duration) == (0.0, 0.0, 0.0)
    np.testing.assert_allclose(at(c0, c1, duration, duration * (1.0 - 1e-9)), 0.0, atol=1e-6)
    s, d = 0.11, 1e-5
    for k in (0, 1):
        slope = (at(c0, c1, duration, s + d)[k] - at(c0, c1, duration, s - d)[k]) / (2.0 * d)
        assert slope == pytest.approx(at(c0, c1, duration, s)[k + 1], rel=1e-7)


def test_a_wall_at_constant_speed_strikes_with_its_own_speed_too():
    """Newton's law about the relative velocity: v+ = u - e (v - u); the wall's drive does the work."""
    e, u, v = 0.5, 0.8, -1.0
    model = wall(NewtonImpact(restitution=e))
    sim = Simulation(model, rtol=1e-10, atol=1e-12)
    h = 0.1
    for k in range(5):
        sim.set_inputs({"x": k * h * u, "v": u})
        sim.advance((k + 1) * h)
    (event,) = sim.events
    assert event.t == pytest.approx(0.4 / (u - v), abs=1e-9)
    assert event.approach_speed == pytest.approx(u - v, rel=1e-9)
    found = values(sim)
    after = u - e * (v - u)
    assert found["ball.vx"] == pytest.approx(after, rel=1e-9)
    assert found["energy.impact_loss"] == pytest.approx(0.5 * 2.0 * (1.0 - e * e) * (u - v) ** 2, rel=1e-9)
    # force on the ball over time is its change of momentum; the drive moves its point of action
    assert found["energy.input_work"] == pytest.approx(2.0 * (after - v) * u, rel=1e-9)
    assert abs(found["energy.balance"]) < 1e-9


def test_a_moving_wall_is_the_resting_one_seen_from_a_moving_frame():
    """Force law: adding one velocity to everything changes no force."""
    u, h = 0.8, 0.03
    law = Hertz(stiffness=1e4)
    rest = simulate(
        wall(law, Polynomial(coefficients=(0.0,)), ()), 0.9, rtol=1e-10, atol=1e-12, t_eval=[0.3, 0.45, 0.9]
    )
    moving = Simulation(wall(law, velocity=(u - 1.0, 0.0)), rtol=1e-10, atol=1e-12)
    seen = []
    for k in range(30):
        moving.set_inputs({"x": k * h * u, "v": u})
        moving.advance((k + 1) * h)
        if k + 1 in (10, 15, 30):
            seen.append(values(moving))
    for name in ("blow.gap", "blow.gap_rate", "blow.normal_force", "blow.impulse", "wall.reaction_x"):
        scale = np.max(np.abs(rest[name]))
        np.testing.assert_allclose([s[name] for s in seen], rest[name], atol=1e-6 * scale)
    assert [event.kind for event in moving.events] == ["close", "open"]


@pytest.mark.sampled(2)
@pytest.mark.parametrize("force", [False, True])
@pytest.mark.parametrize("given, order", [(False, 1.8), (True, 2.7)])
def test_a_coarse_motion_converges_with_the_communication_step(force, given, order):
    """A wall that oscillates, with a ball that a spring presses on it; samples of its motion every h s. The lag is
    a h^2/2, so the error is of second order, and of third with the acceleration given; jumps put no energy in that the
    ledger does not know."""
    amplitude, w, t_end, stiffness = 0.2, 5.0, 0.8, 1e5
    law = Hertz(stiffness=stiffness) if force else NewtonImpact(restitution=0.0)

    def build(motion, inputs=INPUTS):
        overlap = brentq(lambda d: stiffness * d**1.5 - 800.0 * (0.6 - d), 0.0, 0.1) if force else 0.0
        model = wall(law, motion, inputs, position=(0.1 - overlap, 0.0), velocity=(amplitude * w, 0.0))
        spring = SpringDamper2D(
            name="spring", a=Marker2D(point=(1.5, 0.0)), b=Marker2D(body="ball"), stiffness=800.0, natural_length=2.0
        )
        return model.model_copy(update={"forces": (spring,)})

    coefficients = [amplitude * (-1) ** (k // 2) * w**k / math.factorial(k) if k % 2 else 0.0 for k in range(28)]
    exact = simulate(build(Polynomial(coefficients=coefficients), ()), t_end, rtol=1e-10, atol=1e-12)
    errors = []
    for count in (40, 80, 160):
        h = t_end / count
        sim = Simulation(build(LED), "irk", rtol=1e-9, atol=1e-11)
        for k in range(count):
            t = k * h
            x, v = amplitude * math.sin(w * t), amplitude * w * math.cos(w * t)
            sim.set_inputs({"x": x, "v": v}, {"v": (-w * w * x,)} if given else {})
            sim.advance((k + 1) * h)
            assert abs(values(sim)["energy.balance"]) < 1e-6
        found = values(sim)
        errors.append(abs(found["ball.x"] - exact["ball.x"][-1]))
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert np.all(orders > order), (errors, orders)


def test_a_jump_is_closed_without_impact(caplog):
    """Position and velocity go on; at the end of the step they are what the input says. The driver's work is the
    change of energy."""
    model = Model(
        name="led",
        gravity=(0.0, 0.0),
        bodies=[PointMass2D(name="p", mass=3.0, position=(5.0, 0.0))],
        joints=[CoordinateDriver(name="hand", body="p", coordinate="x", motion=LED)],
        inputs=INPUTS,
    )
    sim = Simulation(model, rtol=1e-10, atol=1e-12)
    # before the first step the body starts where the input says
    sim.set_inputs({"x": 1.0, "v": 0.5})
    found = values(sim)
    assert (found["p.x"], found["p.vx"], found["energy.balance"]) == (1.0, 0.5, 0.0)
    sim.advance(0.1)
    with caplog.at_level(logging.WARNING):
        sim.set_inputs({"x": 1.5, "v": -0.25})
        found = values(sim)
        assert found["p.x"] == pytest.approx(1.05, abs=1e-14) and found["p.vx"] == pytest.approx(0.5, abs=1e-14)
        assert found["p.ax"] == 0.0 == found["hand.reaction"]
        sim.advance(0.2)
    assert "the motion is -0.45 away from its input 'x'" in caplog.text
    found = values(sim)
    assert found["p.x"] == pytest.approx(1.475, abs=1e-13) and found["p.vx"] == pytest.approx(-0.25, abs=1e-12)
    assert found["energy.input_work"] == pytest.approx(1.5 * (0.25**2 - 0.5**2), rel=1e-6)
    sim.advance(0.4)
    found = values(sim)
    assert found["p.x"] == pytest.approx(1.425, abs=1e-13) and abs(found["p.ax"]) < 1e-9


def test_the_state_holds_a_jump_that_is_being_closed():
    """Restored in a new simulation from bytes, the run goes on bit for bit, also in the middle of closing."""
    model = wall(Hertz(stiffness=1e4))

    def go_on(sim):
        sim.advance(0.3)
        sim.set_inputs({"x": 0.02, "v": 0.2})
        sim.advance(0.9)
        return sim.values()

    sim = Simulation(model, rtol=1e-8)
    sim.advance(0.1)
    sim.set_inputs({"x": 0.05, "v": 0.3})
    before = sim.state().to_bytes()
    sim.advance(0.2)
    inside = sim.state().to_bytes()
    end = go_on(sim)
    for stored, t in ((before, 0.2), (inside, 0.2)):
        other = Simulation(model, rtol=1e-8)
        other.restore(State.from_bytes(stored))
        other.advance(t)
        assert np.array_equal(go_on(other), end)


def test_the_balance_of_energy_belongs_to_the_state():
    """Inputs make the start, and its energy with it: a run that started elsewhere goes on with that of the state."""
    body = RigidBody2D(name="body", mass=2.0, inertia=1.0)
    model = Model(
        bodies=[body], joints=[CoordinateDriver(name="lift", body="body", coordinate="y", motion=LED)], inputs=INPUTS
    )
    here, elsewhere = Simulation(model), Simulation(model)
    here.set_inputs({"x": 3.0, "v": 1.0})
    elsewhere.set_inputs({"x": -7.0, "v": 2.0})
    for sim in (here, elsewhere):
        sim.advance(0.2)
    state = here.state()
    elsewhere.restore(State.from_bytes(state.to_bytes()))
    assert elsewhere.state() == state
    assert abs(values(here)["energy.balance"]) < 1e-9
    assert elsewhere.values().tobytes() == here.values().tobytes()


@pytest.mark.parametrize("x, v", [(1e6, 0.0), (0.0, -1e6), (1e300, 1e300)])
def test_an_absurd_way_is_refused_at_once_and_the_run_can_go_back(x, v):
    sim = Simulation(wall(Hertz(stiffness=1e4)))
    sim.advance(0.1)
    state = sim.state()
    sim.set_inputs({"x": x, "v": v})
    with pytest.raises(SimulationError, match=r"inputs \['x', 'v'\] ask for a way of .* check their values and units"):
        sim.advance(0.2)
    sim.restore(state)
    sim.advance(0.2)


def test_a_run_may_start_at_any_time():
    """The motion goes on from the start of the run, not from t = 0."""
    inputs = (Input(name="x", unit="m", start=0.1), Input(name="v", unit="m/s", start=0.2))
    for set_again in (False, True):
        sim = Simulation(wall(Hertz(stiffness=1e4), inputs=inputs), t0=5.0)
        if set_again:
            sim.set_inputs({"x": 0.15, "v": 0.2})
        sim.advance(5.25)
        assert values(sim)["wall.x"] == pytest.approx((0.15 if set_again else 0.1) + 0.05, abs=1e-12)


def test_without_a_rate_the_motion_comes_to_rest_at_each_point():
    model = wall(Hertz(stiffness=1e4), InputSignal(channel="x"), (Input(name="x", unit="m"),))
    sim = Simulation(model)
    sim.advance(0.1)
    sim.set_inputs({"x": 0.001})
    sim.advance(0.2)
    found = values(sim)
    assert found["wall.x"] == pytest.approx(0.001, abs=1e-15) and abs(found["wall.vx"]) < 1e-12


def test_a_frame_moves_by_any_time_function_and_carries_joints():
    """A rigid body welded to a turning frame by a spring-free guide would be a rotor: here, a wall on a Ramp."""
    model = wall(Hertz(stiffness=1e4), Ramp(start=0.0, duration=10.0, before=0.0, after=5.0), ())
    result = simulate(model, 0.2)
    np.testing.assert_allclose(result["wall.x"], 0.5 * result.t, atol=1e-12)
    with pytest.raises(ModelError, match="a jump in position is no motion"):
        MovingFrame2D(name="wall", y=Step(time=1.0))


def test_rates_belong_to_motions_and_must_be_declared():
    body = RigidBody2D(name="b", mass=1.0, inertia=1.0)
    driver = CoordinateDriver(name="d", body="b", coordinate="x", motion=LED)
    with pytest.raises(ModelError, match="input channel 'v', which is not declared"):
        Model(bodies=[body], joints=[driver], inputs=INPUTS[:1])
    from tlismni.core import CoordinateLoad

    load = CoordinateLoad(name="f", body="b", coordinate="x", load=LED)
    with pytest.raises(ModelError, match="only motions have a velocity"):
        Model(bodies=[body], forces=[load], inputs=INPUTS)
