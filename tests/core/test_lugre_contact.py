"""LuGre's friction in a contact: pre-sliding, break-away, Stribeck's curve, stick-slip, ledger; against the equations
of a block, written down here."""

import math

import numpy as np
import pytest
from contact_points import ContactPoint, check_derivatives, state_at
from helpers import G, events, on
from lugre_models import BRISTLES, LAW, MASS, MU, NORMAL, S0, S1, S2, STATIC, STIFFNESS, STRIBECK, TIGHT
from scipy.integrate import solve_ivp
from tlismni.core import (
    AppliedForce2D,
    CoordinateContact,
    CoordinateDriver,
    CoordinateTerm,
    Disk2D,
    DiskOnDisk2D,
    DiskOnHalfPlane2D,
    DiskOnLine2D,
    DiskOnSegment2D,
    HalfPlane2D,
    KelvinVoigt,
    Line2D,
    LuGreFriction,
    Marker2D,
    Model,
    ModelError,
    NewtonImpact,
    PointMass2D,
    Polynomial,
    Ramp,
    RigidBody2D,
    Segment2D,
    Simulation,
    Sine,
    SpringDamper2D,
    simulate,
)
from tlismni.core.state.modes import ACTIVE, OPEN


def resting(*forces, speed=0.0, friction=BRISTLES, **parts):
    """A block in static equilibrium on the floor."""
    block = PointMass2D(name="block", mass=MASS, position=(1.0, -NORMAL / STIFFNESS), velocity=(speed, 0.0))
    floor = DiskOnHalfPlane2D(
        name="c", plane=HalfPlane2D(), disk=Disk2D(marker=on("block")), law=LAW, friction=friction
    )
    bodies = [block, *parts.pop("bodies", [])]
    return Model(bodies=bodies, contacts=[floor], forces=forces, gravity=(0.0, -G), **parts)


def pull(signal):
    return AppliedForce2D(name="pull", marker=on("block"), force_x=signal)


def friction(z, v):
    """(z', F) of the equations as published."""
    g = NORMAL * (MU + (STATIC - MU) * math.exp(-((v / STRIBECK) ** 2)))
    rate = v - S0 * abs(v) * z / g
    return rate, -(S0 * z + S1 * rate + S2 * v)


def block(force, times, max_step=np.inf):
    """Reference (x, v, z) at `times` of the block under force(t, x, v)."""

    def rhs(t, y):
        rate, rub = friction(y[2], y[1])
        return [y[1], (force(t, y[0], y[1]) + rub) / MASS, rate]

    found = solve_ivp(rhs, (0.0, times[-1]), [1.0, 0.0, 0.0], "Radau", times, rtol=1e-10, atol=1e-13, max_step=max_step)
    assert found.success
    return found.y


@pytest.mark.sampled(1)
@pytest.mark.parametrize("method", ["ebdf", "bdf", "irk"])
def test_break_away_under_a_growing_force(method):
    """It is held by a spring s0, breaks away below the static friction, and slides on with the kinetic one."""
    rate, times = 5.0, np.linspace(0.0, 3.0, 121)
    result = simulate(
        resting(pull(Ramp(start=0.0, duration=10.0, before=0.0, after=10.0 * rate))), 3.0, method, t_eval=times, **TIGHT
    )
    x, v, z = block(lambda t, x, v: rate * t, times)
    assert result["block.x"] == pytest.approx(x, abs=2e-6)
    assert result["block.vx"] == pytest.approx(v, abs=2e-6)
    assert result["c.bristle"] == pytest.approx(z, abs=1e-8)
    held = (times > 0.2) & (times < 0.8)
    # pre-sliding, with what it loses to creep: z' = v (1 - s0 z/g)
    load = rate * times[held]
    creep = -STATIC * NORMAL / S0 * np.log(1.0 - load / (STATIC * NORMAL))
    assert result["block.x"][held] - 1.0 == pytest.approx(creep, rel=5e-2)
    broken = float(times[int(np.argmax(v > STRIBECK))]) * rate
    assert 0.85 * STATIC * NORMAL < broken < 1.05 * STATIC * NORMAL
    assert np.abs(result["energy.balance"]).max() < 1e-6


def test_small_oscillations_feel_the_bristles_stiffness():
    """A load that slowly swings by 1 % of the break-away force moves it as a spring of stiffness s0 would."""
    amplitude, w = 0.01 * STATIC * NORMAL, 2.0 * math.pi
    result = simulate(resting(pull(Sine(amplitude=amplitude, angular_frequency=w))), 3.0, **TIGHT)
    late = result.t > 1.0
    moved = result["block.x"][late] - 1.0
    assert np.abs(moved - moved.mean()).max() == pytest.approx(amplitude / S0, rel=2e-2)


