"""Material points of flexible bodies and what is attached to them: tangents, motion, joints, forces, contacts."""

import math

import numpy as np
import pytest
from helpers import GROUND, on, residuals
from test_tangents import SINE, Point, check_levels, check_matrix, draw
from tlismni.core import (
    AppliedForce2D,
    Cable2D,
    Clamp2D,
    Constant,
    Disk2D,
    DiskOnHalfPlane2D,
    Flores,
    HalfPlane2D,
    LinearSystem,
    MaterialPoint2D,
    Model,
    ModelError,
    NewtonImpact,
    PointMass2D,
    Prismatic2D,
    Revolute2D,
    RigidBody2D,
    simulate,
)
from tlismni.core.elements.flexible_body import PointShape
from tlismni.core.state.modes import ACTIVE, CLOSED

ARC = tuple(
    (2.5 * math.sin(0.4 * s), 2.5 * (1.0 - math.cos(0.4 * s)), math.cos(0.4 * s), math.sin(0.4 * s)) for s in (0, 1, 2)
)
PLASTIC = NewtonImpact(restitution=0.0)
FINE = 2e-3
"""Span of the differences: strains are no polynomials of the coordinates."""
CABLE = {
    "name": "cable", "elements": 2, "length": 2.4, "mass_per_length": 1.3, "axial_stiffness": 7.0,
    "bending_stiffness": 2.0, "axial_damping": 0.4, "bending_damping": 0.3, "reference_strain": 0.05,
    "reference_curvature": -0.2, "shape": ARC, "angle": 0.3, "position": (0.5, -0.2), "velocity": (0.1, 0.7),
    "angular_velocity": 0.6,
}  # fmt: skip
BODY = RigidBody2D(name="b", mass=0.7, inertia=0.2, position=(2.0, 0.5))
MIDDLE = MaterialPoint2D(name="middle", body="cable", point=(0.7, 0.0))
TIP = MaterialPoint2D(name="tip", body="cable", point=(2.4, 0.0))


def on_floor(law):
    plane, disk = HalfPlane2D(marker=on("ground", 0.0, 1.5, 0.2)), Disk2D(marker=on("middle", 0.1, -0.2), radius=1.5)
    return DiskOnHalfPlane2D(name="c", plane=plane, disk=disk, law=law)


CASES = {
    "cable": {},
    "cable, reduced integration": {"cable": {"integration": "reduced", "relaxed": "start"}},
    "point": {"bodies": [MIDDLE]},
    "points": {"bodies": [TIP, MIDDLE]},
    "clamp": {"bodies": [TIP], "joints": [Clamp2D(name="j", a=on("b", 0.3, -0.4), b=on("tip", 0.1, 0.2))]},
    "clamp on ground": {
        "bodies": [TIP], "joints": [Clamp2D(name="j", a=on("ground", 0.3), b=on("tip"), relative_angle=0.3)]
    },
    "pin": {"bodies": [MIDDLE], "joints": [Revolute2D(name="j", a=on("b", 0.3, -0.4), b=on("middle", 0.1, 0.2))]},
    "slider": {"bodies": [MIDDLE], "joints": [Prismatic2D(name="j", a=on("middle", 0.1, 0.2, 0.3), b=on("b"))]},
    "follower force": {
        "bodies": [TIP],
        "forces": [AppliedForce2D(name="f", marker=on("tip"), force_x=SINE, force_y=SINE, follower=True)],
    },
    "closed contact": {"bodies": [MIDDLE], "contacts": [on_floor(PLASTIC)], "mode": CLOSED},
    "contact force": {
        "bodies": [MIDDLE],
        "contacts": [on_floor(Flores(stiffness=6.0, restitution=0.5, exponent=2.0))], "mode": ACTIVE,
    },
}  # fmt: skip


def system(case):
    parts = {key: value for key, value in CASES[case].items() if key not in ("mode", "bodies", "cable")}
    bodies = [BODY, *CASES[case].get("bodies", ()), Cable2D(**CABLE | CASES[case].get("cable", {}))]
    return Point(Model(gravity=(0.3, -9.0), bodies=bodies, **parts), CASES[case].get("mode"))


@pytest.mark.parametrize("case", CASES)
def test_tangent_and_levels(case):
    point = system(case)
    for seed in range(4):
        state = draw(point, seed)
        state[1] = point.workspace.assembly.q0 + 0.5 * (state[1] - point.workspace.assembly.q0)
        check_matrix(point, state, h=FINE)
        check_levels(point, state, h=FINE)


