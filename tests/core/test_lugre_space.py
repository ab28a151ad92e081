"""LuGre's friction in space: Stribeck's curve, pre-sliding, circles, ledger, other shapes, the record."""

import math

import numpy as np
import pytest
from helpers import G, events
from lugre_models import (
    BRISTLES,
    DOWN,
    LAW,
    MASS,
    MU,
    NORMAL,
    S0,
    S1,
    S2,
    STATIC,
    STIFFNESS,
    STRIBECK,
    TIGHT,
    ball,
    pull,
    resting,
    sphere,
)
from tlismni.core import (
    Axes,
    Box3D,
    Cable3D,
    CableLine3D,
    Capsule3D,
    CapsuleOnCapsule3D,
    ContactGroup3D,
    CoordinateDriver,
    Ellipsoid3D,
    HalfSpace3D,
    KelvinVoigt,
    Marker3D,
    Model,
    ModelError,
    Parameter,
    Polynomial,
    RigidBody3D,
    RotationVector,
    Simulation,
    Sine,
    SmoothOnHalfSpace3D,
    Sphere3D,
    SphereInSphere3D,
    SphereOnCable3D,
    SphereOnHalfSpace3D,
    SphereOnMesh3D,
    SphereOnSphere3D,
    TriangleMesh3D,
    compile_model,
    simulate,
)

# ---- the law --------------------------------------------------------------------------------------------------------


def driven(x, y):
    motions = {"x": x, "y": y}
    return [CoordinateDriver(name=f"drive_{c}", body="block", coordinate=c, motion=m) for c, m in motions.items()]


@pytest.mark.parametrize("speed", [0.002, 0.01, 0.05, 0.5])
@pytest.mark.parametrize("angle", [0.6, 2.5, -1.9])
def test_steady_sliding_lies_on_the_stribeck_curve_against_the_slip(speed, angle):
    way = np.array([math.cos(angle), math.sin(angle)])
    x, y = (Polynomial(coefficients=(0.0, speed * c)) for c in way)
    model = resting(velocity=tuple(speed * way), joints=driven(x, y))
    result = simulate(model, 12.0 * STATIC * NORMAL / S0 / speed, **TIGHT)
    g = NORMAL * (MU + (STATIC - MU) * math.exp(-((speed / STRIBECK) ** 2)))
    assert result["c.friction_force"][-1] == pytest.approx(g + S2 * speed, rel=1e-4)
    bent = np.array([result["c.bristle_x"], result["c.bristle_y"]])
    assert bent[:, -1] == pytest.approx(g / S0 * way, rel=1e-4)
    assert np.hypot(*bent).max() <= STATIC * NORMAL / S0 * (1.0 + 1e-6)
    pulls = -np.array([result[f"drive_{c}.reaction"][-1] for c in "xy"])
    assert pulls == pytest.approx((g + S2 * speed) * way, rel=1e-4)
    assert np.abs(result["energy.balance"]).max() < 1e-7


@pytest.mark.parametrize("angle", [0.0, 0.8, 2.0])
def test_small_oscillations_feel_the_bristles_stiffness_in_every_direction(angle):
    amplitude, way = 0.01 * STATIC * NORMAL, (math.cos(angle), math.sin(angle))
    load = Sine(amplitude=amplitude, angular_frequency=2.0 * math.pi)
    result = simulate(resting(pull(load, way)), 3.0, **TIGHT)
    late = result.t > 1.0
    along = (way[0] * result["block.x"] + way[1] * result["block.y"])[late]
    across = (way[0] * result["block.y"] - way[1] * result["block.x"])[late]
    assert np.abs(along - along.mean()).max() == pytest.approx(amplitude / S0, rel=2e-2)
    assert np.abs(across).max() < 1e-12


