"""The tippe top on its patch: Newton's and Euler's equations by scipy, with the ellipsoid and the patch's integral."""

import math
from functools import cache

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.special import ellipe, ellipk
from tlismni.core import simulate
from tlismni.models import load

MASS, ACROSS, AT_LIMIT, RADIUS, CENTRE, PATCH, MU, G = 6e-3, 8e-7, 7e-7, 15e-3, 3e-3, 5e-4, 0.3, 9.81
TILT, SPIN, STEM = 0.1, 180.0, (5.0 - 15.0) / (16.0 - 3.0)
UP = np.array([0.0, 0.0, 1.0])


def ellipsoid(u, w):
    """Friction along the tangents and torque about the normal, for each newton of mu N."""
    r = 2.0 / 3.0 * PATCH
    s = math.hypot(*u, r * w)
    return u / s, r * r * w / s


def patch(u, w):
    """The same of Coulomb's friction at each place of a disk under constant pressure, by complete elliptic integrals
    (Lurie; Leine and Glocker 2003, Eur. J. Mech. A/Solids 22, 193)."""
    speed, rim = math.hypot(*u), PATCH * abs(w)
    if speed <= rim:
        x = max(speed / rim, 1e-9)
        k, e = ellipk(x * x), ellipe(x * x)
        force = 4.0 / (3.0 * math.pi) * ((x * x + 1.0) * e + (x * x - 1.0) * k) / x if x > 1e-5 else x
        torque = 4.0 / (9.0 * math.pi) * ((4.0 - 2.0 * x * x) * e + (x * x - 1.0) * k)
    else:
        x = speed / rim
        k, e = ellipk(1.0 / (x * x)), ellipe(1.0 / (x * x))
        force = 4.0 / (3.0 * math.pi) * ((x * x + 1.0) * e - (x * x - 1.0) * k)
        torque = 4.0 / (9.0 * math.pi) * x * ((4.0 - 2.0 * x * x) * e + (2.0 * x * x - 5.0 + 3.0 / (x * x)) * k)
    return force * u / max(speed, 1e-300), math.copysign(torque * PATCH, w)


def quadrature(u, w):
    """The same by summing over the disk."""
    radii = (np.arange(400) + 0.5) / 400 * PATCH
    angles = (np.arange(400) + 0.5) / 400 * 2.0 * math.pi
    r, angle = (a.ravel() for a in np.meshgrid(radii, angles))
    x, y = u[0] - w * r * np.sin(angle), u[1] + w * r * np.cos(angle)
    share = r / r.sum() / np.hypot(x, y)
    return np.array([share @ x, share @ y]), share @ (r * (y * np.cos(angle) - x * np.sin(angle)))


@pytest.mark.parametrize("u", [(0.01, 0.02), (0.05, 0.0), (0.3, -0.1)])
def test_the_patchs_integral(u):
    """Written out, and what the ellipsoid has in its place: both ends alike, between them a fifth more at most here."""
    u, w = np.array(u), 150.0
    force, torque = patch(u, w)
    summed, turned = quadrature(u, w)
    assert force == pytest.approx(summed, rel=2e-3, abs=1e-4)
    assert torque == pytest.approx(turned, rel=2e-3)
    for way in (1e-4, 1e4):
        (f, m), (g, n) = ellipsoid(way * u, w), patch(way * u, w)
        # nearly spinning alone, nearly sliding alone
        assert (m == pytest.approx(n, rel=1e-3)) if way < 1.0 else (f == pytest.approx(g, rel=1e-6))


