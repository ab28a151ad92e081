"""The ANCF cable at rest: rigid motions, patches, deflections, and what its matrices say about its frequencies."""

import math

import numpy as np
import pytest
from cables import EA, EI, LENGTH, LINE, System, beam_frequencies, straight
from helpers import GROUND, on, order
from scipy.integrate import solve_ivp
from scipy.linalg import eigh
from scipy.optimize import root
from tlismni.core import AppliedForce2D, AppliedTorque2D, Cable2D, Clamp2D, Constant, MaterialPoint2D, Model, Revolute2D

STILL = (0.0, 0.0)


def cantilever(elements, *forces, **fields):
    """A cable clamped at the origin, with a point `tip`."""
    points = [MaterialPoint2D(name=name, body="cable", point=(s, 0.0)) for name, s in (("root", 0.0), ("tip", LENGTH))]
    return Model(
        gravity=STILL,
        bodies=[Cable2D(**straight(elements, **fields)), *points],
        joints=[Clamp2D(name="clamp", a=GROUND, b=on("root"))],
        forces=forces,
    )


def tip_force(x, y):
    return AppliedForce2D(name="load", marker=on("tip"), force_x=Constant(value=x), force_y=Constant(value=y))


def tip_torque(value):
    return AppliedTorque2D(name="moment", body="tip", torque=Constant(value=value))


def tip(system, q):
    """x, y, angle of the tip; the points' coordinates are the last ones."""
    return q[-3:]


@pytest.mark.parametrize("integration", ["full", "reduced"])
def test_rigid_motion_makes_no_forces(integration):
    for shape in (None, tuple((math.sin(s), 1.0 - math.cos(s), math.cos(s), math.sin(s)) for s in (0.0, 0.5, 1.0))):
        fields = straight(2, shape=shape, relaxed="start", integration=integration)
        for angle in (0.0, 0.7, 2.9):
            moved = Cable2D(**fields | {"angle": angle, "position": (3.0, -2.0)})
            system = System(Model(gravity=STILL, bodies=[Cable2D(**fields)]))
            assert np.abs(system.residual(moved.start_shape().ravel())[0]).max() < 1e-12 * EA


@pytest.mark.parametrize("integration", ["full", "reduced"])
@pytest.mark.parametrize("strain", [-0.1, 1e-3, 0.5])
def test_patch_of_constant_axial_strain(integration, strain):
    """Force EA eps at both ends, none between; whatever the direction."""
    cable = Cable2D(**straight(3, angle=0.4, integration=integration))
    system = System(Model(gravity=STILL, bodies=[cable]))
    r = system.residual((1.0 + strain) * system.q0)[0].reshape(-1, 4)
    expected = np.zeros((4, 4))
    expected[-1, :2] = EA * strain * np.array([math.cos(0.4), math.sin(0.4)])
    expected[0] = -expected[-1]
    assert np.abs(r - expected).max() < 1e-13 * EA


