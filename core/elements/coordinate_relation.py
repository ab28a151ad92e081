"""Relation between coordinates: a sum of them, times factors, stays what it is. Phi = sum f_k q_k - offset."""

from collections.abc import Sequence
from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field, model_validator

from ..compiled.jit import internal
from ..compiled.kernels import RESIDUAL, TANGENT
from ..compiled.views import imat, mat, vec
from ..model.base import Name, Record
from ..model.channels import Channel
from .base import Form, JointElement, Numbering, Row
from .coordinate import UNKNOWN_UNIT


@internal
def coordinate_relation_kernel(job: int, t: float, b: Any) -> None:
    if job != RESIDUAL and job != TANGENT:
        return
    n = b.ncoord
    par, coord, row = mat(b.par, b.count, b.npar), imat(b.coord, b.count, n), imat(b.row, b.count, 1)
    q, v, a = vec(b.q, b.n_extended), vec(b.v, b.n_extended), vec(b.a, b.n_extended)
    r, lam = vec(b.r, b.n_extended), vec(b.lam, b.m_extended)
    for e in range(b.count):
        k = row[e, 0]
        if job == TANGENT:
            values = vec(b.values, b.n_values)
            for i in range(n):
                values[imat(b.slot_j, b.count, n)[e, i]] += par[e, 1 + i]
                values[imat(b.slot_jt, b.count, n)[e, i]] += par[e, 1 + i]
            continue
        phi, phid, phidd = -par[e, 0], 0.0, 0.0
        for i in range(n):
            at, f = coord[e, i], par[e, 1 + i]
            phi += f * q[at]
            phid += f * v[at]
            phidd += f * a[at]
            r[at] += f * lam[k]
        vec(b.phi, b.m_extended)[k] = phi
        vec(b.phid, b.m_extended)[k] = phid
        vec(b.phidd, b.m_extended)[k] = phidd


class RelationTerm(Record):
    """A coordinate of a body times a factor."""

    body: Name
    """Name of the body."""
    coordinate: Name
    """"x", "y" or "angle" of a planar body, or the name of one of any other body's."""
    factor: float = 1.0
    """Times which the coordinate counts."""


class CoordinateRelation(JointElement):
    """The sum of `terms`, coordinates times factors, stays `offset`: a transmission, a coupling, a symmetry.

    It holds coordinates as they are counted, in the inertial frame; its force on each is -(factor) (multiplier).
    Channel: the multiplier.
    """

    type: Literal["CoordinateRelation"] = "CoordinateRelation"
    kernel: ClassVar[Any] = coordinate_relation_kernel
    constraint_rows: ClassVar[int] = 1

    terms: Annotated[tuple[RelationTerm, ...], Field(min_length=1)]
    """Their sum is held at `offset`."""
    offset: float = 0.0
    """In the unit of the terms."""

    @model_validator(mode="after")
    def _check(self) -> "CoordinateRelation":
        if len(set(self.moved_coordinates())) < len(self.terms):
            raise ValueError(f"relation '{self.name}' names a coordinate twice: add its factors up")
        if any(term.factor == 0.0 for term in self.terms):
            raise ValueError(f"relation '{self.name}' has a term with factor 0, which relates nothing: leave it out")
        return self

    @property
    def linear(self) -> bool:
        return True

    def form(self) -> Form:
        return Form(coordinate_relation_kernel, 1, (), tuple((0, j) for j in range(len(self.terms))))

    def moved_coordinates(self) -> Sequence[tuple[str, str]]:
        return tuple((term.body, term.coordinate) for term in self.terms)

    def row(self, numbering: Numbering) -> Row:
        indices = [numbering.coordinate(term.body, term.coordinate) for term in self.terms]
        return Row((self.offset, *(term.factor for term in self.terms)), indices)

    def multiplier_channels(self) -> Sequence[Channel]:
        return (Channel(f"{self.name}.multiplier", UNKNOWN_UNIT, "force against the growth of its sum"),)
