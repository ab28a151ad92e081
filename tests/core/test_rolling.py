"""Velocity-level rows: closed forms of rolling balls and of a sleigh, partitions, blows, states, what is refused."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from tlismni.core import (
    AngleDriver3D,
    Axes,
    KnifeEdge2D,
    Marker2D,
    Marker3D,
    Model,
    ModelError,
    NewtonImpact,
    Polynomial,
    Revolute3D,
    RigidBody2D,
    RigidBody3D,
    RollingDisk3D,
    RollingSphere3D,
    Simulation,
    SlideStop3D,
    simulate,
)
from tlismni.core.analysis import mobility, state_space, static_equilibrium
from tlismni.core.simulation.state import State
from tlismni.models import load

MASS, INERTIA, AHEAD = 2.0, 0.3, 0.5


def check_levels(result, most=1e-10):
    assert np.abs(result["residual.position"]).max() < most
    assert np.abs(result["residual.velocity"]).max() < most
    assert np.abs(result["residual.acceleration"]).max() < most * max(1.0, np.abs(result.a).max())


def sleigh(speed=0.4, rate=1.5):
    """Chaplygin's sleigh: a body on a knife edge that is AHEAD behind its centre of mass."""
    body = RigidBody2D(
        name="sleigh", mass=MASS, inertia=INERTIA, position=(AHEAD, 0.0), velocity=(speed, AHEAD * rate),
        angular_velocity=rate,
    )  # fmt: skip
    edge = KnifeEdge2D(name="edge", marker=Marker2D(body="sleigh", point=(-AHEAD, 0.0)))
    return Model(gravity=(0.0, 0.0), bodies=[body], joints=[edge])


def sleigh_at(t, speed=0.4, rate=1.5):
    """(x, y, angle) from u' = a w^2, (J + m a^2) w' = -m a u w (Neimark and Fufaev 1972, II.3)."""

    def motion(_, y):
        u, w, _, _, angle = y
        turn = -MASS * AHEAD * u * w / (INERTIA + MASS * AHEAD**2)
        return [AHEAD * w * w, turn, u * math.cos(angle), u * math.sin(angle), w]

    start = [speed, rate, 0.0, 0.0, 0.0]
    _, _, x, y, angle = solve_ivp(motion, (0.0, t), start, "DOP853", rtol=1e-13, atol=1e-14).y[:, -1]
    return np.array([x + AHEAD * math.cos(angle), y + AHEAD * math.sin(angle), angle])


@pytest.mark.parametrize("method", ["ebdf", "bdf", "irk", "adams", "newmark", "hht", "baumgarte", "hht_ggl"])
def test_chaplygins_sleigh(method):
    result = simulate(sleigh(), 2.0, method, rtol=1e-8, atol=1e-10)
    most = 1e-4 if method in ("newmark", "hht", "hht_ggl") else 1e-6
    assert np.abs(result.q[-1] - sleigh_at(2.0)).max() < most
    energy = result["energy.kinetic"]
    assert np.ptp(energy) < 10.0 * most * energy[0]
    if method not in ("baumgarte", "hht_ggl"):
        check_levels(result)


def test_positions_have_fewer_dependent_coordinates_than_velocities():
    sim = Simulation(load("rolling_disk").model)
    structure = sim.workspace.structure
    assert (structure.m_held, len(structure.active)) == (2, 4)
    assert structure.lu_p is not None and structure.lu_p.n == 2 and structure.lu_d.n == 4
    assert len(set(structure.dependent.tolist())) == 4
    planar = Simulation(load("four_bar").model).workspace.structure
    assert planar.m_held == len(planar.active) and planar.lu_p is None


def ball(**more):
    """Of 1 kg with a radius of 0.1 m, homogeneous."""
    moment = 0.4 * 0.1**2
    return RigidBody3D(name="ball", mass=1.0, inertia=(moment,) * 3, **more)


def test_a_ball_on_a_turntable_goes_in_a_circle():
    """Its velocity turns with 2/7 of the table's angular velocity, whatever it is (Milne 1948)."""
    rate, speed = 3.0, 0.5
    table = RigidBody3D(name="table", mass=5.0, inertia=(0.3, 0.3, 0.5), angular_velocity=(0.0, 0.0, rate))
    # at (1, 0) the table moves with 3 m/s along y: the ball, with v in space, turns as its lowest point does
    v = np.array([0.0, speed, 0.0])
    slip = v - np.array([0.0, rate, 0.0])
    w = np.cross([0.0, 0.0, 1.0], slip) / 0.1
    rolling = ball(position=(1.0, 0.0, 0.1), velocity=tuple(v), angular_velocity=tuple(w))
    ends = {"a": Marker3D(), "b": Marker3D(body="table")}
    model = Model(
        gravity=(0.0, 0.0, -9.81),
        bodies=[table, rolling],
        joints=[
            Revolute3D(name="axis", **ends),
            AngleDriver3D(name="motor", **ends, angle=Polynomial(coefficients=(0.0, rate))),
            RollingSphere3D(name="rolling", a=Marker3D(body="table"), b=Marker3D(body="ball"), radius=0.1),
        ],
    )
    times = np.linspace(0.0, 5.0, 11)
    result = simulate(model, 5.0, rtol=1e-10, atol=1e-12, t_eval=times)
    turned = 2.0 / 7.0 * rate * times
    assert np.abs(result["ball.vx"] + speed * np.sin(turned)).max() < 1e-8
    assert np.abs(result["ball.vy"] - speed * np.cos(turned)).max() < 1e-8
    assert np.abs(result["ball.z"] - 0.1).max() < 1e-12
    check_levels(result)


