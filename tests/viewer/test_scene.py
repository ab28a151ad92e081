"""Scenes: what is drawn is where the result says, at all times."""

import json
from typing import Any

import numpy as np
import pytest
from runs import run
from tlismni.core import (
    AngleStop2D,
    AppliedForce2D,
    Disk2D,
    DiskOnDisk2D,
    EquationSystem,
    HuntCrossley,
    Marker2D,
    Model,
    ModelError,
    NewtonImpact,
    PointMass2D,
    Revolute2D,
    RigidBody2D,
    Sine,
    SpringDamper2D,
    TorsionSpring2D,
    axial_force,
    bending_stress,
    deformed_shape,
    simulate,
)
from tlismni.models import load, names
from tlismni.viewer import CrossSection, animate, show
from tlismni.viewer.packing import unpack
from tlismni.viewer.scene import Scene
from tlismni.viewer.space.build import is_spatial


def frame(scene: Scene, name: str) -> Any:
    return next(f for f in scene.frames if f.name == name)


def test_bodies_are_where_their_channels_say() -> None:
    result = run("pendulum_stop")
    scene = animate(result).scene
    motion = frame(scene, "pendulum").motion
    assert motion.shape == (len(scene.t), 3)
    # every sample of this short run is a frame, unchanged
    for k, name in enumerate(("x", "y", "angle")):
        shown = dict(zip(scene.t.tolist(), motion[:, k].tolist(), strict=True))
        assert all(shown[t] == y for t, y in zip(result.t.tolist(), result[f"pendulum.{name}"].tolist(), strict=True))
    # between them, on the circle that the pin holds the centre of mass on
    radius = np.hypot(motion[:, 0], motion[:, 1])
    assert radius == pytest.approx(np.full(len(radius), 0.5), abs=1e-5)


def test_an_impact_is_two_frames_and_the_velocity_jumps_between_them() -> None:
    result = run("pendulum_stop")
    scene = animate(result).scene
    velocity = frame(scene, "pendulum").velocity
    for event in result.events:
        (first, second) = np.flatnonzero(scene.t == event.t)
        before, after = velocity[first], velocity[second]
        assert after == pytest.approx(-0.7 * before, rel=1e-6)


def test_channels_go_in_step_with_the_motion() -> None:
    result = run("pendulum_stop")
    scene = animate(result, channels=["pendulum.angle"]).scene
    assert scene.plots == ["pendulum.angle"]
    tracks = {track.name: track for track in scene.tracks}
    assert np.array_equal(tracks["pendulum.angle"].values, frame(scene, "pendulum").motion[:, 2])
    assert tracks["stop.mode"].steps and set(tracks["stop.mode"].values) <= set(result["stop.mode"])
    assert tracks["stop.gap"].unit == "m"
    with pytest.raises(KeyError, match="did you mean"):
        animate(result, channels=["pendulum.angel"])


