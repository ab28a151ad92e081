"""A user's own joint, forces, contacts and body (`own_parts.py`) in models, runs and model files."""

import math
from typing import Literal

import numpy as np
import pytest
from helpers import G, events, on
from own_parts import CrankRotor, Drag, HardeningSpring, InBowl, OnParabola, WheelOnFloor, height
from scipy.integrate import solve_ivp
from tlismni.core import (
    BrownMcPheeFriction,
    Constant,
    CoordinateLoad,
    CoulombFriction,
    Disk2D,
    DiskOnHalfPlane2D,
    Distance2D,
    HalfPlane2D,
    Hertz,
    HuntCrossley,
    LuGreFriction,
    Marker2D,
    Model,
    ModelError,
    NewtonImpact,
    PointMass2D,
    RigidBody2D,
    ScalarForce2D,
    ScalarJoint2D,
    SpringDamper2D,
    scalar_constraint,
    scalar_force,
    simulate,
)

C = 1.6


def bead(u=0.8, joint=True, **parts):
    """A point mass on the parabola y = C x^2/2."""
    joints = [OnParabola(name="wire", b=on("bead"), curvature=C)] if joint else []
    return Model(bodies=[PointMass2D(name="bead", mass=0.7, position=(u, 0.5 * C * u * u))], joints=joints, **parts)


def reference(u, t):
    """Lagrange's equation of the bead: (1 + C^2 u^2) u'' + C^2 u u'^2 + g C u = 0; t may stay for a while."""

    def rates(_, y):
        return y[1], -(C * C * y[0] * y[1] ** 2 + G * C * y[0]) / (1.0 + (C * y[0]) ** 2)

    times, which = np.unique(t, return_inverse=True)
    return solve_ivp(rates, (0.0, t[-1]), (u, 0.0), t_eval=times, rtol=1e-11, atol=1e-12).y[:, which]


def test_own_joint_guides_as_its_curve_says():
    result = simulate(bead(), 3.0, rtol=1e-9, atol=1e-11)
    u, rate = reference(0.8, result.t)
    assert result["bead.x"] == pytest.approx(u, abs=1e-6)
    assert result["bead.vx"] == pytest.approx(rate, abs=1e-6)
    for level in ("residual.position", "residual.velocity", "residual.acceleration"):
        assert np.abs(result[level]).max() < 1e-8
    # the force of the wire in its normal: m (g + C u'^2)/(1 + C^2 u^2), upwards on the bead
    expected = -0.7 * (G + C * rate**2) / (1.0 + (C * u) ** 2)
    assert result["wire.multiplier"] == pytest.approx(expected, abs=1e-4)
    assert np.abs(result["energy.balance"]).max() < 1e-6


def test_own_contact_that_stays_closed_is_the_joint():
    """Laid into the bowl the contact holds the bead as the wire does."""
    bowl = InBowl(name="bowl", b=on("bead"), curvature=C, law=NewtonImpact(restitution=0.0))
    result = simulate(bead(joint=False, contacts=[bowl]), 2.0, rtol=1e-9, atol=1e-11)
    assert result["bead.x"] == pytest.approx(reference(0.8, result.t)[0], abs=1e-6)
    assert result["bowl.normal_force"][1:].min() > 0.0


def test_own_contact_bounces_along_its_normal():
    ball = PointMass2D(name="bead", mass=0.7, position=(0.5, 1.0))
    bowl = InBowl(name="bowl", b=on("bead"), curvature=C, law=NewtonImpact(restitution=0.6))
    result = simulate(Model(bodies=[ball], contacts=[bowl]), 0.5, rtol=1e-10, atol=1e-12)
    first = events(result, "impact")[0]
    fall = 1.0 - 0.5 * C * 0.25
    assert first.t == pytest.approx(math.sqrt(2.0 * fall / G), rel=1e-12)
    # the normal's share of the speed turns round with e, the tangent's stays
    approach = math.sqrt(2.0 * G * fall) / math.hypot(1.0, C * 0.5)
    assert first.approach_speed == pytest.approx(approach, rel=1e-9)
    assert first.separation_speed == pytest.approx(0.6 * approach, rel=1e-9)
    assert first.energy_loss == pytest.approx(0.5 * 0.7 * approach**2 * (1.0 - 0.36), rel=1e-8)