def test_a_ball_rolls_down_a_slope():
    """a = (5/7) g sin(slope), and a normal force m g cos(slope)."""
    slope = 0.4
    plane = Marker3D(attitude=Axes(z=(math.sin(slope), 0.0, math.cos(slope))))
    start = tuple(0.1 * plane.axes()[:, 2])
    model = Model(
        gravity=(0.0, 0.0, -9.81), bodies=[ball(position=start)],
        joints=[RollingSphere3D(name="rolling", a=plane, b=Marker3D(body="ball"), radius=0.1)],
    )  # fmt: skip
    result = simulate(model, 1.0, rtol=1e-10, atol=1e-12)
    way = 0.5 * 5.0 / 7.0 * 9.81 * math.sin(slope)
    assert result["ball.x"][-1] - start[0] == pytest.approx(way * math.cos(slope), rel=1e-8)
    assert result["ball.z"][-1] - start[2] == pytest.approx(-way * math.sin(slope), rel=1e-8)
    assert result["rolling.force_z"] == pytest.approx(9.81 * math.cos(slope), rel=1e-8)


def test_a_blow_keeps_a_ball_rolling():
    """A ball that rolls against a stop: the blow has to turn it back too, (m + J/r^2)(1 + e) v."""
    model = Model(
        gravity=(0.0, 0.0, -9.81),
        bodies=[ball(position=(0.0, 0.0, 0.1), velocity=(2.0, 0.0, 0.0), angular_velocity=(0.0, 20.0, 0.0))],
        joints=[RollingSphere3D(name="rolling", a=Marker3D(), b=Marker3D(body="ball"), radius=0.1)],
        contacts=[
            SlideStop3D(
                name="stop", a=Marker3D(attitude=Axes(z=(1.0, 0.0, 0.0))), b=Marker3D(body="ball"), limit=1.0,
                law=NewtonImpact(restitution=0.5),
            )
        ],
    )  # fmt: skip
    result = simulate(model, 1.0, rtol=1e-10, atol=1e-12)
    (strike,) = [event for event in result.events if event.kind == "impact"]
    assert strike.t == pytest.approx(0.5, abs=1e-10)
    assert strike.impulse == pytest.approx(1.4 * 1.5 * 2.0, rel=1e-9)
    assert result["ball.vx"][-1] == pytest.approx(-1.0, rel=1e-9)
    assert result["ball.angular_velocity_y"][-1] == pytest.approx(-10.0, rel=1e-9)
    check_levels(result)


@pytest.mark.parametrize("outer", ["simple", "jfnk"])
def test_every_outer_loop(outer):
    model = load("rolling_disk", tilt_rate=0.5).model
    one, other = (
        simulate(model, 0.2, "hht", step=1e-3, newton_tolerance=1e-12, outer=o, fallback=False, t_eval=[0.2])
        for o in ("newton", outer)
    )
    assert np.abs(one.q - other.q).max() < 1e-10
    check_levels(other)


def test_a_state_goes_through_bytes():
    sim = Simulation(load("rolling_disk", tilt_rate=1.0).model)
    sim.advance(0.7)
    kept = sim.state().to_bytes()
    sim.advance(1.5)
    later = sim.values().copy()
    sim.restore(State.from_bytes(kept))
    sim.advance(1.5)
    assert np.array_equal(sim.values(), later)


def test_rows_that_repeat_others_are_named():
    rolling = [RollingSphere3D(name=name, a=Marker3D(), b=Marker3D(body="ball"), radius=0.1) for name in ("one", "two")]
    model = Model(gravity=(0.0, 0.0, -9.81), bodies=[ball(position=(0.0, 0.0, 0.1))], joints=rolling)
    result = simulate(model, 0.1)
    assert [row.constraint for row in result.redundant] == ["two"] * 3
    check_levels(result)


def test_what_is_refused():
    disk = load("rolling_disk").model
    flat = {"a": Marker3D(), "b": Marker3D(body="ball")}
    with pytest.raises(ValueError, match="flat on the plane"):
        Model(bodies=[ball()], joints=[RollingDisk3D(name="r", **flat, radius=0.1)])
    upright = {"a": Marker3D(), "b": Marker3D(body="ball", attitude=Axes(z=(1.0, 0.0, 0.0)))}
    with pytest.raises(ValueError, match="rim of radius"):
        Model(bodies=[ball()], joints=[RollingDisk3D(name="r", **upright, radius=0.1, rim_radius=0.2)])
    for analysis in (state_space, static_equilibrium):
        with pytest.raises(ModelError, match="nonholonomic"):
            analysis(disk)
    assert mobility(disk).freedom == 3
