"""Actuators, servos, controllers, springs with tables and joint friction in space: as the planar ones, lifted; the
ledger of energy."""

import math

import numpy as np
import pytest
from tlismni.core import (
    Axes,
    Bushing3D,
    ConsistencyError,
    Input,
    InputSignal,
    Marker2D,
    Marker3D,
    Model,
    ModelError,
    PIDController2D,
    PIDController3D,
    PointMass2D,
    PointMass3D,
    Prismatic2D,
    Prismatic3D,
    RelativeLoad2D,
    RelativeLoad3D,
    Revolute2D,
    Revolute3D,
    RevoluteFriction2D,
    RevoluteFriction3D,
    RigidBody2D,
    RigidBody3D,
    RotationVector,
    Servo2D,
    Servo3D,
    Simulation,
    Sine,
    SlideFriction2D,
    SlideFriction3D,
    SpringDamper2D,
    SpringDamper3D,
    TableSpring2D,
    TableSpring3D,
    simulate,
)

TIGHT = {"rtol": 1e-11, "atol": 1e-13}
SINE = Sine(amplitude=0.7, angular_frequency=2.0, phase=0.3, offset=0.2)
SLOW = Sine(amplitude=0.2, angular_frequency=2.0, phase=0.3, offset=1.2)
TIMES = np.linspace(0.0, 2.0, 11)
TABLE = {"lengths_table": (0.4, 0.8, 1.2, 1.6, 2.0), "forces": (-6.0, -1.0, 0.5, 2.0, 7.0), "damping": 0.3}
GAINS = {"gain": 20.0, "rate_gain": 3.0}


def turning(flat, solid):
    """A pendulum on a hinge."""
    rod = {"name": "body", "mass": 1.0, "position": (0.5, 0.0)}
    planar = Model(
        bodies=[RigidBody2D(**rod, inertia=0.1)],
        joints=[Revolute2D(name="joint", a=Marker2D(), b=Marker2D(body="body", point=(-0.5, 0.0)))], forces=[flat],
    )  # fmt: skip
    ends = {"a": Marker3D(), "b": Marker3D(body="body", point=(-0.5, 0.0, 0.0))}
    body = RigidBody3D(**{**rod, "position": (0.5, 0.0, 0.0)}, inertia=(0.05, 0.08, 0.1))
    space = Model(gravity=(0.0, -9.81, 0.0), bodies=[body], joints=[Revolute3D(name="joint", **ends)], forces=[solid])
    return planar, space


def sliding(flat, solid):
    """A block on an incline."""
    angle = 0.4
    axis = (math.cos(angle), math.sin(angle))
    place = tuple(0.7 * x for x in axis)
    planar = Model(
        bodies=[RigidBody2D(name="body", mass=1.0, inertia=0.1, position=place, angle=angle)],
        joints=[Prismatic2D(name="joint", a=Marker2D(angle=angle), b=Marker2D(body="body"))], forces=[flat],
    )  # fmt: skip
    turn = Axes(z=(*axis, 0.0), x=(0.0, 0.0, 1.0))
    body = RigidBody3D(name="body", mass=1.0, inertia=(0.1, 0.1, 0.1), position=(*place, 0.0), attitude=turn)
    joint = Prismatic3D(name="joint", a=Marker3D(attitude=turn), b=Marker3D(body="body"))
    return planar, Model(gravity=(0.0, -9.81, 0.0), bodies=[body], joints=[joint], forces=[solid])


def hanging(flat, solid):
    """A mass that swings on what acts along its distance from the origin."""
    planar = Model(
        bodies=[PointMass2D(name="body", mass=1.0, position=(0.6, -0.8), velocity=(1.0, 0.5))], forces=[flat]
    )
    mass = PointMass3D(name="body", mass=1.0, position=(0.6, -0.8, 0.0), velocity=(1.0, 0.5, 0.0))
    return planar, Model(gravity=(0.0, -9.81, 0.0), bodies=[mass], forces=[solid])


