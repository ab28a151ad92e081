"""The mechanism as lines that move: what a report draws and animates."""

import math
from typing import Any

import numpy as np

from ..core import Result
from ..core.contacts.contact2d import DiskOnHalfPlane2D
from ..core.elements import AxialRod, Cable2D, FlexibleBody, LinearSystem, MaterialPoint2D, SpatialFrame
from ..core.model.marker_channels3d import points_in_space
from ..core.model.markers import GROUND, Marker2D
from ..core.multibody_model import Model
from ..viewer.drawing.view import View, star
from .rod_drawing import rod_lines

MOST_FRAMES = 240
CIRCLE = np.linspace(0.0, 2.0 * math.pi, 25)
DIGITS = 5


def drawing(model: Model, result: Result) -> dict[str, Any] | None:
    """Lines over time as plain data: {"t": [...], "lines": [{"kind", "x": [[...] per frame], "y": ...}], "box": [...]}.

    Bodies in space are seen from a corner. None for a model without places.
    """
    keep = np.unique(np.linspace(0, len(result.t) - 1, min(MOST_FRAMES, len(result.t))).astype(int))
    lines: list[tuple[str, np.ndarray]] = []
    for body in model.bodies:
        lines += _body(body, model, result, keep)
    rods, factor = rod_lines(model, result, keep)
    lines += rods
    for contact in model.contacts:
        lines += [("disk", _circle(d.marker, d.radius, result, keep)) for d in contact.disks() if d.radius > 0.0]
    moving = [line for kind, line in lines]
    if not moving:
        return None
    every = np.concatenate([line.reshape(-1, 2) for line in moving])
    low, high = every.min(axis=0), every.max(axis=0)
    margin = 0.08 * float(max(*(high - low), 1e-9))
    low, high = low - margin, high + margin
    size = float(max(high - low))
    for contact in model.contacts:
        if isinstance(contact, DiskOnHalfPlane2D):
            lines.append(("wall", _half_plane(contact.plane.marker, size, result, keep)))
    return {
        "t": [round(float(t), 7) for t in result.t[keep]],
        "note": f"Displacements along the rods are drawn {factor:g} times as large." if factor > 1.0 else "",
        "box": [*low.tolist(), *high.tolist()],
        "lines": [
            {"kind": kind, "x": _rounded(line[..., 0], size), "y": _rounded(line[..., 1], size)} for kind, line in lines
        ],
    }


def _rounded(values: np.ndarray, size: float) -> list[list[float]]:
    digits = DIGITS - math.floor(math.log10(size)) - 1
    found: list[list[float]] = np.round(values, digits).tolist()
    return found


def _body(body: Any, model: Model, result: Result, keep: np.ndarray) -> list[tuple[str, np.ndarray]]:
    """The lines of one body, each (frames, points, 2)."""

    def track(name: str) -> np.ndarray:
        return np.asarray(result[f"{body.name}.{name}"])[keep]

    if isinstance(body, Cable2D):
        nodes = range(body.elements + 1)
        return [("flexible", np.stack([np.stack([track(f"x{k}"), track(f"y{k}")], -1) for k in nodes], 1))]
    if isinstance(body, LinearSystem | MaterialPoint2D | AxialRod):
        return []
    if isinstance(body, FlexibleBody):
        return _points_of(body, model, result, keep)
    if isinstance(body, SpatialFrame):
        q = np.stack([track(name) for name in body.coordinate_names], axis=1)
        return [("body", View(model)(points_in_space(q, star(model, body).tolist())))]
    local = [(0.0, 0.0), *_markers_on(body.name, model)]
    if len(local) == 1 or "angle" not in body.coordinate_names:
        return [("mass", _place(Marker2D(body=body.name), result, keep)[:, None, :])]
    # from the first marker over the centre of mass to the others
    chain = [local[1], local[0], *local[2:]]
    return [("body", np.stack([_place(Marker2D(body=body.name, point=p), result, keep) for p in chain], 1))]


def _points_of(body: Any, model: Model, result: Result, keep: np.ndarray) -> list[tuple[str, np.ndarray]]:
    """A body in a floating frame by its frame's origin and its material points."""
    points = sorted(
        (b for b in model.bodies if isinstance(b, MaterialPoint2D) and b.body == body.name), key=lambda b: b.point
    )
    names = [body.name, *(p.name for p in points)]
    return [("flexible", np.stack([_place(Marker2D(body=n), result, keep) for n in names], 1))]


def _markers_on(body: str, model: Model) -> list[tuple[float, float]]:
    found: list[tuple[float, float]] = []
    for element in model.elements():
        for marker in element.markers():
            if marker.body == body and isinstance(marker, Marker2D) and marker.point not in [(0.0, 0.0), *found]:
                found.append(marker.point)
    return found


def _place(marker: Marker2D, result: Result, keep: np.ndarray) -> np.ndarray:
    """(frames, 2)."""
    u, w = marker.point
    if marker.body == GROUND:
        return np.tile([u, w], (len(keep), 1))
    x, y = (np.asarray(result[f"{marker.body}.{name}"])[keep] for name in "xy")
    angle = f"{marker.body}.angle"
    turn = np.asarray(result[angle])[keep] if angle in result.channels else np.zeros(len(keep))
    c, s = np.cos(turn), np.sin(turn)
    return np.stack([x + c * u - s * w, y + s * u + c * w], -1)


def _circle(marker: Marker2D, radius: float, result: Result, keep: np.ndarray) -> np.ndarray:
    rim = radius * np.stack([np.cos(CIRCLE), np.sin(CIRCLE)], -1)
    return np.asarray(_place(marker, result, keep)[:, None, :] + rim)


def _half_plane(marker: Marker2D, size: float, result: Result, keep: np.ndarray) -> np.ndarray:
    c, s = math.cos(marker.angle), math.sin(marker.angle)
    ends = [
        marker.model_copy(update={"point": (marker.point[0] + k * size * c, marker.point[1] + k * size * s)})
        for k in (-1.0, 1.0)
    ]
    return np.stack([_place(end, result, keep) for end in ends], 1)
