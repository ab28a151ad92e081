"""Loads between bodies, gains of inputs, springs whose length moves, disks in rings, polygons: closed forms."""

import math

import numpy as np
import pytest
from helpers import on
from tlismni.core import (
    AppliedForce2D,
    Box2D,
    Constant,
    ContactGroup2D,
    CoordinateDriver,
    CoulombFriction,
    Disk2D,
    DiskInRing2D,
    DiskOnPolygon2D,
    HalfPlane2D,
    Input,
    InputSignal,
    Marker2D,
    Model,
    ModelError,
    NewtonImpact,
    PointMass2D,
    Polygon2D,
    Prismatic2D,
    RelativeLoad2D,
    Revolute2D,
    RigidBody2D,
    Ring2D,
    Simulation,
    Sine,
    SpringDamper2D,
    contacts_between,
    simulate,
)
from tlismni.core.contacts.disk_on_box2d import box_gap, box_slide
from tlismni.core.contacts.polygon2d import polygon_gap, polygon_slide
from tlismni.core.contacts.ring2d import ring_slide
from tlismni.core.elements import Frame2D

TIGHT = {"rtol": 1e-10, "atol": 1e-12}
DEAD = NewtonImpact(restitution=0.0)
G = 9.81


def frame(x: float, y: float, angle: float) -> Frame2D:
    return Frame2D(x, y, angle, math.cos(angle), math.sin(angle))


def slider(name: str, mass: float, x: float = 0.0) -> tuple[RigidBody2D, Prismatic2D]:
    body = RigidBody2D(name=name, mass=mass, inertia=0.1, position=(x, 0.0))
    return body, Prismatic2D(name=f"guide_{name}", a=on("ground"), b=on(name))


@pytest.mark.parametrize("measure", ["slide", "distance"])
def test_a_force_between_two_bodies_pushes_them_apart(measure: str) -> None:
    """Free bodies: accelerations F/m against each other, the centre of mass stays, and what is put in is kinetic."""
    bodies = [PointMass2D(name="a", mass=2.0), PointMass2D(name="b", mass=3.0, position=(1.0, 0.0))]
    load = RelativeLoad2D(name="push", a=on("a"), b=on("b"), load=Constant(value=1.5), measure=measure)
    result = simulate(Model(gravity=(0.0, 0.0), bodies=bodies, forces=[load]), 2.0, **TIGHT)
    assert result["a.x"] == pytest.approx(-0.5 * 1.5 / 2.0 * result.t**2, abs=1e-9)
    assert result["b.x"] == pytest.approx(1.0 + 0.5 * 1.5 / 3.0 * result.t**2, abs=1e-9)
    assert result["energy.input_work"] == pytest.approx(result["energy.kinetic"], abs=1e-9)


def test_a_torque_between_two_rotors_is_a_motor() -> None:
    rotors = [RigidBody2D(name=n, mass=1.0, inertia=i) for n, i in (("a", 0.5), ("b", 0.2))]
    pins = [Revolute2D(name=f"pin_{n}", a=on("ground"), b=on(n)) for n in "ab"]
    motor = RelativeLoad2D(name="motor", a=on("a"), b=on("b"), load=Sine(amplitude=0.4, angular_frequency=3.0))
    result = simulate(Model(bodies=rotors, joints=pins, forces=[motor]), 2.0, **TIGHT)
    # twice the integral of 0.4 sin 3t from rest
    swing = 0.4 / 3.0 * (result.t - np.sin(3.0 * result.t) / 3.0)
    assert result["a.angle"] == pytest.approx(-swing / 0.5, abs=1e-8)
    assert result["b.angle"] == pytest.approx(swing / 0.2, abs=1e-8)


