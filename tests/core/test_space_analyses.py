"""Analyses in space: variations against differences of runs, and all of them against the same model in the plane."""

import math

import numpy as np
import pytest
from helpers import G
from test_saltation import carried
from test_space_lift import lifted
from tlismni.core import (
    AppliedTorque3D,
    Axes,
    CoulombFriction,
    EulerParameters,
    HalfSpace3D,
    Input,
    InputSignal,
    Marker3D,
    Model,
    ModelError,
    NewtonImpact,
    Revolute3D,
    RigidBody3D,
    Simulation,
    SimulationError,
    Sphere3D,
    SphereOnHalfSpace3D,
    simulate,
)
from tlismni.core.analysis import (
    eigenmodes,
    lyapunov_exponents,
    parameter_sensitivities,
    state_space,
    static_equilibrium,
)
from tlismni.core.analysis.saltation import Rows, _normal_part
from tlismni.core.analysis.variation import Variation
from tlismni.models import load


def beside(model, dq, dv):
    """The model with its bodies' coordinates and velocities changed by dq and dv (7 a body)."""
    bodies = []
    for k, body in enumerate(model.bodies):
        q, v = (np.array(x) for x in body.initial_state())
        q, v = q + dq[7 * k : 7 * k + 7], v + dv[7 * k : 7 * k + 7]
        spin = _spin(q[3:], v[3:])
        bodies.append(
            body.model_copy(
                update={
                    "position": tuple(q[:3]),
                    "attitude": EulerParameters(values=tuple(q[3:])),
                    "velocity": tuple(v[:3]),
                    "angular_velocity": tuple(spin),
                    "angular_velocity_in": "body",
                }
            )
        )
    return model.model_copy(update={"bodies": tuple(bodies)})


def _spin(p, rate):
    """w = 2 G(p) p'/p.p in the body's axes, G = [-e, e0 I - e~]."""
    e0, e = p[0], p[1:]
    return 2.0 * (e0 * rate[1:] - e * rate[0] - np.cross(e, rate[1:])) / (p @ p)


def thrown():
    """A body of three different inertias, thrown with spin on a slope that a ball aside of its centre strikes."""
    body = RigidBody3D(
        name="body", mass=1.3, inertia=(0.05, 0.08, 0.1), position=(0.1, -0.2, 0.7), velocity=(0.4, 0.3, 1.0),
        attitude=EulerParameters(values=(0.9, 0.2, -0.3, 0.1)), angular_velocity=(2.0, 7.0, -3.0),
    )  # fmt: skip
    slope = HalfSpace3D(marker=Marker3D(attitude=Axes(z=(0.2, -0.1, 1.0))))
    ball = Sphere3D(marker=Marker3D(body="body", point=(0.15, 0.1, -0.2)), radius=0.06)
    stop = SphereOnHalfSpace3D(name="stop", plane=slope, sphere=ball, law=NewtonImpact(restitution=0.7))
    return Model(gravity=(0.0, 0.0, -G), bodies=[body], contacts=[stop])


def hanging():
    """Chrono's pendulum on a universal joint, whose lower end strikes a wall on its way."""
    model = load("universal_pendulum", tilt=1.3).model
    wall = HalfSpace3D(marker=Marker3D(point=(-1.2, 0.0, 0.0), attitude=Axes(z=(1.0, 0.2, 0.1))))
    ball = Sphere3D(marker=Marker3D(body="pendulum", point=(0.1, 0.05, -0.3)), radius=0.1)
    stop = SphereOnHalfSpace3D(name="stop", plane=wall, sphere=ball, law=NewtonImpact(restitution=0.6))
    return model.model_copy(update={"contacts": (stop,)})


def arm():
    """The robot's arm, whose elbow strikes its end stop."""
    return load("arm_stop").model


