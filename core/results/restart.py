"""A model that starts where a run was."""

from collections.abc import Mapping
from functools import singledispatch
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ..assembly.numbering import ModelNumbering
from ..elements import (
    AxialRod,
    BodyElement,
    Cable2D,
    Cable3D,
    Element,
    FloatingBody2D,
    InterfaceFrame3D,
    LinearSystem,
    MaterialPoint2D,
    MaterialPoint3D,
    MovingFrame2D,
    PointMass2D,
    PointMass3D,
    ReducedBody3D,
    RigidBody2D,
    RigidBody3D,
)
from ..elements.turn3d import account_of
from ..errors import ModelError
from ..model.attitude import UPRIGHT, EulerParameters
from ..model.said_angle import CountsTurns
from ..model.words import an
from ..multibody_model import Model

if TYPE_CHECKING:
    from .result import Result

Floats = NDArray[np.float64]
REMEDY = "go on with simulate(model, t_end, t0=result.t[-1], start_values=result.start_at())"
RIGID = 1e-9
"""How near velocities must be to those of a rigid motion, relative, to count as one."""


def row_at(result: "Result", t: float | None) -> int:
    """The sample at `t`, the last one if left out; of two at one time, the later.

    Raises
    ------
    ModelError : for a time that was not recorded.
    """
    times = result.t
    if len(times) == 0:
        raise ModelError("the result has no samples: record some (record=True, or t_eval) to go on from there")
    if t is None:
        return len(times) - 1
    k = int(np.searchsorted(times, t, side="right")) - 1
    near = 1e-12 * max(abs(float(times[0])), abs(float(times[-1])))
    for row in (min(k + 1, len(times) - 1), max(k, 0)):
        if abs(float(times[row]) - t) <= near:
            return row
    around = sorted({float(times[max(k, 0)]), float(times[min(k + 1, len(times) - 1)])})
    raise ModelError(f"t = {t!r} s was not recorded; around it are {around}: take one of these, or record it (t_eval)")


def start_at(result: "Result", t: float | None = None) -> dict[str, float]:
    """Coordinates and rates at a recorded time by the names of channels, for `simulate(..., start_values=...)`."""
    row, layout = row_at(result, t), result.layout
    every = np.arange(result.samples.shape[1])
    states = {int(column) for part in ("q", "v") for column in every[layout[part]]}
    found = {name: float(result[name][row]) for name, column in result.plain_columns().items() if column in states}
    return {**found, **_turned(result, row, found)}


def _turned(result: "Result", row: int, start: Mapping[str, float]) -> dict[str, float]:
    """Angles with their whole turns, which coordinates do not tell: as channels show them, else as accounts count."""
    model = result.system
    if not isinstance(model, Model):
        return {}
    known = set(result.channels)
    counted = [angle for e in model.elements() if isinstance(e, CountsTurns) for angle in e.counted_angles()]
    found = {angle.name: float(result[angle.name][row]) for angle in counted if angle.name in known}
    # the others are about the axis of one of these, or nobody has recorded them
    accounts: Mapping[str, int] = getattr(getattr(result._table, "layout", None), "work", {})
    for angle in counted:
        account = accounts.get(account_of(angle.name.rpartition(".")[0]))
        if angle.name not in found and account is not None:
            began = ModelNumbering(model).start_angle(angle.a, angle.b)
            around = began + float(result.samples[row, account])
            found[angle.name] = ModelNumbering(model, {**start, angle.name: around}).start_angle(angle.a, angle.b)
    return found


def model_at(result: "Result", t: float | None = None) -> Model:
    """The model of a run, starting where the run was at a recorded time.

    Raises
    ------
    ModelError : for a result without a model, a time that was not recorded, or a body whose record cannot say where it
        is, such as a cable that swings.
    """
    model = result.system
    if not isinstance(model, Model):
        raise ModelError(f"this result is not of a Model, or comes without it: {REMEDY}")
    return model_from(model, start_at(result, t))


def model_from(model: Model, start: Mapping[str, float]) -> Model:
    """The model, starting with coordinates and rates by the names of channels.

    Raises
    ------
    ModelError : for a body whose record cannot say where it is.
    """
    bodies = []
    for body in model.bodies:
        records = body.coordinate_records()
        q = np.array([start[f"{body.name}.{c.name}"] for c in records])
        v = np.array([start[f"{body.name}.{c.rate}"] for c in records])
        bodies.append(type(body).model_validate({**body.model_dump(), **moved(body, q, v)}))
    parts = {name: getattr(model, name) for name in Model.model_fields}
    numbering = ModelNumbering(model, start)
    turned = {kind: tuple(_with_turns(e, numbering) for e in parts[kind]) for kind in ("joints", "forces", "contacts")}
    return Model(**{**parts, **turned, "bodies": tuple(bodies)})


def _with_turns(element: Element, numbering: ModelNumbering) -> Element:
    """An element that says at which angle it starts, with that of now."""
    if not isinstance(element, CountsTurns) or "start_angle" not in type(element).model_fields:
        return element
    angles = [numbering.start_angle(angle.a, angle.b) for angle in element.counted_angles()]
    return element.model_copy(update={"start_angle": angles[0]}) if angles else element


@singledispatch
def moved(body: BodyElement, q: Floats, v: Floats) -> dict[str, Any]:
    """The fields of a body's record that make it start at coordinates q and rates v.

    Raises
    ------
    ModelError : if it has none for that.
    """
    raise ModelError(f"{an(type(body).__name__)} ('{body.name}') cannot say in its record where it is now: {REMEDY}")


