"""From a model in space to a scene."""

from collections.abc import Mapping

import numpy as np

from ...core.contacts.contact3d import HalfSpace3D
from ...core.elements import BodyElement, Cable3D, LinearSystem, MaterialPoint3D, PlanarFrame, SpatialFrame
from ...core.elements.cable_shape import weights
from ...core.model.base import in_space
from ...core.model.markers import GROUND, Marker3D
from ...core.model.outputs import MarkerOutput3D
from ...core.multibody_model import Model
from ..drawing.shapes import PORT
from ..fields import loads
from ..motion import Motion
from ..scene import SPACE, Band, Field, Floats, Frame, Gauge, Scene
from ..tracks import Tracks
from . import meshes
from .fixtures import add_plane, add_planes, place
from .forces import add_forces
from .shapes import add_body, add_shapes, single_balls
from .stage import Stage3D, pose_of
from .turning import matrices

WAY = 0.4
"""Symbols are made for this part of the way that bodies go, where the mechanism is smaller."""
CABLE = 0.6
"""Half of a cable's width, in hundredths of the scene's size."""
BETWEEN = 4
"""Pieces that an element of a cable is drawn in."""
MOST_GAUGES = 4


def is_spatial(model: Model) -> bool:
    """Whether anything of a model is in space."""
    return any(isinstance(body, SpatialFrame | Cable3D) for body in model.bodies)


def spatial_scene(
    motion: Motion, title: str, tracks: Tracks | None, points: Mapping[str, Floats] | None = None
) -> Scene:
    """A scene in space. `points`: places (F, 3) of what is drawn besides, by names."""
    model = motion.model
    scene = Scene(model.name, title, motion.t, _size(motion), dimension=SPACE, eye=eye_of(model))
    stage = Stage3D(scene, motion)
    stage.add_frame(Frame(GROUND, pose_of(motion, GROUND)))
    for body in model.bodies:
        if isinstance(body, SpatialFrame | PlanarFrame):
            _add_frame(stage, body)
    for element in (*model.joints, *model.forces, *model.contacts):
        place(element, stage)
    for group in model.groups:
        for shape in group.all_shapes():
            if isinstance(shape, HalfSpace3D):
                add_plane(stage, shape.marker)
    stage.shaped |= _shaped(model)
    add_shapes(stage, GROUND)
    for body in model.bodies:
        if isinstance(body, SpatialFrame) and not isinstance(body, MaterialPoint3D):
            add_body(stage, body)
        elif isinstance(body, PlanarFrame):
            stage.solid(Marker3D(body=body.name), meshes.ball(), (0.02 * stage.size,) * 3)
        elif isinstance(body, Cable3D):
            scene.bands.append(Band(body.name, cable_points(motion, body), 2.0 * CABLE, cable_fields(motion, body)))
        elif isinstance(body, LinearSystem):
            units = {record.name: record.unit for record in body.coordinate_records()}
            names = body.coordinates[:MOST_GAUGES]
            scene.gauges += [Gauge(f"{body.name}.{n}", units[n], motion.coordinate(body.name, n)) for n in names]
    for output in model.outputs:
        if isinstance(output, MarkerOutput3D):
            _add_dot(stage, output.name, stage.at(output.marker))
    for name, places in (points or {}).items():
        _add_dot(stage, name, places)
    if tracks is not None:
        add_forces(stage, tracks.values_or_none, tracks.struck)
    add_planes(stage, every_place(scene))
    places = every_place(scene)
    ways = np.array([(x, y, z) for x in (-1, 0, 1) for y in (-1, 0, 1) for z in (-1, 0, 1) if (x, y, z) != (0, 0, 0)])
    scene.corners = places[np.unique(np.argmax(places @ ways.T, axis=0))]
    seen = places @ paper(scene).T
    (x0, y0), (x1, y1) = seen.min(axis=0).tolist(), seen.max(axis=0).tolist()
    scene.box = x0, y0, x1, y1
    return scene


def eye_of(model: Model) -> tuple[tuple[float, float, float], ...]:
    """Right, up and towards the reader: the axis that is most against gravity points up, z without gravity."""
    gravity = np.array(in_space(model.gravity))
    up = int(np.argmax(np.abs(gravity))) if np.any(gravity) else 2
    sign = -1.0 if gravity[up] > 0.0 else 1.0
    towards, right = (up + 1) % 3, (up + 2) % 3
    axes = np.zeros((3, 3))
    axes[1, up], axes[2, towards], axes[0, right] = sign, 1.0, sign
    right_axis, up_axis, towards_axis = ((float(x), float(y), float(z)) for x, y, z in axes)
    return right_axis, up_axis, towards_axis


def cable_points(motion: Motion, body: Cable3D, order: int = 0) -> Floats:
    """Places (F, P, 3) along a cable, or their derivatives of this order by its length."""
    q = motion.table(body.name)[0].reshape(len(motion.t), body.elements + 1, 2, 3)
    length, found = body.length / body.elements, []
    for e in range(body.elements):
        nodes = q[:, e : e + 2].reshape(len(q), 4, 3)
        for x in np.linspace(0.0, 1.0, BETWEEN, endpoint=False):
            found.append(np.einsum("i,fij->fj", weights(float(x), length, order), nodes))
    found.append(np.einsum("i,fij->fj", weights(1.0, length, order), q[:, -2:].reshape(len(q), 4, 3)))
    return np.stack(found, axis=1)


