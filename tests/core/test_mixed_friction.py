"""Friction in contacts of the plane and of space in one model: each part does what it does in a model of its own.

How large a model is decides how small a bounce is the last, so the model of a part that bounces to rest has the other
part too, without its friction.
"""

import numpy as np
import pytest
from test_impulse_steps import in_steps, values
from test_space_lift_friction import in_space, same_events, touching
from test_space_lift_woodpecker import flat_woodpecker
from tlismni.core import (
    Axes,
    Box3D,
    CoordinateRelation,
    CoulombFriction,
    Disk2D,
    DiskOnHalfPlane2D,
    HalfPlane2D,
    HalfSpace3D,
    Marker2D,
    Marker3D,
    Model,
    NewtonImpact,
    PointMass2D,
    PointMass3D,
    PointOnPlane3D,
    PoissonImpact,
    RelationTerm,
    RigidBody2D,
    RigidBody3D,
    RotationVector,
    Simulation,
    Sphere3D,
    SphereOnHalfSpace3D,
    SpringDamper2D,
    SpringDamper3D,
    compile_model,
    contacts_between,
    simulate,
)
from tlismni.core.compiled.library import LIBRARY
from tlismni.core.native import image_of
from tlismni.models import load

G = 9.81
DOWN = (0.0, -G, 0.0)
FLOOR = HalfSpace3D(marker=Marker3D(attitude=Axes(z=(0.0, 1.0, 0.0))))
TIGHT = {"rtol": 1e-13, "atol": 1e-15}


def ball(restitution=0.0, height=0.0):
    """A ball with spin that slides, and rolls."""
    radius = 0.1
    body = RigidBody3D(
        name="ball", mass=1.0, inertia=(0.004,) * 3, position=(0.0, radius + height, 0.0), velocity=(1.0, 0.0, 0.3),
        angular_velocity=(3.0, 5.0, 20.0),
    )  # fmt: skip
    contact = SphereOnHalfSpace3D(
        name="rolls", plane=FLOOR, sphere=Sphere3D(marker=Marker3D(body="ball"), radius=radius),
        law=NewtonImpact(restitution=restitution), friction=CoulombFriction(coefficient=0.2),
    )  # fmt: skip
    return Model(gravity=DOWN, bodies=[body], contacts=[contact])


def box():
    """A box that falls on a corner, tumbles and comes to rest on a face."""
    body = RigidBody3D(
        name="box", mass=2.0, inertia=(0.022, 0.034, 0.042), position=(0.0, 0.3, 0.0), velocity=(0.5, 0.0, 0.2),
        attitude=RotationVector(vector=(0.4, 0.2, 0.1)),
    )  # fmt: skip
    shape = Box3D(marker=Marker3D(body="box"), size=(0.4, 0.3, 0.2))
    law, friction = NewtonImpact(restitution=0.2, rest_ratio=0.05), CoulombFriction(coefficient=0.3)
    return Model(
        gravity=DOWN, bodies=[body], contacts=contacts_between("lands", [FLOOR], [shape], law=law, friction=friction)
    )


def block():
    """A block on two feet falls on the floor, slides into a stop, tips, and comes to rest."""
    friction = CoulombFriction(coefficient=0.2, static_coefficient=0.3)
    body = RigidBody2D(name="block", mass=1.0, inertia=0.02, position=(0.0, 0.15), velocity=(2.0, 0.0))
    wall = HalfPlane2D(marker=Marker2D(point=(0.4, 0.0), angle=np.pi / 2))

    def edge(name, plane, x, restitution):
        disk, law = Disk2D(marker=Marker2D(body="block", point=(x, -0.1))), NewtonImpact(restitution=restitution)
        return DiskOnHalfPlane2D(name=name, plane=plane, disk=disk, law=law, friction=friction)

    push = SpringDamper2D(
        name="push", a=Marker2D(point=(2.0, 0.1)), b=Marker2D(body="block"), stiffness=2.0, natural_length=0.5
    )
    floor = HalfPlane2D()
    contacts = [edge("left", floor, -0.1, 0.0), edge("right", floor, 0.1, 0.0), edge("stop", wall, 0.1, 0.3)]
    return Model(gravity=DOWN, bodies=[body], forces=[push], contacts=contacts)