@pytest.mark.sampled(1)
@pytest.mark.parametrize("make, t_end", [(thrown, 0.9), (hanging, 2.0), (arm, 0.22)])
def test_variations_are_what_neighbouring_runs_give(make, t_end):
    """Through turns by more than 180 degrees, in which each Euler parameter passes zero, and through blows."""
    model = make()
    start, last, variation = carried(model, t_end)
    assert variation.impacts >= 1
    assert np.sum(variation.growth) == pytest.approx(variation.volume, abs=1e-9)
    sim = Simulation(model)
    n = sim.assembly.n
    layout = Variation(sim)._layouts.now()
    # neighbours keep the velocities of their joints, so the normal part has to be there
    dv = start[1] + _normal_part(sim, layout, Rows(sim, sim.workspace.arrays["v"][:n].copy()), *start)
    ends, size = [], 1e-6
    for column in range(2 * variation.freedom):
        pair = []
        for sign in (size, -size):
            changed = beside(model, sign * start[0][:, column], sign * dv[:, column])
            run = simulate(changed, t_end, "irk", 1e-12, 1e-14, tableau="gauss3", record=False)
            pair.append(np.concatenate([run.q[-1], run.v[-1]]))
        ends.append((pair[0] - pair[1]) / (2.0 * size))
    expected = np.array(ends).T
    basis, _, mass = variation._frame()
    most = 1e-6 * np.abs(expected).max()
    assert last[:n] == pytest.approx(expected[:n], abs=most)
    assert basis.T @ mass @ last[n:] == pytest.approx(basis.T @ mass @ expected[n:], abs=most)
    run = simulate(model, t_end, rtol=1e-8)
    turned = run.q[:, 3:7] @ run.q[0, 3:7]
    assert make is not thrown or turned.min() < 0.0 < turned.max()


@pytest.mark.sampled(1)
@pytest.mark.parametrize(
    "name, parameters, t_end",
    [("chain", {"links": 3}, 3.0), ("pendulum", {}, 3.0), ("pendulum_stop", {"driven": False}, 4.0)],
)
def test_growth_of_variations_is_that_of_the_planar_model(name, parameters, t_end):
    """Lengths in the kinetic energy know no coordinates: the factors by which they grow over a run are the same."""
    flat = load(name, **parameters).model
    factors = []
    for model in (flat, lifted(flat)):
        sim = Simulation(model, "irk", tableau="gauss3", rtol=1e-11, atol=1e-13)
        variation = Variation(sim, factors=True)
        product = np.eye(len(variation.exponents))
        while sim.t_internal < t_end:
            variation.advance(t_end)
            product = variation.last @ product
        factors.append(np.linalg.svd(product, compute_uv=False))
    assert len(factors[0]) == len(factors[1])
    assert factors[1] == pytest.approx(factors[0], rel=1e-6)


@pytest.mark.sampled(2)
@pytest.mark.parametrize(
    "name, t_end",
    [("heavy_top", 0.3), ("free_body", 12.0), ("universal_pendulum", 3.0), ("spatial_slider_crank", 2.0),
     ("bricard", 3.0), ("spatial_cradle", 0.5)],
)  # fmt: skip
def test_exponents_of_conservative_mechanisms_add_up_to_nothing(name, t_end):
    """Liouville: volume is kept, which the exponents do not know. Each of these runs stopped once at 180 degrees."""
    found = lyapunov_exponents(load(name).model, t_end)
    assert abs(found.sum_residual) < 1e-7 and abs(found.volume_rate) < 1e-7


def pendulum_with_a_motor():
    """A rod of 1 m, 1 kg on a hinge about y, hanging, with a torque about it as input."""
    hinge = Axes(z=(0.0, 1.0, 0.0))
    rod = RigidBody3D(name="rod", mass=1.0, inertia=(1.0 / 12.0, 1.0 / 12.0, 1e-3), position=(0.0, 0.0, -0.5))
    return Model(
        gravity=(0.0, 0.0, -G), bodies=[rod],
        joints=[Revolute3D(name="pin", a=Marker3D(attitude=hinge), b=rod.marker_at((0.0, 0.0, 0.0), hinge))],
        forces=[AppliedTorque3D(name="motor", marker=Marker3D(body="rod"), torque_y=InputSignal(channel="torque"))],
        inputs=[Input(name="torque", unit="N.m")],
    )  # fmt: skip


def test_a_driven_pendulum_as_a_linear_model():
    """theta'' = -(3 g/2) theta + 3 T, and the pin feels m L/2 theta'' across."""
    linear = state_space(pendulum_with_a_motor(), outputs=["pin.angle", "rod.ax", "pin.force_z"])
    f = np.array([0.1, 0.5, 2.0])
    omega = 2.0 * math.pi * f
    theta = 3.0 / (1.5 * G - omega**2)
    found = linear.transfer(f)[:, :, 0]
    assert found[:, 0] == pytest.approx(theta, rel=1e-8)
    assert np.abs(found[:, 1]) == pytest.approx(np.abs(0.5 * omega**2 * theta), rel=1e-7)
    assert np.sort_complex(linear.poles) == pytest.approx(np.array([-1j, 1j]) * math.sqrt(1.5 * G), abs=1e-9)