def cable_fields(motion: Motion, body: Cable3D) -> tuple[Field, ...]:
    """Axial force EA (|r'| - 1 - eps_0) and the size of the bending moment, EI |r' x r''|/|r'|^2, along a cable."""
    if not motion.moves:
        return ()
    slope, bend = cable_points(motion, body, 1), cable_points(motion, body, 2)
    stretch = np.linalg.norm(slope, axis=2)
    strain = stretch - 1.0 - body.reference_strain
    curvature = np.linalg.norm(np.cross(slope, bend), axis=2) / stretch**2
    return tuple(loads(body.axial_stiffness * strain, strain, body.bending_stiffness * curvature, curvature))


def _add_frame(stage: Stage3D, body: BodyElement) -> None:
    motion = stage.motion
    rates = motion.table(body.name)[1]
    velocity, label = None, None
    if not isinstance(body, MaterialPoint3D):
        velocity = rates[:, :3] if isinstance(body, SpatialFrame) else np.pad(rates[:, :2], ((0, 0), (0, 1)))
        label = (0.0, 0.0, 0.0)
    stage.add_frame(Frame(body.name, stage.pose(body.name), velocity if motion.moves else None, label))


def _add_dot(stage: Stage3D, name: str, places: Floats) -> None:
    motion = np.pad(places, ((0, 0), (0, 4)))
    motion[:, 3] = 1.0
    stage.add_frame(Frame(name, motion, None, (0.0, 0.0, 0.0)))
    stage.solid(Marker3D(body=name), meshes.ball(), (0.012 * stage.size,) * 3, PORT)


def _shaped(model: Model) -> set[str]:
    """Bodies whose joints say what they look like: wheels and balls that roll, gears."""
    found = set()
    for joint in model.joints:
        for name in ("wheel", "wheel_a", "wheel_b", "rack"):
            marker = getattr(joint, name, None)
            if isinstance(marker, Marker3D):
                found.add(marker.body)
        if type(joint).__name__.startswith("Rolling"):
            found.add(joint.markers()[1].body)
    return found


def _size(motion: Motion) -> float:
    """What symbols are drawn for, m: the mechanism's size at its start, or a part of the way that it goes."""
    model = motion.model
    stage = Stage3D(Scene(model.name, "", motion.t, 1.0), motion)
    shown = [body for body in model.bodies if isinstance(body, SpatialFrame | PlanarFrame)]
    starts = [stage.pose(body.name)[0, :3] for body in shown]
    starts += [stage.at(marker)[0] for element in model.elements() for marker in element.markers()]
    for ball in single_balls(model):
        middle = stage.at(ball.marker)[0]
        starts += [middle - ball.radius, middle + ball.radius]
    for group in model.groups:
        for shape in (*getattr(group, "boxes", ()), *getattr(group, "polyhedra", ()), *getattr(group, "capsules", ())):
            starts += [stage.at(corner.marker)[0] for corner in shape.corners()]
    for body in model.bodies:
        if isinstance(body, Cable3D):
            starts += list(cable_points(motion, body)[0])
    starts += [
        np.full(3, sign * joint.radius) for joint in model.joints for sign in (-1, 1) if hasattr(joint, "radius")
    ]
    cloud = np.array(starts) if starts else np.zeros((1, 3))
    ways = [stage.pose(body.name)[:, :3] for body in shown]
    way = float(np.linalg.norm(np.ptp(np.concatenate(ways), axis=0))) if ways else 0.0
    return max(float(np.linalg.norm(np.ptp(cloud, axis=0))), WAY * way) or 1.0


def every_place(scene: Scene) -> Floats:
    """Corners (N, 3) of the boxes around all solids, and cables, over all frames, m."""
    clouds = [band.points.reshape(-1, 3) for band in scene.bands]
    for solid in scene.solids:
        motion = scene.frames[solid.frame].motion
        vertices = solid.mesh.vertices
        lengths = np.ptp(vertices, axis=0)
        middle = vertices.min(axis=0) + 0.5 * lengths
        corners = np.array([(x, y, z) for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)])
        own = (middle + corners * lengths) * np.array(solid.size)
        inner = np.array(solid.at) + own @ matrices(np.array(solid.turn)).T
        clouds.append((motion[:, None, :3] + np.einsum("fij,cj->fci", matrices(motion[:, 3:]), inner)).reshape(-1, 3))
    every = np.concatenate(clouds) if clouds else np.zeros((1, 3))
    found: Floats = every[np.all(np.isfinite(every), axis=1)]
    return found


def paper(scene: Scene) -> Floats:
    """From places in space to those on paper (2, 3): seen from the side on which the three axes of `eye` come alike."""
    right, up, towards = np.array(scene.eye)
    x = (right - towards) / np.sqrt(2.0)
    y = (2.0 * up - right - towards) / np.sqrt(6.0)
    return np.stack([x, y])
