"""The frame of an interface of a reduced body in space: a massless frame with x, y, z and Euler parameters f.

Seven rows: place R + A(p) u - r_f = 0 with u = u0 + S w; attitude 2 G(p) f - T w = 0, whose left part is the vector
2 sin(angle/2) of the turn from the body's frame to this one, so T w is a small rotation; norm f.f - 1 = 0. The
multipliers are the load on the frame, handed on to the body.
"""

import math
from collections.abc import Mapping, Sequence
from typing import Any, ClassVar, Literal

import numpy as np

from ..compiled.jit import internal
from ..compiled.kernels import RESIDUAL, TANGENT
from ..compiled.views import imat, mat, vec
from ..errors import ModelError
from ..model.angular_velocity import AngularVelocity
from ..model.attitude import product, rotation_matrix
from ..model.base import Name
from ..model.derived import Derived
from ..model.rotation3d import (
    add_bend,
    along,
    body_axes,
    body_rate,
    dot,
    four,
    of_body_torque,
    onto,
    plus,
    times,
    turned,
    turning,
)
from .base import NO_INPUTS, BodyElement, Form, Numbering, Row
from .coordinate import Coordinate, X, Y, Z
from .interface_load3d import InterfaceLoad
from .named_body import body_named
from .reduced_body3d import ReducedBody3D
from .spatial_body import EULER, SpatialFrame

BODY, LOCAL = 7, 14
"""Where the coordinates of the body's frame begin among those of this element, and its amplitudes."""
ROWS = 7


