"""The frame of a material point of a flexible body: a massless body with x, y, angle, tied to it by three rows.

Phi = (p_f - p, angle - theta - arg t) with p = R + A(theta) u, u = u0 + S w + g(w, w)/2 and t = t0 + T w, see
`flexible_body.py`; S + g(w, .) is what u changes by.
The frame has no mass of its own, so the multipliers are the load on the frame, handed on to the flexible body.
The derivatives of arg t: arg_k = (t x T_k)/|t|^2, arg_kj = (T_j x T_k)/|t|^2 - 2 (t . T_j)(t x T_k)/|t|^4.
"""

import math
from collections.abc import Mapping, Sequence
from typing import Any, ClassVar, Literal, cast

import numpy as np

from ..compiled.jit import inlined, internal
from ..compiled.kernels import RESIDUAL, TANGENT
from ..compiled.views import imat, mat, vec
from ..model.base import Name, Vector2
from ..model.channels import Channel
from ..model.markers import GROUND
from ..model.words import an
from .base import NO_INPUTS, BodyElement, Form, Numbering, Row
from .coordinate import Coordinate, X, Y
from .flexible_body import FlexibleBody, PointShape
from .planar_body import ANGLE_COORDINATE, PlanarFrame

FIXED = 6
"""Coordinates before the local ones: x, y, angle of the point's frame and of the floating frame."""


@inlined
def along_row(par: Any, e: int, first: int, n: int, k: int, x: Any, coord: Any) -> Any:
    """Row k of g_x and g_y, which stand from column `first` on, times the local part of x."""
    gx, gy = 0.0, 0.0
    for j in range(n):
        y = x[coord[e, FIXED + j]]
        gx += par[e, first + k * n + j] * y
        gy += par[e, first + (n + k) * n + j] * y
    return gx, gy


