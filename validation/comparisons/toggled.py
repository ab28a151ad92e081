"""The impulse as exudyn's users get it: a constraint switched on at the touch, integrated at index 2.

exudyn has no impact law, but its index-2 trapezoidal rule takes an inconsistent velocity away in one step: with a
constraint G v = 0 along the contact's normal that is the plastic impact; its multiplier after one step of h is twice
the impulse over h. Newton's law multiplies it by 1 + e. What comes after is not compared: the multiplier rings on.
"""

from typing import Any

import numpy as np

from ...core import NewtonImpact, Result
from ...core.elements import PointMass2D, RigidBody2D
from ...core.multibody_model import Model
from ..exudyn_model import build_exudyn_model
from ..exudyn_run import ExudynSettings, solve
from ..translation.user_gaps import user_gap
from .common import Row, Task, Touch, contact_units

STEP = 1e-8
"""s: what forces and motion add in it does not count."""
TOLERANCE = 1e-5
TOUCHING = 1e-9
"""m: gap of a contact that is closed."""


def toggled_rows(task: Task, first: Touch, ours: Result) -> list[Row]:
    """The row of the first impact's impulse; none where the contact joins more than two bodies or others than rigid,
    nor where another contact touches too and takes its share."""
    contact = next(c for c in task.exudyn_model.contacts if c.name == first.contact)
    if not isinstance(contact.law, NewtonImpact) or first.start <= 0.0:
        return []
    before = int(np.searchsorted(ours.t, first.start))
    others = [c.name for c in task.exudyn_model.contacts if c is not contact]
    if any(ours[f"{name}.gap"][before] <= TOUCHING for name in others):
        return []
    struck = _at(task.exudyn_model, ours, before)
    if struck is None:
        return []
    impulse = plastic_impulse(struck, contact)
    if impulse is None:
        return []
    name = f"{first.contact}: momentum that exudyn's constraint takes when switched on (index 2), times 1 + e"
    theirs = (1.0 + contact.law.restitution) * impulse
    return [Row(name, contact_units(ours, first.contact).impulse, first.impulse, theirs, TOLERANCE, "relative")]


def plastic_impulse(model: Model, contact: Any) -> float | None:
    """Impulse (N s) that stops the approach of `contact` at the start of `model`; None for more than two nodes."""
    build = build_exudyn_model(model, sensors=False)
    gap = user_gap(contact, build)
    if len(gap.nodes) > 2:
        return None
    _, along, _ = gap.evaluate(gap.reference)
    half = len(gap.reference) if len(gap.nodes) == 1 else len(_reference(build, gap.nodes[0]))
    parts = [np.array([along[:half]])] + ([np.array([along[half:]])] if len(gap.nodes) == 2 else [])
    markers = [build.add("MarkerNodeCoordinates", nodeNumber=node) for node in gap.nodes]
    if len(markers) == 1:
        markers.insert(0, build.add("MarkerNodeCoordinates", nodeNumber=build.ground_node))
        parts.insert(0, np.zeros((1, 0)))
    else:
        parts[0] = -parts[0]  # exudyn takes the difference
    build.add(
        "ObjectConnectorCoordinateVector", markerNumbers=markers, scalingMarker0=parts[0], scalingMarker1=parts[1],
        offset=[0.0], velocityLevel=False,
    )  # fmt: skip
    build.mbs.Assemble()
    solve(build, STEP, STEP, ExudynSettings(integrator="trapezoidal"))
    return abs(float(build.mbs.systemData.GetAECoordinates()[-1])) * 0.5 * STEP


def _reference(build: Any, node: int) -> tuple[float, ...]:
    return next(items.reference for items in build.bodies.values() if node in items.all_nodes)


def _at(model: Model, ours: Result, k: int) -> Model | None:
    """The model without contacts, its bodies as they are in record `k`; None if there are others than rigid ones."""
    bodies = []
    for body in model.bodies:
        if type(body) not in (RigidBody2D, PointMass2D):
            return None
        place = {n: float(ours[f"{body.name}.{n}"][k]) for n in (*body.coordinate_names, "vx", "vy")}
        update: dict[str, Any] = {"position": (place["x"], place["y"]), "velocity": (place["vx"], place["vy"])}
        if isinstance(body, RigidBody2D):
            update |= {"angle": place["angle"], "angular_velocity": float(ours[f"{body.name}.angular_velocity"][k])}
        bodies.append(body.model_copy(update=update))
    return model.model_copy(update={"bodies": tuple(bodies), "contacts": (), "parameters": ()})