@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_on_a_circle_the_force_turns_with_the_slip(sense):
    """At constant |u| and turning direction z = u/(h + i w), F = -(s0 z + s1 i w z + s2 u) in the complex plane."""
    rate, radius = 4.0 * sense, 0.02
    speed = abs(rate) * radius
    x = Sine(amplitude=radius, angular_frequency=rate, phase=0.5 * math.pi)
    y = Sine(amplitude=radius, angular_frequency=rate)
    result = simulate(resting(place=(radius, 0.0), velocity=(0.0, rate * radius), joints=driven(x, y)), 6.0, **TIGHT)
    h = S0 * speed / (NORMAL * (MU + (STATIC - MU) * math.exp(-((speed / STRIBECK) ** 2))))
    u = 1j * rate * radius * np.exp(1j * rate * result.t)
    z = u / (h + 1j * rate)
    force = -(S0 * z + S1 * 1j * rate * z + S2 * u)
    late = result.t > 3.0
    assert np.abs(result["c.bristle_x"] + 1j * result["c.bristle_y"] - z)[late].max() < 1e-6 * np.abs(z).max()
    assert result["c.friction_force"][late] == pytest.approx(np.abs(force)[late], rel=1e-6)
    inertia = -MASS * rate**2 * radius * np.exp(1j * rate * result.t)
    held = -result["drive_x.reaction"] - 1j * result["drive_y.reaction"]
    assert np.abs(held - (inertia - force))[late].max() < 1e-4 * np.abs(force).max()
    assert np.abs(result["energy.balance"]).max() < 1e-7


# ---- contacts that open, other shapes -------------------------------------------------------------------------------


def test_bristles_stand_straight_while_the_contact_is_open():
    """A ball that bounces and rubs: deflection zero in the air, and the ledger knows what is let go."""
    result = simulate(_bouncing(), 1.0, **TIGHT)
    assert len(events(result, "open")) >= 2
    touch = np.array([event.t for event in result.events])
    away = (result["c.in_contact"] == 0.0) & (np.abs(result.t[:, None] - touch).min(axis=1) > 1e-9)
    bent = np.hypot(result["c.bristle_x"], result["c.bristle_y"])
    assert away.any() and np.all(bent[away] == 0.0) and bent.max() > 1e-5
    assert np.abs(result["energy.balance"]).max() < 1e-6


def _bouncing(release="gap"):
    body = ball(position=(0.0, 0.0, 0.3), velocity=(0.8, 0.6, 0.0), angular_velocity=(2.0, 0.0, 4.0))
    law = LAW.model_copy(update={"release_rule": release})
    floor = SphereOnHalfSpace3D(name="c", plane=HalfSpace3D(), sphere=sphere("ball", 0.15), law=law, friction=BRISTLES)
    return Model(bodies=[body], contacts=[floor], gravity=DOWN)


def test_box_stands_on_a_slope():
    """Held by the bristles of its corners; the forces along the slope are its weight's part."""
    slope = 0.2
    plane = Marker3D(
        attitude=Axes(x=(math.cos(slope), 0.0, -math.sin(slope)), z=(math.sin(slope), 0.0, math.cos(slope)))
    )
    high = 0.1 - 0.25 * NORMAL * math.cos(slope) / STIFFNESS
    box = RigidBody3D(
        name="box", mass=MASS, inertia=(0.02, 0.02, 0.02),
        position=(high * math.sin(slope), 0.0, high * math.cos(slope)),
        attitude=RotationVector(vector=(0.0, slope, 0.0)),
    )  # fmt: skip
    group = ContactGroup3D(
        name="g", boxes=(Box3D(marker=Marker3D(body="box"), size=(0.3, 0.3, 0.2)),),
        half_spaces=(HalfSpace3D(marker=plane),), law=LAW, friction=BRISTLES,
    )  # fmt: skip
    result = simulate(Model(bodies=[box], groups=[group], gravity=DOWN), 0.5, rtol=1e-7, atol=1e-10)
    names = [name for name in result.channels if name.endswith(".friction_force")]
    held = sum(result[name][-1] for name in names)
    assert len(names) == 8 and held == pytest.approx(NORMAL * math.sin(slope), rel=2e-2)
    assert abs(result["box.x"][-1] - result["box.x"][0]) < 5e-3
    assert np.abs(result["energy.balance"]).max() < 1e-6