def test_an_input_has_a_gain_as_a_force() -> None:
    body = PointMass2D(name="m", mass=2.0)
    force = AppliedForce2D(name="push", marker=on("m"), force_x=InputSignal(channel="current", gain=3.0))
    model = Model(
        gravity=(0.0, 0.0), bodies=[body], forces=[force], inputs=[Input(name="current", start=0.5, unit="A")]
    )
    result = simulate(model, 1.0, **TIGHT)
    assert result["m.x"][-1] == pytest.approx(0.5 * 3.0 * 0.5 / 2.0, abs=1e-10)
    sim = Simulation(model)
    ax = next(k for k, channel in enumerate(sim.channels) if channel.name == "m.ax")
    assert sim.input_derivatives({"current": 1.0})[ax] == pytest.approx(1.5, rel=1e-12)


def test_an_input_has_a_gain_as_a_motion_with_its_rate() -> None:
    """Millimetres lead a slider; after a change of the rate it follows without an impact and arrives where they say."""
    body, guide = slider("s", 1.0)
    motion = InputSignal(channel="x_mm", rate="v_mm", gain=1e-3)
    drive = CoordinateDriver(name="drive", body="s", coordinate="x", motion=motion)
    rows = [guide.model_copy(update={"a": on("ground"), "b": on("s")})]
    model = Model(
        gravity=(0.0, 0.0), bodies=[body], joints=[*rows, drive],
        inputs=[Input(name="x_mm", start=0.0), Input(name="v_mm", start=200.0)],
    )  # fmt: skip
    sim = Simulation(model, rtol=1e-8)
    names = [channel.name for channel in sim.channels]
    sim.advance(0.1)
    assert sim.values()[names.index("s.x")] == pytest.approx(0.02, abs=1e-9)
    sim.set_inputs({"x_mm": 20.0, "v_mm": 100.0})
    sim.advance(0.2)
    assert sim.values()[names.index("s.x")] == pytest.approx(0.03, abs=1e-9)
    assert sim.values()[names.index("s.vx")] == pytest.approx(0.1, abs=1e-8)


def test_a_spring_whose_natural_length_moves_shakes_a_mass() -> None:
    """m x'' + c x' + k (x - l0(t)) = 0: response to a sine after the free part has gone; the ledger holds."""
    body, guide = slider("s", 2.0, 1.0)
    length = Sine(amplitude=0.05, angular_frequency=6.0, offset=1.0)
    spring = SpringDamper2D(name="k", a=on("ground"), b=on("s"), stiffness=50.0, damping=8.0, natural_length=length)
    model = Model(gravity=(0.0, 0.0), bodies=[body], joints=[guide], forces=[spring])
    result = simulate(model, 12.0, t_eval=np.linspace(10.0, 12.0, 60), **TIGHT)
    w = 6.0j
    response = 0.05 * 50.0 / (2.0 * w * w + 8.0 * w + 50.0)
    assert result["s.x"] - 1.0 == pytest.approx((response * np.exp(w * result.t)).imag, abs=1e-7)
    assert np.abs(result["energy.balance"]).max() < 1e-6
    assert Model.from_json(model.to_json()) == model


def test_a_natural_length_may_be_an_input() -> None:
    body, guide = slider("s", 2.0, 1.0)
    spring = SpringDamper2D(
        name="k", a=on("ground"), b=on("s"), stiffness=50.0, natural_length=InputSignal(channel="length")
    )
    model = Model(gravity=(0.0, 0.0), bodies=[body], joints=[guide], forces=[spring], inputs=[Input(name="length")])
    result = simulate(model, 0.7, inputs={"length": 0.8}, **TIGHT)
    assert result["s.x"] == pytest.approx(0.8 + 0.2 * np.cos(5.0 * result.t), abs=1e-8)


# rings


def in_a_drum(friction: CoulombFriction | None, angle: float = 0.4, law: NewtonImpact = DEAD) -> Model:
    radius, drum = 0.1, 0.5
    at = ((drum - radius) * math.sin(angle), -(drum - radius) * math.cos(angle))
    body = RigidBody2D(name="ball", mass=2.0, inertia=0.5 * 2.0 * radius**2, position=at)
    contact = DiskInRing2D(
        name="c", shape=Ring2D(marker=Marker2D(), radius=drum), disk=Disk2D(marker=on("ball"), radius=radius),
        law=law, friction=friction,
    )  # fmt: skip
    return Model(bodies=[body], contacts=[contact])


