"""Random scenes with indeterminate contact forces: forces of a dense reference, motion of any order and any units.

`benchmarks/indeterminate_scenes.py` runs a thousand of them.
"""

from itertools import permutations

import numpy as np
import pytest
from dense_contacts import contact_problem
from indeterminate_scenes import permuted, scene, turned
from regularised_contacts import rigid_forces
from scene_checks import deviations, first_forces, reference_forces, wrong
from tlismni.core import (
    CoulombFriction,
    HalfSpace3D,
    Marker3D,
    Model,
    NewtonImpact,
    RigidBody3D,
    Sphere3D,
    SphereOnHalfSpace3D,
    simulate,
)

G = 9.81
PLANE, SPACE = range(2009, 2032), (*range(3001, 3004), *range(3005, 3015))
"""Seeds."""
EDGES = (191, 701, 873)
"""Of stacks whose corners pass edges, in the plane: the force of a contact jumps, and with it that of others."""


@pytest.mark.sampled(8)
@pytest.mark.parametrize("seed", PLANE)
def test_planar_scene_is_that_of_any_order_and_units(seed):
    _examine(scene(seed, 2))


@pytest.mark.parametrize("seed", SPACE)
def test_spatial_scene_is_that_of_any_order_and_units(seed):
    _examine(scene(seed, 3))


@pytest.mark.sampled(1)
@pytest.mark.parametrize("seed", EDGES)
def test_corner_passes_an_edge_alike_in_any_order_and_units(seed):
    drawn = scene(seed)
    assert drawn.kind.startswith("stack2")
    _examine(drawn, orders=2)


def test_forces_in_a_groove_are_those_of_any_order():
    """Three feet on one side, at the limit of their friction, and one on the other: in two of all orders the way to
    their least forces was lost, and two feet carried nothing."""
    drawn = scene(14)
    problem = contact_problem(drawn.model)
    wanted = reference_forces(rigid_forces(problem), planar=True)
    for order in permutations(drawn.model.contacts):
        result = simulate(drawn.model.model_copy(update={"contacts": list(order)}), 0.02 * drawn.end, drawn.method)
        assert result.stats["unshared_loads"] == 0
        found = first_forces(result, problem.names, planar=True)
        np.testing.assert_allclose(found, wanted, atol=1e-8 * np.abs(wanted).max())


def _examine(drawn, orders=1):
    found, tight = deviations(drawn, orders)
    assert not wrong(found, tight), f"{drawn.kind} by {drawn.method}: {found}; {tight}"


# ---- the reference itself -------------------------------------------------------------------------------------------


def spinning(places, spin, mu=0.3):
    """A body of 2 kg on feet 0.3 m below its centre."""
    body = RigidBody3D(
        name="b", mass=2.0, inertia=(0.1, 0.1, 0.08), position=(0.0, 0.0, 0.3), angular_velocity=(0.0, 0.0, spin)
    )
    feet = [
        SphereOnHalfSpace3D(
            name=f"f{i}",
            plane=HalfSpace3D(),
            sphere=Sphere3D(marker=Marker3D(body="b", point=(x, y, -0.3)), radius=0.0),
            law=NewtonImpact(restitution=0.0),
            friction=CoulombFriction(coefficient=mu),
        )
        for i, (x, y) in enumerate(places)
    ]
    return Model(gravity=(0.0, 0.0, -G), bodies=[body], contacts=feet)


AREA = [(-0.3, -0.1), (0.2, -0.2), (-0.1, 0.25), (0.25, 0.15), (0.05, 0.02)]


def test_reference_of_feet_at_rest_is_the_least_sum_of_squares():
    wanted = np.linalg.lstsq(np.array([[1.0, x, y] for x, y in AREA]).T, np.array([2.0 * G, 0.0, 0.0]), rcond=None)[0]
    forces = rigid_forces(contact_problem(spinning(AREA, 0.0)))
    np.testing.assert_allclose(forces.values[:, 0].astype(float), wanted, rtol=1e-8)
    assert np.abs(forces.values[:, 1:]).max() < 1e-8
    assert not forces.begins.any()


def test_reference_of_feet_that_spin_brakes_each_with_its_share():
    square = [(-0.2, -0.2), (0.2, -0.2), (-0.2, 0.2), (0.2, 0.2)]
    problem = contact_problem(spinning(square, 5.0))
    forces = rigid_forces(problem)
    np.testing.assert_allclose(forces.values[:, 0].astype(float), 0.5 * G, rtol=1e-8)
    turn = problem.motion(forces.values)["b"].astype(float)
    np.testing.assert_allclose(turn[5], -0.3 * 2.0 * G * np.hypot(0.2, 0.2) / 0.08, rtol=1e-8)


@pytest.mark.sampled(8)
@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize("seed", range(12))
def test_reference_follows_the_laws_and_does_not_depend_on_its_compliance(seed, dimension):
    problem = contact_problem(scene(seed, dimension).model)
    forces, softer = rigid_forces(problem), rigid_forces(problem, 1e-8)
    values, motion = forces.values.astype(float), forces.accelerations.astype(float)
    largest, fastest = np.abs(values).max(), float(np.abs(problem.free).max())
    assert np.abs(values - softer.values.astype(float)).max() < 1e-5 * largest
    normal, friction = values[:, 0], np.linalg.norm(values[:, 1:], axis=1)
    assert normal.min() >= 0.0
    assert motion[:, 0].min() > -1e-7 * fastest
    assert np.abs(normal * motion[:, 0]).max() < 1e-7 * largest * fastest
    assert np.all(friction <= problem.static.astype(float) * normal + 1e-9 * largest)


@pytest.mark.sampled(1)
@pytest.mark.parametrize("dimension", [2, 3])
def test_reference_is_that_of_any_order_and_attitude(dimension):
    for seed in range(6):
        rng, drawn = np.random.default_rng(seed), scene(seed, dimension)
        found = []
        for model in (drawn.model, permuted(drawn.model, rng), turned(drawn.model, rng)):
            problem = contact_problem(model)
            forces = rigid_forces(problem).values.astype(float)
            sizes = {name: (row[0], np.hypot(row[1], row[2])) for name, row in zip(problem.names, forces, strict=True)}
            found.append(np.array([sizes[name] for name in sorted(sizes)]))
        for other in found[1:]:
            np.testing.assert_allclose(other, found[0], atol=1e-6 * np.abs(found[0]).max())