def test_friction_holds_on_the_slope_that_it_can_and_not_on_a_steeper_one():
    def slid(u):
        bowl = InBowl(
            name="bowl", b=on("bead"), curvature=C, law=NewtonImpact(restitution=0.0),
            friction=CoulombFriction(coefficient=0.5),
        )  # fmt: skip
        return simulate(bead(u, joint=False, contacts=[bowl]), 0.3)["bead.x"][-1] - u

    assert slid(0.49 / C) == pytest.approx(0.0, abs=1e-9)
    assert slid(0.55 / C) < -1e-4


FRICTIONS = {
    "none": (NewtonImpact(restitution=0.5), None),
    "Coulomb": (NewtonImpact(restitution=0.5), CoulombFriction(coefficient=0.3)),
    "regularised": (HuntCrossley(stiffness=1e5, restitution=0.5),
                    BrownMcPheeFriction(coefficient=0.3, static_coefficient=0.4, transition_speed=0.01)),
    "LuGre": (Hertz(stiffness=1e5),
              LuGreFriction(coefficient=0.3, static_coefficient=0.4, stribeck_speed=0.01, bristle_stiffness=1e4,
                            bristle_damping=10.0)),
}  # fmt: skip


@pytest.mark.sampled(1)
@pytest.mark.parametrize("name", FRICTIONS)
def test_wheel_from_two_formulas_is_the_library_s(name):
    """Thrown with spin, it bounces, slides and rolls: the same with all kinds of friction."""
    law, friction = FRICTIONS[name]
    wheel = RigidBody2D(name="wheel", mass=1.0, inertia=0.01, position=(0.0, 0.25), velocity=(1.0, -1.0),
                        angular_velocity=-3.0)  # fmt: skip
    known = DiskOnHalfPlane2D(
        name="floor", plane=HalfPlane2D(), disk=Disk2D(marker=on("wheel"), radius=0.2), law=law, friction=friction
    )
    own = WheelOnFloor(name="floor", b=on("wheel"), radius=0.2, law=law, friction=friction)
    one, other = (simulate(Model(bodies=[wheel], contacts=[c]), 0.8, rtol=1e-8, atol=1e-10) for c in (known, own))
    assert [e.kind for e in one.events] == [e.kind for e in other.events]
    assert len(one.events) >= 2
    assert [e.t for e in one.events] == pytest.approx([e.t for e in other.events], rel=1e-7)
    assert other.q[-1] == pytest.approx(one.q[-1], rel=1e-6)
    assert other.v[-1] == pytest.approx(one.v[-1], rel=1e-5, abs=1e-7)


def test_own_contact_without_sliding_distance_takes_no_friction():
    class Bare(WheelOnFloor):
        formula = type(WheelOnFloor.formula)(WheelOnFloor.formula.gap, None)

    bare = Bare(name="floor", b=on("ball"), radius=0.1, law=NewtonImpact(restitution=0.5),
                friction=CoulombFriction(coefficient=0.3))  # fmt: skip
    with pytest.raises(ModelError, match="says no sliding distance"):
        simulate(Model(bodies=[PointMass2D(name="ball", mass=1.0, position=(0.0, 1.0))], contacts=[bare]), 0.1)


def test_own_force_is_the_library_s_where_they_agree():
    ball = RigidBody2D(name="ball", mass=0.8, inertia=0.1, position=(1.0, 0.3), angular_velocity=2.0)
    settings = {"a": Marker2D(), "b": on("ball", 0.1, 0.05), "natural_length": 0.7, "stiffness": 90.0, "damping": 0.6}
    kinds = SpringDamper2D, HardeningSpring
    one, other = (
        simulate(Model(bodies=[ball], forces=[kind(name="spring", **settings)]), 2.0, rtol=1e-9, atol=1e-11)
        for kind in kinds
    )
    assert other.q[-1] == pytest.approx(one.q[-1], abs=1e-7)
    for account in ("energy.strain", "energy.dissipation"):
        assert other[account][-1] == pytest.approx(one[account][-1], rel=1e-6)


def test_own_force_keeps_its_energy_or_loses_it():
    ball = PointMass2D(name="ball", mass=0.8, position=(1.3, 0.0))
    spring = {"b": on("ball"), "natural_length": 1.0, "stiffness": 20.0, "cubic": 300.0}
    for damping, least in ((0.0, 0.0), (0.8, 0.1)):
        force = HardeningSpring(name="spring", damping=damping, **spring)
        result = simulate(Model(bodies=[ball], forces=[force]), 2.0, "ebdf", rtol=1e-9, atol=1e-11)
        assert np.abs(result["energy.balance"]).max() < 1e-6
        # without damping to rounding of 5 J
        assert result["energy.dissipation"][-1] >= least - 1e-14
        x = np.hypot(result["ball.x"], result["ball.y"]) - 1.0
        assert result["energy.strain"] == pytest.approx(10.0 * x**2 + 75.0 * x**4, abs=1e-8)


