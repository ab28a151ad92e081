"""From a model and a result to a scene."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from ..core.elements import Cable3D, FlexibleBody, PlanarFrame
from ..core.errors import ModelError
from ..core.model.markers import GROUND
from ..core.multibody_model import Model
from . import mechanical  # noqa: F401  (importing it teaches `place` its elements)
from .bodies import Stage, add_bodies, add_dot, add_output
from .drawing.shapes import Circle, Point
from .fields import NO_SECTIONS, CrossSection
from .fixtures import add_fixtures
from .forces import add_forces
from .motion import Motion
from .scene import Floats, Frame, Part, Scene
from .sketches import Sketch
from .sketching import add_sketches
from .space.build import is_spatial, spatial_scene
from .timing import EVEN, MOST_SAMPLES, choose_frames
from .tracks import Tracks

if TYPE_CHECKING:
    from ..core.results.result import Result

MOST_EVENTS = 2000
MOST_NUMBERS = 2_000_000
"""Of bodies' places in one page: 10 MB."""
LEAST = 60
"""Frames, however large the model is."""
WAY = 0.4
"""Symbols are made for this part of the way that bodies go, where the mechanism is smaller."""
Outlines = Mapping[str, Sequence[Point]]


def scene_of_start(
    model: Model, title: str = "", outlines: Outlines | None = None, sketches: Sequence[Sketch] = ()
) -> Scene:
    """The start of `model` as a scene of one frame.

    Raises
    ------
    ModelError : for an outline of a body that the model does not have.
    """
    motion, title = Motion.at_start(model), title or f"{model.name}, as it starts"
    if is_spatial(model):
        _no_plane(outlines, None, sketches)
        return spatial_scene(motion, title, None)
    return _build(motion, title, None, outlines or {}, sketches=sketches)


def _no_plane(outlines: Outlines | None, sections: object, sketches: Sequence[Sketch]) -> None:
    """Refuse what only pictures of the plane have."""
    for what, given in (("outlines", outlines), ("sections", sections), ("sketches", sketches)):
        if given:
            raise ModelError(
                f"{what} are for models of the plane; in space bodies look like the shapes of their contacts: "
                f"leave {what} out, or give the body a Box3D, Sphere3D, Capsule3D or ConvexPolyhedron3D to touch with"
            )


def scene_of_result(
    model: Model,
    result: "Result",
    title: str = "",
    channels: Iterable[str] | None = None,
    outlines: Outlines | None = None,
    sections: Mapping[str, CrossSection] | None = None,
    sketches: Sequence[Sketch] = (),
    points: Mapping[str, tuple[str, ...]] | None = None,
    frames: int = EVEN,
) -> Scene:
    """A run as a scene.

    Parameters
    ----------
    channels : names of the channels to plot at first; left out: the last body's motion and forces of contacts.
    outlines : polygons in the frames of bodies, m, in place of the shapes that are made up.
    sections : cross-sections of flexible bodies, which are then coloured by their stress.
    sketches : polygons that move with generalised coordinates.
    points : channels that are the x and y (in space: x, y and z) of points to draw besides, by the points' names.
    frames : how many at equal intervals, besides those of the solver's steps.

    Raises
    ------
    ModelError : for an outline of a body that the model does not have, or a result without samples.
    KeyError : for a channel that the result does not have.
    """
    if len(result.t) == 0:
        raise ModelError("the result has no samples: record some (record=True, or t_eval) to see them")
    frames, most = affordable(model, frames)
    among = choose_frames(result.t, (event.t for event in result.events), frames, most)
    tracks = Tracks(result, model, among)
    motion = Motion.of_result(model, result, among)
    if is_spatial(model):
        _no_plane(outlines, sections, sketches)
        dots = {name: np.stack([tracks.values(c) for c in places], axis=1) for name, places in (points or {}).items()}
        scene = spatial_scene(motion, title or model.name, tracks, dots)
    else:
        dots_2d = points_of(tracks, points or {})
        scene = _build(motion, title or model.name, tracks, outlines or {}, sections or {}, sketches, dots_2d)
    wanted = tuple(channels) if channels is not None else tracks.interesting()
    for name in wanted:
        tracks.values(name)  # an unknown one is refused
    scene.plots = list(wanted)
    scene.tracks = tracks.chosen(wanted)
    units = {channel.name: channel.unit for channel in result.channel_records}
    scene.events = [
        event.to_dict() | {"impulse_unit": units.get(f"{event.contact}.impulse", "N.s")}
        for event in result.events[:MOST_EVENTS]
    ]
    if len(result.events) > MOST_EVENTS:
        scene.notes.append(f"The first {MOST_EVENTS} of {len(result.events)} events are marked.")
    return scene