@internal
def interface_frame3d_kernel(job: int, t: float, b: Any) -> None:
    if job != RESIDUAL and job != TANGENT:
        return
    width = b.ncoord
    n = width - LOCAL
    coord, row = imat(b.coord, b.count, width), imat(b.row, b.count, ROWS)
    q, v, a = vec(b.q, b.n_extended), vec(b.v, b.n_extended), vec(b.a, b.n_extended)
    lam, r, values = vec(b.lam, b.m_extended), vec(b.r, b.n_extended), vec(b.values, b.n_values)
    phi, phid, phidd = vec(b.phi, b.m_extended), vec(b.phid, b.m_extended), vec(b.phidd, b.m_extended)
    for e in range(b.count):
        table = mat(b.par + 8 * b.npar * e, 1 + 2 * n, 3)  # u0, S_k, T_k
        at, k = coord[e], row[e, 0]
        u, du, ddu = (table[0, 0], table[0, 1], table[0, 2]), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
        turn, dturn, ddturn = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
        for j in range(n):
            shape = table[1 + j, 0], table[1 + j, 1], table[1 + j, 2]
            twist = table[1 + n + j, 0], table[1 + n + j, 1], table[1 + n + j, 2]
            w, dw, ddw = q[at[LOCAL + j]], v[at[LOCAL + j]], a[at[LOCAL + j]]
            u, du, ddu = plus(u, times(w, shape)), plus(du, times(dw, shape)), plus(ddu, times(ddw, shape))
            turn, dturn = plus(turn, times(w, twist)), plus(dturn, times(dw, twist))
            ddturn = plus(ddturn, times(ddw, twist))
        f, p = four(q, at, 3, 0.0), four(q, at, BODY + 3, 0.0)
        force, moment, pull = (
            (lam[k], lam[k + 1], lam[k + 2]), (lam[k + 3], lam[k + 4], lam[k + 5]), lam[k + 6]
        )  # fmt: skip
        columns = turning(p, u)
        if job == RESIDUAL:
            df, ddf, dp, ddp = four(v, at, 3, 0.0), four(a, at, 3, 0.0), four(v, at, 10, 0.0), four(a, at, 10, 0.0)
            by_rate = along(turning(dp, u), dp)
            arm, arm_rate = turned(columns, p), plus(along(columns, dp), turned(turning(p, du), p))
            arm_second = plus(plus(along(columns, ddp), by_rate), turned(turning(p, ddu), p))
            arm_second = plus(arm_second, times(2.0, along(turning(p, du), dp)))
            relative, rate = body_rate(p, f), plus(body_rate(dp, f), body_rate(p, df))
            second = plus(plus(body_rate(ddp, f), body_rate(p, ddf)), times(2.0, body_rate(dp, df)))
            norm, norm_rate, norm_second = -1.0, 0.0, 0.0
            of_arm, of_f, of_p = onto(columns, force), of_body_torque(p, moment), of_body_torque(f, moment)
            for i in range(3):
                phi[k + i] = q[at[i]] - q[at[BODY + i]] - arm[i]
                phid[k + i] = v[at[i]] - v[at[BODY + i]] - arm_rate[i]
                phidd[k + i] = a[at[i]] - a[at[BODY + i]] - arm_second[i]
                phi[k + 3 + i] = 2.0 * relative[i] - turn[i]
                phid[k + 3 + i] = 2.0 * rate[i] - dturn[i]
                phidd[k + 3 + i] = 2.0 * second[i] - ddturn[i]
                r[at[i]] += force[i]
                r[at[BODY + i]] -= force[i]
            for i in range(4):
                norm += f[i] * f[i]
                norm_rate += 2.0 * f[i] * df[i]
                norm_second += 2.0 * (f[i] * ddf[i] + df[i] * df[i])
                r[at[3 + i]] += 2.0 * (of_f[i] + f[i] * pull)
                r[at[BODY + 3 + i]] -= of_arm[i] + 2.0 * of_p[i]
            phi[k + 6], phid[k + 6], phidd[k + 6] = norm, norm_rate, norm_second
            for j in range(n):
                shape = table[1 + j, 0], table[1 + j, 1], table[1 + j, 2]
                twist = table[1 + n + j, 0], table[1 + n + j, 1], table[1 + n + j, 2]
                r[at[LOCAL + j]] -= dot(turned(turning(p, shape), p), force) + dot(twist, moment)
        else:
            c_q = vec(b.coef, 2)[0]
            slot = imat(b.slot_s + 8 * width * width * e, width, width)
            jacobian = imat(b.slot_j + 8 * ROWS * width * e, ROWS, width)
            transposed = imat(b.slot_jt + 8 * ROWS * width * e, ROWS, width)
            add_bend(values, slot, BODY + 3, -c_q, force, u)
            of_f, of_p = body_axes(p), body_axes(f)
            for side in range(2):
                to = transposed if side else jacobian
                for i in range(3):
                    values[to[i, i]] += 1.0
                    values[to[i, BODY + i]] -= 1.0
                    for j in range(4):
                        values[to[i, BODY + 3 + j]] -= columns[j][i]
                        values[to[3 + i, 3 + j]] += 2.0 * of_f[j][i]
                        values[to[3 + i, BODY + 3 + j]] -= 2.0 * of_p[j][i]
                for j in range(4):
                    values[to[6, 3 + j]] += 2.0 * f[j]
            for j in range(4):
                values[slot[3 + j, 3 + j]] += 2.0 * c_q * pull
            # d(2 G(p)^T y)/dp = 2 [[0, -y^T], [y, -y~]] in the rows of f, reversed in those of p
            for side in range(2):
                sign = 2.0 * c_q * (1.0 - 2.0 * side)
                x, y, z = times(sign, moment)
                own, other = 3 + BODY * side, 3 + BODY * (1 - side)
                values[slot[own, other + 1]] -= x
                values[slot[own, other + 2]] -= y
                values[slot[own, other + 3]] -= z
                values[slot[own + 1, other]] += x
                values[slot[own + 2, other]] += y
                values[slot[own + 3, other]] += z
                values[slot[own + 1, other + 2]] += z
                values[slot[own + 1, other + 3]] -= y
                values[slot[own + 2, other + 1]] -= z
                values[slot[own + 2, other + 3]] += x
                values[slot[own + 3, other + 1]] += y
                values[slot[own + 3, other + 2]] -= x
            for j in range(n):
                shape = table[1 + j, 0], table[1 + j, 1], table[1 + j, 2]
                moving = turning(p, shape)
                placed, by = turned(moving, p), onto(moving, force)
                for i in range(3):
                    values[jacobian[i, LOCAL + j]] -= placed[i]
                    values[transposed[i, LOCAL + j]] -= placed[i]
                    values[jacobian[3 + i, LOCAL + j]] -= table[1 + n + j, i]
                    values[transposed[3 + i, LOCAL + j]] -= table[1 + n + j, i]
                for i in range(4):
                    values[slot[LOCAL + j, BODY + 3 + i]] -= c_q * by[i]
                    values[slot[BODY + 3 + i, LOCAL + j]] -= c_q * by[i]


