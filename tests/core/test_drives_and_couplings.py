"""Springs, dampers, friction, motors, servos, racks, belts and relations against closed forms."""

import math

import numpy as np
import pytest
from helpers import GROUND, G, on, residuals, rod_pendulum
from scipy.integrate import quad
from tlismni.core import (
    AppliedTorque2D,
    Belt2D,
    Constant,
    CoordinateRelation,
    Model,
    ModelError,
    PointMass2D,
    Polynomial,
    Prismatic2D,
    Rack2D,
    RelationTerm,
    RelativeMotor2D,
    Revolute2D,
    RevoluteFriction2D,
    RigidBody2D,
    Servo2D,
    Sine,
    SlideFriction2D,
    SlideSpring2D,
    SpringDamper2D,
    TableSpring2D,
    TorsionSpring2D,
    simulate,
)
from tlismni.core.analysis import eigenmodes, static_equilibrium

TIGHT = {"rtol": 1e-10, "atol": 1e-12}


def rotor(name="rotor", inertia=0.5, x=0.0, **start):
    """A wheel on a pin of the ground."""
    wheel = RigidBody2D(name=name, mass=1.0, inertia=inertia, position=(x, 0.0), **start)
    return wheel, Revolute2D(name=f"{name}_pin", a=on("ground", x), b=on(name))


def slider(**start):
    """A body of 2 kg on the ground's x axis."""
    body = RigidBody2D(name="slider", mass=2.0, inertia=1.0, **start)
    return body, Prismatic2D(name="guide", a=GROUND, b=on("slider"))


@pytest.mark.parametrize("ratio", [0.0, 0.1])
def test_a_torsion_spring_swings_a_rotor(ratio):
    k, inertia = 8.0, 0.5
    omega = math.sqrt(k / inertia)
    wheel, pin = rotor(angle=1.0)
    spring = TorsionSpring2D(
        name="s", a=GROUND, b=on("rotor"), stiffness=k, damping=2.0 * ratio * math.sqrt(k * inertia), natural_angle=0.2
    )
    result = simulate(Model(bodies=[wheel], joints=[pin], forces=[spring]), 2.0, **TIGHT)
    t, damped = result.t, omega * math.sqrt(1.0 - ratio**2)
    expected = 0.2 + 0.8 * np.exp(-ratio * omega * t) * (
        np.cos(damped * t) + ratio * omega / damped * np.sin(damped * t)
    )
    assert result["rotor.angle"] == pytest.approx(expected, abs=1e-7)
    assert np.abs(result["energy.balance"]).max() < 1e-8


def test_damping_alone_stops_a_joint_exponentially():
    wheel, pin = rotor(angular_velocity=3.0)
    damper = TorsionSpring2D(name="d", a=GROUND, b=on("rotor"), damping=0.7)
    result = simulate(Model(bodies=[wheel], joints=[pin], forces=[damper]), 1.0, **TIGHT)
    assert result["rotor.angular_velocity"] == pytest.approx(3.0 * np.exp(-0.7 / 0.5 * result.t), abs=1e-7)


def test_a_slide_spring_passes_through_zero_length():
    body, guide = slider(position=(0.4, 0.0))
    spring = SlideSpring2D(name="s", a=GROUND, b=on("slider"), stiffness=50.0)
    result = simulate(Model(gravity=(0.0, 0.0), bodies=[body], joints=[guide], forces=[spring]), 2.0, **TIGHT)
    assert result["slider.x"] == pytest.approx(0.4 * np.cos(5.0 * result.t), abs=1e-7)


def test_a_spring_of_no_natural_length_is_a_harmonic_centre():
    """k d towards a point: an ellipse about it, x and y each with sqrt(k/m)."""
    mass = PointMass2D(name="p", mass=2.0, position=(1.0, 0.0), velocity=(0.0, 1.5))
    spring = SpringDamper2D(name="s", a=GROUND, b=on("p"), stiffness=50.0, natural_length=0.0)
    result = simulate(Model(gravity=(0.0, 0.0), bodies=[mass], forces=[spring]), 2.0, **TIGHT)
    assert result["p.x"] == pytest.approx(np.cos(5.0 * result.t), abs=1e-7)
    assert result["p.y"] == pytest.approx(0.3 * np.sin(5.0 * result.t), abs=1e-7)


