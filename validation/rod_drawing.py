"""Elastic rods as lines that move: micrometres beside metres, so displacements and gaps are drawn magnified."""

import numpy as np

from ..core import Result
from ..core.contacts.coordinate_contact import CoordinateContact
from ..core.elements import AxialRod
from ..core.multibody_model import Model

VISIBLE = 0.08
"""The largest displacement as drawn, in parts of the shortest rod."""
HEIGHT = 0.02
"""Half the height of a rod as drawn, in parts of its length."""
Lines = list[tuple[str, np.ndarray]]


def rod_lines(model: Model, result: Result, keep: np.ndarray) -> tuple[Lines, float]:
    """(lines of the rods and of what they touch, each (frames, points, 2); how much they are magnified).

    Every node is drawn at its place at the start plus the magnified displacement; rods that follow one another are
    drawn apart by the magnified gap, so that they touch in the picture when they touch.
    """
    rods = [b for b in model.bodies if isinstance(b, AxialRod)]
    places = {r.name: _nodes(r, result, keep) for r in rods}
    largest = max((float(np.abs(x - x[0]).max()) for x in places.values()), default=0.0)
    shortest = min((r.length for r in rods), default=1.0)
    factor = max(1.0, float(f"{VISIBLE * shortest / largest:.1g}")) if largest > 0.0 else 1.0
    lines: Lines = []
    starts: dict[str, np.ndarray] = {}
    shift, end = 0.0, None
    for rod in sorted(rods, key=lambda r: float(places[r.name][0, 0])):
        x = places[rod.name]
        if end is not None:
            shift += (factor - 1.0) * (float(x[0].min()) - end)
        end = float(x[0].max())
        starts[rod.name] = x[0] + shift
        drawn = starts[rod.name] + factor * (x - x[0])
        outline = np.concatenate([drawn, drawn[:, ::-1], drawn[:, :1]], 1)
        y = np.full(outline.shape, HEIGHT * rod.length)
        y[:, drawn.shape[1] : -1] *= -1.0
        lines.append(("flexible", np.stack([outline, y], -1)))
    for contact in model.contacts:
        if isinstance(contact, CoordinateContact):
            lines += _touched(contact, rods, result, keep, starts, factor)
    return lines, factor


def _nodes(rod: AxialRod, result: Result, keep: np.ndarray) -> np.ndarray:
    """(frames, nodes), m."""
    return np.stack([np.asarray(result[f"{rod.name}.x{k}"])[keep] for k in range(rod.elements + 1)], 1)


def _touched(
    contact: CoordinateContact,
    rods: list[AxialRod],
    result: Result,
    keep: np.ndarray,
    starts: dict[str, np.ndarray],
    factor: float,
) -> Lines:
    """What a rod touches that is no rod: a wall, or a mass, where the rod's node would be if the gap were closed."""
    own = [t for t in contact.terms if t.body in starts and t.coordinate.startswith("x")]
    if len(own) != 1 or not own[0].factor:
        return []
    others = [t for t in contact.terms if t is not own[0]]
    face = np.full(len(keep), -contact.offset / own[0].factor)
    for term in others:
        face = face - term.factor / own[0].factor * np.asarray(result[f"{term.body}.{term.coordinate}"])[keep]
    node = int(own[0].coordinate[1:])
    first = float(np.asarray(result[f"{own[0].body}.x{node}"])[keep][0])
    x = starts[own[0].body][node] + factor * (face - first)
    length = next(r.length for r in rods if r.name == own[0].body)
    if others:
        return [("mass", np.stack([x, np.zeros(len(x))], -1)[:, None, :])]
    ends = [np.stack([x, np.full(len(x), side * 4.0 * HEIGHT * length)], -1) for side in (-1.0, 1.0)]
    return [("wall", np.stack(ends, 1))]
