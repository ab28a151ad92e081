"""The scene: everything that a player needs, as data. F frames; lengths in m, angles in rad, times in s.

In the plane places have two numbers and a frame's motion three (x, y, angle). In space they have three, and a motion
seven (place, then Euler parameters); `dimension` D says which. Solids stand on frames only in space, parts only in the
plane.
"""

import base64
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .drawing.shapes import STEEL, Circle, Path
from .packing import plain
from .space.gltf import to_glb
from .space.meshes import Mesh

FORMAT = "tlismni-scene-1"
GROUND_FRAME = 0
SPACE = 3
Floats = NDArray[np.float64]
Shape = Path | Circle


@dataclass(frozen=True)
class Frame:
    """Something that moves like a rigid body; the ground is the first of a scene."""

    name: str
    motion: Floats
    """(F, 3): x, y, angle, or (F, 7) in space; one row of what stands still."""
    velocity: Floats | None = None
    """(F, D) of its origin, m/s; None: no arrow."""
    label: tuple[float, ...] | None = None
    """Where its name stands, in the frame; None: no name."""


@dataclass(frozen=True)
class Part:
    """Shapes on a frame. `layer`: 0 behind everything, 1 bodies, 2 joints and what lies on them."""

    frame: int
    layer: int
    shapes: tuple[Shape, ...]


@dataclass(frozen=True, eq=False)
class Solid:
    """A surface on a frame, in space."""

    frame: int
    mesh: Mesh
    at: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """m, in the frame."""
    turn: tuple[float, float, float, float] = (1.0, 0.0, 0.0, 0.0)
    """Euler parameters in the frame."""
    size: tuple[float, float, float] = (1.0, 1.0, 1.0)
    """By which the mesh is stretched along its own axes, m."""
    colour: str = STEEL
    opacity: float = 1.0


@dataclass(frozen=True)
class Anchor:
    """A point of a frame."""

    frame: int
    point: tuple[float, ...]


@dataclass(frozen=True)
class Link:
    """What stretches between two points: kind "spring", "damper", "spring-damper", "rod" or "rope"."""

    name: str
    kind: str
    a: Anchor
    b: Anchor


@dataclass(frozen=True)
class Line:
    """A line through points of frames, rounded at its vertices (`Line2D`)."""

    name: str
    nodes: tuple[Anchor, ...]
    thickness: float
    rounding: float
    closed: bool


@dataclass(frozen=True)
class Field:
    """A quantity along a flexible body."""

    name: str
    unit: str
    values: Floats
    """(F, P)."""
    limit: float
    """Largest magnitude, which the colours reach to."""


@dataclass(frozen=True)
class Band:
    """A flexible body as a line through P of its points."""

    name: str
    points: Floats
    """(F, P, D)."""
    width: float
    """In hundredths of the scene's size."""
    fields: tuple[Field, ...] = ()


@dataclass(frozen=True)
class Arrow:
    """A vector at a place: kind "contact", "joint" or "load"; zero where nothing acts."""

    name: str
    kind: str
    unit: str
    at: Floats
    """(F, D)."""
    vector: Floats
    """(F, D)."""


@dataclass(frozen=True)
class Track:
    """A channel over the frames."""

    name: str
    unit: str
    description: str
    values: Floats
    """(F,)."""
    steps: bool = False
    """Whether it keeps each value until the next one (modes, switches)."""


@dataclass(frozen=True)
class Gauge:
    """A coordinate that has no place in the plane, shown by a pointer."""

    name: str
    unit: str
    values: Floats
    """(F,)."""


@dataclass
class Scene:
    """A model over time, or at one time."""

    name: str
    title: str
    t: Floats = field(metadata={"double": True})
    """(F,), s; twice where something jumps."""
    size: float
    """Of the mechanism, m: what symbols are drawn for."""
    frames: list[Frame] = field(default_factory=list)
    parts: list[Part] = field(default_factory=list)
    solids: list[Solid] = field(default_factory=list)
    links: list[Link] = field(default_factory=list)
    lines: list[Line] = field(default_factory=list)
    bands: list[Band] = field(default_factory=list)
    arrows: list[Arrow] = field(default_factory=list)
    gauges: list[Gauge] = field(default_factory=list)
    tracks: list[Track] = field(default_factory=list)
    plots: list[str] = field(default_factory=list)
    """Names of the channels plotted at first."""
    events: list[dict[str, Any]] = field(default_factory=list)
    box: tuple[float, float, float, float] = (0.0, 0.0, 1.0, 1.0)
    """Left, bottom, right, top of everything over all frames, m; in space of what is seen from `eye`."""
    notes: list[str] = field(default_factory=list)
    """What a reader must know of the picture, such as magnified displacements."""
    dimension: int = 2
    eye: tuple[tuple[float, float, float], ...] = ()
    """In space: the axes of the picture, to the right, upwards and towards the reader (of glTF: X, Y, Z), at first."""
    corners: Floats = field(default_factory=lambda: np.zeros((0, 3)))
    """In space: the outermost places (K, 3) over all frames, m; what a picture from any side must hold."""
    format: str = FORMAT

    def to_data(self) -> dict[str, Any]:
        """The scene as JSON data (`tlismni-scene-1`); solids stand in it as glTF (.glb, as base64 text)."""
        data: dict[str, Any] = plain(replace(self, solids=[]))
        if self.dimension == SPACE:
            data["solids"] = base64.b64encode(to_glb(self, bands=False)).decode("ascii")
        for part, record in zip(data["parts"], self.parts, strict=True):
            for shape, given in zip(part["shapes"], record.shapes, strict=True):
                shape["kind"] = type(given).__name__.lower()
        return data