class InterfaceFrame3D(SpatialFrame):
    """The frame of an interface of a ReducedBody3D: a massless frame that moves and turns with it.

    Joints, forces, drivers, contacts and outputs take it like a rigid body. Its attitude is that of the body's frame
    turned by the interface's small rotation. Channels force_x, ..., torque_x, ... are the load that it hands on to the
    body, at its point, along the axes of space.

    Raises
    ------
    ModelError : if `body` is no ReducedBody3D, or has no such interface.
    """

    type: Literal["InterfaceFrame3D"] = "InterfaceFrame3D"
    kernel: ClassVar[Any] = interface_frame3d_kernel

    body: Name
    """Name of the reduced body."""
    interface: Name
    """Name of its interface."""

    def coordinate_records(self) -> Sequence[Coordinate]:
        return (X, Y, Z, *EULER)

    def check_in(self, bodies: Mapping[str, BodyElement]) -> None:
        """Refuse what is no reduced body, and interfaces that it lacks."""
        body_named(self.name, "an interface", self.body, ReducedBody3D, bodies).interface(self.interface)

    def acts_on(self) -> frozenset[str]:
        return super().acts_on() | {self.body}

    def start_in(
        self, bodies: Mapping[str, BodyElement], inputs: Mapping[str, float] = NO_INPUTS
    ) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """(q0, v0) that follow from the body's. Raises ModelError for a rotation beyond 2 rad."""
        body = body_named(self.name, "an interface", self.body, ReducedBody3D, bodies)
        place, (q, v) = body.interface(self.interface), (np.array(x) for x in body.start_in(bodies, inputs))
        shape = np.array(place.shape)
        rotation = np.zeros_like(shape) if place.rotation is None else np.array(place.rotation)
        p, rate, half, half_rate = tuple(q[3:7]), tuple(v[3:7]), 0.5 * q[7:] @ rotation, 0.5 * v[7:] @ rotation
        if not half @ half < 1.0:
            raise ModelError(f"'{self.name}' starts turned by {2.0 * half} rad against the frame of '{self.body}': the "
                             "amplitudes of a reduced body are small displacements")  # fmt: skip
        cosine = math.sqrt(1.0 - half @ half)
        turn, turn_rate = (cosine, *half.tolist()), (-float(half @ half_rate) / cosine, *half_rate.tolist())
        f_rate = np.add(product(rate, turn), product(p, turn_rate))
        # p'* p is half the angular velocity in the frame
        spin, u = 2.0 * np.array(product((p[0], -p[1], -p[2], -p[3]), rate)[1:]), place.point + q[7:] @ shape
        axes = rotation_matrix(p)
        point, moved = q[:3] + axes @ u, v[:3] + axes @ (np.cross(spin, u) + v[7:] @ shape)
        return (*point.tolist(), *product(p, turn)), (*moved.tolist(), *f_rate.tolist())

    def form_in(self, bodies: Mapping[str, BodyElement]) -> Form:
        n = len(body_named(self.name, "an interface", self.body, ReducedBody3D, bodies).stiffness)
        own, turn, local = range(3, 7), range(BODY + 3, LOCAL), range(LOCAL, LOCAL + n)
        blocks = ((own, own), (own, turn), (turn, own), (turn, turn), (turn, local), (local, turn))
        pattern = tuple(sorted({(i, j) for rows, columns in blocks for i in rows for j in columns}))
        jacobian = (
            *((i, j) for i in range(3) for j in (i, BODY + i, *turn, *local)),
            *((3 + i, j) for i in range(3) for j in (*own, *turn, *local)),
            *((6, j) for j in own),
        )
        return Form(type(self).kernel, ROWS, pattern, jacobian)

    def row(self, numbering: Numbering) -> Row:
        body = body_named(self.name, "an interface", self.body, ReducedBody3D, numbering.bodies)
        place = body.interface(self.interface)
        rotation = np.zeros((len(place.shape), 3)) if place.rotation is None else np.array(place.rotation)
        carried = [numbering.coordinate(self.body, name) for name in body.coordinate_names]
        parameters = np.concatenate([[place.point], place.shape, rotation]).ravel()
        return Row(tuple(parameters.tolist()), (*numbering.coordinates(self.name)[:7], *carried))

    def derived_channels(self, numbering: Numbering, rows: Sequence[int]) -> Sequence[Derived]:
        own = numbering.coordinates(self.name)[:7]
        turn = numbering.coordinates(self.body)[3:7]
        return AngularVelocity(self.name, own[3:]), InterfaceLoad(self.name, own[3:], turn, rows)