def test_force_without_an_energy_dissipates_all_of_its_work():
    class Dashpot(ScalarForce2D):
        formula = scalar_force(lambda a, b: b.y - a.y, lambda x, rate, c: c * rate)
        a: Marker2D = Marker2D()
        b: Marker2D
        c: float

    ball = PointMass2D(name="ball", mass=1.0)
    result = simulate(Model(bodies=[ball], forces=[Dashpot(name="d", b=on("ball"), c=5.0)]), 2.0, rtol=1e-9)
    assert result["ball.vy"] == pytest.approx(-G / 5.0 * (1.0 - np.exp(-5.0 * result.t)), abs=1e-6)
    assert np.abs(result["energy.balance"]).max() < 1e-5


def test_own_kernel_falls_to_its_terminal_speed():
    ball = PointMass2D(name="ball", mass=0.5)
    model = Model(bodies=[ball], forces=[Drag(name="air", marker=on("ball"), coefficient=0.2)])
    result = simulate(model, 3.0, rtol=1e-9, atol=1e-11)
    terminal = math.sqrt(0.5 * G / 0.2)
    assert result["ball.vy"] == pytest.approx(-terminal * np.tanh(G * result.t / terminal), abs=1e-6)
    assert np.abs(result["energy.balance"]).max() < 1e-6


def test_own_body_is_moved_by_a_load_on_its_coordinate():
    crank = CrankRotor(name="crank", mean=0.4, swing=0.15, speed=3.0)
    load = CoordinateLoad(name="motor", body="crank", coordinate="angle", load=Constant(value=0.7))
    result = simulate(Model(bodies=[crank], forces=[load]), 4.0, rtol=1e-9, atol=1e-11)
    # work of the torque goes into J omega^2/2
    angle, speed = result["crank.angle"], result["crank.angular_velocity"]
    inertia = 0.4 + 0.15 * np.cos(angle)
    assert 0.5 * inertia * speed**2 - 0.7 * angle == pytest.approx(np.full_like(angle, 0.5 * 0.55 * 9.0), abs=1e-6)
    assert np.abs(result["energy.balance"]).max() < 1e-6


# what formulas and classes must be


def test_formulas_that_cannot_be_used_are_named():
    def run(formula):
        class Odd(ScalarJoint2D):
            a: Marker2D = Marker2D()
            b: Marker2D
            size: float = 1.0
            word: str = "x"

        Odd.formula = scalar_constraint(formula)
        simulate(Model(bodies=[PointMass2D(name="p", mass=1.0)], joints=[Odd(name="j", b=on("p"))]), 0.1)

    for formula, text in (
        (lambda a, b, sise: b.x, r"argument 'sise', which is none of its fields \[.*'a', 'b', 'size', 'word'\]"),
        (lambda a, b, word: b.x, r"Odd.word = 'x' is no number"),
        (lambda size: size, "no argument that is a Marker2D"),
        (lambda a, b, size: size, "does not depend on where its markers are"),
        (lambda a, b: b.z, "is not usable"),
        (lambda a, b: [b.x, b.y], "is not usable|does not depend"),
    ):
        with pytest.raises(ModelError, match=text):
            run(formula)
    with pytest.raises(ModelError, match="is no formula"):
        scalar_constraint(3.0)
    with pytest.raises(ModelError, match="needed"):
        scalar_force(lambda a, b: b.x, lambda x: x)


def test_own_classes_stand_where_they_belong():
    wire = OnParabola(name="wire", b=on("bead"), curvature=C)
    with pytest.raises(ModelError, match="forces"):
        bead(joint=False, forces=[wire])
    with pytest.raises(ModelError, match="joints"):
        Model(joints=[Drag(name="air", marker=Marker2D(), coefficient=1.0)])
    with pytest.raises(ModelError, match="forces"):
        bead(joint=False, forces=[Distance2D(name="rod", b=on("bead"), a=Marker2D(), length=1.0)])

    class Impostor(ScalarJoint2D):
        type: Literal["Distance2D"] = "Distance2D"
        formula = scalar_constraint(height)
        a: Marker2D = Marker2D()
        b: Marker2D
        curvature: float = 1.0

    with pytest.raises(ModelError, match="type 'Distance2D' is taken"):
        Model(bodies=[PointMass2D(name="bead", mass=1.0)], joints=[Impostor(name="j", b=on("bead"))])
