"""Boxes and convex polyhedra on each other: they fall, lie, stand in stacks, slide, strike by their edges, collide."""

import numpy as np
import pytest
from solids import EULER, clearance, random_shape, uniform_box
from tlismni.core import (
    Box3D,
    Capsule3D,
    ContactGroup3D,
    ConvexPolyhedron3D,
    CoulombFriction,
    EdgesOnEdges3D,
    HalfSpace3D,
    KelvinVoigt,
    Marker3D,
    Model,
    NewtonImpact,
    RigidBody3D,
    RotationVector,
    Sphere3D,
    TanhFriction,
    simulate,
)
from tlismni.core.contacts.edges3d import ROUND
from tlismni.core.model.attitude import rotation_matrix

G = 9.81
DOWN = (0.0, 0.0, -G)
SOFT = NewtonImpact(restitution=0.3, rest_ratio=1e-3)
TABLE = Box3D(marker=Marker3D(), size=(1.0, 1.0, 0.2))
SIZE = (0.4, 0.3, 0.2)


def only_in_full(seeds):
    """With `-m full` only."""
    return [pytest.param(seed, marks=pytest.mark.full) for seed in seeds]


def on(body, size=SIZE, **more):
    return Box3D(marker=Marker3D(body=body), size=size, **more)


def carried(result, model):
    """Sum of the normal forces at the end, N, and how many there are."""
    forces = np.array([result[f"{contact.name}.normal_force"][-1] for contact in model.contacts])
    return forces.sum(), int((forces > 1e-9 * G).sum())


def energy(result):
    return result["energy.kinetic"] + result["energy.potential"]


@pytest.mark.sampled(2)
@pytest.mark.parametrize("friction", [None, CoulombFriction(coefficient=0.4)], ids=["smooth", "rough"])
@pytest.mark.parametrize("falls", [(0.0, 0.0, 0.3), (0.5, 0.0, 0.2), (0.5, 0.6, 0.1)], ids=["face", "edge", "corner"])
def test_a_box_falls_on_a_box_and_lies(falls, friction):
    box = uniform_box("box", SIZE, position=(0.0, 0.0, 0.4), attitude=RotationVector(vector=falls))
    group = ContactGroup3D(name="g", boxes=[TABLE, on("box")], law=SOFT, friction=friction)
    model = Model(gravity=DOWN, bodies=[box], groups=[group])
    result = simulate(model, 1.5, rtol=1e-8)
    assert result["box.z"][-1] == pytest.approx(0.2, abs=1e-11)
    if friction is None:
        assert np.abs([result[f"box.{v}"][-1] for v in ("vz", "angular_velocity_x", "angular_velocity_y")]).max() < 1e-9
    else:
        assert result["energy.kinetic"][-1] < 1e-15
    assert carried(result, model)[0] == pytest.approx(G, rel=1e-9)
    assert np.diff(energy(result)).max() < 1e-8 and np.abs(result["energy.balance"]).max() < 1e-7
    assert clearance(result, TABLE, on("box")).min() > -1e-9


def test_three_boxes_stand_on_each_other():
    """The forces under each are the weights above it, and nothing moves; the lowest stands on a floor."""
    sizes, masses = [(0.4, 0.3, 0.2), (0.35, 0.3, 0.15), (0.4, 0.2, 0.1)], (3.0, 2.0, 1.0)
    bodies, height = [], 0.0
    for name, size, mass in zip("abc", sizes, masses, strict=True):
        bodies.append(uniform_box(name, size, mass, position=(0.0, 0.0, height + 0.5 * size[2])))
        height += size[2]
    shapes = [on(name, size) for name, size in zip("abc", sizes, strict=True)]
    group = ContactGroup3D(
        name="g", boxes=shapes, half_spaces=[HalfSpace3D()], law=SOFT, friction=CoulombFriction(coefficient=0.5)
    )
    model = Model(gravity=DOWN, bodies=bodies, groups=[group])
    result = simulate(model, 1.0)
    for name in "abc":
        for axis in "xyz":
            assert np.ptp(result[f"{name}.{axis}"]) < 1e-12
    for pair, weight in (("a_ground", 6.0), ("b_a", 3.0), ("a_b", 3.0), ("c_b", 1.0), ("b_c", 1.0)):
        forces = [result[f"{c.name}.normal_force"][-1] for c in model.contacts if c.name.startswith(f"g_{pair}_")]
        assert not forces or sum(forces) == pytest.approx(weight * G, rel=1e-9)
    assert clearance(result, shapes[0], shapes[1]).min() > -1e-12


