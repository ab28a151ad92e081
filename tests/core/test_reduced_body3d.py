"""Reduced bodies in space against their particles, rigid bodies, the plane; what they refuse; files of arrays."""

import json

import numpy as np
import pytest
from reduced_bodies import cloud, moments, plain, points_with_modes
from test_floating_frame import particles
from test_tangents import Point, draw
from tlismni.core import (
    AppliedForce2D,
    AppliedForce3D,
    Constant,
    CoordinateDriver,
    HalfSpace3D,
    HuntCrossley,
    InterfaceFrame3D,
    Marker2D,
    Marker3D,
    MaterialPoint2D,
    Model,
    ModelError,
    NewtonImpact,
    ReducedBody3D,
    ReducedPoint,
    Revolute2D,
    Revolute3D,
    RigidBody3D,
    RotationVector,
    Sphere3D,
    SphereOnHalfSpace3D,
    Spherical3D,
    simulate,
)
from tlismni.core.model.attitude import product, rotation_matrix

TIGHT = {"rtol": 1e-10, "atol": 1e-12}
MODES, POINTS = 3, 9
START = {
    "position": (0.2, -0.1, 0.4), "attitude": RotationVector(vector=(0.4, 0.2, -0.3)), "velocity": (0.3, 0.1, -0.2),
    "angular_velocity": (1.0, -0.6, 0.8),
}  # fmt: skip
WEIGHT = (0.3, -0.4, -9.0)


def body(seed=3, **changes):
    return ReducedBody3D(name="r", **{**points_with_modes(seed, POINTS, MODES), **START, **changes})


def turning(p, u):
    """d(A u)/dp (..., 3, 4): A is quadratic in p, so differences over any step are exact."""
    both = [0.5 * (rotation_matrix(p + unit) - rotation_matrix(p - unit)) for unit in np.eye(4)]
    return np.stack([u @ matrix.T for matrix in both], axis=-1)


def motion(seed, q, v):
    """Masses, places and velocities of the particles for coordinates and rates (7 + n,)."""
    mass, places, shapes = cloud(seed, POINTS, MODES)
    local = places + np.einsum("k,kai->ai", q[7:], shapes)
    moved = turning(q[3:7], local) @ v[3:7] + np.einsum("k,kai->ai", v[7:], shapes) @ rotation_matrix(q[3:7]).T
    return mass, q[:3] + local @ rotation_matrix(q[3:7]).T, v[:3] + moved


def total(result):
    return sum(result[f"energy.{part}"] for part in ("kinetic", "potential", "strain"))


@pytest.mark.parametrize("seed", range(4))
def test_equations_are_those_of_its_particles(seed):
    """J^T (M x'' - weight) of all particles, but for what the norm's row takes; and the forces of modes."""
    record = body(seed)
    point = Point(Model(gravity=WEIGHT, bodies=[record]))
    t, q, v, a, _ = draw(point, seed)
    q[3:7] /= np.linalg.norm(q[3:7])
    v[3:7] -= q[3:7] * (q[3:7] @ v[3:7])
    a[3:7] -= q[3:7] * (q[3:7] @ a[3:7] + v[3:7] @ v[3:7])
    mass, places, shapes = cloud(seed, POINTS, MODES)
    p, dp, ddp, axes = q[3:7], v[3:7], a[3:7], rotation_matrix(q[3:7])
    local, dlocal, ddlocal = (places * (x is q) + np.einsum("k,kai->ai", x[7:], shapes) for x in (q, v, a))
    by_p = turning(p, local)
    inertial = a[:3] + by_p @ ddp + turning(dp, local) @ dp + 2.0 * turning(p, dlocal) @ dp + ddlocal @ axes.T
    force = mass[:, None] * (inertial - WEIGHT)
    on_p = np.einsum("aij,ai->j", by_p, force)
    on_modes = np.einsum("kai,ai->k", shapes, force @ axes) + np.array(record.stiffness) @ q[7:]
    r, *_ = point.at(t, q, v, a, np.zeros(1))
    across = np.eye(4) - np.outer(p, p)
    np.testing.assert_allclose(r[:3], force.sum(axis=0), rtol=0, atol=1e-13)
    np.testing.assert_allclose(across @ r[3:7], across @ on_p, rtol=0, atol=1e-12)
    np.testing.assert_allclose(r[7:], on_modes, rtol=0, atol=1e-12)