@cache
def course(friction, until):
    """Axis, angular velocity and velocity along the floor of the top on its large sphere; it ends where the stem
    touches."""

    def rates(_, y):
        e, w, v = y[:3], y[3:6], y[6:8]
        turns, arm = np.cross(w, e), CENTRE * e - RADIUS * UP
        slip = np.array([v[0], v[1], -CENTRE * turns[2]]) + np.cross(w, arm)
        force, drill = friction(slip[:2], w[2])
        push = UP - MU * np.append(force, 0.0)
        torque = np.cross(arm, push) - MU * drill * UP
        inertia = ACROSS * np.eye(3) + (AT_LIMIT - ACROSS) * np.outer(e, e)
        free = np.linalg.solve(inertia, -(AT_LIMIT - ACROSS) * (w @ e) * turns)
        pushed = np.linalg.solve(inertia, torque)
        # the lowest point stays on the floor: m z'' = N - m g, z = R - c e_z
        falls = -CENTRE * (np.cross(free, e) + np.cross(w, turns))[2]
        normal = (falls + G) / (1.0 / MASS + CENTRE * np.cross(pushed, e)[2])
        return np.concatenate([turns, free + normal * pushed, -MU * normal / MASS * force])

    def touches(_, y):
        return y[2] - STEM

    touches.terminal = True
    e = np.array([0.0, -math.sin(TILT), math.cos(TILT)])
    start = np.concatenate([e, SPIN * e, np.zeros(2)])
    return solve_ivp(rates, (0.0, until), start, method="LSODA", rtol=1e-9, atol=1e-12, events=touches,
                     dense_output=True)  # fmt: skip


def upright(result):
    """Cosine of the angle between the axis and the vertical."""
    return 1.0 - 2.0 * (result["top.e1"] ** 2 + result["top.e2"] ** 2)


def energy(result):
    return result["energy.kinetic"] + result["energy.potential"] + result["energy.strain"]


def test_it_turns_over_as_its_equations_say():
    """The angle of its axis until the stem touches, at 1.373 s; half a turn later it stands on the stem."""
    found, scenario = course(ellipsoid, 2.0), load("tippe_top")
    result = simulate(scenario.model, 2.0, rtol=1e-9, atol=1e-12)
    stem = next(event.t for event in result.events if event.contact == "stem")
    assert stem == pytest.approx(found.t_events[0][0], rel=1e-5)
    before = result.t < stem
    assert upright(result)[before] == pytest.approx(found.sol(result.t[before])[2], abs=1e-4)
    assert upright(result)[-1] < -0.98 and result["top.z"][-1] > result["top.z"][0] + 3e-3
    assert np.all(np.diff(energy(result)) < 1e-8 * energy(result)[0])
    assert np.ptp(result["energy.balance"]) < 1e-6 * energy(result)[0]


def test_the_patchs_integral_turns_it_over_at_the_same_time():
    """Leine's and Glocker's friction in the ellipsoid's place."""
    one, other = (course(friction, 2.0) for friction in (patch, ellipsoid))
    assert one.t_events[0][0] == pytest.approx(other.t_events[0][0], rel=1e-3)
    times = np.linspace(0.0, 1.3, 27)
    angles = [np.arccos(found.sol(times)[2]) for found in (one, other)]
    assert np.abs(angles[0] - angles[1]).max() < 0.05


def test_by_force_it_does_so_too():
    """On a floor that gives way, with friction that is regularised."""
    scenario = load("tippe_top", law="hunt_crossley", restitution=0.3, stiffness=1e7, transition_speed=1e-4)
    result = simulate(scenario.model, 2.0, rtol=1e-7, atol=1e-10)
    stem = next(event.t for event in result.events if event.contact == "stem")
    assert stem == pytest.approx(course(ellipsoid, 2.0).t_events[0][0], rel=0.02)
    assert upright(result)[-1] < -0.98
    assert np.all(np.diff(energy(result)) < 1e-7 * energy(result)[0])


def test_on_a_point_it_does_not():
    """It rolls after 0.04 s, and stays nearly upright: what turns it over is friction on the patch."""
    result = simulate(load("tippe_top", patch_radius=0.0).model, 2.0, rtol=1e-9, atol=1e-12)
    assert [event.kind for event in result.events] == ["close", "stick"]
    assert result.events[-1].t == pytest.approx(0.04, abs=0.005)
    assert upright(result).min() > math.cos(0.11)
