"""Beams in a floating frame: frequencies, statics, material points, rotation with stiffening, against ANCF."""

import math

import numpy as np
import pytest
from helpers import GROUND, on
from scipy.linalg import eigh
from test_tangents import Point, check_levels, check_matrix, draw
from tlismni.core import (
    AppliedForce2D,
    Attachment,
    Cable2D,
    Clamp2D,
    Constant,
    CoordinateDriver,
    FloatingBeam2D,
    MaterialPoint2D,
    Model,
    ModelError,
    Polynomial,
    Revolute2D,
    RigidBody2D,
    Table,
    bending_stress,
    deformed_shape,
    section,
    simulate,
    stress,
)

LENGTH, MASS, STIFFNESS = 1.5, 2.0, 7.0
UNIT = math.sqrt(STIFFNESS * LENGTH / MASS) / LENGTH**2
"""Frequencies are roots squared times this."""
ROOTS = {  # of the characteristic equations: Blevins, Formulas for Natural Frequency and Mode Shape (1979), table 8-1
    "cantilever": (1.87510407, 4.69409113, 7.85475744, 10.99554073),
    "simply_supported": (math.pi, 2.0 * math.pi, 3.0 * math.pi, 4.0 * math.pi),
    "free": (4.73004074, 7.85320462, 10.9956079, 14.1371655),
}


def beam(**changes):
    fields = {"name": "beam", "mass": MASS, "length": LENGTH, "bending_stiffness": STIFFNESS, "modes": 4}
    return FloatingBeam2D(**{**fields, **changes})


# ---- modes ----------------------------------------


@pytest.mark.parametrize("boundary", ROOTS)
def test_frequencies_converge_to_theory_with_the_power_four(boundary):
    exact = np.array(ROOTS[boundary]) ** 2 * UNIT
    errors = np.array([beam(boundary_conditions=boundary, elements=n).frequencies() / exact - 1.0 for n in (8, 16, 32)])
    assert np.all(errors[-1] < 3e-5) and np.all(errors > -1e-8)  # from above: Rayleigh's principle
    assert np.log2(errors[0] / errors[1]) == pytest.approx(4.0, abs=0.5)
    assert np.log2(errors[1, 1:] / errors[2, 1:]) == pytest.approx(4.0, abs=0.3)


@pytest.mark.parametrize("boundary", ROOTS)
def test_axial_frequencies_converge_to_theory(boundary):
    exact = np.arange(1, 4) if boundary == "free" else np.arange(3) + 0.5
    exact = exact * math.pi / LENGTH * math.sqrt(100.0 * LENGTH / MASS)
    found = beam(boundary_conditions=boundary, axial_modes=3, axial_stiffness=100.0).frequencies()[4:]
    assert found == pytest.approx(exact, rel=1e-6)


def test_rotary_inertia_lowers_the_frequencies_as_rayleigh_says():
    """Simply supported: w^2 = EI k^4/(mu + rho I k^2), k = n pi/L."""
    k = np.arange(1, 5) * math.pi / LENGTH
    exact = np.sqrt(STIFFNESS * k**4 / (MASS / LENGTH + 0.05 * k**2))
    found = beam(boundary_conditions="simply_supported", rotary_inertia=0.05, elements=80).frequencies()
    assert found == pytest.approx(exact, rel=1e-6)


def test_free_modes_hold_no_rigid_motion():
    """Mean axes: no momentum and no moment of momentum in the modes, those of attachments included."""
    s = beam(
        boundary_conditions="free", axial_modes=2, axial_stiffness=100.0,
        attachments=tuple(
            Attachment(position=s, direction=d) for s, d in ((0.3, "transverse"), (LENGTH, "moment"), (0.0, "axial"))
        ),
    )  # fmt: skip
    i = s.invariants()
    assert np.abs(i.H).max() < 1e-9 and np.abs(i.b).max() < 1e-9 and np.abs(i.first_moment).max() < 1e-12


