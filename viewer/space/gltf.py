"""Scenes in space as glTF 2.0, one binary file (.glb): Khronos' specification, chapters 3 and 4.

Frames are nodes, solids their children, links nodes that are stretched, cables rows of links; their motion is one
animation with straight lines between frames. glTF's y axis is the scene's `eye[1]`, upwards. Times are single precision
there and must grow, so of the two frames of an impact the later one stays.
"""

import json
import struct
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ...core.model.attitude import parameters_of_matrix
from . import meshes
from .colours import CABLE, JOINT, WIRE
from .meshes import Mesh
from .turning import Floats, matrices, nearest, towards

if TYPE_CHECKING:
    from ..scene import Scene

FLOAT, BYTE, INDEX = 5126, 5121, 5125
VERTICES, INDICES = 34962, 34963
LINKS = {"rod": 0.010, "rope": 0.005}
"""Radii of links, in parts of the scene's size."""
COIL, DASHPOT = 0.024, (0.022, 0.008)


class Writer:
    """Nodes, meshes and numbers of a file that is being set up."""

    def __init__(self, scene: "Scene") -> None:
        self.scene = scene
        self.data = bytearray()
        self.file: dict[str, Any] = {
            "asset": {"version": "2.0", "generator": "tlismni"},
            "scene": 0,
            "scenes": [{"nodes": [0]}],
            "nodes": [{"name": scene.name, "rotation": _xyzw(_upright(scene)), "children": []}],
        }
        self._meshes: dict[Any, int] = {}
        self._surfaces: dict[int, tuple[dict[str, int], int]] = {}
        self._colours: dict[Any, int] = {}
        times = scene.t.astype(np.float32)
        later = np.append(np.diff(times) > 0.0, True)
        self.rows = np.flatnonzero(later)
        self.moves = len(self.rows) > 1
        self._clock = self.numbers((times[self.rows] - times[0]), "SCALAR", limits=True) if self.moves else -1

    def add(self, key: str, entry: dict[str, Any]) -> int:
        """Put an entry into one of the file's lists; gives its number."""
        entries = self.file.setdefault(key, [])
        entries.append(entry)
        return len(entries) - 1

    def numbers(
        self, values: Any, kind: str, component: int = FLOAT, target: int | None = None, limits: bool = False
    ) -> int:
        """An array in the buffer; gives the number of its accessor."""
        dtype = {FLOAT: "<f4", BYTE: "u1", INDEX: "<u4"}[component]
        array = np.ascontiguousarray(values, dtype=dtype)
        view: dict[str, Any] = {"buffer": 0, "byteOffset": len(self.data), "byteLength": array.nbytes}
        if target is not None:
            view["target"] = target
        self.data += array.tobytes()
        self.data += b"\0" * (-len(self.data) % 4)
        entry: dict[str, Any] = {
            "bufferView": self.add("bufferViews", view), "componentType": component, "count": len(array), "type": kind,
        }  # fmt: skip
        if component == BYTE:
            entry["normalized"] = True
        if limits:
            flat = array.reshape(len(array), -1)
            entry["min"], entry["max"] = flat.min(axis=0).tolist(), flat.max(axis=0).tolist()
        return self.add("accessors", entry)

    def surface(self, mesh: Mesh) -> tuple[dict[str, int], int]:
        """Attributes and indices of a mesh, once."""
        if id(mesh) not in self._surfaces:
            attributes = {
                "POSITION": self.numbers(mesh.vertices, "VEC3", target=VERTICES, limits=True),
                "NORMAL": self.numbers(mesh.normals, "VEC3", target=VERTICES),
            }
            if mesh.shades is not None:
                colours = np.full((len(mesh.vertices), 4), 255.0)
                colours[:, :3] *= mesh.shades[:, None]
                attributes["COLOR_0"] = self.numbers(colours.round(), "VEC4", BYTE, VERTICES)
            indices = self.numbers(mesh.triangles.ravel(), "SCALAR", INDEX, INDICES)
            self._surfaces[id(mesh)] = attributes, indices
        return self._surfaces[id(mesh)]

    def mesh(self, mesh: Mesh, colour: str, opacity: float = 1.0) -> int:
        """A mesh in a colour, once."""
        key = id(mesh), colour, opacity
        if key not in self._meshes:
            attributes, indices = self.surface(mesh)
            primitive = {"attributes": attributes, "indices": indices, "material": self.material(colour, opacity)}
            self._meshes[key] = self.add("meshes", {"primitives": [primitive]})
        return self._meshes[key]

    def material(self, colour: str, opacity: float) -> int:
        """A material, once."""
        if (colour, opacity) not in self._colours:
            srgb = np.array([int(colour[k : k + 2], 16) for k in (1, 3, 5)]) / 255.0
            linear = np.where(srgb <= 0.04045, srgb / 12.92, ((srgb + 0.055) / 1.055) ** 2.4)
            shiny = {"baseColorFactor": [*linear.tolist(), opacity], "metallicFactor": 0.0, "roughnessFactor": 0.75}
            entry: dict[str, Any] = {"pbrMetallicRoughness": shiny}
            if opacity < 1.0:
                entry |= {"alphaMode": "BLEND", "doubleSided": True}
            self._colours[colour, opacity] = self.add("materials", entry)
        return self._colours[colour, opacity]

    def node(self, parent: int, **entry: Any) -> int:
        """A node below another one."""
        number = self.add("nodes", entry)
        self.file["nodes"][parent].setdefault("children", []).append(number)
        return number

    def move(self, node: int, place: Floats, turn: Floats, stretch: Floats | None = None) -> None:
        """Let a node move: places (F, 3), unit quaternions (F, 4) and scales (F, 3); one row stands still."""
        for path, values in (("translation", place), ("rotation", turn), ("scale", stretch)):
            if values is None:
                continue
            shown = np.roll(values, -1, axis=1) if path == "rotation" else values
            entry, resting = self.file["nodes"][node], np.ptp(shown, axis=0).max() == 0.0
            if len(shown) == 1 or resting or not self.moves:
                entry[path] = shown[-1].tolist()
                continue
            entry[path] = shown[0].tolist()
            kind = "VEC4" if path == "rotation" else "VEC3"
            output = self.numbers(shown[self.rows], kind)
            motion = self.file.setdefault("animations", [{"name": "run", "channels": [], "samplers": []}])[0]
            motion["samplers"].append({"input": self._clock, "output": output, "interpolation": "LINEAR"})
            target = {"node": node, "path": path}
            motion["channels"].append({"sampler": len(motion["samplers"]) - 1, "target": target})

    def bytes(self) -> bytes:
        """The file."""
        if self.data:
            self.file["buffers"] = [{"byteLength": len(self.data)}]
        text = json.dumps(self.file, separators=(",", ":"), allow_nan=False).encode()
        text += b" " * (-len(text) % 4)
        binary = bytes(self.data)
        chunks = struct.pack("<II", len(text), 0x4E4F534A) + text
        if binary:
            chunks += struct.pack("<II", len(binary), 0x004E4942) + binary
        return struct.pack("<III", 0x46546C67, 2, 12 + len(chunks)) + chunks