def test_patch_of_constant_curvature():
    """A circle of nodes with its slopes: strain and curvature come to 0 and 1/R like h^4 and h^2, and at the
    middle node the forces per length vanish."""
    radius, errors = 1.5, []
    for elements in (4, 8, 16):
        s = np.linspace(0.0, LENGTH, elements + 1) / radius
        nodes = np.stack([radius * np.sin(s), radius * (1.0 - np.cos(s)), np.cos(s), np.sin(s)], axis=1)
        cable = Cable2D(**straight(elements, shape=tuple(map(tuple, nodes.tolist()))))
        strain, curvature = cable.strains_at(nodes, np.linspace(0.0, 1.0, 9))
        r = System(Model(gravity=STILL, bodies=[cable])).residual(nodes.ravel())[0].reshape(-1, 4)
        moment = r[-1, 2:] @ np.array([-math.sin(s[-1]), math.cos(s[-1])])
        errors.append([
            np.abs(strain).max(), np.abs(curvature - 1.0 / radius).max(), abs(moment - EI / radius),
            np.abs(r[elements // 2]).max() * elements,
        ])  # fmt: skip
    for column, least in zip(np.array(errors).T, (3.8, 1.9, 1.9, 1.9), strict=True):
        assert column[-1] < 2e-2
        assert order(column) > least


@pytest.mark.parametrize("integration", ["full", "reduced"])
def test_small_deflections_of_a_cantilever(integration):
    """F L^3/(3 EI) and M L^2/(2 EI) are exact for cubics; the second order of the deflection remains."""
    for load, deflection, slope in (
        (tip_force(0.0, 1e-5), 1e-5 * LENGTH**3 / (3.0 * EI), 1e-5 * LENGTH**2 / (2.0 * EI)),
        (tip_torque(1e-5), 1e-5 * LENGTH**2 / (2.0 * EI), 1e-5 * LENGTH / EI),
    ):
        system = System(cantilever(3, load, integration=integration))
        q, _ = system.equilibrium()
        _, y, angle = tip(system, q)
        assert abs(y / deflection - 1.0) < 1e-7
        assert abs(angle / slope - 1.0) < 1e-7


def test_axial_load_and_reactions():
    system = System(cantilever(3, tip_force(25.0, 0.0)))
    q, lam = system.equilibrium()
    assert abs(tip(system, q)[0] - LENGTH * (1.0 + 25.0 / EA)) < 1e-12
    # rows of the points (root, tip), then of the clamp: force and torque on the cable's root
    assert np.abs(lam - [-25.0, 0.0, 0.0, 25.0, 0.0, 0.0, -25.0, 0.0, 0.0]).max() < 1e-10


@pytest.mark.parametrize("integration", ["full", "reduced"])
def test_an_end_moment_bends_a_cantilever_to_a_circle(integration):
    """M = pi EI/L: a half circle of radius L/pi, with the tip above the root."""
    errors = []
    for elements in (4, 8, 16):
        system = System(cantilever(elements, tip_torque(math.pi * EI / LENGTH), integration=integration))
        x, y, angle = tip(system, system.equilibrium()[0])
        errors.append(max(abs(x), abs(y - 2.0 * LENGTH / math.pi), abs(angle - math.pi)))
    assert errors[-1] < 3e-4
    assert order(errors) > 3.5


def elastica(fx, fy):
    """Tip (x, y, angle) of an extensible elastica: EI theta'' = (1 + eps) (F x t), EA eps = F . t, by shooting."""

    def rhs(s, y):
        c, sn = math.cos(y[2]), math.sin(y[2])
        stretch = 1.0 + (fx * c + fy * sn) / EA
        return [stretch * c, stretch * sn, y[3], stretch * (fx * sn - fy * c) / EI]

    def run(bend):
        return solve_ivp(rhs, (0.0, LENGTH), [0.0, 0.0, 0.0, bend], "DOP853", rtol=1e-12, atol=1e-13).y[:, -1]

    found = root(lambda b: run(b[0])[3:], [fy * LENGTH / EI * 0.3], tol=1e-12)
    assert abs(found.fun[0]) < 1e-9
    return run(found.x[0])[:3]


@pytest.mark.parametrize("integration", ["full", "reduced"])
@pytest.mark.parametrize("force", [(0.0, 0.5), (0.0, 1.5), (-0.3, 0.4)])
def test_large_deflections_against_the_elastica(integration, force):
    expected, errors = elastica(*force), []
    for elements in (4, 8, 16):
        system = System(cantilever(elements, tip_force(*force), integration=integration))
        errors.append(np.abs(tip(system, system.equilibrium()[0]) - expected).max())
    assert errors[-1] < 2e-4
    assert order(errors) > 3.5


def frequencies(elements, kind, **fields):
    """Bending and axial angular frequencies from M and K of the straight cable."""
    system = System(Model(gravity=STILL, bodies=[Cable2D(**straight(elements, **fields))]))
    mass, stiffness = system.mass_and_stiffness(system.q0)
    held = {"free": [], "cantilever": [0, 1, 3], "supported": [0, 1, 4 * elements + 1]}[kind]
    free = np.setdiff1d(np.arange(system.n), held)
    found = []
    for axis in (1, 0):  # y and slope_y bend, x and slope_x stretch
        own = free[(free % 2) == axis]
        found.append(np.sqrt(np.abs(eigh(stiffness[np.ix_(own, own)], mass[np.ix_(own, own)], eigvals_only=True))))
    return found


@pytest.mark.parametrize("kind", ["cantilever", "free", "supported"])
def test_bending_frequencies_converge_with_order_four(kind):
    exact = (beam_frequencies(kind, 3) / LENGTH) ** 2 * math.sqrt(EI / LINE)
    skipped = 2 if kind == "free" else 0  # rigid motion
    errors = np.array(
        [np.abs(frequencies(n, kind)[0][skipped : skipped + 3] / exact - 1.0) for n in (4, 8, 16)]
    )  # fmt: skip
    assert errors[-1].max() < 3e-4
    assert all(order(column) > 3.8 for column in errors.T)


def test_axial_frequencies_converge_with_order_six():
    exact = np.pi * (np.arange(3) + 0.5) / LENGTH * math.sqrt(EA / LINE)
    errors = np.array([np.abs(frequencies(n, "cantilever")[1][:3] / exact - 1.0) for n in (4, 8, 16)])
    assert errors[-1].max() < 3e-5
    assert all(order(column) > 5.4 for column in errors.T)


def test_rigid_motions_have_no_stiffness():
    bending, axial = frequencies(4, "free")
    assert max(bending[0], bending[1], axial[0]) < 1e-4 * bending[2]


def test_mass_of_rigid_motions():
    """Total mass, and the moment of inertia m L^2/3 about the first node."""
    system = System(Model(gravity=STILL, bodies=[Cable2D(**straight(3))]))
    mass, _ = system.mass_and_stiffness(system.q0)
    along = np.tile([1.0, 0.0, 0.0, 0.0], 4)
    assert abs(along @ mass @ along - LINE * LENGTH) < 1e-13
    spin = np.array(Cable2D(**straight(3, angular_velocity=1.0)).initial_state()[1])
    assert abs(spin @ mass @ spin - LINE * LENGTH**3 / 3.0) < 1e-13


def test_a_pinned_cable_hangs_like_a_chain_under_its_weight():
    """Stretch of a hanging cable: EA eps(s) = m g (L - s)."""
    cable = Cable2D(**straight(4, angle=-0.5 * math.pi))
    point = MaterialPoint2D(name="root", body="cable", point=(0.0, 0.0))
    model = Model(bodies=[cable, point], joints=[Revolute2D(name="pin", a=GROUND, b=on("root"))])
    system = System(model)
    q, _ = system.equilibrium()
    strain = cable.strains_at(q[:-3].reshape(-1, 4), [0.0, 0.5])[0]
    s = LENGTH / 4 * (np.arange(4)[:, None] + np.array([0.0, 0.5]))
    assert np.abs(strain - LINE * 9.81 * (LENGTH - s) / EA).max() < 1e-12