def stick_slip():
    return load("stick_slip").model.model_copy(update={"gravity": DOWN})


def woodpecker():
    return flat_woodpecker().model_copy(update={"gravity": DOWN})


def both(flat, spatial, without=()):
    """One model of both; contacts of the parts `without` have no friction."""
    contacts = []
    for part in (flat, spatial):
        update = {"friction": None} if part in without else {}
        contacts += [contact.model_copy(update=update) for contact in part.contacts]
    return Model(
        gravity=DOWN, bodies=[*flat.bodies, *spatial.bodies], joints=[*flat.joints, *spatial.joints],
        forces=[*flat.forces, *spatial.forces], contacts=contacts,
    )  # fmt: skip


def motion_of(result, body):
    """Its coordinates and velocities, (channels, times)."""
    rates = ("angular_velocity", *(f"angular_velocity_{axis}" for axis in "xyz"))
    names = [f"{body}.{name}" for name in ("x", "y", "z", "vx", "vy", "vz", "angle", *rates)]
    return np.array([result[name] for name in names if name in result.channels])


def is_felt(event, places):
    """Not a touch without a blow: whether the last of a row of bounces is one, rounding says."""
    return event.kind in ("stick", "slip") or event.impulse > 1e3 * places


def same_parts(own, mixed, places, with_events=True):
    """Motion of each of the `own` (part, run) in the mixed run, and its events."""
    for part, run in own:
        for body in part.bodies:
            one, other = motion_of(run, body.name), motion_of(mixed, body.name)
            assert len(one) > 3 and np.abs(one - other).max() < places * max(1.0, np.abs(one).max())
        if not with_events:
            continue
        names = {contact.name for contact in part.contacts}
        events = [event for event in mixed.events if event.contact in names and is_felt(event, places)]
        alone = [event for event in run.events if event.contact in names and is_felt(event, places)]
        assert [(e.kind, e.contact) for e in events] == [(e.kind, e.contact) for e in alone]
        for one, other in zip(alone, events, strict=True):
            assert one.t == pytest.approx(other.t, abs=places)
            for what in ("impulse", "energy_loss", "friction_impulse"):
                assert getattr(one, what) == pytest.approx(getattr(other, what), abs=places)


@pytest.mark.sampled(1)
@pytest.mark.parametrize(
    ("flat", "spatial", "t_end", "kinds"),
    [
        (stick_slip, ball, 4.0, {"stick", "slip"}),
        (woodpecker, lambda: ball(0.5, 0.05), 0.6, {"impact", "stick", "slip"}),
        (block, box, 1.5, {"impact", "stick", "slip"}),
    ],
)
def test_side_by_side(flat, spatial, t_end, kinds):
    """Stick and slip, impacts with friction, jams, rest: 1e-9. (Which corners of a box carry it rounding says.)"""
    flat, spatial = flat(), spatial()
    times = np.linspace(0.0, t_end, 101)
    models = both(flat, spatial, [spatial]), both(flat, spatial, [flat]), both(flat, spatial)
    of_flat, of_spatial, mixed = (simulate(m, t_end, t_eval=times, **TIGHT) for m in models)
    same_parts([(flat, of_flat)], mixed, 1e-9)
    same_parts([(spatial, of_spatial)], mixed, 1e-9, len(spatial.contacts) == 1)
    assert kinds <= {event.kind for event in of_flat.events}
    assert {"close", "stick", "rest"} & {event.kind for event in of_spatial.events}
    assert [event.t for event in mixed.events] == sorted(event.t for event in mixed.events)