def test_a_plank_lies_across_another_by_its_edges():
    """No corner of one is over the other."""
    size = (1.0, 0.2, 0.1)
    plank = uniform_box("box", size, position=(0.05, 0.02, 0.3), attitude=RotationVector(vector=(0.05, 0.03, 1.4)))
    group = ContactGroup3D(
        name="g", boxes=[Box3D(marker=Marker3D(), size=size), on("box", size)], law=SOFT,
        friction=CoulombFriction(coefficient=0.5),
    )  # fmt: skip
    model = Model(gravity=DOWN, bodies=[plank], groups=[group])
    result = simulate(model, 5.0)
    assert result["box.z"][-1] == pytest.approx(0.1, abs=1e-11) and result["energy.kinetic"][-1] < 1e-15
    carry = [c for c in model.contacts if result[f"{c.name}.normal_force"][-1] > 1e-9]
    assert len(carry) >= 2 and all(isinstance(contact, EdgesOnEdges3D) for contact in carry)
    assert carried(result, model)[0] == pytest.approx(G, rel=1e-9)


@pytest.mark.parametrize("radius", [0.0, 0.02])
def test_edge_strikes_edge(radius):
    """Two free boxes on edge, one along x, one along y: P = (1 + e) v/sum(1/m + (r x n) J^-1 (r x n))."""
    sizes, (m, x, y), speed, e = ((0.8, 0.2, 0.2), (0.2, 0.7, 0.2)), (2.0, 0.15, -0.1), 1.5, 0.6
    round_by = radius if radius > 0.0 else ROUND * 0.2
    # from the middle of a box to its edge
    high = np.sqrt(2.0) * (0.1 - round_by) + round_by
    bodies = [
        uniform_box("a", sizes[0], m, attitude=RotationVector(vector=(np.pi / 4.0, 0.0, 0.0))),
        uniform_box(
            "b", sizes[1], position=(x, y, 2.0 * high + 0.1), velocity=(0.0, 0.0, -speed),
            attitude=RotationVector(vector=(0.0, np.pi / 4.0, 0.0)),
        ),
    ]  # fmt: skip
    shapes = [on(name, size, edge_radius=radius) for name, size in zip("ab", sizes, strict=True)]
    group = ContactGroup3D(name="g", boxes=shapes, law=NewtonImpact(restitution=e))
    result = simulate(Model(gravity=(0.0, 0.0, 0.0), bodies=bodies, groups=[group]), 0.1)
    (hit,) = [event for event in result.events if event.kind == "impact"]
    assert hit.t == pytest.approx(0.1 / speed, rel=1e-12)
    inverse_mass = 0.0
    for body, place in zip(bodies, ((x, 0.0, high), (0.0, -y, -high)), strict=True):
        axes, lever = rotation_matrix(body.attitude.parameters()), np.cross(place, (0.0, 0.0, 1.0))
        inverse_mass += 1.0 / body.mass + lever @ axes @ ((axes.T @ lever) / np.array(body.inertia))
    assert hit.impulse == pytest.approx((1.0 + e) * speed / inverse_mass, rel=1e-10)
    assert result["b.vz"][-1] == pytest.approx(hit.impulse - speed, rel=1e-10)
    assert result["a.vz"][-1] == pytest.approx(-hit.impulse / m, rel=1e-10)


def momenta(result, bodies):
    """Momentum and angular momentum about the origin at each sample, (samples, 6)."""
    total = np.zeros((len(result.t), 6))
    for body in bodies:
        x, v, w = (
            np.column_stack([result[f"{body.name}.{what}{axis}"] for axis in "xyz"])
            for what in ("", "v", "angular_velocity_")
        )
        euler = np.column_stack([result[f"{body.name}.{part}"] for part in EULER])
        axes = np.array([rotation_matrix(parameters) for parameters in euler])
        spin = np.einsum("kij,j,klj,kl->ki", axes, np.array(body.inertia), axes, w)
        total += np.hstack((body.mass * v, np.cross(x, body.mass * v) + spin))
    return total


def thrown(seed):
    """Two or three shapes that fly at each other, turning."""
    rng = np.random.default_rng(seed)
    names = "abc"[: 2 + seed % 2]
    shapes = [
        random_shape(rng, name, *((("box", 0.0), ("box", 0.01), ("hull", 1e-3))[rng.integers(0, 3)])) for name in names
    ]
    bodies = []
    for k, name in enumerate(names):
        angle = 2.0 * np.pi * k / len(names)
        way = 0.6 * np.array((np.cos(angle), np.sin(angle), 0.0))
        bodies.append(
            RigidBody3D(
                name=name, mass=float(rng.uniform(0.5, 2.0)), inertia=tuple(rng.uniform(0.02, 0.03, 3)),
                position=tuple(way + rng.uniform(-0.1, 0.1, 3)), velocity=tuple(-way * rng.uniform(1.0, 2.5)),
                attitude=RotationVector(vector=tuple(rng.uniform(-2.0, 2.0, 3))),
                angular_velocity=tuple(rng.uniform(-6.0, 6.0, 3)),
            )
        )  # fmt: skip
    return bodies, shapes


