"""Impacts that several contacts share: chains of balls by each law, blows beside contacts that last."""

import math

import numpy as np
import pytest
from helpers import G, events, on
from sliders import PLASTIC, foot
from test_several_contacts import HEIGHT, MASS, WIDTH, block
from tlismni.core import (
    Disk2D,
    DiskOnDisk2D,
    DiskOnHalfPlane2D,
    HalfPlane2D,
    Marker2D,
    Model,
    NewtonImpact,
    PointMass2D,
    PoissonImpact,
    RigidBody2D,
    simulate,
)
from tlismni.core.events.impact_retries import MOST_BOUNCES

# ---- chains of balls ------------------------------------------------------------------------------------------------


def balls(speeds, laws, masses=None):
    """Balls of radius 0.1 in a row that touch."""
    count = len(speeds)
    masses = masses or [1.0] * count
    bodies = [
        PointMass2D(name=f"b{i}", mass=masses[i], position=(0.2 * i, 0.0), velocity=(speeds[i], 0.0))
        for i in range(count)
    ]
    contacts = [
        DiskOnDisk2D(
            name=f"c{i}", a=Disk2D(marker=on(f"b{i}"), radius=0.1), b=Disk2D(marker=on(f"b{i + 1}"), radius=0.1),
            law=laws[i] if isinstance(laws, list) else laws,
        )
        for i in range(count - 1)
    ]  # fmt: skip
    return Model(gravity=(0.0, 0.0), bodies=bodies, contacts=contacts)


def after(model):
    result = simulate(model, 1e-3)
    return np.array([result[f"{b.name}.vx"][-1] for b in model.bodies]), result


def test_three_equal_balls_by_each_law():
    """Newton at once, one blow after another, Poisson (impulses of compression 2/3, 1/3 doubled)."""
    at_once, _ = after(balls((1.0, 0.0, 0.0), NewtonImpact(restitution=1.0)))
    assert at_once == pytest.approx([-1.0 / 3.0, 2.0 / 3.0, 2.0 / 3.0], abs=1e-13)
    sequential, _ = after(balls((1.0, 0.0, 0.0), NewtonImpact(restitution=1.0, propagation="sequential")))
    assert sequential == pytest.approx([0.0, 0.0, 1.0], abs=1e-13)
    poisson, _ = after(balls((1.0, 0.0, 0.0), PoissonImpact(restitution=1.0)))
    assert poisson == pytest.approx([-1.0 / 3.0, 2.0 / 3.0, 2.0 / 3.0], abs=1e-13)
    plastic, _ = after(balls((1.0, 0.0, 0.0), PLASTIC))
    assert plastic == pytest.approx([1.0 / 3.0] * 3, abs=1e-13)


def test_five_balls():
    e = 1.0
    sequential = NewtonImpact(restitution=e, propagation="sequential")
    for speeds in ((1.0, 0, 0, 0, 0), (1.0, 1.0, 0, 0, 0), (1.0, 1.0, 1.0, 0, 0), (1.0, 0, 0, 0, -1.0)):
        found, _ = after(balls(speeds, sequential))
        assert found == pytest.approx(speeds[::-1], abs=1e-13)
    # at once: the first contact is struck; 0 <= g'+ + e g'-: the first ball recoils, the others go on as one
    at_once, result = after(balls((1.0, 0, 0, 0, 0), NewtonImpact(restitution=e)))
    assert at_once == pytest.approx([-0.6, 0.4, 0.4, 0.4, 0.4], abs=1e-13)
    # none of them grazes: each passes on what those behind it get
    assert [event.kind for event in result.events if event.impulse > 0.0] == ["impact"] * 4
    assert np.abs(result["energy.balance"]).max() < 1e-13
    assert 0.5 * at_once @ at_once == pytest.approx(0.5, rel=1e-12)


