"""Ropes, end stops of joints, boxes and groups of shapes against closed forms."""

import math

import numpy as np
import pytest
from helpers import GROUND, G, events, on, pendulum_angles, rod_pendulum
from tlismni.core import (
    AngleStop2D,
    Box2D,
    CoulombFriction,
    Disk2D,
    DiskOnBox2D,
    DiskOnDisk2D,
    DiskOnHalfPlane2D,
    DiskOnPolygon2D,
    HalfPlane2D,
    KelvinVoigt,
    Marker2D,
    Model,
    ModelError,
    NewtonImpact,
    PointMass2D,
    Polygon2D,
    RigidBody2D,
    Rope2D,
    Segment2D,
    TanhFriction,
    contacts_between,
    simulate,
)
from tlismni.core.analysis import static_equilibrium

TIGHT = {"rtol": 1e-10, "atol": 1e-12}
DEAD = NewtonImpact(restitution=0.0)


def roped(law, position=(0.6, 0.0), velocity=(0.0, 0.0), length=1.0):
    """A bob on a rope from the origin."""
    bob = PointMass2D(name="bob", mass=2.0, position=position, velocity=velocity)
    return Model(bodies=[bob], contacts=[Rope2D(name="rope", b=on("bob"), length=length, law=law)])


def test_a_slack_rope_pulls_taut_with_a_jerk():
    """Free fall at x = 0.6 until y = -0.8: the rope takes the radial part of the velocity, sqrt(2 g 0.8) 0.8."""
    result = simulate(roped(DEAD), 0.8, **TIGHT)
    (jerk,) = events(result, "impact")
    speed = math.sqrt(2.0 * G * 0.8)
    assert jerk.t == pytest.approx(math.sqrt(1.6 / G), abs=1e-9)
    assert jerk.impulse == pytest.approx(2.0 * 0.8 * speed, rel=1e-9)
    assert jerk.energy_loss == pytest.approx((0.8 * speed) ** 2, rel=1e-9)
    after = result.t > jerk.t
    assert np.hypot(result["bob.x"], result["bob.y"])[after] == pytest.approx(np.ones(np.sum(after)), abs=1e-9)
    # then it is a pendulum, with the tension of one
    v2 = result["bob.vx"] ** 2 + result["bob.vy"] ** 2
    tension = 2.0 * (v2 - G * result["bob.y"])
    assert result["rope.normal_force"][after][1:] == pytest.approx(tension[after][1:], rel=1e-6)


def test_a_rope_goes_slack_on_the_way_up():
    """Thrown from the bottom with v^2 = 3.5 g L: slack where cos a = -(v^2 - 2 g L)/(3 g L) = -1/2."""
    result = simulate(roped(DEAD, (0.0, -1.0), (math.sqrt(3.5 * G), 0.0)), 1.2, **TIGHT)
    slack = events(result, "open")[0]
    y = np.interp(slack.t, result.t, result["bob.y"])
    assert y == pytest.approx(0.5, abs=1e-6)


def test_an_elastic_rope_only_pulls():
    """A bob under a spring that only pulls, thrown up from its rest: half a sine below, a parabola above."""
    k, m = 2000.0, 2.0
    rest = m * G / k
    model = roped(KelvinVoigt(stiffness=k, damping=0.0), (0.0, -1.0 - rest), (0.0, 2.0))
    result = simulate(model, 0.6, **TIGHT)
    omega = math.sqrt(k / m)
    t_open = events(result, "open")[0].t
    assert rest - 2.0 / omega * math.sin(omega * t_open) == pytest.approx(0.0, abs=1e-8)
    free = result["rope.gap"] > 1e-9
    assert np.all(result["rope.normal_force"][free] == 0.0) and np.sum(free) > 3
    assert np.abs(result["energy.balance"]).max() < 1e-7
    taut = static_equilibrium(roped(KelvinVoigt(stiffness=k, damping=0.0)))
    assert taut["bob.y"] == pytest.approx(-1.0 - rest, rel=1e-9)