def group_of(shapes, **more):
    boxes = [shape for shape in shapes if isinstance(shape, Box3D)]
    return ContactGroup3D(
        name="g", boxes=boxes, polyhedra=[shape for shape in shapes if isinstance(shape, ConvexPolyhedron3D)], **more
    )


def overlap(result, shapes):
    """The deepest overlap of any two at any sample, m, by least squares."""
    return -min(clearance(result, a, b).min() for k, a in enumerate(shapes) for b in shapes[:k])


@pytest.mark.sampled(2)
@pytest.mark.parametrize("seed", [*range(5), *only_in_full(range(5, 10))])
def test_what_is_thrown_at_each_other_keeps_momentum_and_energy(seed):
    """Without loss; the impacts themselves are exact, and the flight between them to what it is integrated to."""
    bodies, shapes = thrown(seed)
    model = Model(gravity=(0.0, 0.0, 0.0), bodies=bodies, groups=[group_of(shapes, law=NewtonImpact(restitution=1.0))])
    result = simulate(model, 1.0, rtol=1e-11, atol=1e-13)
    hits = [event for event in result.events if event.kind == "impact"]
    assert hits and overlap(result, shapes) < 1e-12
    total = momenta(result, bodies)
    assert np.ptp(total[:, :3], axis=0).max() < 1e-13 and np.ptp(total[:, 3:], axis=0).max() < 1e-9
    for hit in {event.t for event in hits}:
        at = np.flatnonzero(result.t == hit)
        before, after = at[0], at[-1]
        assert after > before
        assert result["energy.kinetic"][after] == pytest.approx(result["energy.kinetic"][before], rel=1e-12)
        assert total[after] == pytest.approx(total[before], abs=1e-12)


@pytest.mark.sampled(2)
@pytest.mark.parametrize("seed", [*range(20, 24), 48, *only_in_full(range(24, 30))])
def test_what_sticks_to_each_other_and_slides_off_keeps_momentum(seed):
    """Without bounce, with friction: they turn about edges and corners, slide over them and part."""
    bodies, shapes = thrown(seed)
    law, friction = NewtonImpact(restitution=0.0, rest_ratio=1e-3), CoulombFriction(coefficient=0.3)
    model = Model(gravity=(0.0, 0.0, 0.0), bodies=bodies, groups=[group_of(shapes, law=law, friction=friction)])
    result = simulate(model, 1.5, rtol=1e-7)
    assert overlap(result, shapes) < 1e-7
    assert np.ptp(momenta(result, bodies), axis=0).max() < 2e-6
    assert np.abs(result["energy.balance"]).max() < 2e-6
    assert all(event.energy_loss > -1e-12 for event in result.events)


def test_a_polyhedron_comes_to_rest_on_another():
    """Unsymmetrical, on a wide frustum: it lies on three places that carry its weight, and its centre is over them."""
    points = [(0.2, 0.0, 0.0), (-0.15, 0.1, 0.0), (-0.1, -0.17, 0.02), (0.03, 0.05, 0.24), (0.1, 0.12, 0.1)]
    stone = ConvexPolyhedron3D(marker=Marker3D(body="stone", point=(0.0, 0.0, -0.08)), vertices=points, radius=0.005)
    below = [
        (x, y, z)
        for z, half in ((-0.3, 0.6), (0.0, 0.5))
        for x, y in ((half, 0.4), (half, -0.4), (-half, 0.4), (-half, -0.3))
    ]
    block = ConvexPolyhedron3D(marker=Marker3D(), vertices=below)
    start = {"position": (0.0, 0.0, 0.35), "attitude": RotationVector(vector=(1.2, 0.4, 0.3))}
    body = RigidBody3D(name="stone", mass=2.0, inertia=(0.012, 0.015, 0.018), **start)
    group = group_of([block, stone], law=SOFT, friction=CoulombFriction(coefficient=0.6))
    model = Model(gravity=DOWN, bodies=[body], groups=[group])
    result = simulate(model, 3.0, rtol=1e-7)
    assert result["energy.kinetic"][-1] < 1e-12 and np.diff(energy(result)).max() < 1e-6
    assert carried(result, model)[0] == pytest.approx(2.0 * G, rel=1e-6)
    assert overlap(result, [block, stone]) < 1e-8 and abs(clearance(result, block, stone)[-1]) < 1e-9