ARM = {"a": Marker2D(), "b": Marker2D(body="body", point=(-0.5, 0.0))}, {
    "a": Marker3D(), "b": Marker3D(body="body", point=(-0.5, 0.0, 0.0))
}  # fmt: skip
WAY = {"a": Marker2D(angle=0.4), "b": Marker2D(body="body")}, {
    "a": Marker3D(attitude=Axes(z=(math.cos(0.4), math.sin(0.4), 0.0), x=(0.0, 0.0, 1.0))), "b": Marker3D(body="body")
}  # fmt: skip
LINE = {"a": Marker2D(), "b": Marker2D(body="body")}, {"a": Marker3D(), "b": Marker3D(body="body")}
PLACES = {"angle": (turning, ARM), "slide": (sliding, WAY), "distance": (hanging, LINE)}
KINDS = {
    "servo": (Servo2D, Servo3D, {"target": SLOW, **GAINS}),
    "servo that saturates": (Servo2D, Servo3D, {"target": SLOW, **GAINS, "largest": 4.0}),
    "rate servo": (Servo2D, Servo3D, {"target": SINE, "rate_gain": 8.0, "of_rate": True}),
    "load": (RelativeLoad2D, RelativeLoad3D, {"load": SINE}),
    "controller": (PIDController2D, PIDController3D, {"target": SLOW, **GAINS, "integral_gain": 5.0}),
    "controller that saturates": (
        PIDController2D, PIDController3D, {"target": SLOW, **GAINS, "integral_gain": 5.0, "largest": 12.0}
    ),
}  # fmt: skip
CASES = {f"{what} of {m}": (m, *kinds[:2], {**kinds[2], "measure": m}) for what, kinds in KINDS.items() for m in PLACES}
CASES |= {
    "table": ("distance", TableSpring2D, TableSpring3D, TABLE),
    "spring whose length moves": (
        "distance", SpringDamper2D, SpringDamper3D, {"stiffness": 50.0, "damping": 0.4, "natural_length": SLOW}
    ),
    "friction of a hinge": (
        "angle", RevoluteFriction2D, RevoluteFriction3D, {"torque": 0.8, "transition_rate": 0.5}
    ),
    "friction of a slide": (
        "slide", SlideFriction2D, SlideFriction3D, {"force": 1.5, "transition_speed": 0.5}
    ),
}  # fmt: skip


@pytest.mark.parametrize("case", CASES)
def test_it_moves_as_in_the_plane_and_its_energy_balances(case):
    measure, flat, solid, fields = CASES[case]
    build, (planar_ends, ends) = PLACES[measure]
    planar, space = build(flat(name="act", **planar_ends, **fields), solid(name="act", **ends, **fields))
    one, other = (simulate(m, 2.0, t_eval=TIMES, **TIGHT) for m in (planar, space))
    for name in ("x", "y", "vx", "vy"):
        assert other[f"body.{name}"] == pytest.approx(one[f"body.{name}"], abs=1e-8)
    for name in ("balance", "dissipation", "input_work", "strain"):
        assert other[f"energy.{name}"] == pytest.approx(one[f"energy.{name}"], abs=1e-7)
    assert np.abs(other["energy.balance"]).max() < 1e-8
    if "controller" in case:
        assert other.v[:, -1] == pytest.approx(one.v[:, -1], abs=1e-7)  # the integral


@pytest.mark.parametrize("measure", ["angle", "slide"])
def test_a_table_about_or_along_an_axis_holds_the_energy_of_its_force(measure):
    build, (planar_ends, ends) = PLACES[measure]
    table = TableSpring3D(name="act", **ends, measure=measure, **{**TABLE, "damping": 0.0})
    still = RelativeLoad2D(name="act", **planar_ends, measure=measure, load=SINE)
    _, space = build(still, table)
    result = simulate(space, 1.0, **TIGHT)
    assert np.abs(result["energy.balance"]).max() < 1e-8 and np.ptp(result["energy.strain"]) > 0.1


def test_turns_are_counted_by_a_table():
    """A constant torque against the angle, over two turns and more."""
    body = RigidBody3D(name="body", mass=1.0, inertia=(1.0, 1.0, 0.5), angular_velocity=(0.0, 0.0, 10.0))
    ends = {"a": Marker3D(), "b": Marker3D(body="body")}
    table = TableSpring3D(
        name="act", **ends, measure="angle", lengths_table=(0.0, 5.0, 10.0, 20.0), forces=(0.0, 2.5, 5.0, 10.0)
    )
    model = Model(gravity=(0.0,) * 3, bodies=[body], joints=[Revolute3D(name="joint", **ends)], forces=[table])
    result = simulate(model, 3.0, t_eval=np.linspace(0.0, 3.0, 31), **TIGHT)
    # the table is a line: torque 0.5 angle
    assert result["joint.angle"] == pytest.approx(10.0 * np.sin(result.t), abs=1e-7)