def test_free_body_keeps_energy_momentum_and_angular_momentum_of_its_particles():
    record = body(amplitudes=(0.2, -0.1, 0.15), amplitude_rates=(0.3, 0.1, -0.2))
    result = simulate(Model(gravity=(0.0, 0.0, 0.0), bodies=[record]), 3.0, t_eval=np.linspace(0.0, 3.0, 7), **TIGHT)
    found = []
    for q, v in zip(result.q, result.v, strict=True):
        mass, x, dx = motion(3, q, v)
        found.append([*(mass @ dx), *np.einsum("a,ai->i", mass, np.cross(x, dx)), 0.5 * mass @ (dx**2).sum(axis=1)])
    found = np.array(found)
    np.testing.assert_allclose(found[:, :6], np.tile(found[0, :6], (7, 1)), rtol=0, atol=1e-8)
    np.testing.assert_allclose(result["energy.kinetic"], found[:, 6], rtol=1e-12)
    assert np.ptp(found[:, 6]) > 0.1 * found[0, 6]  # energy goes to and fro between motion and strain
    np.testing.assert_allclose(total(result), total(result)[0], rtol=1e-8)
    np.testing.assert_allclose(np.linalg.norm(result.q[:, 3:7], axis=1), 1.0, rtol=0, atol=1e-13)


def test_damping_and_weight_are_in_the_balance():
    damping = (0.2 * np.eye(3)).tolist()
    record = body(damping=damping, amplitudes=(0.3, 0.0, 0.0))
    tip = InterfaceFrame3D(name="m", body="r", interface="turning")
    pivot = Spherical3D(name="j", a=Marker3D(point=START["position"]), b=Marker3D(body="r"))
    result = simulate(Model(gravity=WEIGHT, bodies=[record.model_copy(update={"velocity": (0.0,) * 3}), tip],
                            joints=[pivot]), 1.0, **TIGHT)  # fmt: skip
    lost = total(result)[0] - total(result)[-1]
    assert lost > 1e-3
    np.testing.assert_allclose(result["energy.dissipation"][-1], lost, rtol=1e-7)


def test_with_modes_held_it_is_a_rigid_body_with_its_centre_of_mass_off_the_frame():
    mass, places, _ = cloud(3, POINTS, MODES)
    middle = mass @ places / mass.sum()
    arms = places - middle
    inertia = np.einsum(
        "a,aij->ij", mass, (arms**2).sum(axis=1)[:, None, None] * np.eye(3) - arms[:, :, None] * arms[:, None]
    )
    record = body(velocity=(0.0, 0.0, 0.0))
    axes = rotation_matrix(record.attitude.parameters())
    rigid = RigidBody3D(
        name="s", mass=mass.sum(), inertia=np.diag(inertia).tolist(),
        inertia_products=(inertia[0, 1], inertia[0, 2], inertia[1, 2]),
        position=(np.array(START["position"]) + axes @ middle).tolist(), attitude=START["attitude"],
        velocity=(axes @ np.cross(START["angular_velocity"], middle)).tolist(),
        angular_velocity=START["angular_velocity"],
    )  # fmt: skip
    end = Marker3D(body="s", point=(places[0] - middle).tolist())
    tip = InterfaceFrame3D(name="m", body="r", interface="turning")
    pivot = Marker3D(point=START["position"])
    held = [CoordinateDriver(name=f"held{k}", body="r", coordinate=f"mode{k + 1}", motion=Constant(value=0.0))
            for k in range(MODES)]  # fmt: skip
    loads = {"force_x": Constant(value=3.0), "force_y": Constant(value=-2.0), "force_z": Constant(value=4.0)}
    flexible = Model(
        gravity=WEIGHT, bodies=[record, tip], joints=[Spherical3D(name="j", a=pivot, b=Marker3D(body="r")), *held],
        forces=[AppliedForce3D(name="f", marker=Marker3D(body="m"), **loads)],
    )  # fmt: skip
    own = Model(
        gravity=WEIGHT, bodies=[rigid],
        joints=[Spherical3D(name="j", a=pivot, b=rigid.marker_at(START["position"]))],
        forces=[AppliedForce3D(name="f", marker=end, **loads)],
    )  # fmt: skip
    a, b = (simulate(model, 1.5, t_eval=[0.5, 1.0, 1.5], **TIGHT) for model in (flexible, own))
    for k in range(4):
        np.testing.assert_allclose(a[f"r.e{k}"], b[f"s.e{k}"], rtol=0, atol=1e-8)
        np.testing.assert_allclose(a[f"m.e{k}"], b[f"s.e{k}"], rtol=0, atol=1e-8)
    for axis in "xyz":
        np.testing.assert_allclose(a[f"j.force_{axis}"], b[f"j.force_{axis}"], rtol=0, atol=1e-6)
        np.testing.assert_allclose(a[f"m.force_{axis}"], loads[f"force_{axis}"].value, rtol=0, atol=1e-9)