def test_modes_have_the_damping_ratios_given():
    """Free vibration of the first mode: logarithmic decrement 2 pi zeta/sqrt(1 - zeta^2)."""
    s = beam(modes=2, damping_ratio=(0.03, 0.1), amplitudes=(0.01, 0.0))
    omega = s.frequencies()[0] * math.sqrt(1.0 - 0.03**2)
    fixed = Clamp2D(name="clamp", a=GROUND, b=on("beam"))
    times = np.arange(4) * 2.0 * math.pi / omega
    result = simulate(Model(gravity=(0.0, 0.0), bodies=[s], joints=[fixed]), times[-1], t_eval=times, rtol=1e-9)
    decrement = np.log(result["beam.mode1"][:-1] / result["beam.mode1"][1:])
    assert decrement == pytest.approx(2.0 * math.pi * 0.03 / math.sqrt(1.0 - 0.03**2), rel=1e-5)
    assert np.abs(result["energy.balance"]).max() < 1e-8


# ---- static shapes ----------------------------------------


def compliance(s, point, direction=1):
    """Displacement of a point under a unit force there, m/N."""
    invariants, shape = s.invariants(), s.material_point((point, 0.0))
    return float(shape.shape[direction] @ np.linalg.solve(invariants.stiffness, shape.shape[direction]))


@pytest.mark.parametrize("modes", [0, 1, 5])
def test_attachments_make_the_compliance_exact(modes):
    """a^3/(3 EI) of the cantilever, a^2 (L - a)^2/(3 EI L) of the simply supported beam, s/EA along it."""
    a = 0.9
    s = beam(modes=modes, attachments=(Attachment(position=a),))
    assert compliance(s, a) == pytest.approx(a**3 / (3.0 * STIFFNESS), rel=1e-9)
    s = beam(modes=modes, attachments=(Attachment(position=a),), boundary_conditions="simply_supported")
    assert compliance(s, a) == pytest.approx((a * (LENGTH - a)) ** 2 / (3.0 * STIFFNESS * LENGTH), rel=1e-9)
    s = beam(
        modes=1, axial_modes=modes, axial_stiffness=50.0, attachments=(Attachment(position=LENGTH, direction="axial"),)
    )
    assert compliance(s, LENGTH, 0) == pytest.approx(LENGTH / 50.0, rel=1e-9)


def test_without_attachment_the_compliance_converges_from_below():
    """Of a cantilever's tip: each mode leaves less, with the power -3."""
    exact = LENGTH**3 / (3.0 * STIFFNESS)
    missing = [1.0 - compliance(beam(modes=n), LENGTH) / exact for n in (2, 4, 8)]
    assert missing[0] > missing[1] > missing[2] > 0.0
    assert math.log2(missing[1] / missing[2]) == pytest.approx(3.0, abs=0.4)


def test_a_moment_bends_the_beam_to_a_parabola():
    s = beam(modes=1, attachments=(Attachment(position=LENGTH, direction="moment"),))
    i, tip = s.invariants(), s.material_point((LENGTH, 0.0))
    p = np.linalg.solve(i.stiffness, tip.slope[1] * 0.3)
    for x in (0.4, 1.0, LENGTH):
        shape = s.material_point((x, 0.0))
        assert shape.shape[1] @ p == pytest.approx(0.5 * 0.3 * x**2 / STIFFNESS, rel=1e-8)
        assert shape.slope[1] @ p == pytest.approx(0.3 * x / STIFFNESS, rel=1e-8)