def test_egg_rolls_on_the_floor_and_a_marble_in_a_bowl():
    egg = RigidBody3D(
        name="egg", mass=1.0, inertia=(2e-3, 4e-3, 5e-3), position=(0.0, 0.0, 0.099), angular_velocity=(4.0, 6.0, 1.0)
    )
    shape = Ellipsoid3D(marker=Marker3D(body="egg"), half_axes=(0.15, 0.12, 0.1))
    floor = SmoothOnHalfSpace3D(name="floor", plane=HalfSpace3D(), shape=shape, law=LAW, friction=BRISTLES)
    marble = ball(position=(0.2, 0.0, -math.sqrt(0.35**2 - 0.04)), velocity=(0.0, 0.6, 0.0))
    bowl = SphereInSphere3D(
        name="bowl", hollow=sphere("ground", 0.5), sphere=sphere("ball", 0.15), law=LAW, friction=BRISTLES
    )
    model = Model(bodies=[egg, marble], contacts=[floor, bowl], gravity=DOWN)
    result = simulate(model, 1.0, rtol=1e-8, atol=1e-11)
    assert np.abs(result["energy.balance"]).max() < 1e-6
    # the marble goes round in the bowl by more than a quarter of a turn; its bristles stay in the tangent plane
    places = np.array([result[f"ball.{axis}"] for axis in "xyz"])
    bent = np.array([result[f"bowl.bristle_{axis}"] for axis in "xyz"])
    normal = places / np.linalg.norm(places, axis=0)
    assert np.ptp(np.unwrap(np.arctan2(places[1], places[0]))) > 2.0
    assert np.abs((normal * bent).sum(axis=0)).max() < 1e-6 * np.linalg.norm(bent, axis=0).max()


def plate_with(mesh):
    """A ball thrown onto a floor, or onto a plate of triangles at its place."""
    body = ball(position=(-0.3, 0.05, 0.25), velocity=(1.2, 0.3, 0.0), angular_velocity=(0.0, 3.0, 6.0))
    parts = {"name": "c", "law": LAW, "friction": BRISTLES}
    if not mesh:
        contact = SphereOnHalfSpace3D(plane=HalfSpace3D(), sphere=sphere("ball", 0.15), **parts)
    else:
        corners = tuple((2.0 * x, 2.0 * y, z) for z in (-1.0, 0.0) for y in (-1.0, 1.0) for x in (-1.0, 1.0))
        faces = (
            (4, 5, 7), (4, 7, 6), (0, 3, 1), (0, 2, 3), (0, 1, 5), (0, 5, 4), (1, 3, 7), (1, 7, 5), (3, 2, 6),
            (3, 6, 7), (2, 0, 4), (2, 4, 6),
        )  # fmt: skip
        plate = TriangleMesh3D(marker=Marker3D(), vertices=corners, faces=faces)
        contact = SphereOnMesh3D(mesh=plate, sphere=sphere("ball", 0.15), **parts)
    times = np.linspace(0.0, 0.8, 81)
    # one table of indices for both kinds
    beside = SphereOnSphere3D(
        name="beside", a=Sphere3D(marker=Marker3D(point=(0.0, -1.5, 0.0)), radius=0.1), b=sphere("ball", 0.15), law=LAW,
        friction=BRISTLES,
    )  # fmt: skip
    model = Model(bodies=[body], contacts=[contact, beside], gravity=DOWN)
    return simulate(model, 0.8, **TIGHT, t_eval=times)


def test_ball_on_a_plate_of_triangles_moves_as_on_a_floor():
    floor, plate = plate_with(False), plate_with(True)
    for name in ("ball.x", "ball.y", "ball.z", "ball.angular_velocity_x", "c.bristle_x", "c.bristle_y"):
        assert np.abs(floor[name] - plate[name]).max() < 1e-7, name
    assert np.abs(plate["c.bristle_z"]).max() < 1e-12
    assert [e.kind for e in floor.events] == [e.kind for e in plate.events]