def test_a_bent_beam_is_drawn_where_its_points_are() -> None:
    result = run("hub_beam_stop")
    model = result.system
    scene = animate(result).scene
    (band,) = scene.bands
    beam = next(body for body in model.bodies if body.name == "beam")
    s = np.linspace(0.0, beam.length, band.points.shape[1])
    # the later one of two frames at an impact
    rows = np.searchsorted(scene.t, scene.t[:: len(scene.t) // 9], side="right") - 1
    expected = deformed_shape(result, beam, s, scene.t[rows])
    assert band.points[rows] == pytest.approx(expected, abs=1e-12)
    assert band.fields[0].name == "bending moment"


def test_a_rod_is_coloured_by_its_axial_force_and_drawn_magnified() -> None:
    result = run("rod_wall")
    scene = animate(result).scene
    (band,) = scene.bands
    rod = result.system.bodies[0]
    (field,) = band.fields
    s = np.linspace(0.0, rod.length, band.points.shape[1])
    k = len(scene.t) // 2
    expected = axial_force(result, rod, s, [scene.t[k]])[0]
    assert field.name == "axial force" and field.values[k] == pytest.approx(expected, rel=1e-9, abs=1e-6)
    assert "1000 times" in scene.notes[0]
    # the drawn rod touches the drawn wall when the gap is closed
    moved = band.points[k, -1, 0] - band.points[0, -1, 0]
    assert moved == pytest.approx(
        1000.0 * (result["wall.gap"][0] - np.interp(scene.t[k], result.t, result["wall.gap"]))
    )


def test_contact_forces_press_at_the_point_of_contact_and_against_the_ground() -> None:
    model = Model(
        gravity=(0.0, 0.0),
        bodies=[
            PointMass2D(name="a", mass=1.0, position=(0.0, 0.0), velocity=(1.0, 0.0)),
            PointMass2D(name="b", mass=1.0, position=(0.25, 0.0)),
        ],
        contacts=[
            DiskOnDisk2D(
                name="blow",
                a=Disk2D(marker=Marker2D(body="a"), radius=0.1),
                b=Disk2D(marker=Marker2D(body="b"), radius=0.1),
                law=HuntCrossley(stiffness=1e5, restitution=0.8, exponent=1.5),
            )
        ],
    )
    result = simulate(model, 0.1)
    scene = animate(result).scene
    (arrow,) = scene.arrows
    k = int(np.argmax(arrow.vector[:, 0]))
    assert arrow.vector[k, 0] == pytest.approx(result["blow.normal_force"].max(), rel=1e-3)
    assert arrow.vector[k, 1] == 0.0
    a, b = frame(scene, "a").motion[k, 0], frame(scene, "b").motion[k, 0]
    assert a < arrow.at[k, 0] < b and arrow.at[k, 0] == pytest.approx(a + 0.1)


def test_springs_loads_and_outlines() -> None:
    model = Model(
        gravity=(0.0, 0.0),
        bodies=[RigidBody2D(name="box", mass=1.0, inertia=1.0, position=(1.0, 0.0))],
        forces=[
            SpringDamper2D(
                name="spring", a=Marker2D(), b=Marker2D(body="box"), stiffness=10.0, damping=1.0, natural_length=1.0
            ),
            AppliedForce2D(
                name="push", marker=Marker2D(body="box"), force_x=Sine(amplitude=2.0, angular_frequency=3.0)
            ),
        ],
    )
    result = simulate(model, 1.0)
    square = [(-0.1, -0.1), (0.1, -0.1), (0.1, 0.1), (-0.1, 0.1)]
    scene = animate(result, outlines={"box": square}).scene
    (link,) = scene.links
    assert link.kind == "spring-damper" and scene.frames[link.b.frame].name == "box"
    push = next(arrow for arrow in scene.arrows if arrow.kind == "load")
    assert push.vector[:, 0] == pytest.approx(2.0 * np.sin(3.0 * scene.t))
    assert any(getattr(shape, "points", None) == tuple(square) for part in scene.parts for shape in part.shapes)
    with pytest.raises(ModelError, match="bodies are"):
        animate(result, outlines={"bax": square})


@pytest.mark.parametrize("name", names())
def test_every_scenario_can_be_shown_at_its_start(name: str) -> None:
    scene = show(load(name).model).scene
    assert len(scene.t) == 1 and np.all(np.isfinite(scene.box))
    data = json.loads(json.dumps(scene.to_data(), allow_nan=False))
    assert data["format"] == "tlismni-scene-1" and data["dimension"] == (3 if is_spatial(load(name).model) else 2)
    assert data["parts"] or data["bands"] or data["gauges"] or data["solids"]


def test_impulses_of_angle_stops_are_angular_and_a_link_in_line_is_a_bar() -> None:
    arm = RigidBody2D(name="arm", mass=1.0, inertia=0.1, position=(0.0, 0.5), angle=1.5708)
    pin = Revolute2D(name="pin", a=Marker2D(), b=Marker2D(body="arm", point=(-0.5, 0.0)))
    spring = TorsionSpring2D(name="spring", a=Marker2D(), b=Marker2D(body="arm"), stiffness=5.0, natural_angle=-0.1)
    stop = AngleStop2D(name="stop", b=Marker2D(body="arm"), side="lower", limit=0.0, law=NewtonImpact(restitution=0.2))
    model = Model(gravity=(0.0, 0.0), bodies=[arm], joints=[pin], forces=[spring], contacts=[stop])
    scene = animate(simulate(model, 1.5)).scene
    assert {event["impulse_unit"] for event in scene.events} == {"N.m.s"}
    assert {event["impulse_unit"] for event in animate(run("pendulum_stop")).scene.events} == {"N.s"}
    number = next(k for k, f in enumerate(scene.frames) if f.name == "arm")
    bar = next(part for part in scene.parts if part.frame == number and part.layer == 1)
    assert [len(shape.points) for shape in bar.shapes if not hasattr(shape, "radius")][:2] == [2, 2]


def test_what_stands_still_is_not_plotted_unless_asked_for() -> None:
    result = run("slider_crank_stop")
    assert animate(result).scene.plots[0] == "slider.x" and "slider.y" not in animate(result).scene.plots
    assert "slider.y" in animate(result, channels=["slider.y"]).scene.plots
    resting = simulate(Model(gravity=(0.0, 0.0), bodies=[PointMass2D(name="ball", mass=1.0)]), 1.0)
    assert animate(resting).scene.plots[:2] == ["ball.x", "ball.y"]


def test_arrays_come_back_from_the_data() -> None:
    scene = animate(run("pendulum_stop")).scene
    data = json.loads(json.dumps(scene.to_data(), allow_nan=False))
    assert np.array_equal(unpack(data["t"]), scene.t)
    assert unpack(data["frames"][1]["motion"]) == pytest.approx(scene.frames[1].motion, rel=1e-6)
    assert [event["contact"] for event in data["events"]] == ["stop"] * 3


def test_a_long_run_has_a_bounded_number_of_frames_and_keeps_short_blows() -> None:
    result = run("pendulum_stop", law="hunt_crossley")
    scene = animate(result, frames=50).scene
    assert len(scene.t) < 1300
    force = next(track for track in scene.tracks if track.name == "stop.normal_force").values
    assert force.max() > 0.99 * result["stop.normal_force"].max()


def test_equations_have_no_bodies_to_draw() -> None:
    system = EquationSystem(mass=np.eye(1), force=lambda t, q, v: -q, q0=[1.0], v0=[0.0])
    result = simulate(system, 0.5)
    with pytest.raises(ModelError, match=r"user-written equations.*result\.plot"):
        result.animate()


def test_stress_is_that_of_the_outermost_fibre() -> None:
    result = run("hub_beam_stop")
    beam = next(body for body in result.system.bodies if body.name == "beam")
    section = CrossSection(area=1e-4, second_moment=0.02 * 0.005**3 / 12.0, height=0.0025)
    (band,) = animate(result, sections={"beam": section}).scene.bands
    field, *others = band.fields
    assert field.name == "stress" and [other.name for other in others] == ["bending moment"]
    s = np.linspace(0.0, beam.length, band.points.shape[1])
    expected = np.abs(bending_stress(result, beam, s, second_moment=section.second_moment, height=section.height))
    assert field.limit == pytest.approx(expected.max(), rel=1e-3)
    with pytest.raises(ModelError, match="flexible bodies are"):
        animate(result, sections={"hub": section})
    with pytest.raises(ModelError, match="give both"):
        CrossSection(area=1.0, height=1.0)


def test_the_page_of_a_large_model_stays_small() -> None:
    chain = load("chain", links=300)
    result = simulate(chain.model, 0.02, "hht", step=1e-4)
    animation = animate(result)
    assert 60 <= len(animation.scene.t) < 1500
    assert len(animation.html()) < 20e6


def test_points_of_equations_move_as_their_channels_say() -> None:
    system = EquationSystem(
        mass=np.eye(2),
        force=lambda t, q, v: np.array([0.0, -9.81]),
        constraint=lambda t, q: q[0] ** 2 + q[1] ** 2 - 1.0,
        q0=[1.0, 0.0],
        v0=[0.0, 0.0],
        coordinates=("x", "y"),
    )
    result = simulate(system, 1.0)
    scene = animate(result, points={"bob": ("x", "y")}).scene
    bob = frame(scene, "bob")
    rows = np.searchsorted(scene.t, result.t)
    assert np.array_equal(bob.motion[rows, 0], result["x"]) and np.array_equal(bob.velocity[rows, 1], result["d_y"])
    assert scene.plots[:2] == ["x", "y"] and 1.0 < scene.size < 3.0
    with pytest.raises(KeyError, match="no channel 'z'"):
        animate(result, points={"bob": ("x", "z")})