@pytest.mark.parametrize("links", [1, 3])
def test_modes_are_those_of_the_planar_model(links):
    flat = load("chain", links=links).model
    one, other = eigenmodes(flat), eigenmodes(lifted(flat))
    assert len(one.frequencies) == len(other.frequencies) == links
    assert other.frequencies == pytest.approx(one.frequencies, rel=1e-9)


def test_modes_of_a_pendulum_on_a_universal_joint():
    """Hanging with level axes: twice sqrt(m g l/(J + m l^2))."""
    modes = eigenmodes(load("universal_pendulum", tilt=0.0).model)
    assert 2.0 * math.pi * modes.frequencies == pytest.approx([math.sqrt(9.80665 * 2.0 / 4.1)] * 2, rel=1e-9)
    assert modes.stable


def test_parameter_sensitivities_are_those_of_the_planar_model():
    """Through the blows at the stop: by restitution, mass and a length of the contact."""
    flat = load("pendulum_stop", driven=False).model
    places, channels, t = ["stop.law.restitution", "pendulum.mass"], ["pendulum.x", "pendulum.vy"], [0.3, 0.9, 1.7]
    one, other = (
        parameter_sensitivities(model, 1.7, places, channels, t_eval=t) for model in (flat, lifted(flat))
    )  # fmt: skip
    assert np.abs(one.derivatives).max() > 0.1
    size = np.abs(one.derivatives).max()
    assert other.derivatives == pytest.approx(one.derivatives, abs=1e-6 * size)


def test_what_has_no_variations_is_said():
    for analysis in (lambda model: lyapunov_exponents(model, 0.1), eigenmodes, state_space):
        with pytest.raises(ModelError, match="nonholonomic"):
            analysis(load("rolling_disk").model)
    model = thrown()
    rough = model.contacts[0].model_copy(update={"friction": CoulombFriction(coefficient=0.2)})
    with pytest.raises(ModelError, match="'stop' has friction"):
        lyapunov_exponents(model.model_copy(update={"contacts": (rough,)}), 1.0)
    with pytest.raises(SimulationError, match="strike at one instant"):
        lyapunov_exponents(load("dropped_box", tilt_x=0.0, tilt_y=0.0).model, 1.0)
    # corner by corner it goes on, also where corners that are struck without rebound stay
    assert lyapunov_exponents(load("dropped_box").model, 0.3919).impacts > 10


@pytest.mark.parametrize("seed", range(12))
def test_a_box_comes_to_rest_on_a_face_whose_corners_say_more_than_enough(seed):
    """Three corners hold it, the fourth follows from them; one of these carries nothing."""
    tilts = dict(zip(("tilt_x", "tilt_y", "tilt_z"), np.random.default_rng(seed).uniform(-2.0, 2.0, 3), strict=True))
    rest = static_equilibrium(load("dropped_box", **tilts).model)
    assert min(abs(rest["box.z"] - z) for z in (0.1, 0.15, 0.2)) < 1e-9
    assert sum(rest[f"floor_ground_box_{k}.normal_force"] for k in range(1, 9)) == pytest.approx(2.0 * G, rel=1e-9)
    assert min(rest[f"floor_ground_box_{k}.gap"] for k in range(1, 9)) > -1e-9


@pytest.mark.parametrize("name, parameters", [("universal_pendulum", {"tilt": 3.0}), ("heavy_top", {"spin": 0.0})])
def test_rest_is_found_through_any_turn(name, parameters):
    rest = static_equilibrium(load(name, **parameters).model)
    (body,) = rest.system.bodies
    assert rest[f"{body.name}.z"] == pytest.approx(-np.linalg.norm(body.position), abs=1e-9)


def test_bricards_loop_vibrates_as_it_swings():
    """Its small vibrations about rest have the period of a run that starts beside it."""
    modes = eigenmodes(load("bricard").model)
    (frequency,) = modes.frequencies
    values = dict(modes.equilibrium.start_values)
    names = [name for name in values if not name.endswith("_rate")]
    shape = dict(zip(modes.coordinates, modes.shapes[0].real, strict=True))
    for name in names:
        if name in shape:
            values[name] += 1e-4 * shape[name]
    half = 0.5 / frequency
    run = simulate(load("bricard").model, half, rtol=1e-10, atol=1e-12, start_values=values, t_eval=[0.0, half])
    angle = run["hinge0.angle"] - modes.equilibrium["hinge0.angle"]
    assert angle[1] == pytest.approx(-angle[0], rel=1e-3) and abs(angle[0]) > 1e-5
