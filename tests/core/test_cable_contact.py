"""A disk on a deformable cable: gap, its derivatives, and a contact that moves from element to element."""

import math

import numpy as np
import pytest
from cables import straight
from helpers import GROUND, events, on
from test_tangents import Point, check_levels, check_matrix, draw
from tlismni.core import (
    Cable2D,
    Clamp2D,
    Disk2D,
    DiskOnCable2D,
    Hertz,
    KelvinVoigt,
    MaterialPoint2D,
    Model,
    ModelError,
    NewtonImpact,
    PointMass2D,
    Revolute2D,
    RigidBody2D,
    curvature,
    simulate,
)
from tlismni.core.elements.cable_shape import weights
from tlismni.core.state.modes import ACTIVE, CLOSED

SHAPE = ((0.0, 0.0, 1.1, 0.4), (0.9, 0.3, 0.9, 0.2), (2.0, 0.2, 1.0, -0.5))
FINE = 2e-3


def contact(law, radius=0.4, body="b", point=(0.1, -0.2)):
    disk = Disk2D(marker=on(body, *point), radius=radius)
    return DiskOnCable2D(name="c", cable="cable", thickness=0.1, disk=disk, law=law)


def system(law, place, mode=None):
    body = RigidBody2D(name="b", mass=0.7, inertia=0.2, position=place)
    cable = Cable2D(**straight(2, shape=SHAPE))
    return Point(Model(bodies=[body, cable], contacts=[contact(law)]), mode)


@pytest.mark.parametrize("law, mode", [(NewtonImpact(restitution=0.5), CLOSED), (Hertz(stiffness=5.0), ACTIVE)])
@pytest.mark.parametrize("place", [(0.4, 0.5), (1.5, 0.1), (2.3, 0.4), (-0.4, 0.3)])
def test_tangent_and_levels_of_a_disk_on_a_cable(law, mode, place):
    """Above the first element, below the second, beyond the end and before the start."""
    point = system(law, place, mode)
    for seed in range(2):
        state = draw(point, seed)
        state[1] = point.workspace.assembly.q0 + 0.2 * (state[1] - point.workspace.assembly.q0)
        check_matrix(point, state, h=FINE)
        check_levels(point, state, h=FINE)


def test_gap_is_the_distance_from_the_curve():
    """Against the nearest of many points of the cubics; the disk sweeps over the border between the elements."""
    point = system(NewtonImpact(restitution=0.5), (0.0, 0.0))
    state = [0.0, point.workspace.assembly.q0.copy(), *(np.zeros(point.n) for _ in range(2)), np.zeros(1)]
    nodes = np.array(SHAPE)
    curve = []
    for e in range(2):
        vectors = np.array([nodes[e, :2], nodes[e, 2:], nodes[e + 1, :2], nodes[e + 1, 2:]])
        curve += [weights(x, 1.0, 0) @ vectors for x in np.linspace(0.0, 1.0, 20001)]
    curve = np.array(curve)
    for x in np.linspace(-0.5, 2.5, 31):
        for y in (0.9, -0.6):
            state[1][:3] = x, y, 0.0
            gap = point.at(*state)[1][0]
            exact = np.min(np.hypot(curve[:, 0] - x - 0.1, curve[:, 1] - y + 0.2)) - 0.5
            assert abs(gap - exact) < 1e-8


def test_curvature_changes_once_between_two_elements():
    """There both are as near as the other within sqrt(rounding): which one acts must not change at random."""
    point = system(NewtonImpact(restitution=0.5), (0.0, 0.0))
    joint, ahead = np.array(SHAPE[1][:2]), np.array(SHAPE[1][2:]) / np.hypot(*SHAPE[1][2:])
    for side in (-1.0, 1.0):
        seen = []
        for s in np.linspace(-1e-8, 1e-8, 401):
            q, v = point.workspace.assembly.q0.copy(), np.zeros(point.n)
            q[:2] = joint + s * ahead + side * 0.5 * np.array([-ahead[1], ahead[0]]) - (0.1, -0.2)
            v[:2] = ahead
            seen.append(point.at(0.0, q, v, np.zeros(point.n), np.zeros(1))[3][0])
        assert np.count_nonzero(np.abs(np.diff(seen)) > 1e-3) == 1


