"""Moreau-Jean time stepping as the method of a whole run: contacts as impulses of fixed steps, without events."""

import math

import numpy as np
import pytest
from helpers import G, point_pendulum
from test_heap3d import box
from thrown_scenes import _planar
from tlismni.core import (
    Axes,
    Box2D,
    ContactGroup2D,
    ContactGroup3D,
    CoulombFriction,
    HalfPlane2D,
    HalfSpace3D,
    Marker2D,
    Marker3D,
    Model,
    ModelError,
    NewtonImpact,
    RigidBody2D,
    RigidBody3D,
    Simulation,
    Sphere3D,
    SphereOnHalfSpace3D,
    State,
    TurningFriction,
    simulate,
)
from tlismni.models import load


def slope(steps, errors):
    return float(np.polyfit(np.log(steps), np.log(errors), 1)[0])


def boxes(rows, friction=0.5, order=None, restitution=0.0, gravity=G):
    """A pyramid of sharp boxes on the ground, `rows` of them in its lowest layer; in the order of a list."""
    width, height, mass = 0.2, 0.1, 1.0
    places = [
        ((k - 0.5 * (rows - layer - 1)) * 1.2 * width, (layer + 0.5) * height)
        for layer in range(rows)
        for k in range(rows - layer)
    ]
    places = [places[i] for i in (range(len(places)) if order is None else order)]
    moment = mass * (width**2 + height**2) / 12.0
    bodies = [RigidBody2D(name=f"b{k}", mass=mass, inertia=moment, position=place) for k, place in enumerate(places)]
    group = ContactGroup2D(
        name="pile",
        boxes=[Box2D(marker=Marker2D(body=f"b{k}"), width=width, height=height) for k in range(len(places))],
        half_planes=[HalfPlane2D(marker=Marker2D())],
        law=NewtonImpact(restitution=restitution), friction=CoulombFriction(coefficient=friction),
    )  # fmt: skip
    return Model(gravity=(0.0, -gravity), bodies=bodies, groups=[group])


def block(speed, friction=0.3):
    """A ball that cannot roll, on a plane in space: it slides until friction has stopped it."""
    ball = RigidBody3D(name="b", mass=2.0, inertia=(1e9,) * 3, position=(0.0, 0.0, 0.1), velocity=(speed, 0.0, 0.0))
    contact = SphereOnHalfSpace3D(
        name="floor", sphere=Sphere3D(marker=Marker3D(body="b"), radius=0.1), plane=HalfSpace3D(marker=Marker3D()),
        law=NewtonImpact(restitution=0.0), friction=CoulombFriction(coefficient=friction),
    )  # fmt: skip
    return Model(gravity=(0.0, 0.0, -G), bodies=[ball], contacts=[contact])


def test_order_one_through_bounces():
    """Height of a ball after its first two bounces, against the parabolas."""
    model = load("bouncing_ball").model.with_parameters({"restitution": 0.8})
    start = simulate(model, 1e-9)
    height = float(start["ball.y"][0])
    radius = height - float(start["floor.gap"][0])
    first = math.sqrt(2.0 * (height - radius) / G)
    speed = 0.8 * G * first
    second = first + 2.0 * speed / G
    t_end = second + 0.25
    exact = radius + 0.8 * speed * 0.25 - 0.5 * G * 0.25**2
    steps = 2e-3 * 0.83 ** np.arange(16)
    errors = [abs(float(simulate(model, t_end, "moreau", step=h)["ball.y"][-1]) - exact) for h in steps]
    # where in a step the ball hits is as good as random: the largest error at steps up to each size
    largest = np.maximum.accumulate(errors[::-1])[::-1]
    assert largest[0] < 3.0 * steps[0] * speed
    assert 0.7 < slope(steps, largest) < 1.5


def test_bounces_are_those_of_the_events():
    """Of a ball that spins so fast that its turns are the fastest motion of the model."""
    scenario = load("spinning_sphere")
    exact = [e for e in simulate(scenario.model, 0.7, rtol=1e-9).events if e.kind == "impact"]
    found = simulate(scenario.model, 0.7, "moreau", step=2.5e-4)
    assert len(exact) >= 4 and len(found.events) >= 4
    for bounce, other in zip(found.events[:4], exact[:4], strict=True):
        assert bounce.t == pytest.approx(other.t, abs=2e-3)
        assert bounce.approach_speed == pytest.approx(other.approach_speed, rel=0.02)
    later = simulate(scenario.model, 1.0, "moreau", step=1e-3)
    gap = next(name for name in later.channels if name.endswith(".gap"))
    # what has landed rests above the floor by what it falls in a step, at most
    assert np.max(np.abs(later[gap][-50:])) < 0.51 * G * 1e-3**2