@pytest.mark.parametrize("rolls", [False, True])
def test_a_disk_in_a_drum_swings_as_a_pendulum(rolls: bool) -> None:
    """Length R - r; rolling adds half a mass: w^2 = g / (3/2 (R - r)). Energy gives the speed at the bottom exactly."""
    model = in_a_drum(CoulombFriction(coefficient=5.0) if rolls else None)
    result = simulate(model, 1.2, **TIGHT)
    height = 0.4 * (1.0 - math.cos(0.4))
    low = np.argmin(np.abs(result["ball.x"]))
    factor = 0.75 if rolls else 0.5
    speed = np.hypot(result["ball.vx"], result["ball.vy"])
    energy = factor * speed**2 + G * (0.4 + result["ball.y"])
    assert energy == pytest.approx(np.full(len(result.t), G * height), abs=1e-8)
    assert np.hypot(result["ball.x"], result["ball.y"]) == pytest.approx(np.full(len(result.t), 0.4), abs=1e-10)
    if rolls:  # without slip: r beta = -(R - r) phi
        turn = result["ball.angle"] - result["ball.angle"][0]
        phi = np.arctan2(result["ball.x"], -result["ball.y"])
        assert 0.1 * turn == pytest.approx(-0.4 * (phi - 0.4), abs=1e-8)
    assert speed[low] > 0.5 and {e.kind for e in result.events} <= {"close", "stick", "graze"}


def test_a_disk_bounces_in_a_drum_and_keeps_its_energy() -> None:
    body = RigidBody2D(name="ball", mass=1.0, inertia=0.01, position=(0.1, 0.2), velocity=(1.0, 0.0))
    drum = Ring2D(marker=Marker2D(), radius=0.5)
    contact = DiskInRing2D(
        name="c", shape=drum, disk=Disk2D(marker=on("ball"), radius=0.1), law=NewtonImpact(restitution=1.0)
    )
    result = simulate(Model(bodies=[body], contacts=[contact]), 2.0, **TIGHT)
    assert sum(event.kind == "impact" for event in result.events) >= 4
    total = result["energy.kinetic"] + result["energy.potential"]
    assert total == pytest.approx(np.full(len(total), total[0]), abs=1e-8)
    assert np.hypot(result["ball.x"], result["ball.y"]).max() <= 0.4 + 1e-9


def test_rolling_in_a_ring_does_not_slide() -> None:
    """The ring turns by alpha, the disk rolls in it: R alpha = (R - r) phi + r beta."""
    rng = np.random.default_rng(0)
    for alpha, phi in rng.uniform(-1.0, 1.0, (50, 2)):
        beta = (0.5 * alpha - 0.3 * phi) / 0.2
        moved = ring_slide(frame(0, 0, alpha), frame(math.cos(phi), math.sin(phi), beta), 0.5, 0.2)
        assert moved == pytest.approx(0.0, abs=1e-12)


def test_a_disk_that_does_not_fit_is_refused() -> None:
    with pytest.raises(ModelError, match="does not go into a hole"):
        DiskInRing2D(
            name="c", shape=Ring2D(marker=Marker2D(), radius=0.1), disk=Disk2D(marker=on("b"), radius=0.1), law=DEAD
        )


# polygons


def numbers(vertices: list[tuple[float, float]]) -> list[float]:
    return [x for vertex in vertices for x in vertex] + [0.0] * (16 - 2 * len(vertices))