def to_glb(scene: "Scene", bands: bool = True) -> bytes:
    """The file as bytes; `bands`: with cables (a player that draws them itself needs none)."""
    out = Writer(scene)
    numbers = []
    for frame in scene.frames:
        numbers.append(out.node(0, name=frame.name))
        out.move(numbers[-1], frame.motion[:, :3], frame.motion[:, 3:])
    for solid in scene.solids:
        out.node(
            numbers[solid.frame], mesh=out.mesh(solid.mesh, solid.colour, solid.opacity), translation=list(solid.at),
            rotation=_xyzw(solid.turn), scale=list(solid.size),
        )  # fmt: skip
    for link in scene.links:
        a, b = (_places(scene, anchor.frame, anchor.point) for anchor in (link.a, link.b))
        stretched(out, link.name, a, b, link.kind)
    if bands:
        for band in scene.bands:
            for k in range(band.points.shape[1] - 1):
                ends = band.points[:, k], band.points[:, k + 1]
                stretched(out, f"{band.name} {k}", *ends, "band", 0.005 * band.width)
    return out.bytes()


def stretched(out: Writer, name: str, a: Floats, b: Floats, kind: str, radius: float = 0.0) -> None:
    """A node at `a` whose z axis goes to `b`, and what is drawn along it."""
    size, way = out.scene.size, b - a
    length = np.linalg.norm(way, axis=1)
    one = np.ones_like(length)
    node = out.node(0, name=name)
    out.move(node, a, nearest(towards(way)), np.stack([one, one, np.maximum(length, 1e-6 * size)], axis=1))

    def part(mesh: Mesh, r: float, colour: str, low: float = 0.0, high: float = 1.0, aside: float = 0.0) -> None:
        middle = 0.5 * (low + high) if mesh is not meshes.coil() else low
        out.node(
            node, mesh=out.mesh(mesh, colour), translation=[aside * size, 0.0, middle],
            scale=[r * size, r * size, high - low],
        )  # fmt: skip

    if kind in LINKS or kind == "band":
        colour = CABLE if kind == "band" else JOINT
        part(meshes.cylinder(), radius or LINKS[kind], colour)
    if "spring" in kind:
        part(meshes.coil(), COIL, WIRE)
    if "damper" in kind:
        aside = 2.4 * COIL if "spring" in kind else 0.0
        outer, inner = DASHPOT
        part(meshes.cylinder(), inner, WIRE, 0.0, 1.0, aside)
        part(meshes.cylinder(), outer, WIRE, 0.3, 0.6, aside)


def write_glb(scene: "Scene", path: Path) -> None:
    """Write a scene in space as a file."""
    path.write_bytes(to_glb(scene))


def _places(scene: "Scene", frame: int, point: tuple[float, ...]) -> Floats:
    motion = scene.frames[frame].motion
    found = motion[:, :3] + matrices(motion[:, 3:]) @ np.array(point)
    return np.broadcast_to(found, (len(scene.t), 3)).copy()


def _upright(scene: "Scene") -> tuple[float, float, float, float]:
    """Euler parameters of the turn that brings the scene's axes `eye` to x, y and z."""
    return parameters_of_matrix(np.array(scene.eye))


def _xyzw(p: tuple[float, float, float, float]) -> list[float]:
    e0, e1, e2, e3 = p
    return [float(e1), float(e2), float(e3), float(e0)]