def test_order_two_without_contacts():
    model, steps = point_pendulum(0.3, 1.0), np.array([4e-3, 2e-3, 1e-3])
    reference = simulate(model, 1.0, "irk", rtol=1e-12, atol=1e-12)
    errors = [np.max(np.abs(simulate(model, 1.0, "moreau", step=h).q[-1] - reference.q[-1])) for h in steps]
    assert slope(steps, errors) == pytest.approx(2.0, abs=0.1)


def test_a_block_is_stopped_by_friction_and_stays():
    speed, mu = 1.0, 0.3
    result = simulate(block(speed, mu), 2.0, "moreau", step=1e-3)
    stop = speed / (mu * G)
    assert result["b.x"][-1] == pytest.approx(0.5 * speed * stop, abs=1e-3 * speed)
    late = result.t > stop + 2e-3
    assert np.ptp(result["b.x"][late]) < 1e-9
    assert result["floor.normal_force"][late] == pytest.approx(2.0 * G, rel=1e-9)
    assert np.max(np.abs(result["floor.gap"])) < 1e-15
    # friction takes all of it, and the ledger says so
    assert result["energy.impact_loss"][-1] == pytest.approx(1.0, rel=1e-9)
    assert np.max(np.abs(result["energy.balance"])) < 1e-9


@pytest.mark.parametrize("rows, seed", [(2, 0), (4, 1)])
def test_pyramids_of_boxes_stay_in_any_order_of_the_list(rows, seed):
    count = rows * (rows + 1) // 2
    order = np.random.default_rng(seed).permutation(count)
    sim = Simulation(boxes(rows, order=order), "moreau", step=2e-3)
    start = sim.workspace.arrays["q"][: 3 * count].copy()
    sim.advance(2.0)
    assert np.max(np.abs(sim.workspace.arrays["q"][: 3 * count] - start)) < 1e-9
    assert np.max(np.abs(sim.workspace.arrays["v"][: 3 * count])) < 1e-9