def test_dry_friction_brings_a_slider_to_rest_after_its_way():
    """v^2/(2 F/m): the way of a sliding body; and what is lost is what it had."""
    body, guide = slider(velocity=(2.0, 0.0))
    rub = SlideFriction2D(name="f", a=GROUND, b=on("slider"), force=6.0, transition_speed=1e-3)
    result = simulate(Model(gravity=(0.0, 0.0), bodies=[body], joints=[guide], forces=[rub]), 1.0, rtol=1e-8)
    assert result["slider.x"][-1] == pytest.approx(4.0 / 6.0, rel=2e-3)
    assert result["energy.dissipation"][-1] == pytest.approx(4.0, rel=1e-6)


def test_dry_friction_holds_a_torque_below_its_own_but_for_a_creep():
    """tanh(w/w0) = T/T0, exactly, once it creeps."""
    wheel, pin = rotor()
    rub = RevoluteFriction2D(name="f", a=GROUND, b=on("rotor"), torque=2.0, transition_rate=1e-3)
    load = AppliedTorque2D(name="load", body="rotor", torque=Constant(value=1.2))
    result = simulate(Model(bodies=[wheel], joints=[pin], forces=[rub, load]), 1.0, rtol=1e-9)
    assert result["rotor.angular_velocity"][-1] == pytest.approx(1e-3 * math.atanh(0.6), rel=1e-6)


def test_a_table_that_is_a_line_is_a_spring_and_one_that_is_a_cubic_keeps_its_energy():
    lengths = np.linspace(0.5, 2.0, 7)
    start = PointMass2D(name="p", mass=1.0, position=(1.3, 0.0), velocity=(0.0, 0.8))
    table = TableSpring2D(
        name="s", a=GROUND, b=on("p"), lengths_table=tuple(lengths), forces=tuple(40.0 * (lengths - 1.0)), damping=0.3
    )
    plain = SpringDamper2D(name="s", a=GROUND, b=on("p"), stiffness=40.0, natural_length=1.0, damping=0.3)
    ends = [simulate(Model(bodies=[start], forces=[s]), 1.5, **TIGHT).q[-1] for s in (table, plain)]
    assert ends[0] == pytest.approx(ends[1], abs=1e-7)

    def force(length):
        return 20.0 * (length - 1.0) + 90.0 * (length - 1.0) ** 3

    cubic = TableSpring2D(name="s", a=GROUND, b=on("p"), lengths_table=tuple(lengths), forces=tuple(force(lengths)))
    result = simulate(Model(bodies=[start], forces=[cubic]), 1.5, **TIGHT)
    assert np.abs(result["energy.balance"]).max() < 1e-7
    far = np.hypot(result["p.x"][-1], result["p.y"][-1])
    stored = result["energy.strain"][-1] - result["energy.strain"][0]
    assert stored == pytest.approx(quad(force, 1.3, far)[0], abs=1e-7)


def test_frequency_on_a_table_spring_follows_its_slope():
    lengths = np.array([0.5, 1.0, 1.5, 2.0])
    mass = PointMass2D(name="p", mass=2.0, position=(0.0, -1.0))
    forces = 5.0 * (lengths - 0.5) ** 2
    spring = TableSpring2D(name="s", a=GROUND, b=on("p"), lengths_table=tuple(lengths), forces=tuple(forces))
    rest = static_equilibrium(Model(bodies=[mass], forces=[spring]))
    length = 0.5 + math.sqrt(2.0 * G / 5.0)
    assert rest["p.y"] == pytest.approx(-length, rel=1e-9)
    modes = eigenmodes(rest)
    assert np.max(2.0 * math.pi * modes.frequencies) == pytest.approx(math.sqrt(10.0 * (length - 0.5) / 2.0), rel=1e-8)


def test_a_motor_between_two_rotors_turns_them_against_each_other():
    """phi = t^2: the torque is that of the reduced inertia, and the angular momentum stays zero."""
    first, pin = rotor(inertia=0.5)
    second, other = rotor("second", inertia=0.3)
    motor = RelativeMotor2D(name="m", a=on("rotor"), b=on("second"), motion=Polynomial(coefficients=(0.0, 0.0, 1.0)))
    result = simulate(Model(bodies=[first, second], joints=[pin, other, motor]), 1.0, **TIGHT)
    reduced = 0.5 * 0.3 / 0.8
    assert result["m.torque"] == pytest.approx(np.full(len(result), -2.0 * reduced), rel=1e-8)
    assert 0.5 * result["rotor.angular_velocity"] == pytest.approx(-0.3 * result["second.angular_velocity"], abs=1e-9)
    assert result["second.angle"] - result["rotor.angle"] == pytest.approx(result.t**2, abs=1e-9)
    assert np.abs(result["energy.balance"]).max() < 1e-8
    assert max(residuals(result)) < 1e-9