def test_clamped_beam_under_weight_and_force_settles_where_theory_says():
    """Weight mu g L^4/(8 EI) and a force at a material point; the reaction of the clamp holds both."""
    weight, force = 1e-3, 2e-3
    s = beam(modes=3, attachments=(Attachment(position=LENGTH),), damping_ratio=0.7)
    tip = MaterialPoint2D(name="tip", body="beam", point=(LENGTH, 0.0))
    push = AppliedForce2D(name="push", marker=on("tip"), force_y=Constant(value=-force))
    clamp = Clamp2D(name="clamp", a=GROUND, b=on("beam"))
    model = Model(gravity=(0.0, -weight / MASS), bodies=[s, tip], joints=[clamp], forces=[push])
    result = simulate(model, 60.0, "irk", rtol=1e-8, atol=1e-12)
    expected = weight * LENGTH**3 / (8.0 * STIFFNESS) + force * LENGTH**3 / (3.0 * STIFFNESS)
    assert result["tip.y"][-1] == pytest.approx(-expected, rel=2e-4)  # the weight's own shape is left to the modes
    assert result["clamp.force_y"][-1] == pytest.approx(weight + force, rel=1e-5)
    assert result["clamp.torque"][-1] == pytest.approx((0.5 * weight + force) * LENGTH, rel=1e-5)
    assert np.abs(result["energy.balance"]).max() < 1e-9
    x = np.array([0.0, 0.3, 0.75, 1.2])
    moment = -(0.5 * weight * (LENGTH - x) ** 2 / LENGTH + force * (LENGTH - x))
    found = section(result, s, x, [60.0])
    assert found.bending_moment[0] == pytest.approx(moment, abs=0.03 * weight * LENGTH)
    assert found.curvature[0] == pytest.approx(found.bending_moment[0] / STIFFNESS, rel=1e-9)
    assert np.all(np.isnan(found.axial_force))  # it keeps its length: nothing tells
    assert deformed_shape(result, s, [LENGTH], [60.0])[0, 0] == pytest.approx([LENGTH, -expected], rel=2e-4)


@pytest.mark.parametrize("pull", [4.0, -1.5])
def test_axial_load_at_the_tip_stiffens_or_softens_the_beam(pull):
    """Cantilever with a dead load P = pull EI/L^2 along it and a small one F across it: w = F (k L - tanh k L)/(k P),
    k^2 = P/EI; under pressure with tan (Timoshenko and Gere, Theory of Elastic Stability, chapter 1)."""
    k = math.sqrt(abs(pull)) / LENGTH
    angle, force = k * LENGTH, 1e-3
    shape = (angle - math.tanh(angle)) if pull > 0.0 else (math.tan(angle) - angle)
    s = beam(modes=4, attachments=(Attachment(position=LENGTH),), damping_ratio=1.0, geometric_stiffening=True)
    tip = MaterialPoint2D(name="tip", body="beam", point=(LENGTH, 0.0))
    load = AppliedForce2D(
        name="load", marker=on("tip"), force_x=Constant(value=pull * STIFFNESS / LENGTH**2),
        force_y=Constant(value=force),
    )  # fmt: skip
    clamp = Clamp2D(name="clamp", a=GROUND, b=on("beam"))
    result = simulate(Model(gravity=(0.0, 0.0), bodies=[s, tip], joints=[clamp], forces=[load]), 60.0, "irk")
    expected = force * shape / (k**3 * STIFFNESS)
    assert result["tip.y"][-1] == pytest.approx(expected, rel=1e-3)
    assert abs(expected / (force * LENGTH**3 / (3.0 * STIFFNESS)) - 1.0) > 0.4
    assert np.abs(result["energy.balance"]).max() < 1e-8


def test_a_pull_along_the_beam_shows_as_axial_force():
    s = beam(
        axial_stiffness=50.0, modes=1, attachments=(Attachment(position=LENGTH, direction="axial"),), damping_ratio=0.7
    )
    tip = MaterialPoint2D(name="tip", body="beam", point=(LENGTH, 0.0))
    pull = AppliedForce2D(name="pull", marker=on("tip"), force_x=Constant(value=0.2))
    clamp = Clamp2D(name="clamp", a=GROUND, b=on("beam"))
    result = simulate(Model(gravity=(0.0, 0.0), bodies=[s, tip], joints=[clamp], forces=[pull]), 30.0, "irk")
    found = section(result, s, [0.1, 1.0], [30.0])
    assert found.axial_force[0] == pytest.approx([0.2, 0.2], rel=1e-5)
    assert found.axial_strain[0] == pytest.approx([0.004, 0.004], rel=1e-5)
    surface = stress(result, s, [1.0], area=1e-4, second_moment=1e-9, height=0.01, times=[30.0])
    assert surface[0, 0] == pytest.approx(2000.0, rel=1e-5)


