"""A scene in space at one frame as a drawing: what films are made of. Triangles from the farthest to the nearest."""

import math
from collections.abc import Iterator

import numpy as np

from ..drawing import symbols
from ..drawing.shapes import Drawing, Path
from ..scene import Floats, Scene, Solid
from ..still import band_colour
from . import meshes
from .build import paper
from .colours import CABLE, JOINT, WIRE
from .gltf import COIL, DASHPOT, LINKS
from .meshes import Mesh
from .turning import matrices, towards

LIGHT = np.array([0.35, 0.85, 0.55])
"""From where light comes, along the scene's `eye`."""
DARKEST = 0.62
ARROW, LONGEST = 0.125, 2.2
COLOURS = {"contact": "#b3402a", "load": "#c96a00"}
Face = tuple[float, Floats, str, float]
"""Depth, corners (3, 2) on paper, colour, opacity."""


def still_in_space(scene: Scene, frame: int) -> Drawing:
    """The scene at frame number `frame`, with contact forces and loads."""
    drawing = Drawing(scene.size)
    faces = [face for solid in scene.solids for face in _solid(scene, solid, frame)]
    for link in scene.links:
        ends = [_point(scene, anchor.frame, anchor.point, frame) for anchor in (link.a, link.b)]
        faces += list(_link(scene, link.kind, *ends))
    for band in scene.bands:
        for k in range(band.points.shape[1] - 1):
            a, b = band.points[frame, k], band.points[frame, k + 1]
            r = 0.005 * band.width * scene.size
            colour = CABLE
            if band.fields:
                values = band.fields[0].values[frame] / band.fields[0].limit
                colour = band_colour(float(0.5 * (values[k] + values[k + 1])))
            faces += list(_stretched(scene, meshes.cylinder(), a, b, (r, r), colour, 0.5))
    for _, corners, colour, _ in sorted(faces, key=lambda face: -face[0]):
        points = [(float(x), float(y)) for x, y in corners]
        drawing.shapes.append(Path(points, None, colour, closed=True))
    for arrow in scene.arrows:
        usual = _usual(scene, arrow.kind) if arrow.kind in COLOURS else 0.0
        size = float(np.linalg.norm(arrow.vector[frame]))
        if usual > 0.0 and size > 1e-3 * usual:
            way = min(size / usual, LONGEST) * ARROW * scene.size * arrow.vector[frame] / size
            foot, tip = paper(scene) @ arrow.at[frame], paper(scene) @ (arrow.at[frame] + way)
            length = math.dist(foot, tip)
            if length > 1e-3 * scene.size:
                (x, y), (dx, dy) = tip.tolist(), ((tip - foot) / length).tolist()
                symbols.arrow(drawing, (x, y), (dx, dy), COLOURS[arrow.kind], length)
    return drawing


def _usual(scene: Scene, kind: str) -> float:
    """The usual size of arrows of a kind: short blows do not make all else invisible."""
    every = np.concatenate([np.linalg.norm(a.vector, axis=1) for a in scene.arrows if a.kind == kind])
    acting = every[every > 0.0]
    return float(np.quantile(acting, 0.95)) if len(acting) else 0.0


def _point(scene: Scene, number: int, point: tuple[float, ...], frame: int) -> Floats:
    row = scene.frames[number].motion[min(frame, len(scene.frames[number].motion) - 1)]
    found: Floats = row[:3] + matrices(row[3:]) @ np.array(point)
    return found


def _solid(scene: Scene, solid: Solid, frame: int) -> Iterator[Face]:
    motion = scene.frames[solid.frame].motion
    row = motion[min(frame, len(motion) - 1)]
    outer, inner = matrices(row[3:]), matrices(np.array(solid.turn))
    turn = outer @ inner
    place = row[:3] + outer @ np.array(solid.at)
    yield from _faces(scene, solid.mesh, place, turn, np.array(solid.size), solid.colour, solid.opacity)


def _link(scene: Scene, kind: str, a: Floats, b: Floats) -> Iterator[Face]:
    u = scene.size
    if kind in LINKS:
        yield from _stretched(scene, meshes.cylinder(), a, b, (LINKS[kind] * u,) * 2, JOINT, 0.5)
    if "spring" in kind:
        yield from _stretched(scene, meshes.coil(), a, b, (COIL * u,) * 2, WIRE, 0.0)
    if "damper" in kind:
        outer, inner = (r * u for r in DASHPOT)
        yield from _stretched(scene, meshes.cylinder(), a, b, (inner, inner), WIRE, 0.5)
        low, high = a + 0.3 * (b - a), a + 0.6 * (b - a)
        yield from _stretched(scene, meshes.cylinder(), low, high, (outer, outer), WIRE, 0.5)


def _stretched(
    scene: Scene, mesh: Mesh, a: Floats, b: Floats, radius: tuple[float, ...], colour: str, middle: float
) -> Iterator[Face]:
    """A mesh from a to b along its z axis; `middle`: where the mesh has its own."""
    way, turn = b - a, matrices(towards((b - a)[None])[0])
    size = np.array([radius[0], radius[1], float(np.linalg.norm(way))])
    yield from _faces(scene, mesh, a + middle * way, turn, size, colour, 1.0)


def _faces(
    scene: Scene, mesh: Mesh, place: Floats, turn: Floats, size: Floats, colour: str, opacity: float
) -> Iterator[Face]:
    """The triangles that are seen, flat and shaded. What shines through is left out but for its farther half."""
    eye = np.array(scene.eye)
    vertices = (place + (mesh.vertices * size) @ turn.T)[mesh.triangles]
    normals = (mesh.normals[mesh.triangles].mean(axis=1) / np.maximum(size, 1e-12)) @ turn.T
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-12)
    seen = normals @ eye.T  # along right, up, towards
    ahead = seen @ np.full(3, 1.0 / math.sqrt(3.0))
    light = np.clip(seen @ (LIGHT / np.linalg.norm(LIGHT)), -0.2, 1.0)
    shade = DARKEST + (1.0 - DARKEST) * (light + 0.2) / 1.2
    if mesh.shades is not None:
        shade = shade * mesh.shades[mesh.triangles].mean(axis=1)
    flat = vertices @ paper(scene).T
    depth = -vertices.mean(axis=1) @ (eye.T @ np.full(3, 1.0 / math.sqrt(3.0)))
    base = np.array([int(colour[k : k + 2], 16) for k in (1, 3, 5)], dtype=float)
    if opacity < 1.0:
        base = 255.0 - opacity * (255.0 - base)
        depth = depth + scene.size  # behind what it would hide
    for k in np.flatnonzero(ahead > 1e-9):
        r, g, b = np.clip(base * min(1.0, float(shade[k])), 0.0, 255.0).round().astype(int).tolist()
        yield float(depth[k]), flat[k], f"#{r:02x}{g:02x}{b:02x}", opacity