@pytest.mark.parametrize("measure", ["slide", "distance"])
def test_a_cylinder_lifts_a_weight(measure):
    """m (g + f'') is its force; the work put in is m g h and m v^2/2."""
    body = RigidBody2D(name="w", mass=3.0, inertia=1.0, position=(0.0, 1.0))
    motion = Polynomial(coefficients=(1.0, 0.0, 0.5))
    upright = on("ground", 0.0, 0.0, 0.5 * math.pi)
    lift = RelativeMotor2D(name="m", a=upright, b=on("w"), motion=motion, measure=measure)
    guide = Prismatic2D(name="g", a=upright, b=on("w", angle=0.5 * math.pi))
    result = simulate(Model(bodies=[body], joints=[guide, lift]), 1.0, **TIGHT)
    assert result["m.force"] == pytest.approx(np.full(len(result), -3.0 * (G + 1.0)), rel=1e-9)
    assert result["energy.input_work"][-1] == pytest.approx(3.0 * (G * 0.5 + 0.5), rel=1e-8)


def test_a_position_servo_is_a_spring_to_a_moving_end():
    """Response of k, c, I to a sinusoidal target, after the free part has gone."""
    wheel, pin = rotor()
    servo = Servo2D(
        name="s", a=GROUND, b=on("rotor"), target=Sine(amplitude=0.3, angular_frequency=4.0), gain=20.0, rate_gain=3.0
    )
    result = simulate(
        Model(bodies=[wheel], joints=[pin], forces=[servo]), 12.0, t_eval=np.linspace(10, 12, 50), **TIGHT
    )
    s = 4.0j
    response = 0.3 * (20.0 + 3.0 * s) / (0.5 * s * s + 3.0 * s + 20.0)
    assert result["rotor.angle"] == pytest.approx((response * np.exp(s * result.t)).imag, abs=1e-7)
    assert np.abs(result["energy.balance"]).max() < 1e-6


def test_a_velocity_servo_approaches_its_rate():
    body, guide = slider()
    servo = Servo2D(
        name="s", a=GROUND, b=on("slider"), target=Constant(value=1.5), measure="slide", rate_gain=4.0, of_rate=True
    )
    result = simulate(Model(gravity=(0.0, 0.0), bodies=[body], joints=[guide], forces=[servo]), 2.0, **TIGHT)
    assert result["slider.vx"] == pytest.approx(1.5 * (1.0 - np.exp(-2.0 * result.t)), abs=1e-8)


def test_a_servo_that_saturates_pushes_with_its_largest_force():
    """Far from its target the force is the largest one: uniform acceleration; near it the servo is what it was."""
    body, guide = slider()
    servo = Servo2D(
        name="s", a=GROUND, b=on("slider"), target=Constant(value=50.0), measure="slide", gain=40.0, rate_gain=60.0,
        largest=6.0,
    )  # fmt: skip
    model = Model(gravity=(0.0, 0.0), bodies=[body], joints=[guide], forces=[servo])
    result = simulate(model, 40.0, **TIGHT)
    early = result.t < 1.0
    assert result["slider.x"][early] == pytest.approx(0.5 * 6.0 / body.mass * result.t[early] ** 2, abs=1e-9)
    assert np.abs(result["slider.ax"]).max() <= 6.0 / body.mass * (1.0 + 1e-12)
    assert result["slider.x"][-1] == pytest.approx(50.0, abs=1e-6)
    assert np.abs(result["energy.balance"]).max() < 1e-6


@pytest.mark.parametrize("radius", [0.2, -0.2])
def test_a_rack_drives_a_wheel(radius):
    """Wheel fixed, rack free, torque T: the rack's acceleration is T r/(I + m r^2), and the teeth carry m times it."""
    wheel, pin = rotor(inertia=0.05)
    bar = RigidBody2D(name="rack", mass=2.0, inertia=1.0, position=(0.3, -radius))
    guide = Prismatic2D(name="g", a=on("ground", 0.0, -radius), b=on("rack"))
    mesh = Rack2D(name="mesh", a=on("rotor"), b=on("rack"), radius=radius)
    load = AppliedTorque2D(name="t", body="rotor", torque=Constant(value=0.7))
    model = Model(gravity=(0.0, 0.0), bodies=[wheel, bar], joints=[pin, guide, mesh], forces=[load])
    result = simulate(model, 1.0, **TIGHT)
    acceleration = 0.7 * radius / (0.05 + 2.0 * radius**2)
    assert result["rack.x"] == pytest.approx(0.3 + 0.5 * acceleration * result.t**2, abs=1e-8)
    assert result["rack.x"] - 0.3 == pytest.approx(radius * result["rotor.angle"], abs=1e-9)
    assert np.abs(result["mesh.tooth_force"]) == pytest.approx(np.full(len(result), abs(2.0 * acceleration)), rel=1e-8)