@pytest.mark.parametrize("seed", range(2))
def test_spheres_come_to_rest_and_energy_only_falls(seed):
    count = 9
    rng = np.random.default_rng(seed)
    radii, k = rng.uniform(0.03, 0.05, count), np.arange(count)
    places = np.stack([0.12 * (k % 3 + 0.5), 0.12 * (k // 3 + 0.5), np.full(count, 0.1)], axis=1)
    places += rng.uniform(-0.008, 0.008, (count, 3))
    model = box(places, radii, turning=TurningFriction(rolling=1e-3, spinning=5e-4))
    result = simulate(model, 1.6, "moreau", step=2e-3)
    assert result.stats["impulse_steps"] == result.stats["steps"] > 700
    total = result["energy.kinetic"] + result["energy.potential"]
    assert np.max(np.diff(total)) < 1e-9 * total[0]
    assert np.max(np.abs(result.v[-1])) < 1e-9
    gaps = [result[name] for name in result.channels if name.endswith(".gap")]
    assert min(gap[1:].min() for gap in gaps) > -1e-9
    # it presses on the floor by its weight
    on_floor = [c.name for c in model.contacts if getattr(c, "plane", None) == model.groups[0].half_spaces[0]]
    assert len(on_floor) == count
    floor = sum(result[f"{name}.normal_force"][-1] for name in on_floor)
    assert floor == pytest.approx(8400.0 * G * np.sum(radii**3), rel=1e-6)


def test_it_goes_on_from_a_state_bit_for_bit():
    model = boxes(3, restitution=0.3)
    sim = Simulation(model, "moreau", step=3e-3)
    sim.advance(0.1)
    stored = sim.state().to_bytes()
    sim.advance(0.3)
    other = Simulation(model, "moreau", step=3e-3)
    other.restore(State.from_bytes(stored))
    other.advance(0.3)
    assert other.state() == sim.state()


def test_its_own_step_is_that_of_the_models_time():
    """Left out, the step follows from the model: with four times the gravity all is twice as fast, and so are steps."""
    slow, fast = simulate(boxes(2), 0.5, "moreau"), simulate(boxes(2, gravity=4.0 * G), 0.25, "moreau")
    assert slow.stats["steps"] == fast.stats["steps"] > 50
    assert fast.q[-1] == pytest.approx(slow.q[-1], abs=1e-12)


def rolling_pile(length=1.0):
    """Five spheres that fall on each other in a box and resist rolling; `length` is the unit of length, in m."""
    radii = np.array([0.05, 0.04, 0.045, 0.035, 0.04]) / length
    places = np.array([[0.1, 0.1, 0.06], [0.2, 0.1, 0.06], [0.15, 0.19, 0.06], [0.15, 0.12, 0.15], [0.1, 0.15, 0.24]])
    bodies = [
        RigidBody3D(
            name=f"s{k}", mass=1.0 + k, inertia=(0.4 * (1.0 + k) * r**2,) * 3, position=tuple(places[k] / length)
        )
        for k, r in enumerate(radii.tolist())
    ]
    group = ContactGroup3D(
        name="pile", spheres=[Sphere3D(marker=Marker3D(body=f"s{k}"), radius=r) for k, r in enumerate(radii.tolist())],
        half_spaces=[HalfSpace3D(marker=Marker3D(attitude=Axes(z=z))) for z in ((0, 0, 1), (1, 0, 0), (0, 1, 0))],
        law=NewtonImpact(restitution=0.2), friction=CoulombFriction(coefficient=0.4),
        turning=TurningFriction(rolling=2e-3 / length, spinning=1e-3 / length),
    )  # fmt: skip
    return Model(gravity=(0.0, 0.0, -G / length), bodies=bodies, groups=[group])


def test_the_unit_of_length_does_not_matter_to_what_rolls():
    """The sweeps end where no rate changes by more than a part of the largest: rates of turning are no speeds."""
    for sweeps in (30, 1000):
        metres, others = (
            simulate(rolling_pile(length), 0.4, "moreau", step=2e-3, sweeps=sweeps) for length in (1.0, 1e-3)
        )
        assert others.stats["impulse_steps"] == metres.stats["impulse_steps"] == 200
        for k in range(5):
            assert others[f"s{k}.x"][-1] == pytest.approx(1e3 * metres[f"s{k}.x"][-1], rel=1e-9)
            attitude = slice(7 * k + 3, 7 * k + 7)
            assert others.q[-1][attitude] == pytest.approx(metres.q[-1][attitude], abs=1e-8)


def test_more_sweeps_change_little():
    """What sweeps leave at their limit is taken up by the next step, which begins with these impulses."""
    few, many = (simulate(rolling_pile(), 2.5, "moreau", step=2e-3, sweeps=n) for n in (10, 30_000))
    assert few.stats["unfinished_sweeps"] > 5 and many.stats["unfinished_sweeps"] == 0
    for result in (few, many):
        assert np.max(np.abs(result.v[-1])) < 1e-12
    at_rest = [np.array([result[f"s{k}.{axis}"][-1] for k in range(5) for axis in "xyz"]) for result in (few, many)]
    assert at_rest[0] == pytest.approx(at_rest[1], abs=0.03)


def test_a_crowd_takes_memory_by_its_contacts():
    """No matrix of all that touches: the room for what an instant decides at once stays as it was."""
    sim = Simulation(boxes(5), "moreau", step=2e-3)
    sim.advance(0.01)
    assert len(sim.drive.instant.touching) >= 30 > sim.drive.instant.decided


def test_contacts_without_impulses_are_refused_by_name():
    model = load("mass_on_rod", massless_contact=True).model
    with pytest.raises(ModelError, match=r"method 'moreau' knows contacts as impulses, and contact '\w+' has none"):
        simulate(model, 1e-4, "moreau")


def test_energy_from_restitution_is_said(caplog):
    """Sharp boxes that are almost elastic and rough: Newton's law gives energy where many corners strike at once."""
    scene = thrown_boxes(restitution=0.9)
    result = simulate(scene, 1.2, "moreau", step=1e-3)
    added = -np.diff(result["energy.impact_loss"])
    assert np.max(added) > 1e-3 * np.max(result["energy.kinetic"])
    assert [f"added {np.max(added):.3g} J" in record.message for record in caplog.records].count(True) == 1
    caplog.clear()
    simulate(thrown_boxes(restitution=0.0), 1.2, "moreau", step=1e-3)
    assert not [record for record in caplog.records if "added" in record.message]


def thrown_boxes(restitution):
    """Seed 7040 of twelve bodies and fewer in a trough."""
    rng = np.random.default_rng(7040)
    count = int(rng.integers(6, 13))
    rng.choice(5), rng.choice(4)
    contact = {"law": NewtonImpact(restitution=restitution), "friction": CoulombFriction(coefficient=0.9)}
    return _planar(rng, count, contact)
