"""Friction on a patch, against sliding and spinning as one: closed forms, and scipy with the law written out."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq
from test_impulse_steps import in_steps, values
from tlismni.core import (
    AppliedForce3D,
    AppliedTorque3D,
    Constant,
    CoulombFriction,
    HalfSpace3D,
    HuntCrossley,
    LuGreFriction,
    Marker3D,
    Model,
    ModelError,
    NewtonImpact,
    PoissonImpact,
    RigidBody3D,
    Simulation,
    Sphere3D,
    SphereOnHalfSpace3D,
    TanhFriction,
    TurningFriction,
    simulate,
)

G, RADIUS, MASS, MU, PATCH = 9.81, 0.05, 0.7, 0.3, 4e-3
INERTIA = 0.4 * MASS * RADIUS**2
STIFF = 1e7
DEPTH = (MASS * G / STIFF) ** (2.0 / 3.0)


def ball(velocity, spin, *, height=0.0, patch=PATCH, gravity=(0.0, 0.0, -G), inertia=INERTIA, mu=MU, loads=(),
         length=1.0, **contact):  # fmt: skip
    """A ball on the floor, on a patch; lengths in units of 1/length m."""
    body = RigidBody3D(
        name="ball", mass=MASS, inertia=(inertia * length**2,) * 3,
        position=(0.0, 0.0, (RADIUS + height) * length), velocity=tuple(length * x for x in velocity),
        angular_velocity=spin,
    )  # fmt: skip
    touch = SphereOnHalfSpace3D(
        name="touch", plane=HalfSpace3D(), sphere=Sphere3D(marker=Marker3D(body="ball"), radius=RADIUS * length),
        turning=TurningFriction(friction_radius=patch * length) if patch > 0.0 else None,
        **({"law": NewtonImpact(restitution=0.0), "friction": CoulombFriction(coefficient=mu)} | contact),
    )  # fmt: skip
    return Model(gravity=tuple(length * x for x in gravity), bodies=[body], contacts=[touch], forces=list(loads))


def soft(speed):
    """A contact by force, whose friction has nearly its full size at this sliding speed, m/s."""
    law = HuntCrossley(stiffness=STIFF, exponent=1.5, restitution=0.5)
    return {"law": law, "friction": TanhFriction(coefficient=MU, transition_speed=speed), "height": -DEPTH}


def slip(result, at=-1):
    """Sliding velocity along x and y, spin about the vertical."""
    x = result["ball.vx"][at] - RADIUS * result["ball.angular_velocity_y"][at]
    y = result["ball.vy"][at] + RADIUS * result["ball.angular_velocity_x"][at]
    return np.array([x, y, result["ball.angular_velocity_z"][at]])


def sliding(u, w, t):
    """Slip and spin after t of a ball that slides and spins: u' = -(7/2) mu g u/s, J w' = -mu m g r^2 w/s."""

    def rates(_, y):
        s = math.sqrt(y[0] ** 2 + y[1] ** 2 + (PATCH * y[2]) ** 2)
        return [-3.5 * MU * G * y[0] / s, -3.5 * MU * G * y[1] / s, -MU * MASS * G * PATCH**2 * y[2] / (INERTIA * s)]

    return solve_ivp(rates, (0.0, t), [*u, w], method="LSODA", rtol=1e-11, atol=1e-13).y[:, -1]


@pytest.mark.parametrize("method", ["ebdf", "irk", "bdf", "adams"])
def test_a_ball_slides_and_spins_as_its_equations_say(method):
    result = simulate(ball((0.5, 0.1, 0.0), (0.0, 0.0, 30.0)), 0.1, method, rtol=1e-9, atol=1e-12)
    assert slip(result) == pytest.approx(sliding((0.5, 0.1), 30.0, 0.1), abs=1e-6)
    assert [event.kind for event in result.events] == ["close"]
    assert np.abs(result["energy.balance"]).max() < 1e-7
    lost = result["energy.kinetic"][0] - result["energy.kinetic"][-1]
    assert result["touch.dissipation"][-1] == pytest.approx(lost, rel=1e-6)


@pytest.mark.parametrize("speed", [1e-3, 1e-5])
def test_forces_do_the_same(speed):
    """Friction of a regularised law is that of its transition away from rest: here of none."""
    result = simulate(ball((0.5, 0.1, 0.0), (0.0, 0.0, 30.0), **soft(speed)), 0.1, "ebdf", rtol=1e-9, atol=1e-12)
    assert slip(result) == pytest.approx(sliding((0.5, 0.1), 30.0, 0.1), abs=1e-5)
    assert np.abs(result["energy.balance"]).max() < 1e-7


def test_by_force_a_ball_comes_to_rest_as_the_constraint_does():
    """Both stop with the torque of spinning alone: the faster the transition, the nearer."""
    speed, spin, end = (0.3, -0.2, 0.0), (0.0, 0.0, 8.0), 0.9
    hard = simulate(ball(speed, spin), end, "ebdf", rtol=1e-8, atol=1e-11)
    (stop,) = [event.t for event in hard.events if event.kind == "stick"]
    apart = []
    for transition in (4e-4, 1e-4):
        result = simulate(ball(speed, spin, **soft(transition)), end, "ebdf", rtol=1e-8, atol=1e-11)
        late = result.t > 0.5 * stop
        turned = np.interp(result.t[late], hard.t, hard["ball.angular_velocity_z"])
        apart.append(np.abs(result["ball.angular_velocity_z"][late] - turned).max())
    assert apart[1] < 0.3 * apart[0] < 0.1


@pytest.mark.parametrize("method", ["ebdf", "irk"])
def test_a_ball_that_only_spins_stops_by_the_torque_of_its_patch(method):
    """w = w0 - mu m g r t/J, and then it sticks."""
    spin = 20.0
    stop = INERTIA * spin / (MU * MASS * G * PATCH)
    result = simulate(ball((0.0, 0.0, 0.0), (0.0, 0.0, -spin)), 1.2 * stop, method, rtol=1e-9, atol=1e-12)
    assert [event.kind for event in result.events] == ["close", "stick"]
    assert result.events[-1].t == pytest.approx(stop, rel=1e-7)
    before = result.t < stop
    expected = -spin * (1.0 - result.t[before] / stop)
    assert result["ball.angular_velocity_z"][before] == pytest.approx(expected, abs=1e-6)
    assert abs(result["ball.angular_velocity_z"][-1]) < 1e-9
    assert np.abs([result["ball.x"], result["ball.y"]]).max() < 1e-12
    assert result["touch.dissipation"][-1] == pytest.approx(0.5 * INERTIA * spin**2, rel=1e-7)


def test_without_spin_it_is_coulombs_friction():
    point, patch = (simulate(ball((0.5, 0.2, 0.0), (0.0, 3.0, 0.0), patch=r), 0.5, rtol=1e-10) for r in (0.0, PATCH))
    assert [event.kind for event in patch.events] == [event.kind for event in point.events] == ["close", "stick"]
    assert patch.events[-1].t == pytest.approx(point.events[-1].t, rel=1e-9)
    for name in ("ball.x", "ball.y", "touch.dissipation"):
        assert patch[name][-1] == pytest.approx(point[name][-1], rel=1e-9)


@pytest.mark.parametrize("contact", [{}, soft(1e-6)], ids=["constraint", "force"])
@pytest.mark.parametrize("part", [0.3, 0.9])
def test_what_spins_creeps_under_a_push_that_it_would_hold_at_rest(contact, part):
    """|F| = mu N |v|/sqrt(v^2 + r^2 w^2): v = r w L/sqrt(1 - L^2) under the part L of mu N, and M falls by
    sqrt(1 - L^2); it has so much inertia that it neither rolls nor slows down."""
    spin, heavy = 3.0, 1e5
    push = AppliedForce3D(name="push", marker=Marker3D(body="ball"), force_y=Constant(value=part * MU * MASS * G))
    result = simulate(
        ball((0.0, 0.0, 0.0), (0.0, 0.0, spin), inertia=heavy, loads=[push], **contact), 1.5, "ebdf", rtol=1e-9
    )
    assert result["ball.vy"][-1] == pytest.approx(PATCH * spin * part / math.sqrt(1.0 - part**2), rel=2e-5)
    assert result["touch.friction_force"][-1] == pytest.approx(part * MU * MASS * G, rel=1e-6)
    rest = simulate(ball((0.0, 0.0, 0.0), (0.0, 0.0, 0.0), inertia=heavy, loads=[push]), 0.2, "ebdf", rtol=1e-9)
    assert abs(rest["ball.vy"][-1]) < 1e-6


@pytest.mark.parametrize("force", [0.3, 0.6, 0.95])
@pytest.mark.parametrize("size", [0.97, 1.03])
def test_at_rest_it_holds_what_lies_in_the_ellipsoid(force, size):
    """(F/(mu N))^2 + (M/(mu N r))^2 < 1; beyond, both begin to move. It creeps by what error control does not see."""
    torque = math.sqrt(1.0 - force**2)
    loads = [
        AppliedForce3D(name="push", marker=Marker3D(body="ball", point=(0.0, 0.0, -RADIUS)),
                       force_x=Constant(value=size * force * MU * MASS * G)),
        AppliedTorque3D(name="turn", marker=Marker3D(body="ball"),
                        torque_z=Constant(value=-size * torque * MU * MASS * G * PATCH)),
    ]  # fmt: skip
    result = simulate(ball((0.0, 0.0, 0.0), (0.0, 0.0, 0.0), loads=loads), 0.3, "ebdf", rtol=1e-7, atol=1e-10)
    u = slip(result)
    if size < 1.0:
        assert abs(u[0]) < 1e-9 and PATCH * abs(u[2]) < 1e-5
    else:
        assert u[0] > 1e-5 and PATCH * u[2] < -1e-5
    assert np.abs(result["energy.balance"]).max() < 1e-7


def test_units_change_nothing():
    """Metres or millimetres."""
    one, other = (
        simulate(ball((0.4, 0.1, 0.0), (0.0, 0.0, 10.0), length=k), 1.0, "ebdf", rtol=1e-8)
        for k in (1.0, 1e3)
    )  # fmt: skip
    assert [event.kind for event in one.events] == [event.kind for event in other.events]
    assert [event.t for event in one.events] == pytest.approx([event.t for event in other.events], abs=1e-7)
    assert 1e3 * one["ball.x"][-1] == pytest.approx(other["ball.x"][-1], rel=1e-6)
    assert one["ball.e3"][-1] == pytest.approx(other["ball.e3"][-1], rel=1e-6)


@pytest.mark.parametrize("law", [NewtonImpact(restitution=0.5), PoissonImpact(restitution=0.5)])
@pytest.mark.parametrize("radius", [PATCH, 0.6 * RADIUS])
@pytest.mark.parametrize("spin", [-100.0, 3.0])
def test_a_blow_meets_sliding_and_spinning_at_once(law, radius, spin):
    """(P_T, M/r) = -mu P_N (u, z)/s, s = |(u, z)|, with the slip u and z = r w at the blow's end:
    u = u0 - (7/2) mu P_N u/(m s), z = z0 - mu P_N r^2 z/(J s)."""
    speed = 1.8
    model = ball((speed, 0.0, 0.0), (0.0, 0.0, spin), height=0.05, law=law, patch=radius)
    result = simulate(model, 0.15, rtol=1e-9, atol=1e-12)
    blow = next(event for event in result.events if event.kind == "impact")
    normal = 1.5 * MASS * math.sqrt(2.0 * G * 0.05)
    assert blow.impulse == pytest.approx(normal, rel=1e-9)

    def after(u, z, pressed):
        """(u, z) at the end of one problem with the normal impulse `pressed`."""

        def end(s):
            most = MU * pressed / s
            return u / (1.0 + 3.5 * most / MASS), z / (1.0 + most * radius**2 / INERTIA)

        return end(brentq(lambda s: math.hypot(*end(s)) - s, 1e-9, 10.0, xtol=1e-15))

    u, z = speed, radius * spin
    # Poisson's law solves one for compression and one for expansion
    for part in (1.0,) if isinstance(law, NewtonImpact) else (2.0 / 3.0, 1.0 / 3.0):
        u, z = after(u, z, part * normal)
    assert blow.friction_impulse == pytest.approx(MASS * (speed - u) / 3.5, rel=1e-8)
    assert slip(result) == pytest.approx([u, 0.0, z / radius], rel=1e-8, abs=1e-9)
    at = np.searchsorted(result.t, blow.t)
    lost = result["energy.kinetic"][at] - result["energy.kinetic"][at + 1]
    assert blow.energy_loss == pytest.approx(lost, rel=1e-8)
    assert np.abs(result["energy.balance"]).max() < 1e-6


def test_blows_in_sequence_meet_it_alike():
    """Of one contact both ways of impact are one."""
    ends = []
    for propagation in ("simultaneous", "sequential"):
        law = NewtonImpact(restitution=0.5, propagation=propagation)
        result = simulate(ball((0.8, 0.3, 0.0), (0.0, 0.0, 40.0), height=0.05, law=law, patch=0.02), 0.15, rtol=1e-9)
        ends.append(slip(result))
    assert ends[0] == pytest.approx(ends[1], rel=1e-9)


def test_a_state_goes_on_alike_and_the_model_is_read_back():
    """Bit for bit, in the middle of sliding and spinning and once at rest."""
    model = ball((0.3, 0.1, 0.0), (0.0, 0.0, 8.0), height=0.01)
    again = Model.model_validate_json(model.model_dump_json())
    assert again == model and again.contacts[0].turning.friction_radius == PATCH
    for t in (0.1, 0.2, 0.9):
        first, second = Simulation(model, "ebdf"), Simulation(again, "ebdf")
        first.advance(t)
        state = first.state()
        first.advance(t + 0.2)
        second.restore(state)
        assert second.state() == state
        second.advance(t + 0.2)
        assert np.array_equal(first.values(), second.values())


def test_steps_of_impulses_know_the_ellipsoid():
    """They come near the run with events as they get shorter, and a pushed ball at rest stays."""
    reference = sliding((0.4, 0.2), 25.0, 0.05)
    off = []
    for step in (4e-4, 1e-4):
        sim = in_steps(ball((0.4, 0.2, 0.0), (0.0, 0.0, 25.0)), step)
        sim.advance(0.05)
        now = values(sim)
        x = now["ball.vx"] - RADIUS * now["ball.angular_velocity_y"]
        off.append(np.abs(np.array([x, now["ball.angular_velocity_z"]]) - reference[[0, 2]]).max())
        assert now["energy.balance"] == pytest.approx(0.0, abs=0.1 * step)
    assert off[1] < 0.35 * off[0] < 2e-3


def test_refused():
    with pytest.raises(ModelError, match="give one of them"):
        TurningFriction(spinning=1e-3, friction_radius=1e-3)
    bristles = LuGreFriction(coefficient=0.3, stribeck_speed=1e-3, bristle_stiffness=1e4)
    with pytest.raises(ModelError, match="do not twist"):
        ball((0.0, 0.0, 0.0), (0.0, 0.0, 0.0), law=HuntCrossley(stiffness=1e6, restitution=0.5), friction=bristles)