def test_planar_reduced_body_lifted_into_a_plane_askew():
    """The same particles, hinged at the frame's origin, with a force at a point."""
    flat, (mass, u0, s, _) = particles(stiffening=False)
    flat = flat.model_copy(update={
        "position": (0.0, 0.0), "angle": 0.3, "angular_velocity": 0.5,
        "points": (ReducedPoint(point=u0[0].tolist(), shape=s[0].tolist()),),
    })  # fmt: skip

    def spread(x):
        return np.concatenate([x, np.zeros((*x.shape[:-1], 1))], axis=-1)

    shapes = spread(s.transpose(2, 0, 1))
    askew = RotationVector(vector=(0.7, -0.4, 0.3))
    axes = rotation_matrix(askew.parameters())
    end = {"name": "tip", "point": spread(u0)[0], "shape": shapes[:, 0]}
    solid = ReducedBody3D(
        name="s", **moments(mass, spread(u0), shapes), stiffness=flat.stiffness, damping=flat.damping,
        interfaces=[plain(end)], angular_velocity=(0.0, 0.0, 0.5),
        attitude={"type": "EulerParameters", "values": _turned(askew, 0.3)},
    )  # fmt: skip
    weight, force = np.array([0.4, -9.0]), np.array([1.5, -2.0])
    in_plane = Model(
        gravity=tuple(weight), bodies=[flat, MaterialPoint2D(name="m", body="s", point=u0[0].tolist())],
        joints=[Revolute2D(name="j", a=Marker2D(), b=Marker2D(body="s"))],
        forces=[AppliedForce2D(name="f", marker=Marker2D(body="m"), force_x=Constant(value=force[0]),
                               force_y=Constant(value=force[1]))],
    )  # fmt: skip
    pull = axes[:, :2] @ force
    in_space = Model(
        gravity=tuple((axes[:, :2] @ weight).tolist()),
        bodies=[solid, InterfaceFrame3D(name="m", body="s", interface="tip")],
        joints=[Revolute3D(name="j", a=Marker3D(attitude=askew), b=Marker3D(body="s"))],
        forces=[AppliedForce3D(name="f", marker=Marker3D(body="m"),
                               **{f"force_{c}": Constant(value=x) for c, x in zip("xyz", pull, strict=True)})],
    )  # fmt: skip
    a, b = (simulate(model, 1.0, t_eval=[0.3, 0.6, 1.0], **TIGHT) for model in (in_plane, in_space))
    for k in (1, 2):
        np.testing.assert_allclose(b[f"s.mode{k}"], a[f"s.mode{k}"], rtol=0, atol=1e-8)
    place = np.stack([b[f"m.{c}"] for c in "xyz"], axis=1) @ axes
    np.testing.assert_allclose(place, np.stack([a["m.x"], a["m.y"], 0.0 * a.t], axis=1), rtol=0, atol=1e-8)
    np.testing.assert_allclose(b["j.angle"], a["s.angle"], rtol=0, atol=1e-8)


def _turned(attitude, angle):
    return product(attitude.parameters(), (np.cos(0.5 * angle), 0.0, 0.0, np.sin(0.5 * angle)))