def test_each_contact_has_its_own_restitution():
    """g'+ = -e_i g'- where impulses are positive: a heavy ball against two light ones that come towards it."""
    laws = [NewtonImpact(restitution=0.9), NewtonImpact(restitution=0.2)]
    speeds, masses = (1.0, 0.0, -2.0), [1.0, 2.0, 3.0]
    found, result = after(balls(speeds, laws, masses))
    assert np.diff(found) == pytest.approx([0.9 * 1.0, 0.2 * 2.0], rel=1e-12)
    assert np.dot(masses, found) == pytest.approx(np.dot(masses, speeds), rel=1e-13)
    hits = {e.contact: e for e in events(result, "impact")}
    assert hits["c0"].impulse == pytest.approx(-masses[0] * (found[0] - 1.0), rel=1e-12)
    assert hits["c1"].impulse == pytest.approx(masses[2] * (found[2] + 2.0), rel=1e-12)
    assert all(e.velocity_increment_residual < 1e-13 for e in hits.values())


# ---- impacts beside contacts that last ------------------------------------------------------------------------------


@pytest.mark.parametrize("law", [NewtonImpact(restitution=0.5), PoissonImpact(restitution=0.5)])
def test_ball_strikes_a_block_that_sticks_to_the_floor(law):
    """A ball flies horizontally against a block that stands with friction: the floor gives no normal impulse, so none
    along it either; the block slides off with the speed of the collision and stops by friction."""
    mu, mass, u = 0.4, 1.0, 2.0
    model = block(2, mu, mass=MASS)
    ball = PointMass2D(name="ball", mass=mass, position=(-1.0, 0.5 * HEIGHT), velocity=(u, 0.0))
    side = DiskOnHalfPlane2D(
        name="side", plane=HalfPlane2D(marker=on("b", -0.5 * WIDTH, 0.0, 0.5 * math.pi)),
        disk=Disk2D(marker=on("ball")), law=law,
    )  # fmt: skip
    model = model.model_copy(update={"bodies": (*model.bodies, ball), "contacts": (*model.contacts, side),
                                     "gravity": (0.0, -G)})  # fmt: skip
    # so that it arrives level with the centre of mass
    t = (1.0 - 0.5 * WIDTH) / u
    ball = ball.model_copy(update={"velocity": (u, 0.5 * G * t)})
    model = model.model_copy(update={"bodies": (model.bodies[0], ball)})
    result = simulate(model, 1.0, rtol=1e-9)
    hits = events(result, "impact")
    assert {e.contact for e in hits} == {"side"} and len(hits) == 1
    reduced = mass * MASS / (mass + MASS)
    assert hits[0].impulse == pytest.approx(1.5 * reduced * u, rel=1e-8)
    speed = hits[0].impulse / MASS
    assert [e.contact for e in events(result, "slip")] == ["f0", "f1"]
    stops = events(result, "stick")
    assert [e.t for e in stops] == pytest.approx([hits[0].t + speed / (mu * G)] * 2, abs=1e-8)
    assert result["b.x"][-1] == pytest.approx(speed**2 / (2.0 * mu * G), rel=1e-7)


def test_blow_from_above_on_a_sticking_block_holds_it_by_the_floors_impulse():
    """The floor answers a slanted blow with a normal impulse and with as much along it as keeps the block at rest."""
    mu, mass, u = 0.8, 0.5, 3.0
    model = block(2, mu)
    slant = 0.3
    top = HalfPlane2D(marker=on("b", 0.0, 0.5 * HEIGHT, slant))
    height, direction = 0.4, np.array([math.sin(slant), -math.cos(slant)])
    start = np.array([0.0, HEIGHT]) - direction * height
    ball = PointMass2D(name="ball", mass=mass, position=tuple(start), velocity=tuple(u * direction))
    hit = DiskOnHalfPlane2D(name="hit", plane=top, disk=Disk2D(marker=on("ball")), law=NewtonImpact(restitution=0.5))
    model = model.model_copy(update={"bodies": (*model.bodies, ball), "contacts": (*model.contacts, hit)})
    result = simulate(model, 0.3, rtol=1e-9)
    blow = events(result, "impact")[0]
    assert blow.contact == "hit"
    together = [e for e in events(result, "impact") if e.t == blow.t and e.contact != "hit"]
    assert sum(e.impulse for e in together) == pytest.approx(blow.impulse * math.cos(slant), rel=1e-9)
    assert sum(e.friction_impulse for e in together) == pytest.approx(-blow.impulse * math.sin(slant), rel=1e-9)
    assert blow.impulse == pytest.approx(1.5 * mass * blow.approach_speed, rel=1e-9)
    assert not events(result, "slip", "open")
    assert np.abs(result["b.x"]).max() < 1e-12