def test_stress_without_axial_modes_is_that_of_bending_alone():
    """A weight F at a cantilever's tip: +-F (L - s) h/I at the surfaces, the upper one is pulled. The whole stress is
    not known."""
    s = beam(attachments=(Attachment(position=LENGTH),), damping_ratio=0.5)
    tip = MaterialPoint2D(name="tip", body="beam", point=(LENGTH, 0.0))
    weight = AppliedForce2D(name="weight", marker=on("tip"), force_y=Constant(value=-0.2))
    clamp = Clamp2D(name="clamp", a=GROUND, b=on("beam"))
    result = simulate(Model(gravity=(0.0, 0.0), bodies=[s, tip], joints=[clamp], forces=[weight]), 30.0, "irk")
    for height in (0.01, -0.01):
        found = bending_stress(result, s, [0.0, 0.5], second_moment=1e-9, height=height, times=[30.0])
        exact = 0.2 * np.array([LENGTH, LENGTH - 0.5]) * height / 1e-9
        assert found[0] == pytest.approx(exact, rel=1e-3)
    with pytest.raises(ModelError, match="axial_stiffness and axial_modes"):
        stress(result, s, [0.5], area=1e-4, second_moment=1e-9, height=0.01)
    with pytest.raises(ModelError, match="second_moment = -1"):
        bending_stress(result, s, [0.5], second_moment=-1.0, height=0.01)


# ---- material points ----------------------------------------

EVERYTHING = {
    "axial_modes": 1, "axial_stiffness": 100.0, "modes": 2, "geometric_stiffening": True, "damping_ratio": 0.1,
    "position": (0.3, 0.1), "angle": 0.5, "velocity": (1.0, -0.5), "angular_velocity": 0.7,
    "amplitudes": (0.1, -0.05, 0.02), "amplitude_rates": (0.4, 0.3, -0.2),
}  # fmt: skip


def test_points_of_the_beam_have_exact_tangents_and_start_on_it():
    points = [MaterialPoint2D(name=f"p{k}", body="beam", point=p) for k, p in enumerate([(0.4, 0.0), (1.5, 0.1)])]
    point = Point(Model(bodies=[points[0], beam(**EVERYTHING), points[1]]))
    for seed in range(4):
        state = draw(point, seed)
        check_matrix(point, state, h=2e-3)
        check_levels(point, state, h=2e-3)
    assembly = point.workspace.assembly
    _, phi, phid, _ = point.at(0.0, assembly.q0, assembly.v0, np.zeros(point.n), np.zeros(point.m))
    assert np.abs(phi).max() < 1e-14 and np.abs(phid).max() < 1e-14


def test_points_off_the_axis_turn_with_the_section():
    """u = -y w' across the beam; beyond its ends there is none."""
    s = beam()
    below, axis = s.material_point((0.6, -0.05)), s.material_point((0.6, 0.0))
    assert below.offset == (0.6, -0.05)
    assert np.allclose(below.shape[0], 0.05 * axis.slope[1]) and np.array_equal(below.shape[1], axis.shape[1])
    with pytest.raises(ModelError, match=r"no point at s = 1.6 m: it reaches from 0 to 1.5 m"):
        s.material_point((1.6, 0.0))


