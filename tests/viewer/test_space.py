"""Scenes in space: solids are where channels say and have the bodies' inertia; glTF and a browser show the same."""

import json
import struct
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from browser import probe
from runs import run
from tlismni.core import (
    Box3D,
    Cable2D,
    Cable3D,
    CableClamp3D,
    Capsule3D,
    Clamp2D,
    ContactGroup3D,
    HalfSpace3D,
    Marker2D,
    Marker3D,
    MaterialPoint2D,
    Model,
    ModelError,
    NewtonImpact,
    PointMass3D,
    RigidBody3D,
    Rope3D,
    RotationVector,
    Sphere3D,
    SpringDamper3D,
    simulate,
)
from tlismni.core.flexible.section_loads import section
from tlismni.models import load, names
from tlismni.viewer import animate, show
from tlismni.viewer.build import scene_of_start
from tlismni.viewer.scene import Scene
from tlismni.viewer.space import meshes
from tlismni.viewer.space.build import is_spatial
from tlismni.viewer.space.gltf import to_glb
from tlismni.viewer.space.meshes import Mesh
from tlismni.viewer.space.turning import matrices, towards

SIZES = {5126: ("<f4", 4), 5121: ("u1", 1), 5125: ("<u4", 4)}
WIDTHS = {"SCALAR": 1, "VEC3": 3, "VEC4": 4}


class Glb:
    """A .glb file, read by the book."""

    def __init__(self, data: bytes) -> None:
        magic, version, length = struct.unpack_from("<III", data)
        assert (magic, version, length) == (0x46546C67, 2, len(data))
        size, kind = struct.unpack_from("<II", data, 12)
        assert kind == 0x4E4F534A and size % 4 == 0
        self.json: dict[str, Any] = json.loads(data[20 : 20 + size])
        binary, kind = struct.unpack_from("<II", data, 20 + size)
        assert kind == 0x004E4942 and binary == self.json["buffers"][0]["byteLength"] == len(data) - 28 - size
        self.binary = data[28 + size :]

    def array(self, number: int) -> Any:
        entry = self.json["accessors"][number]
        view = self.json["bufferViews"][entry["bufferView"]]
        dtype, size = SIZES[entry["componentType"]]
        count = entry["count"] * WIDTHS[entry["type"]]
        assert view["byteLength"] == count * size and view["byteOffset"] % 4 == 0
        found = np.frombuffer(self.binary, dtype, count, view["byteOffset"])
        return found.reshape(entry["count"], WIDTHS[entry["type"]])


def moments(mesh: Mesh, size: Any) -> tuple[float, Any]:
    """Volume, and the integral of x x^T over a closed surface's inside, by tetrahedra from the origin."""
    a, b, c = np.swapaxes((mesh.vertices * np.array(size))[mesh.triangles], 0, 1)
    volumes = np.einsum("ti,ti->t", a, np.cross(b, c)) / 6.0
    second = np.zeros((3, 3))
    for u in (a, b, c):
        for w in (a, b, c):
            second += np.einsum("t,ti,tj->ij", volumes * (2.0 if u is w else 1.0), u, w) / 20.0
    return float(volumes.sum()), second


def bodies_in_space() -> Model:
    return Model(
        gravity=(0.0, 0.0, -9.81),
        bodies=[
            RigidBody3D(name="box", mass=2.0, inertia=(0.5, 0.7, 0.9), inertia_products=(0.05, 0.0, 0.1)),
            RigidBody3D(name="drum", mass=2.0, inertia=(0.3, 0.2, 0.3), position=(3.0, 0.0, 0.0),
                        attitude=RotationVector(vector=(0.3, 0.2, 0.5)), angular_velocity=(1.0, 2.0, 0.0)),
            RigidBody3D(name="globe", mass=1.0, inertia=(0.4, 0.4, 0.4), position=(0.0, 3.0, 0.0)),
            PointMass3D(name="bead", mass=1.0, position=(0.0, 0.0, -2.0)),
        ],
        forces=[SpringDamper3D(name="spring", a=Marker3D(), b=Marker3D(body="bead"), stiffness=50.0, damping=1.0,
                               natural_length=2.0)],
        contacts=[Rope3D(name="rope", a=Marker3D(point=(0.0, 3.0, 2.0)), b=Marker3D(body="globe"), length=4.0,
                         law=NewtonImpact(restitution=0.0))],
    )  # fmt: skip