def bridge(law, elements=6, speed=3.0, mass=0.3):
    """A cable between two pins, and a mass that slides along on top of it."""
    points = [MaterialPoint2D(name=n, body="cable", point=(s, 0.0)) for n, s in (("left", 0.0), ("right", 2.0))]
    cable = Cable2D(**straight(elements, axial_damping=1.0, bending_damping=0.05))
    ball = PointMass2D(name="ball", mass=mass, position=(0.2, 0.1), velocity=(speed, 0.0))
    joints = [
        Revolute2D(name="pin", a=GROUND, b=on("left")), Revolute2D(name="other", a=on("ground", 2.0), b=on("right")),
    ]  # fmt: skip
    disk = DiskOnCable2D(name="c", cable="cable", thickness=0.02, law=law,
                         disk=Disk2D(marker=on("ball"), radius=0.08))  # fmt: skip
    return Model(bodies=[ball, cable, *points], joints=joints, contacts=[disk])


def check_passage(result, elements):
    """The contact passes all borders without a jump in gap, force or energy."""
    place = result["ball.x"] * elements / 2.0
    assert place[0] < 1.0 and place[-1] > elements - 1.6
    steps = np.abs(np.diff(result["c.gap"]))
    dt = np.diff(result.t)
    moving = dt > 0.0
    assert np.all(steps[moving] <= 3.0 * dt[moving] + 1e-9)
    borders = [k for k in range(len(place) - 1) if int(place[k]) != int(place[k + 1]) and moving[k]]
    assert len(borders) >= elements - 2
    return borders


def test_a_mass_slides_over_element_borders_as_a_constraint():
    """Plastic contact: the gap stays closed over the borders in contact, the force changes there no more than in the
    steps beside, and the energy balance holds."""
    result = simulate(bridge(NewtonImpact(restitution=0.0)), 0.5, rtol=1e-6)
    borders = check_passage(result, 6)
    force, inside = result["c.normal_force"], result["c.in_contact"] > 0.5
    largest = force.max()
    for k in borders:
        if inside[k] and inside[k + 1]:
            # as far as the force moves in the steps beside this one
            near = np.delete(np.abs(np.diff(force[max(k - 6, 0) : k + 8])), min(k, 6))
            assert abs(force[k + 1] - force[k]) < 3.0 * np.max(near) + 1e-3 * largest
    assert np.abs(result["c.gap"][inside]).max() < 1e-9
    assert abs(result["energy.balance"][-1]) < 1e-4
    assert events(result, "close")
    assert not [e for e in events(result, "impact") if e.t > 0.3 and e.energy_loss > 1e-3]


