"""A point of a cable in space is held at a marker, its direction along the marker's x axis.

Phi = (R + A u - w . n, -t . A y, t . A z) with the point w . n of the cable and its tangent t = w' . n, n its element's
nodes, y and z the marker's other axes. The cable has no torsion: it may turn about its own direction.
"""

from collections.abc import Mapping, Sequence
from typing import Any, ClassVar, Literal

from ..compiled.jit import internal
from ..compiled.kernels import RESIDUAL, TANGENT
from ..compiled.views import imat, mat, vec
from ..model.base import Name, NonNegative
from ..model.channels import Channel
from ..model.markers import Marker3D
from ..model.rotation3d import add_bend, columns_at, constant, dot, onto, turns
from .base import BodyElement, JointElement, Numbering, Row
from .cable3d import Cable3D
from .named_body import body_named

SIZE, NODES = 19, 7
"""Coordinates: seven of the marker's body, then the twelve of the cable's element."""
SHAPE, SLOPE = 10, 14
"""Where these weights begin among the parameters; before them `rest`, the marker's point, its reversed y axis, its z
axis."""


@internal
def cable_clamp3d_kernel(job: int, t: float, b: Any) -> None:
    if job != RESIDUAL and job != TANGENT:
        return
    par, coord, row = mat(b.par, b.count, 18), imat(b.coord, b.count, SIZE), imat(b.row, b.count, 5)
    q, v, a = vec(b.q, b.n_extended), vec(b.v, b.n_extended), vec(b.a, b.n_extended)
    phi, phid, phidd = vec(b.phi, b.m_extended), vec(b.phid, b.m_extended), vec(b.phidd, b.m_extended)
    lam, r, values = vec(b.lam, b.m_extended), vec(b.r, b.n_extended), vec(b.values, b.n_values)
    c_q = vec(b.coef, 2)[0]
    for e in range(b.count):
        w, ix = par[e], coord[e]
        u = constant(w, 1)
        force = lam[row[e, 0]], lam[row[e, 1]], lam[row[e, 2]]
        slope = _weighted(w, q, ix)
        if job == RESIDUAL:
            columns, arm, arm_rate, arm_second = turns(b, ix, 3, w[0], u)
            by = onto(columns, force)
            for c in range(3):
                k = row[e, c]
                phi[k], phid[k], phidd[k] = q[ix[c]] + arm[c], v[ix[c]] + arm_rate[c], a[ix[c]] + arm_second[c]
                r[ix[c]] += lam[k]
                for i in range(4):
                    at = ix[NODES + 3 * i + c]
                    phi[k] -= w[SHAPE + i] * q[at]
                    phid[k] -= w[SHAPE + i] * v[at]
                    phidd[k] -= w[SHAPE + i] * a[at]
                    r[at] -= w[SHAPE + i] * lam[k]
            for i in range(4):
                r[ix[3 + i]] += by[i]
            rate, second = _weighted(w, v, ix), _weighted(w, a, ix)
            for side in range(2):
                k = row[e, 3 + side]
                columns, axis, axis_rate, axis_second = turns(b, ix, 3, w[0], constant(w, 4 + 3 * side))
                phi[k] = dot(slope, axis)
                phid[k] = dot(rate, axis) + dot(slope, axis_rate)
                phidd[k] = dot(second, axis) + 2.0 * dot(rate, axis_rate) + dot(slope, axis_second)
                by = onto(columns, slope)
                for i in range(4):
                    r[ix[3 + i]] += lam[k] * by[i]
                    for c in range(3):
                        r[ix[NODES + 3 * i + c]] += lam[k] * w[SLOPE + i] * axis[c]
        else:
            slot = imat(b.slot_s + 8 * SIZE * SIZE * e, SIZE, SIZE)
            slot_j, slot_jt = imat(b.slot_j + 40 * SIZE * e, 5, SIZE), imat(b.slot_jt + 40 * SIZE * e, 5, SIZE)
            columns, _ = columns_at(b, ix, 3, w[0], u)
            add_bend(values, slot, 3, c_q, force, u)
            for transposed in range(2):
                at = slot_jt if transposed else slot_j
                for c in range(3):
                    values[at[c, c]] += 1.0
                    for i in range(4):
                        values[at[c, 3 + i]] += columns[i][c]
                        values[at[c, NODES + 3 * i + c]] -= w[SHAPE + i]
            for side in range(2):
                direction, factor = constant(w, 4 + 3 * side), c_q * lam[row[e, 3 + side]]
                columns, axis = columns_at(b, ix, 3, w[0], direction)
                by = onto(columns, slope)
                add_bend(values, slot, 3, factor, slope, direction)
                for i in range(4):
                    values[slot_j[3 + side, 3 + i]] += by[i]
                    values[slot_jt[3 + side, 3 + i]] += by[i]
                    for c in range(3):
                        k = NODES + 3 * i + c
                        values[slot_j[3 + side, k]] += w[SLOPE + i] * axis[c]
                        values[slot_jt[3 + side, k]] += w[SLOPE + i] * axis[c]
                        for j in range(4):
                            mixed = factor * w[SLOPE + i] * columns[j][c]
                            values[slot[3 + j, k]] += mixed
                            values[slot[k, 3 + j]] += mixed