@pytest.mark.parametrize("name", ["box", "drum", "globe"])
def test_a_body_without_shapes_is_the_uniform_solid_with_its_inertia(name: str) -> None:
    model = bodies_in_space()
    body = next(b for b in model.bodies if b.name == name)
    scene = show(model).scene
    number = next(k for k, frame in enumerate(scene.frames) if frame.name == name)
    solid = next(s for s in scene.solids if s.frame == number)
    volume, second = moments(solid.mesh, solid.size)
    turn = matrices(np.array(solid.turn))
    second = turn @ second @ turn.T * body.mass / volume
    inertia = np.trace(second) * np.eye(3) - second
    (xx, yy, zz), (xy, xz, yz) = body.inertia, body.inertia_products
    wanted = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    # round ones have AROUND sides: 1.2 % are missing of a square of the radius, twice that of a ball's
    assert inertia == pytest.approx(wanted, rel=0.035, abs=1e-3 if name == "box" else 0.01)


@pytest.mark.parametrize(
    "mesh", [meshes.ball(), meshes.cylinder(), meshes.box(), meshes.coil(), meshes.cylinder(marked=True)]
)
def test_surfaces_are_closed_and_face_outwards(mesh: Mesh) -> None:
    assert np.linalg.norm(mesh.normals, axis=1) == pytest.approx(np.ones(len(mesh.normals)), abs=1e-9)
    a, b, c = np.swapaxes(mesh.vertices[mesh.triangles], 0, 1)
    area = np.cross(b - a, c - a)
    assert np.all(np.einsum("ti,tki->tk", area, mesh.normals[mesh.triangles]).sum(axis=1) > 0.0)
    if mesh is not meshes.coil():  # its ends are open, within the ends of what it joins
        assert area.sum(axis=0) == pytest.approx(np.zeros(3), abs=1e-9)
    assert moments(mesh, (1.0, 1.0, 1.0))[0] > 0.0


def test_turns_bring_z_to_any_direction() -> None:
    rng = np.random.default_rng(3)
    ways = np.concatenate([rng.normal(size=(50, 3)), np.eye(3), -np.eye(3)])
    found = matrices(towards(ways))[:, :, 2]
    assert found == pytest.approx(ways / np.linalg.norm(ways, axis=1, keepdims=True), abs=1e-12)


def test_gltf_moves_bodies_as_the_channels_do() -> None:
    result = simulate(bodies_in_space(), 0.5, rtol=1e-8)
    file = Glb(to_glb(animate(result).scene))
    nodes = file.json["nodes"]
    (motion,) = file.json["animations"]
    upright = matrices(np.array([nodes[0]["rotation"][k] for k in (3, 0, 1, 2)]))
    # z is up, and y in glTF
    assert upright @ [0.0, 0.0, 1.0] == pytest.approx([0.0, 1.0, 0.0], abs=1e-12)
    moved = 0
    for channel in motion["channels"]:
        sampler, target = motion["samplers"][channel["sampler"]], channel["target"]
        t, y = file.array(sampler["input"])[:, 0], file.array(sampler["output"])
        assert np.all(np.diff(t) > 0.0) and len(t) == len(y) and t[0] == 0.0
        body = nodes[target["node"]]["name"]
        if target["path"] == "translation" and body in ("drum", "bead", "globe"):
            moved += 1
            for k, c in enumerate("xyz"):
                wanted = np.interp(t, result.t, result[f"{body}.{c}"])
                assert y[:, k] == pytest.approx(wanted, abs=2e-3)
                assert y[-1, k] == pytest.approx(result[f"{body}.{c}"][-1], abs=1e-6)
        if target["path"] == "rotation" and body == "drum":
            last = np.roll(y[-1], 1)
            wanted = np.array([result[f"drum.e{k}"][-1] for k in range(4)])
            assert abs(last @ wanted) == pytest.approx(1.0, abs=1e-6)
        if target["path"] == "scale" and body == "spring":
            assert y[:, 2] == pytest.approx(-np.interp(t, result.t, result["bead.z"]), abs=2e-3)
    assert moved == 3


def test_shapes_that_touch_are_drawn_as_they_are() -> None:
    group = ContactGroup3D(
        name="pile",
        boxes=[Box3D(marker=Marker3D(body="crate"), size=(0.4, 0.3, 0.2))],
        capsules=[Capsule3D(marker=Marker3D(body="pill"), length=0.2, radius=0.1)],
        spheres=[Sphere3D(marker=Marker3D(body="ball", point=(0.1, 0.0, 0.0)), radius=0.15)],
        half_spaces=[HalfSpace3D()],
        law=NewtonImpact(restitution=0.2),
        except_bodies=[("crate", "pill"), ("crate", "ball"), ("pill", "ball")],
    )
    bodies = [
        RigidBody3D(name=name, mass=1.0, inertia=(0.1, 0.1, 0.1), position=(x, 0.0, 1.0))
        for name, x in (("crate", -1.0), ("pill", 0.0), ("ball", 1.0))
    ]
    scene = show(Model(gravity=(0.0, 0.0, -9.81), bodies=bodies, groups=[group])).scene
    named = {frame.name: k for k, frame in enumerate(scene.frames)}
    assert [s.size for s in scene.solids if s.frame == named["crate"]] == [(0.4, 0.3, 0.2)]
    assert {s.size for s in scene.solids if s.frame == named["pill"]} == {(0.1, 0.1, 0.2), (0.1, 0.1, 0.1)}
    (ball,) = (s for s in scene.solids if s.frame == named["ball"])
    assert ball.at == (0.1, 0.0, 0.0) and ball.size == (0.15, 0.15, 0.15)
    (floor,) = (s for s in scene.solids if s.frame == named["ground"])
    assert floor.size[0] > 2.5 and floor.at[2] == 0.0