@pytest.mark.parametrize("speed", [0.002, 0.01, 0.05, 0.5, -0.05])
def test_steady_sliding_lies_on_the_stribeck_curve(speed):
    """Driven at constant speed: F = -(mu(v) F_n sgn v + s2 v), s0 z = mu(v) F_n sgn v."""
    driver = CoordinateDriver(name="drive", body="block", coordinate="x", motion=Polynomial(coefficients=(1.0, speed)))
    way = 12.0 * STATIC * NORMAL / S0  # the bristles bend to 1 - e^-12 of their steady state
    result = simulate(resting(speed=speed, joints=[driver]), way / abs(speed), **TIGHT)
    g = math.copysign(NORMAL * (MU + (STATIC - MU) * math.exp(-((speed / STRIBECK) ** 2))), speed)
    assert result["c.friction_force"][-1] == pytest.approx(-(g + S2 * speed), rel=1e-4)
    assert result["c.bristle"][-1] == pytest.approx(g / S0, rel=1e-4)
    assert np.abs(result["c.bristle"]).max() <= STATIC * NORMAL / S0 * (1.0 + 1e-6)
    assert np.abs(result["energy.balance"]).max() < 1e-7


def test_stick_slip():
    """Pulled through a spring by something slow: it sticks and slips in turn, with the period of the reference."""
    speed, k, length = 0.02, 200.0, 0.5
    pulled = Polynomial(coefficients=(1.0 + length, speed))
    model = resting(
        SpringDamper2D(name="spring", a=on("block"), b=on("hand"), stiffness=k, damping=0.0, natural_length=length),
        bodies=[
            PointMass2D(name="hand", mass=1.0, position=(1.0 + length, -NORMAL / STIFFNESS), velocity=(speed, 0.0))
        ],
        joints=[
            CoordinateDriver(name="pull", body="hand", coordinate="x", motion=pulled),
            CoordinateDriver(
                name="level", body="hand", coordinate="y", motion=Polynomial(coefficients=(-NORMAL / STIFFNESS,))
            ),
        ],
    )
    times = np.linspace(0.0, 8.0, 801)
    result = simulate(model, 8.0, t_eval=times, **TIGHT)
    x, _, z = block(lambda t, x, v: k * (1.0 + speed * t - x), times, 1e-2)
    assert result["block.x"] == pytest.approx(x, abs=1e-5)
    assert result["c.bristle"] == pytest.approx(z, abs=1e-6)
    sliding = result["block.vx"] > 2.0 * speed
    slips = np.flatnonzero(np.diff(sliding.astype(int)) == 1)
    assert len(slips) >= 2 and np.mean(result["block.vx"] < 0.1 * speed) > 0.6
    force = -result["c.friction_force"]
    assert 0.85 * STATIC * NORMAL < force.max() < 1.05 * STATIC * NORMAL
    assert np.abs(result["energy.balance"]).max() < 1e-6


def test_bristles_stand_straight_while_the_contact_is_open():
    """A thrown ball that bounces and rubs: deflection zero in the air, and the ledger knows what is let go."""
    ball = RigidBody2D(name="ball", mass=MASS, inertia=0.02, position=(0.0, 0.3), velocity=(1.0, 0.0))
    floor = DiskOnHalfPlane2D(
        name="c", plane=HalfPlane2D(), disk=Disk2D(marker=on("ball"), radius=0.15), law=LAW, friction=BRISTLES
    )
    model = Model(bodies=[ball], contacts=[floor], gravity=(0.0, -G))
    result = simulate(model, 1.0, **TIGHT)
    assert len(events(result, "open")) >= 2
    air = result["c.in_contact"] == 0.0
    touch = np.array([event.t for event in result.events])
    away = air & (np.abs(result.t[:, None] - touch).min(axis=1) > 1e-9)
    assert away.any() and np.all(result["c.bristle"][away] == 0.0)
    assert np.abs(result["c.bristle"]).max() > 1e-5
    assert np.abs(result["energy.balance"]).max() < 1e-6


SLOPE = 0.2


