"""Spheres in a box: sliding that begins at the limit of friction, and shapes that touch without force."""

import numpy as np
import pytest
from tlismni.core import (
    Axes,
    ContactGroup3D,
    CoulombFriction,
    HalfSpace3D,
    Marker3D,
    Model,
    NewtonImpact,
    RigidBody3D,
    Simulation,
    Sphere3D,
    TurningFriction,
    simulate,
)

G, WIDTH = 9.81, 0.36


def box(places, radii, speeds=None, friction=0.4, turning=None):
    """Spheres of water's tenfold density in an open box; the law's restitution is 0.3."""
    bodies, spheres = [], []
    for k, (place, radius) in enumerate(zip(places, radii, strict=True)):
        mass = 8400.0 * radius**3
        speed = {} if speeds is None else {"velocity": tuple(speeds[k][:3]), "angular_velocity": tuple(speeds[k][3:])}
        inertia = (0.4 * mass * radius**2,) * 3
        bodies.append(RigidBody3D(name=f"s{k}", mass=mass, inertia=inertia, position=tuple(place), **speed))
        spheres.append(Sphere3D(marker=Marker3D(body=f"s{k}"), radius=radius))
    walls = [((0, 0, 0), (0, 0, 1)), ((0, 0, 0), (1, 0, 0)), ((0, 0, 0), (0, 1, 0))]
    walls += [((WIDTH, 0, 0), (-1, 0, 0)), ((0, WIDTH, 0), (0, -1, 0))]
    group = ContactGroup3D(
        name="heap", spheres=spheres, law=NewtonImpact(restitution=0.3, rest_ratio=1e-3),
        half_spaces=[HalfSpace3D(marker=Marker3D(point=point, attitude=Axes(z=normal))) for point, normal in walls],
        friction=CoulombFriction(coefficient=friction), turning=turning,
    )  # fmt: skip
    return Model(gravity=(0.0, 0.0, -G), bodies=bodies, groups=[group])


