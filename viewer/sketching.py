"""Sketches put into a scene."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from ..core.errors import ModelError
from .drawing.shapes import GROUND, INK, STEEL, Path
from .scene import Floats, Frame, Part
from .sketches import Sketch

if TYPE_CHECKING:
    from .bodies import Stage


def add_sketches(stage: "Stage", sketches: Sequence[Sketch]) -> None:
    """Sketches as frames with a shape; they stand in place of gauges.

    Raises
    ------
    ModelError : for a coordinate that the model does not have.
    """
    for sketch in sketches:
        columns = [
            start + _sum(stage, sketch, factors)
            for start, factors in zip(sketch.at, (sketch.x, sketch.y, sketch.angle), strict=True)
        ]
        number = stage.add_frame(Frame(sketch.name, np.stack(columns, axis=1)))
        stroke, fill = (GROUND, "#e5e7eb") if sketch.fixed else (INK, STEEL)
        shape = Path(tuple(sketch.outline), stroke, fill, 0.5, closed=True)
        stage.scene.parts.append(Part(number, 0 if sketch.fixed else 1, (shape,)))
    if sketches:
        stage.scene.gauges.clear()


def _sum(stage: "Stage", sketch: Sketch, factors: Mapping[str, float]) -> Floats:
    total = np.zeros(len(stage.motion.t))
    for name, factor in factors.items():
        body, _, coordinate = name.rpartition(".")
        if body not in stage.motion.bodies or coordinate not in stage.motion.bodies[body].coordinate_names:
            known = [f"{b}.{c}" for b, record in stage.motion.bodies.items() for c in record.coordinate_names]
            raise ModelError(f"sketch '{sketch.name}' moves with '{name}'; the coordinates are {known[:20]}")
        total = total + factor * stage.motion.coordinate(body, coordinate)
    return total
