"""A block in space whose feet slide beyond the edge of what they stand on: its motion does not change."""

import itertools

import numpy as np
import pytest
from helpers import G, events
from test_mesh_shapes import cube
from tlismni.core import (
    CoulombFriction,
    Marker3D,
    Model,
    NewtonImpact,
    RigidBody3D,
    Sphere3D,
    SphereOnMesh3D,
    TriangleMesh3D,
    simulate,
)

MU, RADIUS, HEIGHT, SPEED, EDGE = 0.2, 2e-3, 0.1, 2.0, 0.3
PLATE = (2.0, 2.0, 1.0)
ROWS = {"three": (0.25, 0.05, -0.15), "two close ones": (0.25, 0.248, -0.15), "close and loaded": (0.05, 0.048, -0.35)}
"""Places along the block, from its centre of mass."""
AWAY = 0.05
"""How far the first row is from the edge at the start."""


def slider(rows, order):
    """A block on rows of two feet across its way; the first rows leave a plate at EDGE."""
    vertices, faces = cube(PLATE)
    middle = Marker3D(point=(EDGE - 0.5 * PLATE[0], 0.0, -0.5 * PLATE[2]))
    plate = TriangleMesh3D(marker=middle, vertices=vertices, faces=faces)
    start = EDGE - AWAY - rows[0]
    block = RigidBody3D(
        name="b", mass=1.0, inertia=(0.01, 0.02, 0.03), position=(start, 0.0, HEIGHT), velocity=(SPEED, 0.0, 0.0)
    )
    points = list(itertools.product(rows, (-0.1, 0.1)))
    feet = [
        SphereOnMesh3D(
            name=f"f{i}",
            mesh=plate,
            sphere=Sphere3D(marker=Marker3D(body="b", point=(*points[i], RADIUS - HEIGHT)), radius=RADIUS),
            law=NewtonImpact(restitution=0.0),
            friction=CoulombFriction(coefficient=MU),
        )
        for i in order
    ]
    return Model(gravity=(0.0, 0.0, -G), bodies=[block], contacts=feet)


def _reached(way):
    """When the block has slid so far, s."""
    braking = MU * G
    return (SPEED - np.sqrt(SPEED**2 - 2.0 * braking * way)) / braking


@pytest.mark.sampled(6)
@pytest.mark.parametrize("method", ["ebdf", "irk", "bdf"])
@pytest.mark.parametrize("order", [(0, 1, 2, 3, 4, 5), (5, 2, 0, 3, 1, 4)])
@pytest.mark.parametrize("rows", ROWS.values(), ids=ROWS)
def test_feet_leave_a_plate_without_a_blow(rows, order, method):
    """The rows that are left carry the weight: the block slides on as before, until its centre is beyond them."""
    # the second row is still on the plate, and the friction below the centre of mass does not tip the block over it
    leaves, ends = _reached(AWAY), _reached(AWAY + 0.75 * (rows[0] - rows[1]))
    times = np.linspace(0.0, ends, 41)
    result = simulate(slider(rows, order), ends, method, rtol=1e-8, atol=1e-11, t_eval=times)
    x = result["b.x"] - result["b.x"][0]
    np.testing.assert_allclose(x, SPEED * times - 0.5 * MU * G * times**2, atol=1e-8)
    np.testing.assert_allclose(result["b.z"], HEIGHT, atol=1e-9)
    assert np.max(result["residual.position"]) < 1e-9
    opened = {event.contact: event.t for event in events(result, "open")}
    assert opened == {"f0": pytest.approx(leaves, abs=1e-6), "f1": pytest.approx(leaves, abs=1e-6)}
    assert all(event.approach_speed <= 1e-8 for event in events(result, "impact"))
    carried = [result[f"f{i}.normal_force"][-1] for i in (2, 4)]
    # friction acts below the centre of mass
    lever, turns = rows[1] - rows[2], MU * G * HEIGHT
    wanted = [0.5 * (turns - G * rows[2]) / lever, 0.5 * (G * rows[1] - turns) / lever]
    np.testing.assert_allclose(carried, wanted, rtol=1e-6)