def test_a_cable_bends_through_its_nodes() -> None:
    cable = Cable3D(
        name="cable", elements=3, length=1.0, mass_per_length=0.3, axial_stiffness=4e3, bending_stiffness=0.7
    )
    root = CableClamp3D(name="root", cable="cable", s=0.0, marker=Marker3D())
    result = simulate(Model(gravity=(0.0, 2.0, -9.81), bodies=[cable], joints=[root]), 0.2)
    scene = animate(result).scene
    (band,) = scene.bands
    for k in range(4):
        nodes = np.stack([result[f"cable.{c}{k}"] for c in "xyz"], axis=1)
        assert band.points[-1, 4 * k] == pytest.approx(nodes[-1], abs=1e-12)
    assert "cable 0" in {node.get("name") for node in Glb(to_glb(scene)).json["nodes"]}


def test_a_cable_in_space_is_coloured_as_the_planar_one() -> None:
    """The same cable by both elements, in one plane: axial force and bending moment along it."""
    numbers: dict[str, Any] = {
        "name": "cable", "elements": 3, "length": 1.0, "mass_per_length": 0.3, "axial_stiffness": 400.0,
        "bending_stiffness": 0.7,
    }  # fmt: skip
    times = np.linspace(0.0, 0.2, 11)
    root = CableClamp3D(name="root", cable="cable", s=0.0, marker=Marker3D())
    space = Model(gravity=(0.0, -9.81, 0.0), bodies=[Cable3D(**numbers)], joints=[root])
    point = MaterialPoint2D(name="end", body="cable", point=(0.0, 0.0))
    weld = Clamp2D(name="root", a=Marker2D(), b=Marker2D(body="end"))
    plane = Model(bodies=[Cable2D(**numbers), point], joints=[weld])
    found = simulate(space, 0.2, rtol=1e-9, t_eval=times)
    swung = simulate(plane, 0.2, rtol=1e-9, t_eval=times)
    like = section(swung, plane.bodies[0], np.linspace(0.0, 1.0, 13), times=times)
    scene = animate(found).scene
    (band,) = scene.bands
    fields = {field.name: field for field in band.fields}
    frames = [int(np.argmin(np.abs(scene.t - t))) for t in times[1:]]
    force, moment = fields["axial force"].values, fields["bending moment"].values
    assert fields["bending moment"].limit > 0.5
    assert moment.shape == band.points.shape[:2]
    assert np.abs(moment[frames][:, ::4] - np.abs(like.bending_moment[1:, ::4])).max() < 1e-4
    assert np.abs(force[frames][:, ::4] - like.axial_force[1:, ::4]).max() < 1e-2


def test_every_scenario_in_space_has_a_scene_and_a_file() -> None:
    found = [name for name in names() if is_spatial(load(name).model)]
    assert len(found) >= 8
    for name in found:
        scene: Scene = show(load(name).model).scene
        assert scene.solids and scene.dimension == 3 and len(scene.corners) >= 4
        assert "animations" not in Glb(to_glb(scene)).json


def test_what_belongs_to_the_plane_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ModelError, match="outlines are for models of the plane"):
        show(bodies_in_space(), outlines={"box": [(0, 0), (1, 0), (1, 1)]})
    with pytest.raises(ModelError, match="glTF is for models in space"):
        run("pendulum_stop").animate(tmp_path / "x.glb")