def test_tangent_and_levels_of_a_point_in_a_floating_frame(monkeypatch):
    """Any coordinates of the body serve as floating frame and as local ones."""
    random = np.random.default_rng(3)
    shape, slope = random.uniform(-1.0, 1.0, (2, 3)), random.uniform(-0.3, 0.3, (2, 3))

    def floating(self, point):
        names = ("x1", "y1", "slope_x1")
        return PointShape(("x0", "y0", "slope_y0"), names, (0.3, 0.2), (1.0, -0.3), shape, slope)

    monkeypatch.setattr(Cable2D, "material_point", floating)
    point = Point(Model(bodies=[MIDDLE, Cable2D(**CABLE)]))
    for seed in range(4):
        state = draw(point, seed)
        check_matrix(point, state, h=FINE)
        check_levels(point, state, h=FINE)


def test_a_point_in_a_floating_frame_starts_where_its_rows_say(monkeypatch):
    def floating(self, point):
        shape, slope = np.array([[0.1, 0.2], [0.3, -0.4]]), np.array([[0.2, 0.1], [-0.3, 0.2]])
        return PointShape(("x0", "y0", "slope_y0"), ("x1", "y1"), (0.3, 0.2), (1.0, -0.3), shape, slope)

    monkeypatch.setattr(Cable2D, "material_point", floating)
    point = Point(Model(bodies=[MIDDLE, Cable2D(**CABLE)]))
    assembly = point.workspace.assembly
    _, phi, phid, _ = point.at(0.0, assembly.q0, assembly.v0, np.zeros(point.n), np.zeros(3))
    assert np.abs(phi).max() < 1e-15
    assert np.abs(phid).max() < 1e-15


def test_points_start_where_the_deformed_cable_is():
    """The cubic follows a circular arc to fourth order; its tangent at a node is the slope itself."""
    cable = Cable2D(**CABLE | {"position": (0.0, 0.0), "angle": 0.0, "length": 2.0})
    model = Model(gravity=(0.0, 0.0), bodies=[cable, MIDDLE, TIP.model_copy(update={"point": (2.0, 0.0)})])
    result = simulate(model, 0.0)
    s = 0.7
    assert abs(result["middle.x"][0] - 2.5 * math.sin(0.4 * s)) < 1e-4
    for name, coordinate in (("x", "x2"), ("y", "y2"), ("vx", "vx2"), ("vy", "vy2")):
        assert abs(result[f"tip.{name}"][0] - result[f"cable.{coordinate}"][0]) < 1e-14
    assert abs(result["tip.angle"][0] - 0.8) < 1e-14
    assert abs(result["tip.angular_velocity"][0] - 0.6) < 1e-14


def test_a_rigid_body_clamped_to_a_tip_moves_like_one_with_the_tip():
    cable = Cable2D(name="cable", elements=2, length=1.0, mass_per_length=1.0, axial_stiffness=50.0,
                    bending_stiffness=0.5)  # fmt: skip
    mass = RigidBody2D(name="mass", mass=0.5, inertia=0.02, position=(1.1, 0.0))
    bodies = [cable, mass, *(MaterialPoint2D(name=n, body="cable", point=(s, 0.0)) for n, s in (("r", 0), ("t", 1)))]
    joints = [Clamp2D(name="root", a=GROUND, b=on("r")), Clamp2D(name="weld", a=on("t"), b=on("mass", -0.1))]
    result = simulate(Model(bodies=bodies, joints=joints), 0.3, method="irk", rtol=1e-7)
    assert np.abs(result["mass.angle"] - result["t.angle"]).max() < 1e-12
    assert np.abs(result["mass.x"] - result["t.x"] - 0.1 * np.cos(result["t.angle"])).max() < 1e-12
    force_x, force_y = result["weld.force_x"], result["weld.force_y"]
    assert np.abs(force_x - 0.5 * result["mass.ax"]).max() < 1e-8
    assert np.abs(force_y - 0.5 * (result["mass.ay"] + 9.81)).max() < 1e-8
    assert np.abs(result["t.force_x"] + force_x).max() < 1e-9  # what the point hands on
    # moment about the clamp: J alpha = torque + arm x force, the arm from the centre of mass to the clamp
    arm = -0.1 * np.stack([np.cos(result["mass.angle"]), np.sin(result["mass.angle"])])
    turning = 0.02 * result["mass.angular_acceleration"]
    assert np.abs(turning - result["weld.torque"] - arm[0] * force_y + arm[1] * force_x).max() < 1e-8
    assert np.abs(result["energy.balance"]).max() < 1e-5
    assert max(residuals(result)[:2]) < 1e-10


