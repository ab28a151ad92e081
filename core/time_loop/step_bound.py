"""How far a step may go, so that the dense output between its ends, by which gaps are judged, is as good as these."""

from typing import Any

from ..compiled.jit import internal
from ..compiled.views import imat, vec
from ..contacts.geometry_kinds import EQUATIONS, OWN
from ..event_detection.contact_evaluation import NEAR_KIND, NEAR_SIZE
from ..methods.history import history_row

BENDING = 1e4
"""For a coordinate that swings as far as it may, x sin(t) over h = 1/2, h^5/720 is about a 10^4th of that way."""


@internal
def leap_of(workspace: Any, method: Any, loop: Any, h: float) -> float:
    """How far the step of size h that ends at the current point has gone, relative to what it may: at most 1.

    The dense output is as good as its ends where the motion is nearly a polynomial of fourth degree, however far it
    goes: q_1 - q_0 - h (v_0 + v_1)/2 + h^2 (a_1 - a_0)/12 = h^5 q^(5)/720 leaves nothing of those (the Euler-Maclaurin
    formula; Davis and Rabinowitz 1984, section 2.9). Where nothing bounds a gap all ways count.
    """
    row, q, leap, largest = (
        history_row(workspace, method, 0),
        vec(workspace.q, workspace.n),
        vec(loop.leap, workspace.n),
        0.0,
    )
    for i in range(workspace.n):
        largest = max(largest, abs(q[i] - row[i]) / leap[i])
    if largest <= 1.0:
        return largest
    near = imat(loop.near, workspace.n_contacts, NEAR_SIZE)
    for k in range(workspace.n_contacts):
        if near[k, NEAR_KIND] == OWN or near[k, NEAR_KIND] == EQUATIONS:
            return largest
    v, a, n, largest = vec(workspace.v, workspace.n), vec(workspace.a, workspace.n), workspace.n_ext, 0.0
    for i in range(workspace.n):
        goes = q[i] - row[i]
        bends = goes - 0.5 * h * (row[n + i] + v[i]) + h * h / 12.0 * (a[i] - row[2 * n + i])
        largest = max(largest, min(abs(goes), BENDING * abs(bends)) / leap[i])
    return largest