@internal
def _weighted(par: Any, x: Any, coord: Any) -> Any:
    """The tangent's weights times the nodes' vectors in x."""
    found = (0.0, 0.0, 0.0)
    for i in range(4):
        w, at = par[SLOPE + i], NODES + 3 * i
        found = (
            found[0] + w * x[coord[at]],
            found[1] + w * x[coord[at + 1]],
            found[2] + w * x[coord[at + 2]],
        )
    return found


TURNED = tuple((3 + i, j) for i in range(4) for j in (*range(3, 7), *range(NODES, SIZE)))


class CableClamp3D(JointElement):
    """Holds the point s m along the undeformed Cable3D `cable` at `marker`, with the cable's direction along the
    marker's x axis (against it, if it starts that way).

    Channels force_x, force_y, force_z are the force on the cable in the directions of space, N; moment_z and moment_y
    the moments on it about the marker's axes, N m, over 1 + the axial strain there.

    Raises
    ------
    ModelError : if `cable` is no Cable3D, or has no such point.
    """

    type: Literal["CableClamp3D"] = "CableClamp3D"
    symbol: ClassVar[str] = "clamp"
    kernel: ClassVar[Any] = cable_clamp3d_kernel
    constraint_rows: ClassVar[int] = 5
    tangent_pattern: ClassVar[Sequence[tuple[int, int]]] = tuple(sorted({*TURNED, *((j, i) for i, j in TURNED)}))
    jacobian_pattern: ClassVar[Sequence[tuple[int, int]]] = (
        *((c, j) for c in range(3) for j in (c, *range(3, 7), *(NODES + 3 * i + c for i in range(4)))),
        *((3 + k, j) for k in range(2) for j in (*range(3, 7), *range(NODES, SIZE))),
    )  # fmt: skip

    cable: Name
    """Name of the cable."""
    s: NonNegative
    """Where along the undeformed cable, m."""
    marker: Marker3D = Marker3D()
    """Where it is held."""

    def check_in(self, bodies: Mapping[str, BodyElement]) -> None:
        """Refuse what is no cable, and points beyond it."""
        body_named(self.name, "at a point", self.cable, Cable3D, bodies).point(self.s)

    def markers(self) -> Sequence[Marker3D]:
        return (self.marker,)

    def acts_on(self) -> frozenset[str]:
        return super().acts_on() | {self.cable}

    def row(self, numbering: Numbering) -> Row:
        point = body_named(self.name, "at a point", self.cable, Cable3D, numbering.bodies).point(self.s)
        axes = self.marker.axes()
        cable = [numbering.coordinate(self.cable, name) for name in point.names]
        parameters = (numbering.at_rest(self.marker)[3], *self.marker.point, *-axes[:, 1], *axes[:, 2])
        return Row((*parameters, *point.shape, *point.slope), (*numbering.frame(self.marker), *cable))

    def multiplier_channels(self) -> Sequence[Channel]:
        name, cable = self.name, self.cable
        forces = [Channel(f"{name}.force_{c}", "N", f"force of {name} on {cable}, {c}") for c in "xyz"]
        text = f"moment of {name} on {cable} about the marker's"
        return (*forces, *(Channel(f"{name}.moment_{c}", "N.m", f"{text} {c} axis") for c in "zy"))