def test_contact_released_by_a_blow_on_another_contact():
    """A see-saw lies on two pegs and is struck at one end: it turns about the near peg, the other lets go at once."""
    plank = RigidBody2D(name="plank", mass=4.0, inertia=1.0)
    ball = PointMass2D(name="ball", mass=1.0, position=(0.9, 0.3))
    pegs = [foot(name, "plank", x, mu=0.5) for name, x in (("left", -0.3), ("right", 0.3))]
    hit = DiskOnHalfPlane2D(
        name="hit", plane=HalfPlane2D(marker=on("plank")), disk=Disk2D(marker=on("ball")), law=PLASTIC
    )
    result = simulate(Model(bodies=[plank, ball], contacts=[*pegs, hit]), 0.26, rtol=1e-9)
    blow = next(e for e in events(result, "impact") if e.contact == "hit")
    reduced = 1.0 / (1.0 + 0.6**2 / (1.0 + 4.0 * 0.3**2))
    assert blow.impulse == pytest.approx(reduced * math.sqrt(2.0 * G * 0.3), rel=1e-8)
    released = next(e for e in events(result, "open") if e.contact == "left")
    assert released.t == blow.t
    rate = 0.6 * blow.impulse / (1.0 + 4.0 * 0.3**2)
    assert released.separation_speed == pytest.approx(0.6 * rate, rel=1e-8)


def test_two_contacts_close_at_once_at_different_places():
    """Two separate balls fall side by side on the floor: one instant, two impacts that do not know of each other."""
    bodies = [PointMass2D(name=f"b{i}", mass=1.0 + i, position=(float(i), 0.5)) for i in range(2)]
    laws = [NewtonImpact(restitution=e) for e in (0.3, 0.8)]
    contacts = [foot(f"c{i}", f"b{i}", mu=None, law=laws[i]) for i in range(2)]
    result = simulate(Model(bodies=bodies, contacts=contacts), 0.4, rtol=1e-9)
    speed = math.sqrt(G)
    hits = events(result, "impact")[:2]
    assert {e.contact for e in hits} == {"c0", "c1"} and hits[0].t == hits[1].t
    assert hits[0].t == pytest.approx(speed / G, abs=1e-10)
    for e in hits:
        i = int(e.contact[1])
        assert e.impulse == pytest.approx((1.0 + i) * (1.0 + laws[i].restitution) * speed, rel=1e-9)


# ---- rounds that feed each other ------------------------------------------------------------------------------------


@pytest.mark.parametrize("law", [NewtonImpact, PoissonImpact])
@pytest.mark.parametrize("e, lasts", [(1.0, True), (0.9, True), (0.3, False)])
def test_ball_between_floor_and_ceiling(law, e, lasts):
    """It touches both: each throws it against the other, at one instant. Where that does not die away, the last of
    MOST_BOUNCES + 1 rounds is without restitution."""
    ball = PointMass2D(name="b", mass=2.0, position=(0.0, 0.5), velocity=(1.0, -1.0))
    floor = foot("floor", "b", mu=None, radius=0.5, law=law(restitution=e))
    ceiling = HalfPlane2D(marker=Marker2D(point=(0.0, 1.0), angle=math.pi))
    above = foot("ceiling", "b", mu=None, radius=0.5, plane=ceiling, law=law(restitution=e))
    result = simulate(Model(gravity=(0.0, 0.0), bodies=[ball], contacts=[floor, above]), 0.1)
    struck = {event.contact: event for event in result.events if event.kind == "impact"}
    assert all(event.t == 0.0 for event in struck.values()) and len(struck) == 2
    # m (1 + e) e^k in round k, in turns, and what is left to the floor
    blows = [2.0 * (1.0 + e) * e**k for k in range(MOST_BOUNCES)]
    left = 2.0 * e**MOST_BOUNCES if lasts else 0.0
    assert struck["floor"].impulse == pytest.approx(sum(blows[::2]) + left, rel=1e-11)
    assert struck["ceiling"].impulse == pytest.approx(sum(blows[1::2]), rel=1e-11)
    assert sum(event.energy_loss for event in struck.values()) == pytest.approx(1.0, rel=1e-12)
    assert result["b.vx"][-1] == pytest.approx(1.0, abs=1e-13) and abs(result["b.vy"][-1]) < 1e-11