def test_a_film_of_a_box_shows_three_of_its_faces(tmp_path: Path) -> None:
    pytest.importorskip("PIL")
    from PIL import Image

    body = RigidBody3D(name="box", mass=1.0, inertia=(0.02, 0.03, 0.04), velocity=(0.1, 0.0, 0.0))
    result = simulate(Model(gravity=(0.0, 0.0, 0.0), bodies=[body]), 1.0)
    result.animate(tmp_path / "x.gif", seconds=0.2, fps=10, width=120)
    picture = np.asarray(Image.open(tmp_path / "x.gif").convert("RGB")).reshape(-1, 3)
    blueish = picture[(picture[:, 2].astype(int) - picture[:, 0] > 20)]
    colours, counts = np.unique(blueish // 4, axis=0, return_counts=True)
    assert np.sum(counts > 60) >= 3, (colours, counts)


@pytest.mark.sampled(1)
@pytest.mark.parametrize("size", [(1280, 800), (390, 844)], ids=["desktop", "phone"])
def test_in_a_browser_solids_are_drawn_where_the_result_says(tmp_path: Path, size: tuple[int, int]) -> None:
    result = simulate(bodies_in_space(), 0.5, rtol=1e-8)
    result.animate(tmp_path / "x.html")
    row = len(result.t) // 2
    found = probe(
        tmp_path / "x.html",
        """
    const t = window.tlismni;
    await t.ready;
    t.seek(TIME);
    t.paint(0);
    found.drum = t.placed("drum");
    const solid = document.getElementById("solid"), copy = document.createElement("canvas");
    [copy.width, copy.height] = [solid.width, solid.height];
    const g = copy.getContext("2d");
    g.drawImage(solid, 0, 0);
    const pixels = g.getImageData(0, 0, copy.width, copy.height).data, colours = new Set();
    for (let i = 0; i < pixels.length; i += 4) colours.add((pixels[i] << 16) + (pixels[i + 1] << 8) + pixels[i + 2]);
    found.colours = colours.size;
    const view = document.getElementById("view"), before = t.camera.turn;
    for (const [kind, x] of [["pointerdown", 100], ["pointermove", 140], ["pointerup", 140]]) {
      const event = new PointerEvent(kind, { clientX: x, clientY: 300, pointerId: 1, buttons: 1, bubbles: true });
      view.setPointerCapture = () => {};
      view.dispatchEvent(event);
    }
    found.turned = before - t.camera.turn;
    const side = document.getElementById("side");
    side.value = "z";
    side.dispatchEvent(new Event("change"));
    const [x, y] = t.toScreen([1, 0, 0]), [a, b] = t.toScreen([0, 1, 0]);
    const [c, d] = t.toScreen([0, 0, 1]), [o, p] = t.toScreen([0, 0, 0]);
    found.axes = [[x - o, p - y], [a - o, p - b], [c - o, p - d]].map((v) => v.map((n) => n / t.camera.scale));
    found.loaded = performance.getEntriesByType("resource").length;
    found.wide = document.documentElement.scrollWidth - window.innerWidth;
    """.replace("TIME", repr(float(result.t[row]))),
        size,
    )
    assert "error" not in found and found["failures"] == []
    place = [result[f"drum.{c}"][row] for c in "xyz"]
    axes = matrices(np.array([result[f"drum.e{k}"][row] for k in range(4)]))
    assert found["drum"][:3] == pytest.approx(place, abs=2e-4)
    assert found["drum"][3:] == pytest.approx(axes.T.ravel(), abs=2e-3)
    assert found["colours"] > 40 and found["turned"] == pytest.approx(0.32)
    # seen along z: x and y are a right angle in true length, counter-clockwise, and z is a point
    (xx, xy), (yx, yy), z = found["axes"]
    assert np.hypot(xx, xy) == pytest.approx(1.0) and xx * yx + xy * yy == pytest.approx(0.0, abs=1e-9)
    assert xx * yy - xy * yx == pytest.approx(1.0) and z == pytest.approx([0.0, 0.0], abs=1e-9)
    assert found["loaded"] == 0 and found["wide"] <= 0


def test_a_browser_that_cannot_draw_in_space_says_so_and_shows_the_rest(tmp_path: Path) -> None:
    simulate(bodies_in_space(), 0.1).animate(tmp_path / "x.html")
    found = probe(
        tmp_path / "x.html",
        """
    const told = document.getElementById("missing");
    found.told = told.textContent;
    found.height = told.getBoundingClientRect().height;
    window.tlismni.seek(0.05);
    window.tlismni.paint(0);
    found.cards = document.querySelectorAll(".card").length;
    """,
        flags=("--disable-gpu", "--disable-3d-apis"),
    )
    assert "WebGL" in found["told"] and ".gif" in found["told"] and found["height"] > 10.0
    assert found["cards"] > 0 and found["failures"] == []


def test_a_ball_at_the_end_of_an_arm_is_drawn_with_the_arm() -> None:
    """A bar goes from the body's middle to it, as to the joint at the other end."""
    scenario = load("arm_stop")
    scene = scene_of_start(scenario.model)
    number = [frame.name for frame in scene.frames].index("lower")
    tip = next(c.sphere.marker.point for c in scenario.model.contacts if c.name == "table")
    solids = [solid for solid in scene.solids if solid.frame == number]
    bars = [solid.at[0] for solid in solids if solid.size[2] == pytest.approx(tip[0])]
    assert sorted(bars) == pytest.approx([-0.5 * tip[0], 0.5 * tip[0]])
