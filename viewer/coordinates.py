"""Where in the plane a coordinate is."""

import numpy as np

from ..core.elements import AxialRod
from .bodies import Stage, has_place
from .scene import Floats


def coordinate_place(stage: Stage, body: str, coordinate: str) -> Floats | None:
    """Places (F, 2) of what a coordinate x, y, x3, y3 ... moves; None of one that has no place in the plane."""
    motion, record = stage.motion, stage.motion.bodies[body]
    names = record.coordinate_names
    if has_place(record):
        if coordinate == "angle" or coordinate.startswith("mode"):
            return None
        if names[:2] == ("x", "y"):
            return motion.frame(body)[:, :2]
        return stage.scene.frames[stage.number(body)].motion[:, :2]
    number = coordinate[1:]
    if coordinate[:1] not in ("x", "y") or not number.isdigit():
        return None
    zero = np.zeros(len(motion.t))
    x, y = (motion.coordinate(body, f"{c}{number}") if f"{c}{number}" in names else zero for c in "xy")
    if isinstance(record, AxialRod):
        x = stage.magnified.node(body, coordinate, x)
    return np.stack([x, y], axis=1)
