"""What a flexible body does along its length, from the result of a run: shape, strain, force, moment, stress.

Every function takes the result, the body's record and points (s along the undeformed axis, m), and gives one row a
sample and one column a point; with `times` one row a time, interpolated between the samples.

A body takes part by two methods of `FlexibleBody`: `material_point` tells how its points move, which is all that
`deformed_shape` needs, and `section` turns the history of its coordinates into a `Section`.
"""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..elements.flexible_body import FlexibleBody, Section
from ..errors import ModelError
from ..interpolation import Between
from ..model.words import an

if TYPE_CHECKING:
    from ..results.result import Result

Floats = NDArray[np.float64]


def deformed_shape(result: "Result", body: FlexibleBody, points: ArrayLike, times: ArrayLike | None = None) -> Floats:
    """Places x, y of the points over time, (N, points, 2), m. Raises ModelError for a point outside the body."""
    q, _ = _history(result, body, times)
    return places(body, [(float(s), 0.0) for s in _points(points)], q)


def places(body: FlexibleBody, points: Sequence[tuple[float, float]], q: Floats) -> Floats:
    """Places (N, points, 2), m, of material points from the history of the body's coordinates (N, n)."""
    index = {name: k for k, name in enumerate(body.coordinate_names)}
    found = []
    for point in points:
        shape = body.material_point(point)
        x, y = shape.local_place(q[:, [index[name] for name in shape.local]])
        if shape.frame is not None:
            rx, ry, angle = (q[:, index[name]] for name in shape.frame)
            c, sn = np.cos(angle), np.sin(angle)
            x, y = rx + c * x - sn * y, ry + sn * x + c * y
        found.append(np.stack([x, y], axis=1))
    return np.stack(found, axis=1)


def section(result: "Result", body: FlexibleBody, points: ArrayLike, times: ArrayLike | None = None) -> Section:
    """Strain, curvature, axial force and bending moment at once, each (N, points).

    Raises
    ------
    ModelError : for a point outside the body, or a body that does not tell its internal forces.
    """
    return body.section(_points(points), *_history(result, body, times))


def axial_strain(result: "Result", body: FlexibleBody, points: ArrayLike, times: ArrayLike | None = None) -> Floats:
    """Strain of the axis (N, points), 1."""
    return section(result, body, points, times).axial_strain


def curvature(result: "Result", body: FlexibleBody, points: ArrayLike, times: ArrayLike | None = None) -> Floats:
    """Curvature (N, points), 1/m: turning of the cross-section per undeformed length."""
    return section(result, body, points, times).curvature


def axial_force(result: "Result", body: FlexibleBody, points: ArrayLike, times: ArrayLike | None = None) -> Floats:
    """Axial force (N, points), N, tension positive, damping included."""
    return section(result, body, points, times).axial_force


def bending_moment(result: "Result", body: FlexibleBody, points: ArrayLike, times: ArrayLike | None = None) -> Floats:
    """Bending moment (N, points), N m, positive where it turns the far side counter-clockwise, damping included."""
    return section(result, body, points, times).bending_moment


def stress(
    result: "Result",
    body: FlexibleBody,
    points: ArrayLike,
    *,
    area: float,
    second_moment: float,
    height: float,
    times: ArrayLike | None = None,
) -> Floats:
    """Normal stress (N, points), Pa, at `height` above the axis: N/A - M height/I.

    Parameters
    ----------
    area : of the cross-section, m^2. second_moment : I, m^4.
    height : of the fibre over the axis, m, on the left-hand side when looking along it; half the section's height and
        minus that are its surfaces.

    Raises
    ------
    ModelError : for an area or a second moment that is not positive, or a body that does not tell its axial force, as a
        FloatingBeam2D without axial modes: `bending_stress` is what is known of it.
    """
    _positive(body, area=area, second_moment=second_moment)
    found = section(result, body, points, times)
    if found.axial_force.size and np.all(np.isnan(found.axial_force)):
        raise ModelError(
            f"stress in '{body.name}' needs its axial force, which {an(type(body).__name__)} tells only with "
            "axial_stiffness and axial_modes (or an axial attachment): give it these, or ask for bending_stress alone"
        )
    return found.axial_force / area - found.bending_moment * height / second_moment


def bending_stress(
    result: "Result",
    body: FlexibleBody,
    points: ArrayLike,
    *,
    second_moment: float,
    height: float,
    times: ArrayLike | None = None,
) -> Floats:
    """Normal stress of bending alone (N, points), Pa: -M height/I, `stress` without its part of the axial force.

    Raises
    ------
    ModelError : for a second moment that is not positive.
    """
    _positive(body, second_moment=second_moment)
    return -bending_moment(result, body, points, times) * height / second_moment


def _positive(body: FlexibleBody, **values: float) -> None:
    for name, value in values.items():
        if not value > 0.0:
            raise ModelError(f"{name} = {value!r} of the cross-section of '{body.name}' must be positive")


def _points(points: ArrayLike) -> Floats:
    found = np.atleast_1d(np.asarray(points, dtype=float))
    if found.ndim != 1:
        raise ModelError(f"points must be a list of places along the body in m, not an array of shape {found.shape}")
    return found


def _history(result: "Result", body: FlexibleBody, times: ArrayLike | None) -> tuple[Floats, Floats]:
    """Coordinates and rates of the body (N, n): at the samples, or at `times` by cubics between them."""
    records = body.coordinate_records()
    q = _columns(result, body.name, [record.name for record in records])
    v = _columns(result, body.name, [record.rate for record in records])
    if times is None:
        return q, v
    wanted, t = np.atleast_1d(np.asarray(times, dtype=float)), result.t
    if wanted.ndim != 1 or len(wanted) == 0:
        raise ModelError(f"times must be a list of at least one time in s, not an array of shape {wanted.shape}; leave "
                         "them out for all samples")  # fmt: skip
    if len(t) == 0 or not (wanted.min() >= t[0] and wanted.max() <= t[-1]):
        raise ModelError(f"times reach from {wanted.min():g} to {wanted.max():g} s, but the result from "
                         f"{t[0] if len(t) else 0.0:g} to {t[-1] if len(t) else 0.0:g} s")  # fmt: skip
    among = Between.at(t, wanted)
    return among.cubic(q, v), among.line(v)


def _columns(result: "Result", body: str, names: Sequence[str]) -> Floats:
    return np.stack([result[f"{body}.{name}"] for name in names], axis=1)
