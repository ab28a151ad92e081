"""The cable in space: the planar one's statics and motion in any plane, momentum and energy, what is refused."""

import numpy as np
import pytest
from cables import LENGTH, System, straight
from helpers import GROUND, on
from tlismni.core import (
    AppliedForce2D,
    AppliedForce3D,
    Cable2D,
    Cable3D,
    CableClamp3D,
    Clamp2D,
    Constant,
    Marker3D,
    MaterialPoint2D,
    MaterialPoint3D,
    Model,
    ModelError,
    Revolute2D,
    RigidBody3D,
    RotationVector,
    Simulation,
    Spherical3D,
    simulate,
)
from tlismni.core.model.attitude import rotation_matrix

TURN = RotationVector(vector=(0.7, -0.4, 1.1))
AXES = rotation_matrix(TURN.parameters())
"""Columns: the axes of a plane that lies askew in space, and its normal."""
G = (0.3, -9.81)


def askew(x, y):
    """A vector of the plane, in space."""
    return tuple((AXES @ (x, y, 0.0)).tolist())


def nodes(values, width):
    """Coordinates (nodes, width) of the cable, which comes first."""
    return np.reshape(values, (-1, width))


def test_cantilever_bends_as_in_the_plane():
    """A load that bends it by half its length and stretches it, in a plane askew."""
    load = (1.0, -0.9)
    flat = Model(
        gravity=(0.0, 0.0),
        bodies=[
            Cable2D(**straight(4)),
            *(MaterialPoint2D(name=name, body="cable", point=(s, 0.0)) for name, s in (("root", 0.0), ("tip", LENGTH))),
        ],
        joints=[Clamp2D(name="clamp", a=GROUND, b=on("root"))],
        forces=[
            AppliedForce2D(
                name="load", marker=on("tip"), force_x=Constant(value=load[0]), force_y=Constant(value=load[1])
            )
        ],
    )  # fmt: skip
    force = dict(zip(("force_x", "force_y", "force_z"), (Constant(value=f) for f in askew(*load)), strict=True))
    spatial = Model(
        gravity=(0.0, 0.0, 0.0),
        bodies=[Cable3D(**straight(4), attitude=TURN), MaterialPoint3D(name="tip", body="cable", s=LENGTH)],
        joints=[CableClamp3D(name="clamp", cable="cable", s=0.0, marker=Marker3D(attitude=TURN))],
        forces=[AppliedForce3D(name="load", marker=Marker3D(body="tip"), **force)],
    )
    planar, system = System(flat), System(spatial)
    q, _ = planar.equilibrium()
    (p, lam) = system.equilibrium()
    expected, found = nodes(q[:20], 4), nodes(p[:30], 6)
    assert np.abs(expected[-1, 1]) > 0.3 * LENGTH
    assert np.abs(found[:, :3] @ AXES - np.pad(expected[:, :2], ((0, 0), (0, 1)))).max() < 1e-9
    assert np.abs(found[:, 3:] @ AXES - np.pad(expected[:, 2:], ((0, 0), (0, 1)))).max() < 1e-9
    # the clamp takes the load, and its moment about the root; multipliers: those of the tip first
    tip = expected[-1, :2]
    assert lam[3:6] == pytest.approx(-np.array(askew(*load)), abs=1e-8)
    stretch = np.linalg.norm(expected[0, 2:])
    assert lam[6] * stretch == pytest.approx(-(tip[0] * load[1] - tip[1] * load[0]), rel=1e-8)
    assert lam[7] == pytest.approx(0.0, abs=1e-7)


@pytest.mark.parametrize("method", ["ebdf", "irk", "hht"])
def test_swings_in_a_plane_askew_as_in_the_plane(method):
    fields = {"axial_damping": 2.0, "elements": 3}
    flat = Model(
        gravity=G,
        bodies=[Cable2D(**straight(3) | fields), MaterialPoint2D(name="root", body="cable", point=(0.0, 0.0))],
        joints=[Revolute2D(name="pin", a=GROUND, b=on("root"))],
    )
    spatial = Model(
        gravity=askew(*G),
        bodies=[
            Cable3D(**straight(3) | fields, attitude=TURN), MaterialPoint3D(name="root", body="cable", s=0.0),
        ],
        joints=[Spherical3D(name="pin", a=Marker3D(), b=Marker3D(body="root"))],
    )  # fmt: skip
    given = {"rtol": 1e-6, "atol": 1e-9} if method == "hht" else {"rtol": 1e-10, "atol": 1e-12}
    one, other = (simulate(m, 0.6, method, t_eval=[0.2, 0.4, 0.6], **given) for m in (flat, spatial))
    places = np.stack([[other[f"cable.{c}{k}"] for c in "xyz"] for k in range(4)])
    expected = np.stack([[one[f"cable.{c}{k}"] for c in "xy"] for k in range(4)])
    found = np.einsum("kct,cd->kdt", places, AXES)
    assert np.abs(expected[-1, 1]).max() > 0.5 * LENGTH
    # error control measures other coordinates: the same motion, not the same steps
    near = 1e-4 if method == "hht" else 1e-8
    assert np.abs(found[:, :2] - expected).max() < near
    assert np.abs(found[:, 2]).max() < 1e-9
    assert other["energy.balance"] == pytest.approx(one["energy.balance"], abs=30.0 * near)


