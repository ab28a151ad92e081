"""A material point of a cable in space: a massless point with x, y, z, tied to it by three linear rows.

Phi = p - (w_0 r_0 + w_1 s_0 + w_2 r_1 + w_3 s_1), w the shape functions there. The multipliers are the load on the
point, handed on to the cable.
"""

from collections.abc import Mapping, Sequence
from typing import Any, ClassVar, Literal

from ..compiled.jit import internal
from ..compiled.kernels import RESIDUAL, TANGENT
from ..compiled.views import imat, mat, vec
from ..model.base import Name, NonNegative
from ..model.channels import Channel
from ..model.markers import Marker
from .base import NO_INPUTS, BodyElement, Numbering, Row
from .cable3d import Cable3D
from .coordinate import Coordinate, X, Y, Z
from .named_body import body_named
from .spatial_body import SpatialFrame

SIZE = 15
"""Coordinates: those of the point, then the twelve of the element."""


@internal
def material_point3d_kernel(job: int, t: float, b: Any) -> None:
    if job != RESIDUAL and job != TANGENT:
        return
    par, coord, row = mat(b.par, b.count, 4), imat(b.coord, b.count, SIZE), imat(b.row, b.count, 3)
    q, v, a = vec(b.q, b.n_extended), vec(b.v, b.n_extended), vec(b.a, b.n_extended)
    phi, phid, phidd = vec(b.phi, b.m_extended), vec(b.phid, b.m_extended), vec(b.phidd, b.m_extended)
    lam, r, values = vec(b.lam, b.m_extended), vec(b.r, b.n_extended), vec(b.values, b.n_values)
    slot_j, slot_jt = imat(b.slot_j, b.count, 3 * SIZE), imat(b.slot_jt, b.count, 3 * SIZE)
    for e in range(b.count):
        for c in range(3):
            k, own = row[e, c], coord[e, c]
            if job == RESIDUAL:
                phi[k], phid[k], phidd[k] = q[own], v[own], a[own]
                r[own] += lam[k]
                for i in range(4):
                    w, at = par[e, i], coord[e, 3 + 3 * i + c]
                    phi[k] -= w * q[at]
                    phid[k] -= w * v[at]
                    phidd[k] -= w * a[at]
                    r[at] -= w * lam[k]
            else:
                for transposed in range(2):
                    slot = slot_jt if transposed else slot_j
                    values[slot[e, c * SIZE + c]] += 1.0
                    for i in range(4):
                        values[slot[e, c * SIZE + 3 + 3 * i + c]] -= par[e, i]


class MaterialPoint3D(SpatialFrame):
    """A point of a Cable3D, s m along the undeformed cable, with coordinates x, y, z.

    Joints, forces, drivers, contacts and outputs take it like a point mass. It has no mass, it only moves along; it has
    no attitude, since the cable has no torsion. Channels force_x, force_y, force_z are the load that it hands on to the
    cable.

    Raises
    ------
    ModelError : if `body` is no Cable3D, or has no such point.
    """

    type: Literal["MaterialPoint3D"] = "MaterialPoint3D"
    kernel: ClassVar[Any] = material_point3d_kernel
    constraint_rows: ClassVar[int] = 3
    jacobian_pattern: ClassVar[Sequence[tuple[int, int]]] = tuple(
        (c, j) for c in range(3) for j in (c, *(3 + 3 * i + c for i in range(4)))
    )

    body: Name
    """Name of the cable."""
    s: NonNegative
    """Where along the undeformed cable, m."""

    @property
    def linear(self) -> bool:
        return True

    def coordinate_records(self) -> Sequence[Coordinate]:
        return (X, Y, Z)

    def check_in(self, bodies: Mapping[str, BodyElement]) -> None:
        """Refuse what is no cable, and points beyond it."""
        body_named(self.name, "at a point", self.body, Cable3D, bodies).point(self.s)

    def check_marker(self, user: str, marker: Marker) -> None:
        super().check_marker(user, marker)
        if not marker.at_origin:
            raise ValueError(
                f"'{user}' has a marker at {marker.point} of material point '{self.name}', which has no extension: use "
                "(0, 0, 0)"
            )

    def acts_on(self) -> frozenset[str]:
        return super().acts_on() | {self.body}

    def start_in(
        self, bodies: Mapping[str, BodyElement], inputs: Mapping[str, float] = NO_INPUTS
    ) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """(q0, v0) that follow from the cable's."""
        cable = body_named(self.name, "at a point", self.body, Cable3D, bodies)
        point, names = cable.point(self.s), cable.coordinate_names
        places = [names.index(name) for name in point.names]
        q, v = (
            tuple(sum(w * x[places[3 * i + c]] for i, w in enumerate(point.shape.tolist())) for c in range(3))
            for x in cable.start_in(bodies, inputs)
        )
        return q, v

    def row(self, numbering: Numbering) -> Row:
        point = body_named(self.name, "at a point", self.body, Cable3D, numbering.bodies).point(self.s)
        cable = [numbering.coordinate(self.body, name) for name in point.names]
        return Row(tuple(point.shape.tolist()), (*numbering.coordinates(self.name)[:3], *cable))

    def multiplier_channels(self) -> Sequence[Channel]:
        return tuple(Channel(f"{self.name}.force_{c}", "N", f"load at {self.name} on its cable, {c}") for c in "xyz")
