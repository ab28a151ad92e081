"""The angle of a joint in space, whole turns and all.

The axes tell an angle but for whole turns. These are counted by a work account, as all accounts a part of the state:
the integral of the relative angular velocity about the z axis of marker a. It is used only to tell which of the angles
that differ by whole turns is meant, so that its own error does not matter while it is below half a turn.
"""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from ..compiled.jit import inlined, internal
from ..compiled.kernels import POWER
from ..compiled.views import imat, mat, vec
from ..model.channels import Channel
from ..model.derived import NOT_KNOWN, Columns
from ..model.marker_channels3d import Floats, Frame3D
from ..model.markers import Marker3D
from .base import Form, Numbering, Part, Row
from .rotation3d import columns_at, constant, dot, four, less

TURN = 2.0 * math.pi
LOOSE = 100.0
"""rad; what the error control takes for the size of such an account, so that it does not shorten steps."""


@inlined
def space_rate(p: Any, rate: Any) -> Any:
    """E(p) p', half the angular velocity in space."""
    return (
        p[0] * rate[1] - p[1] * rate[0] + p[2] * rate[3] - p[3] * rate[2],
        p[0] * rate[2] - p[2] * rate[0] + p[3] * rate[1] - p[1] * rate[3],
        p[0] * rate[3] - p[3] * rate[0] + p[1] * rate[2] - p[2] * rate[1],
    )


@internal
def turn3d_kernel(job: int, t: float, b: Any) -> None:
    if job != POWER:
        return
    par, coord, extra = mat(b.par, b.count, 5), imat(b.coord, b.count, 14), imat(b.extra, b.count, 1)
    q, v = vec(b.q, b.n_extended), vec(b.v, b.n_extended)
    for e in range(b.count):
        _, axis = columns_at(b, coord[e], 3, par[e, 0], constant(par[e], 2))
        of_a = space_rate(four(q, coord[e], 3, par[e, 0]), four(v, coord[e], 3, 0.0))
        of_b = space_rate(four(q, coord[e], 10, par[e, 1]), four(v, coord[e], 10, 0.0))
        vec(b.a, b.n_extended)[extra[e, 0]] += 2.0 * dot(less(of_b, of_a), axis)


FORM = Form(turn3d_kernel, 0, (), ())


def account_of(joint: str) -> str:
    """Name of the account of a joint's angle."""
    return f"{joint}.turned"


def turn_part(joint: str, a: Marker3D, b: Marker3D, numbering: Numbering) -> Part:
    """What counts the turns of a joint, as tables."""
    rest = (numbering.at_rest(a)[3], numbering.at_rest(b)[3])
    coordinates = (*numbering.frame(a), *numbering.frame(b))
    account = numbering.work(account_of(joint), LOOSE)
    return Part(FORM, (Row((*rest, *a.axes()[:, 2]), coordinates, (account,)),))


class JointAngle:
    """Angle (rad) from the x axis of marker a to that of marker b about the z axis of marker a, and its rate."""

    def __init__(self, name: str, a: Frame3D, b: Frame3D, start: float) -> None:
        self._a, self._b, self._start, self._account = a, b, start, account_of(name)
        self.channels = (
            Channel(f"{name}.angle", "rad", f"angle of {name}, turns counted"),
            Channel(f"{name}.angular_velocity", "rad/s", f"rate of the angle of {name}"),
        )
        self.rate_of: Sequence[int] = (1, NOT_KNOWN)

    def __call__(self, columns: Columns) -> Floats:
        """Both (N, 2)."""
        a, b = self._a.axes(columns.q), self._b.axes(columns.q)
        angle = np.arctan2(_product(a[:, :, 1], b[:, :, 0]), _product(a[:, :, 0], b[:, :, 0]))
        about = self._start + columns.work(self._account)
        angle = angle + TURN * np.round((about - angle) / TURN)
        of_a, of_b = (_space_rate(frame, columns) for frame in (self._a, self._b))
        z = a[:, :, 2]
        rate = np.stack([of_b[i] - of_a[i] for i in range(3)], axis=1)
        return np.stack([angle, 2.0 * _product(rate, z)], axis=1)


def _product(a: Floats, b: Floats) -> Floats:
    found: Floats = a[:, 0] * b[:, 0] + a[:, 1] * b[:, 1] + a[:, 2] * b[:, 2]
    return found


def _space_rate(frame: Frame3D, columns: Columns) -> list[Any]:
    p, rate = frame.place(columns.q)[1], frame.rates(columns.v)[1]
    crossed = (p[2] * rate[3] - p[3] * rate[2], p[3] * rate[1] - p[1] * rate[3], p[1] * rate[2] - p[2] * rate[1])
    return [p[0] * rate[i + 1] - p[i + 1] * rate[0] + crossed[i] for i in range(3)]


class JointPosition:
    """Place (m) of the point of marker b along the z axis of marker a, and its rate."""

    def __init__(self, name: str, a: Frame3D, b: Frame3D) -> None:
        self._a, self._b = a, b
        self.channels = (
            Channel(f"{name}.position", "m", f"place of b along the axis of {name}"),
            Channel(f"{name}.velocity", "m/s", f"rate of the position of {name}"),
        )
        self.rate_of: Sequence[int] = (1, NOT_KNOWN)

    def __call__(self, columns: Columns) -> Floats:
        """Both (N, 2)."""
        z = self._a.axes(columns.q)[:, :, 2]
        d = self._b.point(columns.q) - self._a.point(columns.q)
        rate = self._b.velocity(columns) - self._a.velocity(columns)
        of_a = _space_rate(self._a, columns)
        turned = (
            of_a[1] * z[:, 2] - of_a[2] * z[:, 1],
            of_a[2] * z[:, 0] - of_a[0] * z[:, 2],
            of_a[0] * z[:, 1] - of_a[1] * z[:, 0],
        )
        z_rate = 2.0 * np.stack(turned, axis=1)
        return np.stack([_product(z, d), _product(z, rate) + _product(z_rate, d)], axis=1)