def _build(
    motion: Motion,
    title: str,
    tracks: Tracks | None,
    outlines: Outlines,
    sections: Mapping[str, CrossSection] = NO_SECTIONS,
    sketches: Sequence[Sketch] = (),
    points: Sequence[Frame] = (),
) -> Scene:
    flexible = [name for name, body in motion.bodies.items() if isinstance(body, FlexibleBody)]
    for what, given, known in (("outlines", outlines, list(motion.bodies)), ("sections", sections, flexible)):
        unknown = sorted(set(given) - set(known))
        if unknown:
            whose = "bodies" if what == "outlines" else "flexible bodies"
            raise ModelError(f"{what} are given for {unknown}, but the {whose} are {sorted(known)}")
    scene = Scene(motion.model.name, title, motion.t, _size(motion, sketches, points))
    stage = Stage(scene, motion)
    if stage.magnified.note:
        scene.notes.append(stage.magnified.note)
    stage.add_frame(Frame(GROUND, np.zeros((1, 3))))
    add_bodies(stage, outlines, sections)
    add_sketches(stage, sketches)
    add_fixtures(stage)
    for output in motion.model.outputs:
        add_output(stage, output)
    for point in points:
        add_dot(stage, replace(point, label=(0.012 * stage.size, 0.0)))
    if tracks is not None:
        add_forces(stage, tracks.values_or_none, tracks.struck)
    scene.box = box_of(scene)
    return scene


def points_of(tracks: Tracks, points: Mapping[str, tuple[str, ...]]) -> list[Frame]:
    """Points whose x and y are channels, as frames; with velocities where their rates are channels too."""
    found = []
    for name, places in points.items():
        if len(places) != 2:
            raise ModelError(f"point '{name}' has {len(places)} channels: a point of the plane has two, its x and y")
        x, y = places
        path = np.stack([tracks.values(x), tracks.values(y)], axis=1)
        rates = [rate for rate in (tracks.rate(x), tracks.rate(y)) if rate is not None]
        velocity = np.stack(rates, axis=1) if len(rates) == 2 else np.zeros_like(path)
        found.append(Frame(name, np.hstack([path, np.zeros((len(path), 1))]), velocity))
    return found


def affordable(model: Model, frames: int) -> tuple[int, int]:
    """Even frames, and samples that become frames, of a model: less than wanted where it is so large that the page
    would be."""
    width = 5 * len(model.bodies) + 200 * sum(isinstance(body, FlexibleBody | Cable3D) for body in model.bodies)
    part = min(1.0, MOST_NUMBERS / (max(width, 1) * (frames + MOST_SAMPLES)))
    return max(LEAST, round(part * frames)) if part < 1.0 else frames, max(LEAST, round(part * MOST_SAMPLES))


def _size(motion: Motion, sketches: Sequence[Sketch], points: Sequence[Frame]) -> float:
    """What symbols are drawn for, m: the mechanism's size at its start, or a part of the way that it goes."""
    shown = [body for body in motion.model.bodies if isinstance(body, PlanarFrame)]
    ways = [motion.frame(body.name)[:, :2] for body in shown]
    drawn = [np.array(sketch.outline) + np.array(sketch.at[:2]) for sketch in sketches]
    drawn += [point.motion[:, :2] for point in points]
    if not ways:
        return (_diagonal(drawn) if drawn else 0.0) or motion.places.size
    attached = {marker.point for element in motion.model.elements() for marker in element.markers()}
    if (
        motion.places.size == 1.0 and len(attached) < 2
    ):  # a model that is one point has no size: its way from the origin
        return _diagonal([*ways, np.zeros((1, 2))]) or 1.0
    return max(motion.places.size, WAY * _diagonal(ways))


def _diagonal(clouds: list[Floats]) -> float:
    every = np.concatenate(clouds)
    return float(np.linalg.norm(every.max(axis=0) - every.min(axis=0)))


def box_of(scene: Scene) -> tuple[float, float, float, float]:
    """Left, bottom, right and top of all shapes over all frames, m."""
    clouds = [band.points.reshape(-1, 2) for band in scene.bands]
    for part in scene.parts:
        motion = scene.frames[part.frame].motion
        c, s = np.cos(motion[:, 2]), np.sin(motion[:, 2])
        for x, y in _corners(part):
            clouds.append(np.stack([motion[:, 0] + c * x - s * y, motion[:, 1] + s * x + c * y], axis=1))
    clouds += [frame.motion[:, :2] for frame in scene.frames if frame.velocity is not None]
    every = np.concatenate(clouds) if clouds else np.zeros((1, 2))
    every = every[np.all(np.isfinite(every), axis=1)]
    (x0, y0), (x1, y1) = every.min(axis=0), every.max(axis=0)
    return float(x0), float(y0), float(x1), float(y1)


def _corners(part: Part) -> list[Point]:
    found: list[Point] = []
    for shape in part.shapes:
        if isinstance(shape, Circle):
            (x, y), r = shape.centre, shape.radius
            found += [(x - r, y - r), (x + r, y - r), (x + r, y + r), (x - r, y + r)]
        else:
            found += shape.points
    return list(dict.fromkeys((float(x), float(y)) for x, y in found))