@pytest.mark.parametrize("crossed", [False, True])
def test_a_belt_turns_two_pulleys(crossed):
    """omega_a r_a = +-omega_b r_b, through several turns; the inertia that a feels is I_a + I_b (r_a/r_b)^2."""
    first, pin = rotor(inertia=0.2)
    second, other = rotor("second", inertia=0.1, x=1.0, angle=0.4)
    belt = Belt2D(name="belt", a=on("rotor"), b=on("second"), radius_a=0.3, radius_b=0.1, crossed=crossed)
    load = AppliedTorque2D(name="t", body="rotor", torque=Constant(value=2.2))
    result = simulate(Model(bodies=[first, second], joints=[pin, other, belt], forces=[load]), 4.0, **TIGHT)
    acceleration, sign = 2.2 / (0.2 + 0.1 * 9.0), -1.0 if crossed else 1.0
    assert result["rotor.angle"] == pytest.approx(0.5 * acceleration * result.t**2, abs=1e-7)
    assert result["second.angle"] == pytest.approx(0.4 + 3.0 * sign * result["rotor.angle"], abs=1e-7)
    assert abs(result["belt.belt_force"][-1]) == pytest.approx(0.1 * 3.0 * acceleration / 0.1, rel=1e-7)
    assert result["rotor.angle"][-1] > 2.0 * math.pi


def test_a_relation_couples_a_slider_and_a_rotor_as_a_screw():
    """x - p angle = 0: acceleration of the slider under its weight component, m g/(m + I/p^2)."""
    body, _ = slider()
    guide = Prismatic2D(name="guide", a=on("ground", angle=0.5 * math.pi), b=on("slider", angle=0.5 * math.pi))
    wheel, pin = rotor(inertia=0.02)
    pitch = 0.1
    screw = CoordinateRelation(
        name="screw",
        terms=[
            RelationTerm(body="slider", coordinate="y"),
            RelationTerm(body="rotor", coordinate="angle", factor=-pitch),
        ],
    )
    result = simulate(Model(bodies=[body, wheel], joints=[guide, pin, screw]), 1.0, **TIGHT)
    acceleration = 2.0 * G / (2.0 + 0.02 / pitch**2)
    assert result["slider.y"] == pytest.approx(-0.5 * acceleration * result.t**2, abs=1e-8)
    assert result["screw.multiplier"] == pytest.approx(np.full(len(result), -2.0 * (G - acceleration)), rel=1e-8)


def test_refusals():
    ends = {"a": GROUND, "b": on("rod", -0.5)}
    for made, said in (
        (lambda: Servo2D(name="s", **ends, target=Constant(value=0.0)), "neither gain nor rate_gain"),
        (
            lambda: Servo2D(name="s", **ends, target=Constant(value=0.0), gain=1.0, of_rate=True),
            "leave one of them out",
        ),
        (lambda: Rack2D(name="r", **ends, radius=0.0), "does not roll"),
        (lambda: Belt2D(name="b", a=on("rod"), b=on("rod"), radius_a=1.0, radius_b=1.0), "give it two bodies"),
        (lambda: TableSpring2D(name="s", **ends, lengths_table=(1, 2, 3, 3), forces=(1, 2, 3, 4)), "grow strictly"),
        (
            lambda: CoordinateRelation(name="r", terms=[RelationTerm(body="a", coordinate="x")] * 2),
            "names a coordinate",
        ),
    ):
        with pytest.raises(ModelError, match=said):
            made()
    model = rod_pendulum(0.0)
    lost = CoordinateRelation(name="r", terms=[RelationTerm(body="rod", coordinate="z")])
    with pytest.raises(ModelError, match="coordinate 'z' of 'rod'"):
        Model(bodies=model.bodies, joints=[*model.joints, lost])


def test_model_files_hold_them(tmp_path):
    wheel, pin = rotor()
    servo = Servo2D(name="s", a=GROUND, b=on("rotor"), target=Constant(value=0.3), gain=2.0)
    model = Model(bodies=[wheel], joints=[pin], forces=[servo])
    model.save(tmp_path / "model.json")
    assert Model.load(tmp_path / "model.json") == model