def thrown(seed, law):
    """Flat and spatial bodies that strike the floor at one instant, with a few points each, and random numbers."""
    rng = np.random.default_rng(seed)
    flat, spatial, of_flat, of_spatial = [], [], [], []
    for k in range(int(rng.integers(1, 3))):
        flat.append(
            RigidBody2D(
                name=f"flat{k}", mass=rng.uniform(0.5, 2.0), inertia=rng.uniform(0.02, 0.1),
                position=(rng.uniform(-1.0, 1.0), 0.2), velocity=(rng.uniform(-1.0, 1.0), rng.uniform(-2.0, -0.2)),
                angular_velocity=rng.uniform(-1.0, 1.0),
            )
        )  # fmt: skip
        for j in range(int(rng.integers(1, 4))):
            disk = Disk2D(marker=Marker2D(body=f"flat{k}", point=(rng.uniform(-0.3, 0.3), -0.2)))
            friction = CoulombFriction(coefficient=rng.uniform(0.05, 0.5))
            own = law(restitution=rng.uniform(0.0, 0.8))
            of_flat.append(
                DiskOnHalfPlane2D(name=f"flat{k}_{j}", plane=HalfPlane2D(), disk=disk, law=own, friction=friction)
            )
    for k in range(int(rng.integers(1, 3))):
        spatial.append(
            RigidBody3D(
                name=f"solid{k}", mass=rng.uniform(0.5, 2.0), inertia=tuple(rng.uniform(0.05, 0.09, 3)),
                position=(rng.uniform(-1.0, 1.0), 0.2, 0.0),
                velocity=(rng.uniform(-1.0, 1.0), rng.uniform(-2.0, -0.2), rng.uniform(-1.0, 1.0)),
                angular_velocity=tuple(rng.uniform(-1.0, 1.0, 3)),
            )
        )  # fmt: skip
        for j in range(int(rng.integers(1, 4))):
            friction = CoulombFriction(coefficient=rng.uniform(0.05, 0.5))
            point = (rng.uniform(-0.3, 0.3), -0.2, rng.uniform(-0.3, 0.3))
            own = law(restitution=rng.uniform(0.0, 0.8))
            sphere = Sphere3D(marker=Marker3D(body=f"solid{k}", point=point))
            of_spatial.append(
                SphereOnHalfSpace3D(name=f"solid{k}_{j}", plane=FLOOR, sphere=sphere, law=own, friction=friction)
            )
    return Model(gravity=DOWN, bodies=flat, contacts=of_flat), Model(gravity=DOWN, bodies=spatial, contacts=of_spatial)


@pytest.mark.sampled(1)
@pytest.mark.parametrize("law", [NewtonImpact, PoissonImpact])
def test_random_impacts_at_one_instant(law):
    """Impulses and friction of 30 random blows of both kinds at one instant as those of the parts: 1e-11."""
    for seed in range(30):
        flat, spatial = thrown(seed, law)
        mixed = simulate(both(flat, spatial), 1e-4)
        same_parts([(part, simulate(part, 1e-4)) for part in (flat, spatial)], mixed, 1e-11)
        struck = {event.contact for event in mixed.events if event.kind == "impact" and event.t == 0.0}
        assert {name[:4] for name in struck} == {"flat", "soli"}


def test_state_and_json():
    """A run goes on from its state bit for bit; a compiled model, and one from JSON, runs the same."""
    model = both(stick_slip(), ball(0.5, 0.05))
    again = Model.from_json(model.to_json())
    assert again == model
    compiled = compile_model(model)
    runs = Simulation(again), compiled.simulation(), compiled.simulation()
    for run in runs:
        run.advance(0.4)
    kept = runs[0].state()
    runs[1].advance(0.7)
    runs[1].restore(kept)
    for run in runs:
        run.advance(1.0)
    assert runs[0].state() == runs[1].state() == runs[2].state()