def test_a_rectangle_is_a_box() -> None:
    """Gaps everywhere, and outside sliding distances but for where they begin."""
    w, h, r = 0.7, 0.3, 0.1
    corners, rng = numbers([(w, -h), (w, h), (-w, h), (-w, -h)]), np.random.default_rng(0)
    period = 4.0 * (w + h) + 2.0 * math.pi * r
    for a, b in rng.normal(size=(300, 2, 3)):
        box, disk = frame(*a), frame(*b)
        gap = box_gap(box, disk, w, h, r)
        assert polygon_gap(box, disk, 4.0, r, *corners) == pytest.approx(gap, abs=1e-12)
        if gap > -r:
            rounds = (box_slide(box, disk, w, h, r) + h - polygon_slide(box, disk, 4.0, r, *corners)) / period
            assert rounds == pytest.approx(round(rounds), abs=1e-9)


@pytest.mark.parametrize("sides", [3, 5, 8])
def test_the_gap_is_the_distance_from_the_outline(sides: int) -> None:
    rng = np.random.default_rng(sides)
    angles = np.sort(rng.uniform(0.0, 2.0 * math.pi, sides) * 0.2 + np.arange(sides) * 2.0 * math.pi / sides * 0.8)
    vertices = [(float(x), float(y)) for x, y in zip(np.cos(angles), 1.3 * np.sin(angles), strict=True)]
    polygon = Polygon2D(marker=Marker2D(), vertices=vertices)
    corners = np.array(polygon.vertices)
    a, b = corners, np.roll(corners, -1, axis=0)
    for p in rng.normal(size=(300, 2)):
        part = np.clip(np.sum((p - a) * (b - a), axis=1) / np.sum((b - a) ** 2, axis=1), 0.0, 1.0)
        away = np.linalg.norm(p - a - part[:, None] * (b - a), axis=1).min()
        side, to = b - a, p - a
        inside = np.all(side[:, 0] * to[:, 1] - side[:, 1] * to[:, 0] > 0.0)
        gap = polygon_gap(frame(0, 0, 0), frame(*p, 0.0), float(sides), 0.0, *numbers(list(polygon.vertices)))
        assert gap == pytest.approx(-away if inside else away, abs=1e-12)


def test_the_sliding_distance_goes_on_round_a_triangle() -> None:
    vertices, r = [(0.0, 0.0), (1.0, 0.0), (0.2, 0.9)], 0.1
    polygon = Polygon2D(marker=Marker2D(), vertices=vertices)
    outline: list[tuple[float, float]] = []
    for k in range(3):
        before, here, after = (np.array(vertices[(k + i) % 3]) for i in (-1, 0, 1))
        first, second = ((q - p) / np.linalg.norm(q - p) for p, q in ((before, here), (here, after)))
        start = math.atan2(-first[0], first[1])
        turn = math.atan2(first[0] * second[1] - first[1] * second[0], first @ second)
        for angle in start + np.linspace(0.0, turn, 200):
            outline.append((here[0] + r * math.cos(angle), here[1] + r * math.sin(angle)))
    points = np.array([*outline, outline[0]])
    s = [polygon_slide(frame(0, 0, 0), frame(*p, 0.0), 3.0, r, *numbers(vertices)) for p in points]
    period = polygon.perimeter + 2.0 * math.pi * r
    gone = np.mod(np.diff(s), period)
    assert gone == pytest.approx(np.hypot(*np.diff(points, axis=0).T), rel=1e-4, abs=1e-9)
    assert np.sum(gone) == pytest.approx(period, rel=1e-12)