@internal
def material_point2d_kernel(job: int, t: float, b: Any) -> None:
    if job != RESIDUAL and job != TANGENT:
        return
    width = b.ncoord
    n = width - FIXED
    # u0, t0, then S_x, S_y, T_x, T_y (n each), then 1 if g is not zero, g_x and g_y (n x n each)
    par = mat(b.par, b.count, b.npar)
    own_x, own_y = np.empty(n), np.empty(n)
    coord, row = imat(b.coord, b.count, width), imat(b.row, b.count, 3)
    q, v, a = vec(b.q, b.n_extended), vec(b.v, b.n_extended), vec(b.a, b.n_extended)
    lam, r, values = vec(b.lam, b.m_extended), vec(b.r, b.n_extended), vec(b.values, b.n_values)
    phi, phid, phidd = vec(b.phi, b.m_extended), vec(b.phid, b.m_extended), vec(b.phidd, b.m_extended)
    c_q = vec(b.coef, 2)[0]
    slot_s = imat(b.slot_s, b.count, width * width)
    slot_j, slot_jt = imat(b.slot_j, b.count, 3 * width), imat(b.slot_jt, b.count, 3 * width)
    for e in range(b.count):
        ix, iy, ia, jx, jy, ja = coord[e, 0], coord[e, 1], coord[e, 2], coord[e, 3], coord[e, 4], coord[e, 5]
        k0, k1, k2 = row[e, 0], row[e, 1], row[e, 2]
        ux, uy, tx, ty = par[e, 0], par[e, 1], par[e, 2], par[e, 3]
        curved = 4 + 4 * n
        for k in range(n):
            w = q[coord[e, FIXED + k]]
            own_x[k], own_y[k] = par[e, 4 + k], par[e, 4 + n + k]
            if par[e, curved] != 0.0:
                gx, gy = along_row(par, e, curved + 1, n, k, q, coord)
                ux += 0.5 * gx * w
                uy += 0.5 * gy * w
                own_x[k] += gx
                own_y[k] += gy
            ux += par[e, 4 + k] * w
            uy += par[e, 4 + n + k] * w
            tx += par[e, 4 + 2 * n + k] * w
            ty += par[e, 4 + 3 * n + k] * w
        c, s = math.cos(q[ja]), math.sin(q[ja])
        x, y = c * ux - s * uy, s * ux + c * uy
        square = tx * tx + ty * ty
        lx, ly, la = lam[k0], lam[k1], lam[k2]
        # the multiplier's force in the floating frame
        fx, fy = c * lx + s * ly, c * ly - s * lx
        if job == RESIDUAL:
            dux, duy, ddux, dduy, dtx, dty, ddtx, ddty = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
            for k in range(n):
                i = coord[e, FIXED + k]
                sx, sy, wx, wy = own_x[k], own_y[k], par[e, 4 + 2 * n + k], par[e, 4 + 3 * n + k]
                dux += sx * v[i]
                duy += sy * v[i]
                ddux += sx * a[i]
                dduy += sy * a[i]
                if par[e, curved] != 0.0:
                    gx, gy = along_row(par, e, curved + 1, n, k, v, coord)
                    ddux += gx * v[i]
                    dduy += gy * v[i]
                dtx += wx * v[i]
                dty += wy * v[i]
                ddtx += wx * a[i]
                ddty += wy * a[i]
                r[i] -= fx * sx + fy * sy + la * (tx * wy - ty * wx) / square
            rate, growth = v[ja], a[ja]
            # velocity and acceleration relative to R in the floating frame
            vx, vy = dux - rate * uy, duy + rate * ux
            ax = ddux - 2.0 * rate * duy - growth * uy - rate * rate * ux
            ay = dduy + 2.0 * rate * dux + growth * ux - rate * rate * uy
            turn = (tx * dty - ty * dtx) / square
            faster = (tx * ddty - ty * ddtx) / square - 2.0 * turn * (tx * dtx + ty * dty) / square
            relative = q[ia] - q[ja]
            ca, sa = math.cos(relative), math.sin(relative)
            phi[k0], phi[k1] = q[ix] - q[jx] - x, q[iy] - q[jy] - y
            phi[k2] = -math.atan2(ca * ty - sa * tx, ca * tx + sa * ty)  # no jump where arg t has one
            phid[k0] = v[ix] - v[jx] - (c * vx - s * vy)
            phid[k1] = v[iy] - v[jy] - (s * vx + c * vy)
            phid[k2] = v[ia] - rate - turn
            phidd[k0] = a[ix] - a[jx] - (c * ax - s * ay)
            phidd[k1] = a[iy] - a[jy] - (s * ax + c * ay)
            phidd[k2] = a[ia] - growth - faster
            r[ix] += lx
            r[iy] += ly
            r[ia] += la
            r[jx] -= lx
            r[jy] -= ly
            r[ja] -= x * ly - y * lx + la
        else:
            at = (FIXED - 1) * width
            values[slot_s[e, at + FIXED - 1]] += c_q * (x * lx + y * ly)
            for k in range(n):
                sx, sy, wx, wy = own_x[k], own_y[k], par[e, 4 + 2 * n + k], par[e, 4 + 3 * n + k]
                arm = c_q * (fy * sx - fx * sy)
                values[slot_s[e, at + FIXED + k]] -= arm
                values[slot_s[e, (FIXED + k) * width + FIXED - 1]] -= arm
                across = (tx * wy - ty * wx) / square
                for j in range(n):
                    zx, zy = par[e, 4 + 2 * n + j], par[e, 4 + 3 * n + j]
                    second = (zx * wy - zy * wx) / square - 2.0 * across * (tx * zx + ty * zy) / square
                    second *= la
                    if par[e, curved] != 0.0:
                        second += fx * par[e, curved + 1 + k * n + j] + fy * par[e, curved + 1 + (n + k) * n + j]
                    values[slot_s[e, (FIXED + k) * width + FIXED + j]] -= c_q * second
            for transposed in range(2):
                slot = slot_jt if transposed else slot_j
                values[slot[e, 0]] += 1.0
                values[slot[e, 3]] -= 1.0
                values[slot[e, 5]] += y
                values[slot[e, width + 1]] += 1.0
                values[slot[e, width + 4]] -= 1.0
                values[slot[e, width + 5]] -= x
                values[slot[e, 2 * width + 2]] += 1.0
                values[slot[e, 2 * width + 5]] -= 1.0
                for k in range(n):
                    sx, sy, wx, wy = own_x[k], own_y[k], par[e, 4 + 2 * n + k], par[e, 4 + 3 * n + k]
                    values[slot[e, FIXED + k]] -= c * sx - s * sy
                    values[slot[e, width + FIXED + k]] -= s * sx + c * sy
                    values[slot[e, 2 * width + FIXED + k]] -= (tx * wy - ty * wx) / square