def test_capsule_rolls_over_another_and_falls_off():
    """Held by its bristles it tips and rolls off a fixed capsule askew below it: the ledger closes."""
    fixed = Capsule3D(
        marker=Marker3D(attitude=RotationVector(vector=(0.0, 0.5 * math.pi, 0.0))), length=1.0, radius=0.1
    )
    rod = RigidBody3D(
        name="rod", mass=1.0, inertia=(0.02, 0.02, 2e-3), position=(0.02, 0.01, 0.1999),
        attitude=RotationVector(vector=(0.5 * math.pi, 0.0, 0.0)), angular_velocity=(0.0, 1.0, 0.5),
    )  # fmt: skip
    moving = Capsule3D(marker=Marker3D(body="rod"), length=0.6, radius=0.1)
    contact = CapsuleOnCapsule3D(name="c", a=fixed, b=moving, law=LAW, friction=BRISTLES)
    result = simulate(Model(bodies=[rod], contacts=[contact], gravity=DOWN), 1.0, rtol=1e-8, atol=1e-11)
    assert np.abs(result["energy.balance"]).max() < 1e-6
    bent = np.array([result[f"c.bristle_{axis}"] for axis in "xyz"])
    assert np.linalg.norm(bent, axis=0).max() > 1e-5
    assert np.linalg.norm(bent, axis=0).max() <= STATIC * result["c.normal_force"].max() / S0 * (1.0 + 1e-6)


def test_cable_falls_on_a_slope_and_is_held_by_the_bristles_of_its_points():
    slope = math.tan(0.1)
    cable = Cable3D(
        name="cable", elements=3, length=1.0, mass_per_length=1.0, axial_stiffness=1e4, bending_stiffness=0.5,
        axial_damping=5.0, position=(0.0, 0.0, 0.04), attitude=RotationVector(vector=(0.0, 0.0, 0.4)),
    )  # fmt: skip
    group = ContactGroup3D(
        name="g", cables=(CableLine3D(cable="cable", thickness=0.02, points=4),),
        half_spaces=(HalfSpace3D(marker=Marker3D(attitude=Axes(z=(slope, 0.0, 1.0)), point=(0.0, 0.0, -0.15))),),
        law=KelvinVoigt(stiffness=5e3, damping=50.0), friction=BRISTLES,
    )  # fmt: skip
    result = simulate(Model(bodies=[cable], groups=[group], gravity=DOWN), 2.0, rtol=1e-7, atol=1e-10)
    assert np.abs(result["energy.balance"]).max() < 1e-6
    names = [name for name in result.channels if name.endswith(".friction_force")]
    assert len(names) == 4
    assert sum(result[name][-1] for name in names) == pytest.approx(G * math.sin(0.1), rel=0.1)
    late = result.t > 1.8
    assert np.ptp(result["cable.x0"][late]) < 1e-3


# ---- the record -----------------------------------------------------------------------------------------------------


def test_names_and_sizes():
    assembly = resting().assemble()
    assert assembly.coordinate_names[-2:] == ["c.bristle_x", "c.bristle_y"]
    assert assembly.n_internal == 2 and np.isinf(assembly.leap[-2:]).all()
    assert {"c.bristle_x", "c.bristle_y"} < set(simulate(resting(), 0.01).channels)
    two = SphereOnSphere3D(name="c", a=sphere("ground", 0.2), b=sphere("ball", 0.1), law=LAW, friction=BRISTLES)
    assert tuple(two.internal_coordinates()) == ("bristle_x", "bristle_y", "bristle_z")


def test_json_round_trip():
    assert Model.from_json(resting().to_json()) == resting()


def test_state_goes_on_bit_for_bit():
    run = Simulation(_bouncing())
    run.advance(0.25)
    state = run.state()
    run.advance(1.0)
    again = Simulation(_bouncing())
    again.restore(state)
    again.advance(1.0)
    assert np.array_equal(run.values(), again.values())


def test_shapes_whose_bristles_are_not_carried_are_refused():
    with pytest.raises(ModelError, match=r"contact 'c' is a SphereOnCable3D, .* BrownMcPhee"):
        SphereOnCable3D(name="c", cable="rope", sphere=sphere("ball", 0.1), law=LAW, friction=BRISTLES)


def test_run_of_a_compiled_model_with_another_stiffness():
    """Of its bristles: bit for bit that of the model built with it, over contacts that end."""
    stiffness = Parameter(name="stiffness", targets=["c.friction.bristle_stiffness"])
    model = _bouncing().model_copy(update={"parameters": (stiffness,)})
    run = compile_model(model).simulation({"stiffness": 2e4})
    alone = Simulation(model.with_parameters({"stiffness": 2e4}))
    for t in (0.25, 1.0):
        for sim in (run, alone):
            sim.advance(t)
        assert run.values().tobytes() == alone.values().tobytes()
        assert run.state().to_bytes() == alone.state().to_bytes()