def test_a_slack_rope_whose_ends_meet_has_a_gap_still():
    result = simulate(roped(DEAD, (0.0, 0.0), (0.3, 0.0), length=5.0), 0.1)
    assert result["rope.gap"][0] == pytest.approx(5.0, rel=1e-7) and not events(result, "impact")


@pytest.mark.parametrize("restitution", [0.0, 0.6])
@pytest.mark.parametrize("side", ["upper", "lower"])
def test_a_pendulum_strikes_the_stop_of_its_joint(side, restitution):
    """Impulse of the torque I (1 + e) w; the mirrored motion strikes the mirrored stop alike."""
    limit = -0.5 * math.pi + 0.3 if side == "lower" else -0.5 * math.pi - 0.3
    start = 0.0 if side == "lower" else -math.pi
    model = rod_pendulum(start)
    stop = AngleStop2D(name="stop", b=on("rod"), limit=limit, side=side, law=NewtonImpact(restitution=restitution))
    result = simulate(Model(bodies=model.bodies, joints=model.joints, contacts=[stop]), 0.75, **TIGHT)
    strike = events(result, "impact")[0]
    rate = math.sqrt(3.0 * G * math.cos(0.3))  # (w^2/2) L^2/3 = g L/2 cos(0.3)
    assert strike.approach_speed == pytest.approx(rate, rel=1e-8)
    assert strike.impulse == pytest.approx((1.0 + restitution) * rate / 3.0, rel=1e-8)
    assert pendulum_angles([strike.t], stiffness=1.5 * G)[0, 0] == pytest.approx(-0.5 * math.pi + 0.3, abs=1e-8)
    units = {c.name: c.unit for c in result.channel_records}
    assert units["stop.normal_force"] == "N.m" and units["stop.gap"] == "rad"
    if restitution == 0.0:
        # it lies on the stop: the torque there is that of its weight
        assert result["stop.normal_force"][-1] == pytest.approx(0.5 * G * math.sin(0.3), rel=1e-8)


BOX = Box2D(marker=Marker2D(body="box", point=(0.1, -0.05), angle=0.3), width=0.8, height=0.5)


def on_box(x, y):
    """A place in the axes of the box's marker, in those of its body."""
    c, s = math.cos(0.3), math.sin(0.3)
    return 0.1 + c * x - s * y, -0.05 + s * x + c * y


PLACES = {
    "right": ((0.45, 0.1), (0.4, 0.0, -0.5 * math.pi)), "left": ((-0.45, -0.1), (-0.4, 0.0, 0.5 * math.pi)),
    "top": ((0.1, 0.3), (0.0, 0.25, 0.0)), "bottom": ((-0.2, -0.3), (0.0, -0.25, math.pi)),
}  # fmt: skip
CORNERS = [(0.4, 0.25), (-0.4, 0.25), (-0.4, -0.25), (0.4, -0.25)]


def two_bodies(place):
    box = RigidBody2D(name="box", mass=1.5, inertia=0.2, velocity=(0.3, -0.2), angular_velocity=0.5)
    ball = RigidBody2D(name="ball", mass=0.7, inertia=0.01, position=on_box(*place), velocity=(-0.1, 0.4),
                       angular_velocity=2.0)  # fmt: skip
    return box, ball


def compare(place, reference, radius):
    """Accelerations, force and friction of a disk pressed into a box against those of a simpler shape."""
    law, friction = KelvinVoigt(stiffness=500.0, damping=2.0), TanhFriction(coefficient=0.4, transition_speed=0.1)
    disk = Disk2D(marker=on("ball"), radius=radius)
    ends = []
    for made in (
        DiskOnBox2D(name="c", shape=BOX, disk=disk, law=law, friction=friction),
        reference(disk, law, friction),
    ):
        model = Model(gravity=(0.0, 0.0), bodies=two_bodies(place), contacts=[made])
        result = simulate(model, 0.004, step=1e-3, method="hht")
        ends.append([*result.a[0], *result.a[-1], result["c.normal_force"][-1], abs(result["c.friction_force"][-1])])
    assert abs(ends[0][-2]) > 1.0
    assert ends[0] == pytest.approx(ends[1], rel=1e-9, abs=1e-9)


