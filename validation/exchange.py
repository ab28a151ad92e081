"""Another model of the same thing, for what exudyn has no equal of: beams in a floating frame as ANCF cables."""

from typing import Any

import numpy as np

from ..core.elements import Cable2D, FloatingBeam2D, MaterialPoint2D
from ..core.multibody_model import Model
from .errors import NotTranslatable

STIFF_IN_LENGTH = 1e3
"""EA of a beam that does not stretch, in parts of EI/L^2 times 12: far above what bends it."""


def has_floating_beams(model: Model) -> bool:
    """Whether something in the model is a beam in a floating frame."""
    return any(isinstance(b, FloatingBeam2D) for b in model.bodies)


def as_cables(model: Model, elements: int = 8) -> Model:
    """`model` with every FloatingBeam2D as a Cable2D of the same section, mass and start, straight and unstressed.

    Markers on the beam's frame go to a new material point at its first end, `NAME_first_end` (of the frames with their
    origin there). Its damping becomes one in proportion to the stiffness, exact in the first mode. A beam without
    stretch gets an axial stiffness that hardly lets it stretch.

    Raises
    ------
    NotTranslatable : for a beam with the frame in its centre of mass.
    """
    beams = {b.name: b for b in model.bodies if isinstance(b, FloatingBeam2D)}
    frames = {name: f"{name}_first_end" for name in beams}
    bodies: list[Any] = []
    for body in model.bodies:
        if isinstance(body, FloatingBeam2D):
            bodies += [
                _cable(body, elements),
                MaterialPoint2D(name=frames[body.name], body=body.name, point=(0.0, 0.0)),
            ]
        else:
            bodies.append(body)
    plain = model.model_dump()
    update: dict[str, Any] = {"bodies": [b.model_dump() for b in bodies], "parameters": []}
    for field in ("joints", "forces", "contacts"):
        update[field] = _moved(plain[field], frames)
    return Model.model_validate({**plain, **update})


def _first_end(beam: str, name: str) -> MaterialPoint2D:
    return MaterialPoint2D(name=name, body=beam, point=(0.0, 0.0))


def _moved(value: Any, frames: dict[str, str]) -> Any:
    """Markers (records with body, point and angle) on a beam, put on its first end's point."""
    if isinstance(value, dict):
        found = {key: _moved(item, frames) for key, item in value.items()}
        if {"body", "point", "angle"} <= found.keys() and found["body"] in frames:
            found["body"] = frames[found["body"]]
        return found
    if isinstance(value, list | tuple):
        return [_moved(item, frames) for item in value]
    return value


def _cable(beam: FloatingBeam2D, elements: int) -> Cable2D:
    if beam.boundary_conditions == "free":
        raise NotTranslatable(
            f"'{beam.name}' has its frame in the mean axes of a free beam, which a cable has no point for: take "
            "boundary_conditions 'cantilever' or 'simply_supported' to compare it"
        )
    ratios = np.atleast_1d(np.asarray(beam.damping_ratio, dtype=float))
    time = 2.0 * float(ratios[0]) / float(beam.frequencies()[0])
    stiffness = beam.axial_stiffness or 12.0 * STIFF_IN_LENGTH * beam.bending_stiffness / beam.length**2
    return Cable2D(
        name=beam.name, elements=elements, length=beam.length, mass_per_length=beam.mass / beam.length,
        axial_stiffness=stiffness, bending_stiffness=beam.bending_stiffness, axial_damping=time * stiffness,
        bending_damping=time * beam.bending_stiffness, position=beam.position, angle=beam.angle,
        velocity=beam.velocity, angular_velocity=beam.angular_velocity,
    )  # fmt: skip