def dropped(count, seed, **more):
    """Spheres in layers of nine, above the floor; their radii."""
    rng = np.random.default_rng(seed)
    radii, k = rng.uniform(0.03, 0.05, count), np.arange(count)
    places = np.stack([WIDTH * (k % 3 + 0.5) / 3, WIDTH * (k // 3 % 3 + 0.5) / 3, 0.08 + 0.13 * (k // 9)], axis=1)
    places += rng.uniform(-0.008, 0.008, (count, 3))
    return Simulation(box(places, radii, **more), "ebdf"), radii


def deepest_until(sim, radii, times):
    """The deepest overlap at these times, m."""
    deepest = 0.0
    for t in times:
        sim.advance(float(t))
        q = sim.workspace.arrays["q"][: 7 * len(radii)].reshape(-1, 7)[:, :3]
        apart = np.linalg.norm(q[:, None] - q, axis=-1) - radii[:, None] - radii + np.diag(np.full(len(radii), np.inf))
        low = np.minimum(q.min(axis=1), WIDTH - q[:, :2].max(axis=1)) - radii
        deepest = max(deepest, -float(min(apart.min(), low.min())))
    return deepest


def test_a_second_layer_costs_no_more_steps_than_its_motion():
    """Twelve spheres, three of which roll between those below. Contacts reach the limit of their friction, and slide so
    slowly that no error control sees where to: some hundred steps, not thousands of next to nothing."""
    sim, radii = dropped(12, 0)
    deepest = deepest_until(sim, radii, np.linspace(0.0, 0.302, 8)[1:])
    values = dict(zip((c.name for c in sim.table.channels), sim.values(), strict=True))
    lost = values["energy.dissipation"] + values["energy.impact_loss"]
    kinds = {event.kind for event in sim.events}
    assert {"impact", "slip", "stick", "open"} <= kinds
    assert deepest < 1e-12
    assert lost > 1.0 and values["energy.balance"] == pytest.approx(0.0, abs=1e-6 * lost)
    # each instant begins a history anew, with some ten steps
    assert sim.stats["steps"] < 12 * len({event.t for event in sim.events})


@pytest.mark.parametrize(
    ("count", "seed", "end"), [(5, 0, 1.2), *(pytest.param(12, seed, 1.6, marks=pytest.mark.full) for seed in range(4))]
)
def test_a_heap_comes_to_rest(count, seed, end):
    """With friction against rolling: what rolls without it goes on for ever."""
    sim, radii = dropped(count, seed, turning=TurningFriction(rolling=1e-3, spinning=5e-4))
    start = dict(zip((c.name for c in sim.table.channels), sim.values(), strict=True))
    assert deepest_until(sim, radii, np.linspace(0.0, end, 25)[1:]) < 1e-12
    values = dict(zip((c.name for c in sim.table.channels), sim.values(), strict=True))
    lost = values["energy.dissipation"] + values["energy.impact_loss"]
    assert lost == pytest.approx(start["energy.potential"] - values["energy.potential"], rel=1e-6)
    assert np.abs(sim.workspace.arrays["v"][: 7 * count]).max() < 1e-9
    assert max(event.t for event in sim.events) < 0.98 * end


@pytest.mark.full
def test_a_heap_whose_instants_crowd_comes_to_rest():
    """Twenty spheres, of which a ring is nearly locked between floor and wall: on by steps of impulses, to rest."""
    sim, radii = dropped(20, 0, turning=TurningFriction(rolling=1e-3, spinning=5e-4))
    start = dict(zip((c.name for c in sim.table.channels), sim.values(), strict=True))
    assert deepest_until(sim, radii, np.linspace(0.0, 1.6, 33)[1:]) < 1e-4
    assert sim.stats["impulse_steps"] > 1000
    values = dict(zip((c.name for c in sim.table.channels), sim.values(), strict=True))
    lost = values["energy.dissipation"] + values["energy.impact_loss"]
    assert values["energy.balance"] == pytest.approx(0.0, abs=1e-6 * lost)
    assert lost == pytest.approx(start["energy.potential"] - values["energy.potential"], rel=1e-5)
    assert np.abs(sim.workspace.arrays["v"][:140]).max() < 1e-2
    assert deepest_until(sim, radii, [1.6]) < 1e-9


def test_a_ball_that_rolls_along_a_wall_touches_it_without_force():
    """It rolls on the floor with a wall beside it, at no distance and without a force. Rounding moves it within what
    the wall can tell; it goes on rolling."""
    radius, speed = 0.04, 0.1
    turns = (0.0, speed / radius, 0.0)
    model = box([(0.1, radius, radius)], [radius], [(speed, 0.0, 0.0, *turns)])
    result = simulate(model, 1.5, "ebdf")
    assert result["s0.x"][-1] == pytest.approx(0.1 + 1.5 * speed, abs=1e-6)
    assert np.ptp(result["s0.y"]) < 1e-9
    assert len(result.events) < 20


@pytest.mark.parametrize("friction", [0.1, 0.3])
def test_the_way_of_sliding_is_followed_to_its_end(friction):
    """A sphere that slides on the floor with a spin: the slip keeps its direction, and it rolls after |slip|/(3.5 mu g)
    with (5 v + 2 R w x n)/7."""
    radius, v, w = 0.04, np.array([0.3, 0.1, 0.0]), np.array([4.0, -6.0, 1.0])
    model = box([(0.15, 0.15, radius)], [radius], [(*v, *w)], friction)
    across = np.cross(w, [0.0, 0.0, 1.0])
    slip = np.linalg.norm((v - radius * across)[:2])
    result = simulate(model, 0.3, "ebdf", rtol=1e-9)
    (end,) = [event.t for event in result.events if event.kind == "stick"]
    assert end == pytest.approx(slip / (3.5 * friction * G), rel=1e-7)
    rolls = (5.0 * v + 2.0 * radius * across) / 7.0
    assert [result["s0.vx"][-1], result["s0.vy"][-1]] == pytest.approx(rolls[:2], abs=1e-8)