def test_a_slider_on_the_tip_follows_the_turning_axis():
    """A body in a guide at the tip: no force along the guide but that of its own weight and inertia."""
    cable = Cable2D(name="cable", elements=1, length=1.0, mass_per_length=1.0, axial_stiffness=50.0,
                    bending_stiffness=0.5)  # fmt: skip
    mass = RigidBody2D(name="mass", mass=0.2, inertia=0.01, position=(1.0, 0.0), velocity=(0.3, 0.0))
    bodies = [cable, mass, *(MaterialPoint2D(name=n, body="cable", point=(s, 0.0)) for n, s in (("r", 0), ("t", 1)))]
    joints = [Revolute2D(name="root", a=GROUND, b=on("r")), Prismatic2D(name="guide", a=on("t"), b=on("mass"))]
    result = simulate(Model(bodies=bodies, joints=joints), 0.3, method="irk", rtol=1e-7)
    angle = result["t.angle"]
    along = np.cos(angle) * result["mass.ax"] + np.sin(angle) * (result["mass.ay"] + 9.81)
    off = np.cos(angle) * (result["mass.y"] - result["t.y"]) - np.sin(angle) * (result["mass.x"] - result["t.x"])
    assert np.abs(along).max() < 1e-8
    assert np.abs(off).max() < 1e-12
    assert np.abs(result["mass.angle"] - angle).max() < 1e-12
    assert np.abs(result["energy.balance"]).max() < 1e-5


def test_an_impact_at_a_material_point_keeps_momentum_and_stops_the_point():
    """A free cable falls on a floor with its middle, e = 0: the impulse is the change of its momentum."""
    cable = Cable2D(name="cable", elements=2, length=1.0, mass_per_length=2.0, axial_stiffness=1e3,
                    bending_stiffness=1.0, position=(0.0, 0.1))  # fmt: skip
    point = MaterialPoint2D(name="p", body="cable", point=(0.4, 0.0))
    floor = DiskOnHalfPlane2D(name="floor", plane=HalfPlane2D(), disk=Disk2D(marker=on("p")), law=PLASTIC)
    result = simulate(Model(bodies=[cable, point], contacts=[floor]), 0.16, rtol=1e-7)
    impact = next(event for event in result.events if event.kind == "impact")
    assert abs(impact.t - math.sqrt(0.2 / 9.81)) < 1e-8
    after = int(np.searchsorted(result.t, impact.t, side="right")) - 1
    assert abs(result["p.vy"][after]) < 1e-10
    # weights of the consistent mass: momentum = integral of the cubic
    weights = np.array([0.25, 1.0 / 48.0, 0.5, 0.0, 0.25, -1.0 / 48.0])
    names = ("vy0", "d_slope_y0", "vy1", "d_slope_y1", "vy2", "d_slope_y2")
    momentum = 2.0 * sum(w * result[f"cable.{name}"] for w, name in zip(weights, names, strict=True))
    assert abs(momentum[after] - momentum[after - 1] - impact.impulse) < 1e-9
    assert abs(result["energy.balance"][-1]) < 1e-5
    assert impact.energy_loss > 0.0


def test_bad_points_are_refused_by_name():
    cable, toy = Cable2D(**CABLE), LinearSystem(name="toy", coordinates=("u",), mass=((1.0,),))
    for body, point, text in (
        ("rope", (0.0, 0.0), "'rope', which does not exist"),
        ("toy", (0.0, 0.0), "is a LinearSystem"),
        ("cable", (2.5, 0.0), "no point at s = 2.5"),
        ("cable", (0.5, 0.1), "lies on its axis"),
    ):
        with pytest.raises(ModelError, match=text):
            Model(bodies=[cable, toy, MaterialPoint2D(name="p", body=body, point=point)])
    with pytest.raises(ModelError, match="MaterialPoint2D"):
        Model(bodies=[cable], forces=[AppliedForce2D(name="f", marker=on("cable"), force_x=Constant(value=1.0))])
    with pytest.raises(ModelError, match="shape of 'cable' has 3 nodes"):
        Cable2D(**CABLE | {"elements": 3})


def test_model_with_a_cable_survives_json():
    model = Model(bodies=[PointMass2D(name="p", mass=1.0), Cable2D(**CABLE), TIP])
    assert Model.from_json(model.to_json()) == model