@pytest.mark.parametrize("face", PLACES)
def test_a_face_of_a_box_is_a_half_plane(face):
    place, (x, y, angle) = PLACES[face]

    def plane(disk, law, friction):
        marker = Marker2D(body="box", point=on_box(x, y), angle=0.3 + angle)
        return DiskOnHalfPlane2D(name="c", plane=HalfPlane2D(marker=marker), disk=disk, law=law, friction=friction)

    compare(place, plane, 0.08)


@pytest.mark.parametrize("corner", CORNERS)
def test_a_corner_of_a_box_is_a_point(corner):
    place = tuple(x + 0.05 * math.copysign(1.0, x) for x in corner)

    def point(disk, law, friction):
        tip = Disk2D(marker=Marker2D(body="box", point=on_box(*corner)))
        return DiskOnDisk2D(name="c", a=tip, b=disk, law=law, friction=friction)

    compare(place, point, 0.1)


@pytest.mark.parametrize("place", [*(place for place, _ in PLACES.values()), (0.45, 0.3), (-0.45, -0.29)])
def test_a_polygon_of_four_corners_acts_as_a_box(place):
    """Beside its sides and about its corners, with friction and rolling."""

    def polygon(disk, law, friction):
        shape = Polygon2D(marker=BOX.marker, vertices=[(-0.4, 0.25), (-0.4, -0.25), (0.4, -0.25), (0.4, 0.25)])
        return DiskOnPolygon2D(name="c", shape=shape, disk=disk, law=law, friction=friction)

    compare(place, polygon, 0.1)


def test_the_sliding_distance_goes_on_round_the_box():
    """Once round without a jump: the whole is the outline with arcs of the disk's radius at the corners."""
    from tlismni.core.contacts.disk_on_box2d import box_slide
    from tlismni.core.elements import Frame2D

    radius, box = 0.1, Frame2D(0.0, 0.0, 0.0, 1.0, 0.0)
    outline = []
    for k, (x, y) in enumerate([(0.4, 0.25), (-0.4, 0.25), (-0.4, -0.25), (0.4, -0.25)]):
        angles = 0.5 * math.pi * k + np.linspace(0.0, 0.5 * math.pi, 200)
        outline += [(x + radius * math.cos(a), y + radius * math.sin(a)) for a in angles]
    points = np.array([*outline, outline[0]])
    steps = np.hypot(*np.diff(points, axis=0).T)
    s = np.array([box_slide(box, Frame2D(x, y, 0.0, 1.0, 0.0), 0.4, 0.25, radius) for x, y in points])
    period = 2.0 * (0.8 + 0.5) + 2.0 * math.pi * radius
    gone = np.mod(np.diff(s), period)
    assert gone == pytest.approx(steps, rel=1e-4, abs=1e-9)
    assert np.sum(gone) == pytest.approx(period, rel=1e-12)


def block(name, x, y, size=0.4, **start):
    body = RigidBody2D(name=name, mass=2.0, inertia=2.0 * size**2 / 6.0, position=(x, y), **start)
    return body, Box2D(marker=on(name), width=size, height=size)


def test_a_block_slides_to_rest_on_the_ground():
    """mu g: the way is v^2/(2 mu g), on its two lower corners."""
    body, box = block("block", 0.0, 0.2, velocity=(1.5, 0.0))
    contacts = contacts_between("group", [HalfPlane2D(), box], law=DEAD, friction=CoulombFriction(coefficient=0.3))
    assert [c.name for c in contacts] == [f"group_ground_block_{k}" for k in (1, 2, 3, 4)]
    result = simulate(Model(bodies=[body], contacts=contacts), 1.0, rtol=1e-8)
    assert result["block.x"][-1] == pytest.approx(1.5**2 / (2.0 * 0.3 * G), rel=1e-6)
    assert np.abs(result["block.angle"]).max() < 1e-9