def test_an_input_moves_a_spring_and_states_go_back():
    mass = PointMass3D(name="body", mass=1.0, position=(0.0, 0.0, -1.0))
    spring = SpringDamper3D(
        name="spring", a=Marker3D(), b=Marker3D(body="body"), stiffness=100.0, damping=2.0,
        natural_length=InputSignal(channel="length"),
    )  # fmt: skip
    model = Model(
        gravity=(0.0, 0.0, 0.0), bodies=[mass], forces=[spring], inputs=[Input(name="length", unit="m", start=1.0)]
    )
    again = Model.from_json(model.to_json())
    sim = Simulation(again)
    sim.set_inputs({"length": 1.3})
    sim.advance(0.2)
    kept = sim.state()
    sim.advance(20.0)
    later = sim.values().copy()
    place = [channel.name for channel in sim.channels].index("body.z")
    assert later[place] == pytest.approx(-1.3, abs=1e-5)
    sim.restore(kept)
    sim.advance(20.0)
    assert np.array_equal(sim.values(), later)


def test_a_bushing_keeps_energy_through_many_turns():
    """Coupled stiffness, turns and displacements, and a body that goes round and round."""
    stiffness = np.diag([3.0, 2.0, 4.0, 1.0, 1.0, 1.0])
    stiffness[0, 5] = stiffness[5, 0] = 0.5
    stiffness[1, 3] = stiffness[3, 1] = 0.3
    body = RigidBody3D(name="body", mass=1.0, inertia=(1.0, 1.0, 1.0), angular_velocity=(0.0, 0.0, 8.0))
    for attitude in (RotationVector(vector=(0.0, 0.0, 0.3)), RotationVector(vector=(0.0, 0.0, 2.0 * math.pi + 0.3))):
        bushing = Bushing3D(
            name="bushing", a=Marker3D(), b=Marker3D(body="body", point=(0.1, 0.0, 0.0), attitude=attitude),
            stiffness=tuple(map(tuple, stiffness.tolist())),
        )  # fmt: skip
        result = simulate(Model(gravity=(0.0,) * 3, bodies=[body], forces=[bushing]), 3.0, **TIGHT)
        assert np.abs(result["energy.balance"]).max() < 1e-7
        assert result["energy.strain"][0] == pytest.approx(_strain(stiffness, 0.3), abs=1e-12)


def _strain(stiffness, angle):
    z = np.array([0.1, 0.0, 0.0, 0.0, 0.0, 2.0 * math.sin(0.5 * angle)])
    return 0.5 * z @ stiffness @ z


@pytest.mark.parametrize(
    "make, words",
    [
        (lambda ends: Servo3D(name="s", **ends, target=SINE), "neither gain nor rate_gain"),
        (lambda ends: Servo3D(name="s", **ends, target=SINE, gain=1.0, of_rate=True), "leave one of them out"),
        (lambda ends: PIDController3D(name="s", **ends, target=SINE), "no gain"),
        (lambda ends: PIDController3D(name="s", **ends, target=SINE, gain=1.0, integral_gain=-1.0), "one sign"),
        (lambda ends: PIDController3D(name="s", **ends, target=SINE, gain=1.0, sensor_a=Marker3D()), "both"),
        (
            lambda ends: PIDController3D(
                name="s", **ends, target=SINE, gain=1.0, measure="slide", start_angle=1.0
            ),
            "senses no angle",
        ),
        (lambda ends: TableSpring3D(name="s", **ends, lengths_table=(1, 2, 3, 3), forces=(1, 2, 3, 4)), "strictly"),
        (lambda ends: TableSpring3D(name="s", **ends, lengths_table=(1, 2, 3, 4), forces=(1, 2, 3, 4, 5)), "as many"),
    ],
)  # fmt: skip
def test_records_that_cannot_be(make, words):
    with pytest.raises(ModelError, match=words):
        make({"a": Marker3D(), "b": Marker3D(body="body")})


def test_loads_and_angles_that_do_not_fit():
    body = RigidBody3D(name="body", mass=1.0, inertia=(1.0, 1.0, 1.0))
    both = {"a": Marker3D(body="body"), "b": Marker3D(body="body")}
    with pytest.raises(ModelError, match="would feel nothing"):
        Model(bodies=[body], forces=[RelativeLoad3D(name="s", **both, load=SINE)])
    ends = {"a": Marker3D(), "b": Marker3D(body="body")}
    slide = Servo3D(name="s", **ends, target=SINE, gain=1.0, measure="slide", start_angle=0.0)
    with pytest.raises(ModelError, match="no angle"):
        Model(bodies=[body], forces=[slide])
    with pytest.raises(ConsistencyError, match="no direction"):
        simulate(Model(bodies=[body], forces=[RelativeLoad3D(name="s", **ends, load=SINE, measure="distance")]), 0.1)