@pytest.mark.parametrize("kind", ["plane", "segment", "line"])
def test_wheel_rolls_down_a_slope(kind):
    """Held by its bristles it rolls: x'' = 2/3 g sin(slope), whatever the slope is made of."""
    radius = 0.2
    normal = MASS * G * math.cos(SLOPE)
    height = radius - normal / STIFFNESS
    c, s = math.cos(SLOPE), math.sin(SLOPE)
    wheel = RigidBody2D(
        name="wheel", mass=MASS, inertia=0.5 * MASS * radius**2, position=(0.2 * c + s * height, -0.2 * s + c * height)
    )
    disk, law = Disk2D(marker=on("wheel"), radius=radius), {"law": LAW, "friction": BRISTLES}
    along = Marker2D(angle=-SLOPE)
    contact = {
        "plane": lambda: DiskOnHalfPlane2D(name="c", plane=HalfPlane2D(marker=along), disk=disk, **law),
        "segment": lambda: DiskOnSegment2D(name="c", segment=Segment2D(marker=along, length=3.0), disk=disk, **law),
        "line": lambda: DiskOnLine2D(
            name="c", disk=disk, **law,
            line=Line2D(nodes=tuple(Marker2D(point=(u * c, -u * s)) for u in (0.0, 0.7, 1.1, 3.0))),
        ),
    }[kind]()  # fmt: skip
    result = simulate(Model(bodies=[wheel], contacts=[contact], gravity=(0.0, -G)), 1.0, rtol=1e-8, atol=1e-11)
    moved = (result["wheel.x"] - result["wheel.x"][0]) / c
    assert moved == pytest.approx(G * s / 3.0 * result.t**2, abs=2e-3)
    assert moved[-1] > 0.6
    assert np.abs(result["energy.balance"]).max() < 1e-7


def test_state_goes_on_bit_for_bit():
    model = resting(pull(Ramp(start=0.0, duration=10.0, before=0.0, after=50.0)))
    run = Simulation(model)
    run.advance(1.5)
    state = run.state()
    run.advance(2.5)
    again = Simulation(model)
    again.restore(state)
    again.advance(2.5)
    assert np.array_equal(run.values(), again.values())


# ---- derivatives ----------------------------------------------------------------------------------------------------

SOFT = LuGreFriction(
    coefficient=0.4, static_coefficient=0.6, stribeck_speed=0.5, bristle_stiffness=0.3, bristle_damping=0.2,
    viscous_damping=0.1,
)  # fmt: skip
A, B = RigidBody2D(name="a", mass=1.3, inertia=0.4), RigidBody2D(name="b", mass=0.7, inertia=0.2, position=(0.0, 1.0))
HARD = KelvinVoigt(stiffness=60.0, damping=0.1)
CONTACTS = {
    "plane": DiskOnHalfPlane2D(
        name="c", plane=HalfPlane2D(marker=on("a", 0.3, -0.2, 0.4)), disk=Disk2D(marker=on("b", -0.4, 0.1), radius=1.8),
        law=HARD, friction=SOFT,
    ),
    "disks": DiskOnDisk2D(
        name="c", a=Disk2D(marker=on("a", 0.3, -0.2), radius=0.9), b=Disk2D(marker=on("b", -0.4, 0.1), radius=0.9),
        law=HARD, friction=SOFT,
    ),
    "coordinates": CoordinateContact(
        name="c", offset=-1.6,
        terms=(CoordinateTerm(body="b", coordinate="y"), CoordinateTerm(body="a", coordinate="x")),
        slide=(CoordinateTerm(body="b", coordinate="x"), CoordinateTerm(body="b", coordinate="angle", factor=0.3)),
        law=HARD, friction=SOFT,
    ),
}  # fmt: skip


@pytest.mark.parametrize("mode", [OPEN, ACTIVE])
@pytest.mark.parametrize("kind", CONTACTS)
def test_derivatives(kind, mode):
    point = ContactPoint(Model(bodies=[A, B], contacts=[CONTACTS[kind]]), mode)
    q = np.array([0.1, -0.1, 0.2, 0.2, 1.1, -0.3])
    for seed in range(3):
        state = state_at(point, q, seed)
        check_derivatives(point, state, distances=slice(1))
        if mode == ACTIVE:
            assert point.at(*state)[1][0] < 0.0 and point.workspace.arrays["monitor"][1] != 0.0


# ---- the record -----------------------------------------------------------------------------------------------------


def test_names_and_sizes():
    model = resting()
    assembly = model.assemble()
    assert assembly.coordinate_names == ["block.x", "block.y", "c.bristle"]
    assert assembly.n_internal == 1 and np.array_equal(assembly.is_internal, [False, False, True])
    assert np.isinf(assembly.leap[2])
    assert "c.bristle" in simulate(model, 0.01).channels


def test_json_round_trip():
    assert Model.from_json(resting().to_json()) == resting()


def test_constraint_contacts_want_coulomb():
    with pytest.raises(ModelError, match="friction 'LuGre' is regularised and belongs to a force law"):
        DiskOnHalfPlane2D(
            name="c", plane=HalfPlane2D(), disk=Disk2D(marker=on("block")), law=NewtonImpact(restitution=0.0),
            friction=BRISTLES,
        )  # fmt: skip