def test_a_box_rests_on_its_two_lower_corners():
    """Each carries half of the weight, at the penetration of its spring."""
    body, box = block("box", 0.0, 0.2)
    contacts = contacts_between("g", [HalfPlane2D(), box], law=KelvinVoigt(stiffness=1e4, damping=20.0))
    rest = static_equilibrium(Model(bodies=[body], contacts=contacts))
    forces = [rest[f"g_ground_box_{k}.normal_force"] for k in (1, 2, 3, 4)]
    assert sorted(forces) == pytest.approx([0.0, 0.0, G, G], rel=1e-9)
    assert rest["box.y"] == pytest.approx(0.2 - G / 1e4, rel=1e-9)


def test_a_stack_of_two_boxes_rests():
    """The lower one carries both weights, the upper one's two corners on its top the weight above it."""
    lower, low = block("low", 0.0, 0.2)
    upper, high = block("high", 0.0, 0.55, size=0.3)
    contacts = contacts_between("g", [HalfPlane2D(), low, high], law=KelvinVoigt(stiffness=1e6, damping=200.0))
    rest = static_equilibrium(Model(bodies=[lower, upper], contacts=contacts))
    below = sum(rest[f"g_ground_low_{k}.normal_force"] for k in (1, 2, 3, 4))
    between = sum(rest[f"g_low_high_{k}.normal_force"] for k in range(1, 9))
    assert below == pytest.approx(4.0 * G, rel=1e-9)
    assert between == pytest.approx(2.0 * G, rel=1e-9)
    assert rest["high.y"] == pytest.approx(0.55 - 3.0 * G / 1e6, abs=1e-9)


def test_disks_in_a_group_strike_as_pairs_listed_by_hand():
    rng = np.random.default_rng(2)
    balls = [
        RigidBody2D(name=f"b{k}", mass=1.0, inertia=0.1, position=(0.5 * k, 0.0), velocity=tuple(rng.normal(size=2)))
        for k in range(4)
    ]
    disks = [Disk2D(marker=on(b.name), radius=0.2) for b in balls]
    law = NewtonImpact(restitution=1.0)
    group = contacts_between("g", disks, law=law)
    pairs = [DiskOnDisk2D(name=f"p{i}{j}", a=disks[i], b=disks[j], law=law) for i in range(4) for j in range(i + 1, 4)]
    ends = [simulate(Model(gravity=(0.0, 0.0), bodies=balls, contacts=c), 1.0).q[-1] for c in (group, pairs)]
    assert np.array_equal(ends[0], ends[1])


def test_what_is_left_out_of_a_group():
    law = DEAD
    disks = [Disk2D(marker=on(name), radius=0.1) for name in ("a", "a", "b", "c")]
    names = {c.name for c in contacts_between("g", disks, law=law, except_bodies=[("b", "c")])}
    assert names == {"g_a_b_1", "g_a_b_2", "g_a_c_1", "g_a_c_2"}
    others = contacts_between("g", disks[2:], [HalfPlane2D()], law=law)
    assert [c.name for c in others] == ["g_b_ground", "g_c_ground"]
    with pytest.raises(ModelError, match="no two shapes that can touch"):
        contacts_between("g", disks[:2], law=law)
    with pytest.raises(ModelError, match="make the segment a thin box"):
        contacts_between("g", [block("x", 0, 0)[1], Segment2D(marker=on("y"), length=1.0)], law=law)


def test_refusals():
    friction = CoulombFriction(coefficient=0.2)
    with pytest.raises(ModelError, match="nothing slides on it"):
        Rope2D(name="r", a=GROUND, b=on("bob"), length=1.0, law=DEAD, friction=friction)
    with pytest.raises(ModelError, match="nothing slides on it"):
        AngleStop2D(name="s", b=on("bob"), limit=1.0, law=DEAD, friction=friction)