def test_steps_of_impulses():
    """The rows of both kinds in one sweep: as in steps of their own, to what sweeps leave in a step."""
    flat, spatial, step = stick_slip(), ball(), 1e-3
    runs = [in_steps(model, step) for model in (flat, spatial, both(flat, spatial))]
    for t in (0.1, 0.3, 0.6):
        for run in runs:
            run.advance(t)
        of_flat, of_spatial, mixed = (values(run) for run in runs)
        for own, names in (
            (of_flat, ("block.x", "block.vx", "rubbing.normal_force", "rubbing.friction_force")),
            (of_spatial, ("ball.x", "ball.z", "ball.vz", "rolls.normal_force", "rolls.friction_force", "rolls.gap")),
        ):
            for name in names:
                places = 1e-2 if name.endswith("force") else 2e-5
                assert mixed[name] == pytest.approx(own[name], abs=places), (t, name)
    assert all(run.stats["impulse_steps"] > 500 for run in runs)
    assert mixed["rubbing.friction_force"] != 0.0


@pytest.mark.skipif(LIBRARY is None, reason="needs the library of machine code (tlismni.core.aot)")
def test_without_python():
    """The bits of Python's run."""
    from tlismni.core.native.in_process import NativeModel, NativeRun

    model = both(block(), ball(0.5, 0.05))
    run, simulation = NativeRun(NativeModel(image_of(model, 1.0), LIBRARY)), Simulation(model)
    for t in np.sort(np.random.default_rng(3).uniform(0.0, 1.0, 20)):
        found = run.step(float(t), [])
        simulation.advance(float(t))
        assert found.tobytes() == simulation.values().tobytes(), t
    assert (run.events, run.steps) == (len(simulation.events), simulation.stats["steps"])


def coupled(flat):
    """A point that a spring pulls over the floor, the flat one of the model or one in space, and a ball: their x go
    together, and they strike at one instant."""
    rub = CoulombFriction(coefficient=0.2, static_coefficient=0.4)
    law = NewtonImpact(restitution=0.4)
    disk = Disk2D(marker=Marker2D(body="point"))
    touch = DiskOnHalfPlane2D(name="rubs", plane=HalfPlane2D(), disk=disk, law=law, friction=rub)
    spring = {"name": "spring", "stiffness": 40.0, "natural_length": 1.0}
    ends = Marker2D(point=(-1.0, 0.0)), Marker2D(body="point")
    drop = ball(0.4, 0.05)
    (sphere,) = drop.bodies
    together = CoordinateRelation(
        name="together",
        terms=(RelationTerm(body="point", coordinate="x"), RelationTerm(body="ball", coordinate="x", factor=-1.0)),
    )
    start = {"name": "point", "mass": 1.5}
    if flat:
        point, joints, contact = PointMass2D(**start, position=(0.0, 0.05), velocity=(1.0, 0.0)), [together], touch
        force = SpringDamper2D(**spring, a=ends[0], b=ends[1])
    else:
        point = PointMass3D(**start, position=(0.0, 0.05, 0.0), velocity=(1.0, 0.0, 0.0))
        held = PointOnPlane3D(name="held", a=Marker3D(), b=Marker3D(body="point"))
        joints, contact = [together, held], touching(touch)
        force = SpringDamper3D(**spring, a=in_space(ends[0]), b=in_space(ends[1]))
    return Model(
        gravity=DOWN, bodies=[point, sphere], joints=joints, forces=[force], contacts=[contact, *drop.contacts]
    )


def test_coupled():
    """Connected parts, whose impulses move each other, as the same all in space: 1e-9."""
    times = np.linspace(0.0, 2.0, 101)
    flat, spatial = (simulate(coupled(which), 2.0, t_eval=times, **TIGHT) for which in (True, False))
    kinds = same_events(flat, spatial, 1e-9)
    assert {("impact", "rubs"), ("impact", "rolls"), ("stick", "rubs"), ("slip", "rubs")} <= set(kinds)
    for name in ("point.x", "point.y", "point.vx", "ball.x", "ball.z", "ball.vz", "ball.angular_velocity_x"):
        assert np.abs(flat[name] - spatial[name]).max() < 1e-9
    assert np.abs(np.abs(flat["rubs.friction_force"]) - np.abs(spatial["rubs.friction_force"])).max() < 1e-7