def test_a_box_slides_on_a_box_as_on_a_floor():
    start = {"position": (-1.0, 0.1, 0.1), "velocity": (2.0, 0.4, 0.0), "angular_velocity": (0.0, 0.0, 2.0)}
    bodies, rough = [uniform_box("box", SIZE, **start)], CoulombFriction(coefficient=0.3)
    floor = (
        {"half_spaces": [HalfSpace3D()]},
        {"boxes": [Box3D(marker=Marker3D(point=(0, 0, -0.5)), size=(8.0, 8.0, 1.0))]},
    )
    ends = []
    for kind in floor:
        boxes = [on("box", edge_radius=ROUND * 0.2), *kind.get("boxes", ())]
        group = ContactGroup3D(name="g", boxes=boxes, half_spaces=kind.get("half_spaces", ()), law=SOFT, friction=rough)
        result = simulate(Model(gravity=DOWN, bodies=bodies, groups=[group]), 0.5, rtol=1e-8)
        ends.append([result[f"box.{name}"][-1] for name in ("x", "y", "e3", "vx", "vy", "angular_velocity_z")])
    assert ends[0] == pytest.approx(ends[1], abs=1e-6)


def test_a_box_slides_over_the_edge_of_another():
    """Without friction: until it tips nothing slows it down, and then no energy is lost but by blows."""
    box = uniform_box("box", SIZE, position=(0.1, 0.05, 0.2), velocity=(1.0, 0.1, 0.0))
    group = ContactGroup3D(name="g", boxes=[TABLE, on("box")], law=NewtonImpact(restitution=0.2, rest_ratio=1e-3))
    model = Model(gravity=DOWN, bodies=[box], groups=[group])
    result = simulate(model, 1.0, rtol=1e-8)
    flat = result["box.x"] < 0.499
    assert flat.sum() > 3 and np.abs(result["box.z"] - 0.2)[flat].max() < 1e-10
    assert result["box.vx"][flat] == pytest.approx(1.0, abs=1e-9)
    assert result["box.z"][-1] < 0.0 and result["box.x"][-1] > 0.6
    assert np.abs(result["energy.balance"]).max() < 1e-6 and np.diff(energy(result)).max() < 1e-6
    assert clearance(result, TABLE, on("box")).min() > -1e-7


def test_balls_a_capsule_and_boxes_in_one_group():
    """Each lies on the box, the box on a floor."""
    capsule = Capsule3D(
        marker=Marker3D(body="pill", attitude=RotationVector(vector=(0.0, np.pi / 2.0, 0.0))), length=0.3, radius=0.05
    )
    bodies = [
        uniform_box("base", (1.2, 0.8, 0.2), 5.0, position=(0.0, 0.0, 0.1)),
        uniform_box("box", SIZE, position=(0.3, 0.0, 0.35)),
        RigidBody3D(name="ball", mass=0.5, inertia=(2e-3,) * 3, position=(-0.4, 0.1, 0.4)),
        RigidBody3D(name="pill", mass=0.8, inertia=(1e-3, 7e-3, 7e-3), position=(-0.2, -0.2, 0.4)),
    ]
    group = ContactGroup3D(
        name="g", spheres=[Sphere3D(marker=Marker3D(body="ball"), radius=0.1)], capsules=[capsule],
        boxes=[on("base", (1.2, 0.8, 0.2)), on("box")], half_spaces=[HalfSpace3D()], law=SOFT,
        friction=CoulombFriction(coefficient=0.5),
    )  # fmt: skip
    result = simulate(Model(gravity=DOWN, bodies=bodies, groups=[group]), 1.5)
    for name, height in (("base", 0.1), ("box", 0.3), ("ball", 0.3), ("pill", 0.25)):
        assert result[f"{name}.z"][-1] == pytest.approx(height, abs=1e-8)
    assert result["energy.kinetic"][-1] < 1e-10 and np.diff(energy(result)).max() < 1e-6


def test_a_box_with_round_edges_lies_by_a_force_law():
    """Four springs side by side carry it, less deep than its edges are round."""
    law, friction = KelvinVoigt(stiffness=2e3, damping=30.0), TanhFriction(coefficient=0.3, transition_speed=1e-3)
    box = uniform_box("box", SIZE, position=(0.0, 0.0, 0.21))
    group = ContactGroup3D(name="g", boxes=[TABLE, on("box", edge_radius=0.02)], law=law, friction=friction)
    model = Model(gravity=DOWN, bodies=[box], groups=[group])
    result = simulate(model, 3.0, rtol=1e-8)
    assert result["box.z"][-1] == pytest.approx(0.2 - G / (4.0 * 2e3), abs=1e-6)
    assert carried(result, model) == (pytest.approx(G, rel=1e-4), 4)
