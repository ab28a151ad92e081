"""The turns of a joint in space, counted.

The axes tell an angle but for whole turns. These are counted by a work account, as all accounts a part of the state:
the integral of the relative angular velocity about the z axis of marker a. It is used only to tell which of the angles
that differ by whole turns is meant, so that its own error does not matter while it is below half a turn.
"""

from typing import Any

from ..compiled.jit import internal
from ..compiled.kernels import POWER
from ..compiled.views import imat, mat, vec
from ..model.markers import Marker3D
from ..model.rotation3d import columns_at, constant, dot, four, less, space_rate
from .base import Form, Numbering, Part, Row

LOOSE = 100.0
"""rad; what the error control takes for the size of such an account, so that it does not shorten steps."""


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