@pytest.mark.parametrize("law", [NewtonImpact(restitution=0.6), HuntCrossley(stiffness=1e5, restitution=0.6)])
def test_ball_on_an_interface_strikes_a_plane(law):
    """The constraint's impact hands its impulse to the whole body; energy goes only where the law says."""
    record = body(angular_velocity=(0.0, 0.3, 0.0), velocity=(0.0, 0.0, -1.0), position=(0.0, 0.0, 1.5))
    tip = InterfaceFrame3D(name="m", body="r", interface="node")
    low = 1.5 + (rotation_matrix(record.attitude.parameters()) @ np.array(record.interfaces[1].point))[2]
    plane = HalfSpace3D(marker=Marker3D(point=(0.0, 0.0, low - 0.3)))
    contact = SphereOnHalfSpace3D(
        name="c", sphere=Sphere3D(marker=Marker3D(body="m"), radius=0.1), plane=plane, law=law
    )
    model = Model(gravity=(0.0, 0.0, 0.0), bodies=[record, tip], contacts=[contact])
    result = simulate(model, 0.5, rtol=1e-8, atol=1e-10)
    impulse = result["c.impulse"][-1]
    assert impulse > 0.1
    mass, _, before = motion(3, result.q[0, :10], result.v[0, :10])
    _, _, after = motion(3, result.q[-1, :10], result.v[-1, :10])
    np.testing.assert_allclose(mass @ (after - before), (0.0, 0.0, impulse), rtol=0, atol=1e-6)
    lost = total(result)[0] - total(result)[-1]
    assert lost > 1e-3
    if isinstance(law, NewtonImpact):
        impact = next(event for event in result.events if event.kind == "impact")
        np.testing.assert_allclose(impact.separation_speed, 0.6 * impact.approach_speed, rtol=1e-8)


def test_arrays_come_from_a_file_beside_the_model(tmp_path):
    record = body()
    model = Model(gravity=WEIGHT, bodies=[record, InterfaceFrame3D(name="m", body="r", interface="turning")])
    assert Model.from_json(model.to_json()) == model
    data = json.loads(model.to_json())
    record.save_arrays(tmp_path / "cloud.npz")
    held = ("name", "type", "position", "velocity", "attitude", "angular_velocity")
    data["bodies"][0] = {**{key: data["bodies"][0][key] for key in held}, "arrays": "cloud.npz"}
    (tmp_path / "model.json").write_text(json.dumps(data))
    assert Model.load(tmp_path / "model.json") == model
    (tmp_path / "deeper").mkdir()
    for name, message in (("../cloud.npz", "not beside"), ("none.npz", "cannot be read"), ("cloud.txt", ".npz")):
        data["bodies"][0]["arrays"] = name
        (tmp_path / "deeper" / "model.json").write_text(json.dumps(data))
        with pytest.raises(ModelError, match=message):
            Model.load(tmp_path / "deeper" / "model.json")
    data["bodies"][0].update(arrays="cloud.npz", mass=1.0)
    (tmp_path / "model.json").write_text(json.dumps(data))
    with pytest.raises(ModelError, match="leave one out"):
        Model.load(tmp_path / "model.json")


def test_what_is_refused():
    fields = points_with_modes(3, POINTS, MODES)
    rigid = np.concatenate([cloud(3, POINTS, MODES)[2], np.tile([1.0, 0.0, 0.0], (1, POINTS, 1))])
    mass, places, _ = cloud(3, POINTS, MODES)
    with pytest.raises(ModelError, match="rigid motion"):
        ReducedBody3D(name="r", **moments(mass, places, rigid), stiffness=np.eye(4).tolist())
    for name, value, message in (
        ("stiffness", -np.eye(3), "negative eigenvalue"), ("damping", -np.eye(3), "negative eigenvalue"),
        ("stiffness", np.triu(np.ones((3, 3))), "symmetric"), ("amplitudes", np.zeros(2), "is needed"),
        ("modal_moment", np.zeros((2, 3, 3)), "is needed"),
    ):  # fmt: skip
        with pytest.raises(ModelError, match=message):
            ReducedBody3D(name="r", **{**fields, name: value.tolist()})
    twice = [*fields["interfaces"], fields["interfaces"][0]]
    with pytest.raises(ModelError, match="names of their own"):
        ReducedBody3D(name="r", **{**fields, "interfaces": twice})
    with pytest.raises(ModelError, match="no interface"):
        Model(bodies=[body(), InterfaceFrame3D(name="m", body="r", interface="other")])
    with pytest.raises(ModelError, match="which does not exist"):
        Model(bodies=[InterfaceFrame3D(name="m", body="r", interface="other")])
    far = body(amplitudes=(9.0, 9.0, 9.0))
    with pytest.raises(ModelError, match="small displacements"):
        simulate(Model(bodies=[far, InterfaceFrame3D(name="m", body="r", interface="turning")]), 0.1)