def bent(elements):
    """A start shape that lies in no plane, nearly unstretched."""
    s = np.linspace(0.0, LENGTH, elements + 1)
    a, c = 0.35, np.sqrt(1.0 - (0.35 * 1.3) ** 2)
    place = np.stack([c * s, a * np.sin(1.3 * s), a * (1.0 - np.cos(1.3 * s))], axis=1)
    slope = np.stack([np.full_like(s, c), a * 1.3 * np.cos(1.3 * s), a * 1.3 * np.sin(1.3 * s)], axis=1)
    return tuple(map(tuple, np.hstack([place, slope]).tolist()))


def momenta(sim, model):
    """Momentum and angular momentum about the origin: sums over nodes with the consistent mass."""
    arrays, n = sim.workspace.arrays, sim.assembly.n
    system = System(model)
    mass = system.mass_and_stiffness(arrays["q"][:n].copy())[0]
    p, q = (mass @ arrays["v"][:n]).reshape(-1, 2, 3), arrays["q"][:n].reshape(-1, 2, 3)
    return p[:, 0].sum(axis=0), np.cross(q, p).sum(axis=(0, 1))


def test_free_flight_keeps_momentum_angular_momentum_and_energy():
    model = Model(
        gravity=(0.0, 0.0, 0.0),
        bodies=[
            Cable3D(
                **straight(4), shape=bent(4), velocity=(0.4, -0.2, 0.3), angular_velocity=(2.0, -3.0, 1.0),
            )
        ],
    )  # fmt: skip
    sim = Simulation(model, "irk", rtol=1e-10, atol=1e-12)
    before, values = momenta(sim, model), dict(zip((c.name for c in sim.table.channels), sim.values(), strict=True))
    sim.advance(0.5)
    after, later = momenta(sim, model), dict(zip((c.name for c in sim.table.channels), sim.values(), strict=True))
    assert np.abs(before[1]).max() > 0.5
    for x, y in zip(before, after, strict=True):
        assert y == pytest.approx(x, abs=1e-8)
    assert later["energy.balance"] == pytest.approx(values["energy.balance"], abs=1e-8)
    assert abs(later["energy.kinetic"] - values["energy.kinetic"]) > 1e-2


def test_clamp_moves_with_its_body():
    """A cable out of the side of a spinning body: the joint holds at all levels, the energy stays."""
    marker = Marker3D(body="hub", point=(0.2, 0.1, 0.0), attitude=RotationVector(vector=(0.0, 0.3, 0.2)))
    hub = RigidBody3D(name="hub", mass=2.0, inertia=(0.05, 0.06, 0.08), angular_velocity=(0.5, 1.0, 3.0))
    held = hub.position + np.array(marker.point)
    axis = marker.axes()[:, 0]
    spin = np.array(hub.angular_velocity)
    cable = Cable3D(
        **straight(2), position=tuple(held), attitude=marker.attitude,
        velocity=tuple(np.cross(spin, held)), angular_velocity=tuple(spin),
    )  # fmt: skip
    model = Model(
        gravity=(0.0, 0.0, -9.81), bodies=[hub, cable],
        joints=[CableClamp3D(name="clamp", cable="cable", s=0.0, marker=marker)],
    )  # fmt: skip
    sim = Simulation(model, "ebdf", rtol=1e-9, atol=1e-11)
    energy = [c.name for c in sim.table.channels].index("energy.balance")
    start = sim.values()[energy]
    sim.advance(0.4)
    values = dict(zip((c.name for c in sim.table.channels), sim.values(), strict=True))
    turn = rotation_matrix([values[f"hub.e{k}"] for k in range(4)])
    place = [values[f"hub.{c}"] for c in "xyz"] + turn @ marker.point
    assert [values[f"cable.{c}0"] for c in "xyz"] == pytest.approx(place, abs=1e-11)
    slope = np.array([values[f"cable.slope_{c}0"] for c in "xyz"])
    assert np.cross(slope, turn @ axis) == pytest.approx(np.zeros(3), abs=1e-11)
    arrays, m = sim.workspace.arrays, sim.assembly.m
    for level, bound in (("phi", 1e-10), ("phid", 1e-10), ("phidd", 1e-8)):
        assert np.abs(arrays[level][:m]).max() < bound
    assert sim.values()[energy] == pytest.approx(start, abs=1e-5)


@pytest.mark.parametrize(
    "change, words",
    [
        ({"shape": ((0.0,) * 3 + (1.0, 0.0, 0.0),) * 2}, "2 nodes"),
        ({"shape": ((0.0,) * 6,) * 3}, "slope zero"),
        ({"bending_stiffness": -1.0}, "bending_stiffness"),
    ],
)
def test_wrong_cables_are_refused(change, words):
    with pytest.raises(ModelError, match=words):
        Cable3D(**straight(2) | change)


def test_points_are_refused_that_no_cable_has():
    cable, body = Cable3D(**straight(2)), RigidBody3D(name="box", mass=1.0, inertia=(1.0, 1.0, 1.0))
    for point, words in (
        (MaterialPoint3D(name="p", body="cable", s=LENGTH + 0.1), "reaches from 0 to"),
        (MaterialPoint3D(name="p", body="box", s=0.1), "is a RigidBody3D"),
        (MaterialPoint3D(name="p", body="rope", s=0.1), "does not exist"),
    ):
        with pytest.raises(ModelError, match=words):
            Model(gravity=(0.0, 0.0, 0.0), bodies=[cable, body, point]).assemble()
    with pytest.raises(ModelError, match="no extension"):
        Model(
            gravity=(0.0, 0.0, 0.0),
            bodies=[cable, MaterialPoint3D(name="p", body="cable", s=0.1)],
            joints=[Spherical3D(name="j", a=Marker3D(), b=Marker3D(body="p", point=(0.1, 0.0, 0.0)))],
        ).assemble()