class MaterialPoint2D(PlanarFrame):
    """The frame of a material point of a flexible body: coordinates x, y and the angle of the body's axis there.

    Joints, forces, drivers, contacts and outputs take it like a rigid body; a marker's `point` on it is an offset in
    the frame, which turns with the body's cross-section. It has no mass, it only moves along. Channels force_x, force_y
    and torque are the load that it hands on to the flexible body.

    Raises
    ------
    ModelError : if `body` is no flexible body, or has no such point.
    """

    type: Literal["MaterialPoint2D"] = "MaterialPoint2D"
    kernel: ClassVar[Any] = material_point2d_kernel
    constraint_rows: ClassVar[int] = 3

    body: Name
    """Name of the flexible body."""
    point: Vector2
    """Where in the undeformed body, m: (s, 0) on the axis of a cable or beam."""

    def check_in(self, bodies: Mapping[str, BodyElement]) -> None:
        """Refuse bodies without material points."""
        body = bodies.get(self.body)
        if not isinstance(body, FlexibleBody):
            flexible = sorted(name for name, b in bodies.items() if isinstance(b, FlexibleBody))
            what = "does not exist" if body is None else f"is {an(type(body).__name__)}, which has none"
            raise ValueError(f"'{self.name}' is a material point of '{self.body}', which {what}: name a flexible body "
                             f"({flexible or 'there is none yet'}), or put a Marker2D on a rigid body")  # fmt: skip
        body.material_point(self.point)

    def acts_on(self) -> frozenset[str]:
        return super().acts_on() | {self.body}

    def coordinate_records(self) -> Sequence[Coordinate]:
        return (X, Y, ANGLE_COORDINATE)

    def start_in(
        self, bodies: Mapping[str, BodyElement], inputs: Mapping[str, float] = NO_INPUTS
    ) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """(q0, v0) that follow from the flexible body's."""
        body, shape = bodies[self.body], self._shape(bodies)
        q, v = body.start_in(bodies, inputs)
        index = {name: k for k, name in enumerate(body.coordinate_names)}
        frame = [index[name] for name in shape.frame or ()]
        frame_q, frame_v = ([x[k] for k in frame] or [0.0] * 3 for x in (q, v))
        local_q, local_v = ([x[index[name]] for name in shape.local] for x in (q, v))
        return shape.place(frame_q, local_q), shape.rates(frame_q, local_q, frame_v, local_v)

    def form_in(self, bodies: Mapping[str, BodyElement]) -> Form:
        return Form(type(self).kernel, 3, *point_pattern(len(self._shape(bodies).local)))

    def row(self, numbering: Numbering) -> Row:
        shape = self._shape(numbering.bodies)
        frame = [numbering.coordinate(self.body, name) for name in shape.frame or ()] or numbering.coordinates(GROUND)
        local = [numbering.coordinate(self.body, name) for name in shape.local]
        n = len(local)
        second = np.zeros((2, n, n)) if shape.second is None else shape.second
        curved = float(shape.second is not None)
        linear = (*shape.offset, *shape.tangent, *shape.shape.ravel(), *shape.slope.ravel())
        parameters = (*linear, curved, *second.ravel())
        return Row(parameters, (*numbering.coordinates(self.name), *frame, *local))

    def _shape(self, bodies: Mapping[str, BodyElement]) -> PointShape:
        self.check_in(bodies)
        return cast(FlexibleBody, bodies[self.body]).material_point(self.point)

    def multiplier_channels(self) -> Sequence[Channel]:
        return (
            Channel(f"{self.name}.force_x", "N", f"load at {self.name} on its flexible body, x"),
            Channel(f"{self.name}.force_y", "N", f"load at {self.name} on its flexible body, y"),
            Channel(f"{self.name}.torque", "N.m", f"load at {self.name} on its flexible body"),
        )


def point_pattern(n: int) -> tuple[Sequence[tuple[int, int]], Sequence[tuple[int, int]]]:
    """Patterns of tangent and Jacobian with n local coordinates."""
    turned = range(FIXED - 1, FIXED + n)
    rows = ((0, 3, 5), (1, 4, 5), (2, 5))
    jacobian = tuple((k, j) for k, fixed in enumerate(rows) for j in (*fixed, *range(FIXED, FIXED + n)))
    return tuple((i, j) for i in turned for j in turned), jacobian
