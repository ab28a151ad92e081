"""Frequencies, damping and shapes against closed forms."""

import math

import numpy as np
import pytest
from helpers import GROUND, G, ball_over_floor, on, point_pendulum, rod_pendulum
from scipy.linalg import eigh
from tlismni.core import (
    Constant,
    CoordinateDriver,
    Distance2D,
    HuntCrossley,
    Marker2D,
    Model,
    ModelError,
    NewtonImpact,
    PointMass2D,
    Polynomial,
    SpringDamper2D,
    simulate,
)
from tlismni.core.analysis import eigenmodes, static_equilibrium
from tlismni.models import load


def test_pendulums():
    for model, square in ((point_pendulum(-1.0), G), (rod_pendulum(0.4), 1.5 * G)):
        modes = eigenmodes(model)
        assert modes.frequencies == pytest.approx([math.sqrt(square) / (2.0 * math.pi)], rel=1e-12)
        assert modes.stable


def test_upside_down_a_pendulum_falls():
    """The growing root stands for the pair: sqrt(g/L)."""
    modes = eigenmodes(point_pendulum(0.5 * math.pi), settle=True)
    assert not modes.stable
    assert modes.eigenvalues == pytest.approx([math.sqrt(G)], rel=1e-10)


def test_a_double_pendulum():
    """Equal masses and rods: omega^2 = (2 -+ sqrt 2) g/L, and the shapes (1, +-sqrt 2)."""
    bodies = [PointMass2D(name=f"p{i}", mass=1.0, position=(0.1 * (i + 1), -(i + 1.0))) for i in range(2)]
    length = math.hypot(0.1, 1.0)
    ends = [GROUND, on("p0"), on("p1")]
    rods = [Distance2D(name=f"r{i}", a=ends[i], b=ends[i + 1], length=length) for i in range(2)]
    modes = eigenmodes(Model(bodies=bodies, joints=rods))
    squares = (2.0 * math.pi * modes.frequencies) ** 2 * length / G
    assert squares == pytest.approx([2.0 - math.sqrt(2.0), 2.0 + math.sqrt(2.0)], rel=1e-10)
    x = modes.shapes[:, [modes.coordinates.index("p0.x"), modes.coordinates.index("p1.x")]].real
    assert (x[:, 1] / x[:, 0]) == pytest.approx([1.0 + math.sqrt(2.0), 1.0 - math.sqrt(2.0)], rel=1e-9)


def oscillator(damping):
    """A mass between two springs and dampers on a line, held on it by two rods without an end."""
    k, m = 50.0, 2.0
    ends = (Marker2D(point=(-1.0, 0.0)), Marker2D(point=(1.0, 0.0)))
    springs = [
        SpringDamper2D(name=f"s{i}", a=end, b=on("p"), stiffness=0.5 * k, damping=0.5 * damping, natural_length=1.0)
        for i, end in enumerate(ends)
    ]
    return Model(gravity=(0.0, 0.0), bodies=[PointMass2D(name="p", mass=m)], forces=springs), k, m


@pytest.mark.parametrize("ratio", [0.0, 0.05, 0.7])
def test_a_damped_oscillator(ratio):
    """Across unstretched springs a mass is free: eigenvalue 0, no damping ratio."""
    model, k, m = oscillator(2.0 * ratio * math.sqrt(50.0 * 2.0))
    modes = eigenmodes(model)
    omega = math.sqrt(k / m)
    seen = modes.eigenvalues[np.abs(modes.eigenvalues) > 0.0]
    assert seen == pytest.approx([complex(-ratio * omega, omega * math.sqrt(1.0 - ratio**2))], rel=1e-9)
    assert modes.damping_ratios[-1] == pytest.approx(ratio, abs=1e-9)
    assert np.isnan(modes.damping_ratios[0])


def test_an_overdamped_oscillator_creeps_at_two_rates():
    model, k, m = oscillator(4.0 * math.sqrt(50.0 * 2.0))
    modes = eigenmodes(model)
    omega = math.sqrt(k / m)
    creeping = np.sort(modes.eigenvalues.real)[:2]
    assert creeping == pytest.approx([-omega * (2.0 + math.sqrt(3.0)), -omega * (2.0 - math.sqrt(3.0))], rel=1e-9)
    assert np.all(modes.frequencies == 0.0)


def test_a_chain_of_masses_and_springs():
    """Fixed ends: omega_j = 2 sqrt(k/m) sin(j pi/(2(N+1))) along; across, unstretched springs hold nothing."""
    count, k, m = 6, 80.0, 0.5
    bodies = [PointMass2D(name=f"p{i}", mass=m, position=(i, 0.0)) for i in range(1, count + 1)]
    ends = [GROUND, *(on(f"p{i}") for i in range(1, count + 1)), Marker2D(point=(count + 1.0, 0.0))]
    springs = [
        SpringDamper2D(name=f"s{i}", a=ends[i], b=ends[i + 1], stiffness=k, natural_length=1.0)
        for i in range(count + 1)
    ]
    modes = eigenmodes(Model(gravity=(0.0, 0.0), bodies=bodies, forces=springs))
    exact = 2.0 * math.sqrt(k / m) * np.sin(np.arange(1, count + 1) * math.pi / (2.0 * (count + 1)))
    assert 2.0 * math.pi * modes.frequencies == pytest.approx([*np.zeros(count), *exact], rel=1e-10, abs=1e-12)