def test_a_constraint_force_jumps_at_borders_by_mass_and_curvature():
    """Where the foot passes from cubic to cubic: |dN| <= m v^2 |d kappa|, less because the cable gives way, with its
    sign; no more than rounding and a step's change where the curvature goes on."""
    model = bridge(NewtonImpact(restitution=0.0), speed=1.0, mass=1.0)
    result = simulate(model, 1.4, rtol=1e-6)
    force, inside, dt = result["c.normal_force"], result["c.in_contact"] > 0.5, np.diff(result.t)
    found = 0
    for node in range(1, 6):
        (x, y), (tx, ty) = (
            [result[f"cable.{what}{axis}{node}"] for axis in ("x", "y")] for what in ("", "slope_")
        )  # fmt: skip
        past = (result["ball.x"] - x) * tx + (result["ball.y"] - y) * ty > 0.0
        before, behind = curvature(result, model.bodies[1], 2.0 * node / 6.0 + np.array([-1e-7, 1e-7])).T
        for k in np.flatnonzero(past[1:] != past[:-1]):
            if not (inside[k] and inside[k + 1] and dt[k] > 0.0):
                continue
            square = sum((result[f"ball.v{a}"][k] - result[f"cable.v{a}{node}"][k]) ** 2 for a in ("x", "y"))
            largest = 1.0 * square * (behind[k] - before[k]) * (1.0 if past[k + 1] else -1.0)
            # as far as the force moves in the steps beside this one
            near = np.delete(np.abs(np.diff(force[max(k - 6, 0) : k + 8])), min(k, 6)).max()
            share = (force[k + 1] - force[k]) / largest
            assert -3.0 * near / abs(largest) < share < 0.5 + 3.0 * near / abs(largest)
            found += 1
    assert found >= 4


def test_a_mass_slides_over_element_borders_with_a_contact_force():
    result = simulate(bridge(KelvinVoigt(stiffness=2e4, damping=20.0)), 0.5, rtol=1e-6)
    borders = check_passage(result, 6)
    force = result["c.normal_force"]
    dt = np.diff(result.t)
    slope = np.abs(np.diff(force))[dt > 0.0] / dt[dt > 0.0]
    assert slope.max() < 2e4 * 5.0  # k times the speed: no jump anywhere, at borders neither
    assert all(abs(force[k + 1] - force[k]) <= 2e4 * 5.0 * dt[k] for k in borders)
    assert np.abs(result["energy.balance"]).max() < 1e-4


def test_static_weight_on_a_cantilever_element_or_border_alike():
    """A ball at rest at the tip side of a clamped cable: the same deflection whatever the mesh says about borders."""
    found = []
    for elements in (3, 4):
        points = [MaterialPoint2D(name=n, body="cable", point=(s, 0.0)) for n, s in (("root", 0.0), ("tip", 2.0))]
        cable = Cable2D(**straight(elements, axial_damping=10.0, bending_damping=1.0, bending_stiffness=50.0))
        ball = RigidBody2D(name="ball", mass=0.5, inertia=1e-3, position=(1.5, 0.1))
        hold = Clamp2D(name="clamp", a=GROUND, b=on("root"))
        disk = DiskOnCable2D(name="c", cable="cable", thickness=0.02, law=KelvinVoigt(stiffness=2e4, damping=50.0),
                             disk=Disk2D(marker=on("ball"), radius=0.08))  # fmt: skip
        model = Model(bodies=[ball, cable, *points], joints=[hold], contacts=[disk])
        found.append(simulate(model, 0.15, method="irk", rtol=1e-6)["ball.y"][-1])
    assert abs(found[0] - found[1]) < 2e-4


def test_what_cannot_touch_is_refused():
    cable, body = Cable2D(**straight(2)), RigidBody2D(name="b", mass=1.0, inertia=1.0)
    law, disk = NewtonImpact(restitution=0.5), Disk2D(marker=on("b"), radius=0.1)
    with pytest.raises(ModelError, match="which is no Cable2D"):
        Model(bodies=[body], contacts=[DiskOnCable2D(name="c", cable="b", disk=disk, law=law)])
    with pytest.raises(ModelError, match="both 0"):
        DiskOnCable2D(name="c", cable="cable", disk=Disk2D(marker=on("b")), law=law)
    own = MaterialPoint2D(name="p", body="cable", point=(1.0, 0.0))
    with pytest.raises(ModelError, match="itself"):
        touching = DiskOnCable2D(name="c", cable="cable", disk=Disk2D(marker=on("p"), radius=0.1), law=law)
        Model(bodies=[cable, own], contacts=[touching])
    assert math.isclose(DiskOnCable2D(name="c", cable="cable", disk=disk, thickness=0.2, law=law).extent(), 0.3)