@moved.register
def _(body: PointMass2D, q: Floats, v: Floats) -> dict[str, Any]:
    return {"position": tuple(q.tolist()), "velocity": tuple(v.tolist())}


@moved.register
def _(body: PointMass3D, q: Floats, v: Floats) -> dict[str, Any]:
    return {"position": tuple(q.tolist()), "velocity": tuple(v.tolist())}


@moved.register
def _(body: RigidBody3D, q: Floats, v: Floats) -> dict[str, Any]:
    return _turning_frame(q, v)


@moved.register
def _(body: ReducedBody3D, q: Floats, v: Floats) -> dict[str, Any]:
    own = {"amplitudes": tuple(q[7:].tolist()), "amplitude_rates": tuple(v[7:].tolist())}
    return {**_turning_frame(q[:7], v[:7]), **own}


@moved.register
def _(body: RigidBody2D, q: Floats, v: Floats) -> dict[str, Any]:
    return _frame(q, v)


@moved.register
def _(body: FloatingBody2D, q: Floats, v: Floats) -> dict[str, Any]:
    return {**_frame(q, v), "amplitudes": tuple(q[3:].tolist()), "amplitude_rates": tuple(v[3:].tolist())}


@moved.register
def _(body: LinearSystem, q: Floats, v: Floats) -> dict[str, Any]:
    return {"position": tuple(q.tolist()), "velocity": tuple(v.tolist())}


@moved.register(InterfaceFrame3D)
@moved.register(MaterialPoint3D)
@moved.register(MaterialPoint2D)
@moved.register(MovingFrame2D)
def _(body: BodyElement, q: Floats, v: Floats) -> dict[str, Any]:
    return {}  # they are where their body is, or where they are told to be


@moved.register
def _(body: AxialRod, q: Floats, v: Floats) -> dict[str, Any]:
    """It starts unstrained, all of it with one velocity."""
    strained = float(np.max(np.abs(np.diff(q) * body.elements / body.length - 1.0)))
    if strained > RIGID or float(np.ptp(v)) > RIGID * float(np.max(np.abs(v), initial=1.0)):
        raise ModelError(
            f"rod '{body.name}' is strained or moves in waves, and its record has no place for that: {REMEDY}"
        )
    return {"position": float(q[0]), "velocity": float(v[0])}


@moved.register
def _(body: Cable2D, q: Floats, v: Floats) -> dict[str, Any]:
    """It starts in any shape, but turning as if rigid."""
    nodes, rates = q.reshape(-1, 4), v.reshape(-1, 4)
    arm = np.stack([-nodes[:, 1], nodes[:, 0], -nodes[:, 3], nodes[:, 2]], axis=1)
    matrix = np.zeros((v.size, 3))
    matrix[0::4, 0] = matrix[1::4, 1] = 1.0
    matrix[:, 2] = arm.ravel()
    (vx, vy, turn), *_ = np.linalg.lstsq(matrix, v, rcond=None)
    off = float(np.max(np.abs(matrix @ np.array([vx, vy, turn]) - v)))
    if off > RIGID * max(float(np.max(np.abs(rates))), 1e-300) or body.relaxed == "start":
        raise ModelError(
            f"cable '{body.name}' swings, or is free of stress where it started, and its record has no place for that: "
            f"{REMEDY}"
        )
    shape = tuple(tuple(node) for node in nodes.tolist())
    return {"shape": shape, "position": (0.0, 0.0), "angle": 0.0, "velocity": (vx, vy), "angular_velocity": turn}


@moved.register
def _(body: Cable3D, q: Floats, v: Floats) -> dict[str, Any]:
    """It starts in any shape, but turning as if rigid."""
    nodes = q.reshape(-1, 2, 3)
    matrix = np.zeros((*nodes.shape, 6))
    matrix[:, 0, :, :3] = np.eye(3)
    for c in range(3):
        matrix[..., 3 + c] = np.cross(np.eye(3)[c], nodes)
    columns = matrix.reshape(v.size, 6)
    motion, *_ = np.linalg.lstsq(columns, v, rcond=None)
    if float(np.max(np.abs(columns @ motion - v))) > RIGID * max(float(np.max(np.abs(v))), 1e-300):
        raise ModelError(f"cable '{body.name}' swings, and its record has no place for that: {REMEDY}")
    return {
        "shape": tuple(tuple(node) for node in nodes.reshape(-1, 6).tolist()), "position": (0.0, 0.0, 0.0),
        "attitude": UPRIGHT, "velocity": tuple(motion[:3].tolist()), "angular_velocity": tuple(motion[3:].tolist()),
    }  # fmt: skip


def _frame(q: Floats, v: Floats) -> dict[str, Any]:
    return {
        "position": tuple(q[:2].tolist()), "angle": float(q[2]),
        "velocity": tuple(v[:2].tolist()), "angular_velocity": float(v[2]),
    }  # fmt: skip


def _turning_frame(q: Floats, v: Floats) -> dict[str, Any]:
    """Its angular velocity in the body is 2 G p'."""
    (e0, *e), (rate, *rates) = q[3:].tolist(), v[3:].tolist()
    spin = 2.0 * (e0 * np.array(rates) - rate * np.array(e) - np.cross(e, rates))
    return {
        "position": tuple(q[:3].tolist()), "velocity": tuple(v[:3].tolist()),
        "attitude": EulerParameters(values=(e0, e[0], e[1], e[2])),
        "angular_velocity": tuple(spin.tolist()), "angular_velocity_in": "body",
    }  # fmt: skip