def test_a_cantilever_of_ancf_elements_has_beam_frequencies():
    """Bernoulli beam, (beta L)^2 = 3.516, 22.03, 61.70; the error falls with the fourth power of the mesh."""
    roots, errors = np.array([1.87510407, 4.69409113, 7.85475744]), []
    for elements in (4, 8):
        scenario = load("cantilever", elements=elements, gravity=0.0, tip_force=0.0)
        p = scenario.parameters
        area, inertia = math.pi * p["diameter"] ** 2 / 4.0, math.pi * p["diameter"] ** 4 / 64.0
        scale = math.sqrt(p["youngs_modulus"] * inertia / (p["density"] * area * p["length"] ** 4))
        exact = roots**2 * scale / (2.0 * math.pi)
        errors.append(np.abs(eigenmodes(scenario.model).frequencies[:3] / exact - 1.0))
    assert np.all(errors[1] < 2e-3)
    assert errors[0][2] / errors[1][2] > 8.0


def test_a_closed_contact_holds_and_a_force_contact_vibrates():
    """On a constraint a ball has no vibration; on Hertz's law omega^2 = 1.5 g/depth."""
    assert np.all(eigenmodes(ball_over_floor(NewtonImpact(restitution=0.5))).frequencies == 0.0)
    model = ball_over_floor(HuntCrossley(stiffness=1e6, restitution=1.0, exponent=1.5))
    rest = static_equilibrium(model)
    assert (2.0 * math.pi * eigenmodes(rest).frequencies[-1]) ** 2 == pytest.approx(-1.5 * G / rest["ball.y"], rel=1e-8)


def test_orthogonality():
    """Shapes of a swinging cable are orthogonal in M and in K."""
    modes = eigenmodes(load("cable_pendulum", elements=3, damping_time=0.0).model, count=6)
    from tlismni.core.analysis.at_rest import matrices

    found = matrices(modes.equilibrium.sim)
    for matrix in (found.mass, found.stiffness):
        gram = (modes.shapes @ matrix @ modes.shapes.T).real
        size = np.sqrt(np.abs(np.diag(gram)))
        assert np.abs(gram / size / size[:, None] - np.eye(6)).max() < 1e-6


def test_a_free_vibration_has_the_period_of_its_mode():
    """The nonlinear run from a small displacement along the first mode comes back after its period."""
    rest = static_equilibrium(load("cable_pendulum", elements=2, damping_time=0.0).model)
    modes = eigenmodes(rest, count=1)
    start = dict(rest.start_values)
    for name, part in zip(modes.coordinates, modes.shapes[0].real, strict=True):
        start[name] += 1e-5 * part
    period = 1.0 / modes.frequencies[0]
    result = simulate(rest.system, period, rtol=1e-8, atol=1e-10, start_values=start, t_eval=[0.0, period])
    moved = result.q - rest.q
    assert np.abs(moved[1] - moved[0]).max() < 1e-3 * np.abs(moved[0]).max()


def test_a_mass_matrix_of_the_field_gives_what_scipy_gives():
    """A LinearSystem's own matrices, against the generalised problem."""
    from tlismni.core import LinearSystem

    rng = np.random.default_rng(3)
    a, b = rng.standard_normal((2, 4, 4))
    mass, stiffness = a @ a.T + 4.0 * np.eye(4), b @ b.T + np.eye(4)
    body = LinearSystem(name="s", coordinates=("w", "x", "y", "z"), mass=mass.tolist(), stiffness=stiffness.tolist())
    exact = np.sqrt(eigh(stiffness, mass, eigvals_only=True)) / (2.0 * math.pi)
    assert eigenmodes(Model(gravity=(0.0, 0.0), bodies=[body])).frequencies == pytest.approx(exact, rel=1e-10)


def test_refusals():
    with pytest.raises(ModelError, match="no place of rest: with settle=True"):
        eigenmodes(rod_pendulum(0.3), settle=False)
    model = point_pendulum(-0.5 * math.pi)
    cart = PointMass2D(name="cart", mass=1.0, position=(3.0, 0.0), velocity=(1.0, 0.0))
    drivers = [
        CoordinateDriver(name="go", body="cart", coordinate="x", motion=Polynomial(coefficients=(3.0, 1.0))),
        CoordinateDriver(name="hold", body="cart", coordinate="y", motion=Constant(value=0.0)),
    ]
    with pytest.raises(ModelError, match="'go' moves at t = 0 s"):
        eigenmodes(Model(bodies=[*model.bodies, cart], joints=[*model.joints, *drivers]))