def test_a_pendulum_of_a_beam_in_different_frames_and_against_ancf():
    """Pinned at one end, from the horizontal. The frame does not matter but for terms of second order in deflections;
    with these (stiffening) the beam is nearer to ANCF."""
    times = np.linspace(0.0, 1.0, 21)

    def swing(body):
        ends = [MaterialPoint2D(name=n, body="beam", point=(x, 0.0)) for n, x in (("root", 0.0), ("tip", LENGTH))]
        pin = Revolute2D(name="pin", a=GROUND, b=on("root"))
        result = simulate(Model(bodies=[body, *ends], joints=[pin]), 1.0, t_eval=times, k=2, rtol=1e-6, atol=1e-8)
        bend = np.abs(result["tip.angle"] - result["root.angle"]).max()
        return np.array([result["tip.x"], result["tip.y"]]), bend * LENGTH

    def flexible(boundary, **changes):
        place = {"position": (0.5 * LENGTH, 0.0)} if boundary == "free" else {}
        return swing(beam(bending_stiffness=30.0, modes=3, boundary_conditions=boundary, **place, **changes))

    cable = Cable2D(name="beam", elements=6, length=LENGTH, mass_per_length=MASS / LENGTH, bending_stiffness=30.0,
                    axial_stiffness=3e4)  # fmt: skip
    expected, size = swing(cable)
    assert size > 0.08
    free, chord = flexible("free", attachments=(Attachment(position=0.0),))[0], flexible("simply_supported")[0]
    assert np.abs(free - chord).max() < 0.01 * size
    cases = {"simply_supported": (), "cantilever": (), "free": (Attachment(position=0.0),)}
    for boundary, attachments in cases.items():
        stiffened = flexible(boundary, geometric_stiffening=True, attachments=attachments)[0]
        assert np.abs(stiffened - expected).max() < 0.04 * size
        assert np.abs(stiffened - expected).max() < 0.4 * np.abs(chord - expected).max()


# ---- rotation ----------------------------------------


@pytest.mark.parametrize(
    "speed, expected", [(1.0, (3.6817, 22.1810)), (3.0, (4.7973, 23.3203)), (6.0, (7.3604, 26.8091))]
)
def test_rotation_stiffens_the_beam_as_wright_and_others_found(speed, expected):
    """Wright, Smith, Thresher and Wang, J. Appl. Mech. 49 (1982) 197: frequencies across the plane of rotation of a
    cantilever of length, mass per length and EI 1; in the plane they are sqrt(w^2 - speed^2)."""
    s = FloatingBeam2D(name="s", mass=1.0, length=1.0, bending_stiffness=1.0, modes=10, geometric_stiffening=True)
    i = s.invariants()
    in_plane = eigh(i.stiffness - speed**2 * i.N, i.mass, eigvals_only=True)[:2]
    assert np.sqrt(in_plane + speed**2) == pytest.approx(expected, abs=2e-4)


SPIN = {"length": 10.0, "mass": 12.0, "bending_stiffness": 1.4e4, "axial_stiffness": 2.8e7}
OMEGA, RISE, END = 6.0, 15.0, 18.0


def spin_up(body, root, times):
    """Tip of a beam on a hub that spins up, (forward, transverse) in the hub's frame.

    Kane, Ryan and Banerjee, J. Guidance 10 (1987) 139, with the data of Simo and Vu-Quoc, J. Sound Vib. 119 (1987)
    487: hub's rate (OMEGA/RISE)(t - RISE/(2 pi) sin(2 pi t/RISE)), then constant.
    """
    knots = np.linspace(0.0, END, 361)
    w = 2.0 * math.pi / RISE
    angle = OMEGA / RISE * (0.5 * knots**2 + (np.cos(w * knots) - 1.0) / w**2)
    angle = np.where(knots < RISE, angle, OMEGA * (knots - 0.5 * RISE))
    hub = RigidBody2D(name="hub", mass=1.0, inertia=1.0)
    tip = MaterialPoint2D(name="tip", body=body.name, point=(body.length, 0.0))
    joints = [
        Revolute2D(name="pin", a=GROUND, b=on("hub")),
        Clamp2D(name="clamp", a=on("hub"), b=on(root.name if root else body.name)),
        CoordinateDriver(
            name="drive", body="hub", coordinate="angle", motion=Table(times=tuple(knots), values=tuple(angle))
        ),
    ]
    model = Model(gravity=(0.0, 0.0), bodies=[hub, body, *([root] if root else []), tip], joints=joints)
    # no further than asked: without stiffening the tip is 1e10 m away soon after, where nothing can be told by rounding
    result = simulate(model, times[-1], t_eval=times, k=2, rtol=1e-5, atol=1e-7)
    c, s = np.cos(result["hub.angle"]), np.sin(result["hub.angle"])
    return c * result["tip.x"] + s * result["tip.y"], c * result["tip.y"] - s * result["tip.x"]