def test_a_ball_rolls_down_the_side_of_a_wedge() -> None:
    """A triangle on the ground as an incline: a = g sin(angle) / (1 + I/(m r^2))."""
    angle, r = 0.3, 0.1
    wedge = Polygon2D(marker=Marker2D(), vertices=((0.0, 0.0), (3.0, 0.0), (0.0, 3.0 * math.tan(angle))))
    along, out = (math.cos(angle), -math.sin(angle)), (math.sin(angle), math.cos(angle))
    start = tuple(0.5 * a + r * o for a, o in zip(along, out, strict=True))
    body = RigidBody2D(
        name="ball", mass=2.0, inertia=0.5 * 2.0 * r**2, position=(start[0], start[1] + 3.0 * math.tan(angle))
    )
    contact = DiskOnPolygon2D(
        name="c", shape=wedge, disk=Disk2D(marker=on("ball"), radius=r), law=DEAD,
        friction=CoulombFriction(coefficient=0.5),
    )  # fmt: skip
    result = simulate(Model(bodies=[body], contacts=[contact]), 0.5, rtol=1e-9)
    gone = 0.5 * G * math.sin(angle) / 1.5 * result.t[-1] ** 2
    assert result["ball.x"][-1] == pytest.approx(body.position[0] + gone * along[0], abs=1e-7)
    assert result["ball.angle"][-1] == pytest.approx(-gone / r, abs=1e-6)


def test_a_triangle_and_a_box_lie_in_one_group() -> None:
    """A prism falls on a box on the floor: weights are carried, nothing overlaps."""
    prism = RigidBody2D(name="prism", mass=1.0, inertia=0.02, position=(0.0, 0.55))
    crate = RigidBody2D(name="crate", mass=2.0, inertia=0.1, position=(0.0, 0.2))
    group = ContactGroup2D(
        name="pile", law=DEAD, friction=CoulombFriction(coefficient=0.5), half_planes=[HalfPlane2D()],
        boxes=[Box2D(marker=on("crate"), width=0.8, height=0.4)],
        polygons=[Polygon2D(marker=on("prism"), vertices=((-0.2, -0.1), (0.2, -0.1), (0.0, 0.2)))],
    )  # fmt: skip
    model = Model(bodies=[prism, crate], groups=[group])
    result = simulate(model, 0.4, rtol=1e-7)
    forces = {c.name: result[f"{c.name}.normal_force"][-1] for c in model.contacts}
    assert sum(f for name, f in forces.items() if "crate" in name and "ground" in name) == pytest.approx(3.0 * G)
    assert result["prism.y"][-1] == pytest.approx(0.5, abs=1e-9) and abs(result["prism.angle"][-1]) < 1e-9
    assert min(result[f"{c.name}.gap"].min() for c in model.contacts if "ground" in c.name) > -1e-9


@pytest.mark.parametrize(
    ("vertices", "said"),
    [
        (((0, 0), (1, 0)), "3 to 8 corners"),
        (((0, 0), (1, 0), (1, 0), (0, 1)), "same point"),
        (((0, 0), (2, 0), (0.5, 0.5), (0, 2)), "not convex at"),
        (((0, 0), (1, 0), (2, 0), (0, 1)), "not convex at"),
        (((1, 0), (-0.8, 0.6), (0.3, -1), (0.3, 1), (-0.8, -0.6)), "not convex at"),
    ],
)
def test_polygons_that_are_none_are_refused(vertices: tuple[tuple[float, float], ...], said: str) -> None:
    with pytest.raises(ModelError, match=said):
        Polygon2D(marker=Marker2D(), vertices=vertices)


def test_the_order_of_corners_does_not_matter() -> None:
    one = Polygon2D(marker=Marker2D(), vertices=((0, 0), (1, 0), (0, 1)))
    other = Polygon2D(marker=Marker2D(), vertices=((0, 1), (1, 0), (0, 0)))
    assert one.perimeter == other.perimeter
    for p in ((0.2, 0.2), (2.0, 1.0), (-1.0, 0.3)):
        gaps = {
            round(polygon_gap(frame(0, 0, 0), frame(*p, 0.0), 3.0, 0.1, *numbers(list(x.vertices))), 12)
            for x in (one, other)
        }
        assert len(gaps) == 1


def test_a_segment_has_no_contact_with_what_has_corners() -> None:
    polygon = Polygon2D(marker=on("p"), vertices=((0, 0), (1, 0), (0, 1)))
    ring = Ring2D(marker=Marker2D(), radius=1.0)
    with pytest.raises(ModelError, match="have no contact"):
        contacts_between("c", [polygon, ring], law=DEAD)