def test_spin_up_with_stiffening_against_ancf_and_without_it_it_fails():
    times = np.linspace(0.0, END, 361)
    cable = Cable2D(name="beam", elements=8, mass_per_length=1.2, **{k: v for k, v in SPIN.items() if k != "mass"})
    _, expected = spin_up(cable, MaterialPoint2D(name="root", body="beam", point=(0.0, 0.0)), times)
    forward, found = spin_up(
        FloatingBeam2D(name="beam", modes=3, axial_modes=1, geometric_stiffening=True, **SPIN), None, times
    )
    assert expected.min() == pytest.approx(-0.5738, abs=1e-3)
    assert np.abs(found - expected).max() < 2e-3  # of 0.574
    steady = times > RISE + 0.5
    assert np.abs(found[steady]).max() < 0.01
    # the stretch under its own centrifugal force, mu w^2 L^3/(3 EA); the last metres shorten it by under 1e-5
    assert np.mean(forward[steady]) - 10.0 == pytest.approx(1.2 * OMEGA**2 * 1e3 / (3.0 * 2.8e7), rel=0.05)
    soft = FloatingBeam2D(name="beam", modes=3, **SPIN)
    _, without = spin_up(soft, None, times[times < 10.0])
    assert np.abs(without).max() > 10.0  # longer than the beam: the textbook failure


def test_moderate_rotation_against_ancf():
    """A beam that starts turning with its hub at a third of its first frequency, under its weight."""
    rate, times = 0.3 * ROOTS["cantilever"][0] ** 2 * UNIT, np.linspace(0.0, 3.0, 121)
    spin = Polynomial(coefficients=(0.0, rate))
    fields = {"name": "beam", "length": LENGTH, "bending_stiffness": STIFFNESS, "angular_velocity": rate}
    tip = MaterialPoint2D(name="tip", body="beam", point=(LENGTH, 0.0))
    drive = CoordinateDriver(name="drive", body="hub", coordinate="angle", motion=spin)
    hub = RigidBody2D(name="hub", mass=1.0, inertia=1.0, angular_velocity=rate)

    def run(body, at):
        joints = [Clamp2D(name="clamp", a=on("hub"), b=on(at)), Revolute2D(name="pin", a=GROUND, b=on("hub")), drive]
        root = [MaterialPoint2D(name="root", body="beam", point=(0.0, 0.0))] if at == "root" else []
        model = Model(gravity=(0.0, -0.3), bodies=[hub, body, *root, tip], joints=joints)
        r = simulate(model, 3.0, t_eval=times, k=2, rtol=1e-6, atol=1e-8)
        return np.cos(r["hub.angle"]) * r["tip.y"] - np.sin(r["hub.angle"]) * r["tip.x"]

    expected = run(Cable2D(elements=6, mass_per_length=MASS / LENGTH, axial_stiffness=2e4, **fields), "root")
    errors = [
        np.abs(run(FloatingBeam2D(mass=MASS, modes=4, geometric_stiffening=on_, **fields), "beam") - expected).max()
        for on_ in (True, False)
    ]
    size = np.abs(expected).max()
    assert size > 0.03 and errors[0] < 0.01 * size
    assert errors[1] > 3.0 * errors[0]
