"""A contact between generalized coordinates: gap and sliding distance are linear in them.

For end stops of a coordinate, and for systems whose geometry has been linearised.
"""

import math
from collections.abc import Mapping, Sequence
from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field, model_validator

from ..compiled.jit import inlined, internal
from ..compiled.views import imat, mat, vec
from ..elements.base import BodyElement, Numbering, Row
from ..elements.geometry2d import along
from ..laws import ForceLaw
from ..model.base import Name, Record
from ..model.markers import GROUND
from ..model.units import UNKNOWN, parse_unit, product
from .bristle2d import act_bristles
from .contact2d import Contact2D
from .geometry_kinds import LINEAR, are
from .normal2d import act
from .sliding2d import act_sliding

MOST_COORDINATES = 6
GAP_FACTORS = 16
"""First column of the gap's factors in the table of parameters."""
SLIDE_FACTORS = GAP_FACTORS + MOST_COORDINATES


@inlined
def _factors(par: Any, first: int) -> Any:
    """Those of the coordinates."""
    return (par[first], par[first + 1], par[first + 2], par[first + 3], par[first + 4], par[first + 5])


@internal
def coordinate_contact_kernel(job: int, t: float, b: Any) -> None:
    par, coord, q = mat(b.par, b.count, b.npar), imat(b.coord, b.count, 6), vec(b.q, b.n_extended)
    # of length 0: nothing is curved
    flat = vec(b.q, 0)
    for e in range(b.count):
        gradient = _factors(par[e], GAP_FACTORS)
        act(b, job, e, par[e, 0] + along(gradient, q, coord[e]), gradient, flat)


@internal
def sliding_coordinate_contact_kernel(job: int, t: float, b: Any) -> None:
    par, coord, q = mat(b.par, b.count, b.npar), imat(b.coord, b.count, 6), vec(b.q, b.n_extended)
    flat = vec(b.q, 0)
    for e in range(b.count):
        gradient, tangent = _factors(par[e], GAP_FACTORS), _factors(par[e], SLIDE_FACTORS)
        g, s = par[e, 0] + along(gradient, q, coord[e]), along(tangent, q, coord[e])
        act_sliding(b, job, t, e, g, gradient, flat, s, tangent, flat, 0.0)


@internal
def bristle_coordinate_contact_kernel(job: int, t: float, b: Any) -> None:
    par, coord, q = mat(b.par, b.count, b.npar), imat(b.coord, b.count, b.ncoord), vec(b.q, b.n_extended)
    flat = vec(b.q, 0)
    for e in range(b.count):
        gradient, tangent = _factors(par[e], GAP_FACTORS), _factors(par[e], SLIDE_FACTORS)
        act_bristles(b, job, t, e, par[e, 0] + along(gradient, q, coord[e]), gradient, flat, tangent, flat)


class CoordinateTerm(Record):
    """`factor` times a coordinate of a body."""

    body: Name
    """Name of the body."""
    coordinate: Name
    """"x", "y" or "angle" of a planar body, or the name of one of its coordinates."""
    factor: float = 1.0
    """Times which the coordinate counts, in `unit`."""
    unit: str | None = None
    """Unit of the factor: "m/rad" for the radius that makes a length of an angle. Left out: none, where all terms are
    in one unit; m per unit of the coordinate, where they are not."""

    @model_validator(mode="after")
    def _check_unit(self) -> "CoordinateTerm":
        if self.unit is not None and parse_unit(self.unit) is None:
            raise ValueError(
                f"unit '{self.unit}' of the factor of '{self.body}.{self.coordinate}' is not understood: products and "
                "powers of SI units such as 'm/rad' or '1' are"
            )
        return self


def _coordinate_unit(term: CoordinateTerm, bodies: Mapping[str, BodyElement]) -> str | None:
    """Unit of a term's coordinate; None if there is no such coordinate."""
    records = bodies[term.body].coordinate_records() if term.body in bodies else ()
    return next((c.unit for c in records if c.name == term.coordinate), None)


class CoordinateContact(Contact2D):
    """Contact with gap = offset + sum of terms, and sliding distance = sum of slide terms.

    An end stop that keeps a coordinate q below a limit has offset = limit and one term with factor -1.

    Gap and sliding distance have the unit of their terms, (unit of the factor) times (unit of the coordinate): on
    angles with plain factors rad, and then the force is a torque, N m, and a law's stiffness is in N m/rad.

    Raises
    ------
    ModelError : without terms, with more than six coordinates, with friction but without slide terms, or with terms
        whose declared units do not add.
    """

    type: Literal["CoordinateContact"] = "CoordinateContact"
    symbol: ClassVar[str] = "wall"
    touch: ClassVar[str] = "coordinate"
    kernel: ClassVar[Any] = coordinate_contact_kernel
    sliding_kernel: ClassVar[Any] = sliding_coordinate_contact_kernel
    bristle_kernel: ClassVar[Any] = bristle_coordinate_contact_kernel

    offset: float = 0.0
    """Gap at coordinates zero, m or what its terms are in."""
    terms: Annotated[tuple[CoordinateTerm, ...], Field(min_length=1)]
    """Their sum with `offset` is the gap."""
    slide: tuple[CoordinateTerm, ...] = ()
    """Their sum is the sliding distance; none: without friction."""

    @model_validator(mode="after")
    def _check_terms(self) -> "CoordinateContact":
        used = self.moved_coordinates()
        if len(used) > MOST_COORDINATES:
            raise ValueError(
                f"contact '{self.name}' depends on {len(used)} coordinates, at most {MOST_COORDINATES} are possible"
            )
        if not any(term.factor for term in self.terms):
            raise ValueError(f"all factors of contact '{self.name}' are zero: its gap never changes")
        if self.friction is not None and not any(term.factor for term in self.slide):
            raise ValueError(f"contact '{self.name}' has friction but no slide terms: say along what it slides")
        return self

    @property
    def linear(self) -> bool:
        return self.friction is None and not isinstance(self.law, ForceLaw)

    def check_in(self, bodies: Mapping[str, BodyElement]) -> None:
        self.units_in(bodies)

    def units_in(self, bodies: Mapping[str, BodyElement]) -> tuple[str, str]:
        return self._unit("gap", self.terms, bodies), self._unit("sliding distance", self.slide, bodies)

    def _unit(self, what: str, terms: Sequence[CoordinateTerm], bodies: Mapping[str, BodyElement]) -> str:
        """Unit of a sum of terms."""
        found = {}
        for term in terms:
            plain = _coordinate_unit(term, bodies)
            if plain is None or term.factor == 0.0:  # a coordinate that does not exist is refused elsewhere
                continue
            found[f"{term.body}.{term.coordinate}"] = (
                plain if term.unit is None else product(plain, term.unit) or UNKNOWN
            )
        units = set(found.values())
        if len(units) < 2:
            return next(iter(units), "m")
        if all(term.unit is None for term in terms):
            return "m"
        raise ValueError(
            f"the {what} of contact '{self.name}' adds terms in different units, {found}: give every term the `unit` "
            "of its factor that makes them one, such as 'm/rad' for a radius on an angle"
        )

    def moved_coordinates(self) -> Sequence[tuple[str, str]]:
        return tuple(dict.fromkeys((term.body, term.coordinate) for term in (*self.terms, *self.slide)))

    def lengths(self) -> Sequence[float]:
        """How far its coordinates go, but for angles."""
        return tuple(abs(self.offset / t.factor) for t in self.terms if t.factor and t.coordinate != "angle")

    def extent(self) -> float:
        return math.inf

    def row(self, numbering: Numbering) -> Row:
        used = self.moved_coordinates()
        indices = [numbering.coordinate(body, coordinate) for body, coordinate in used]
        indices += [numbering.coordinates(GROUND)[0]] * (MOST_COORDINATES - len(used))
        factors = [[0.0] * MOST_COORDINATES for _ in range(2)]
        for row, terms in zip(factors, (self.terms, self.slide), strict=True):
            for term in terms:
                row[used.index((term.body, term.coordinate))] += term.factor
        law = self._law_columns(numbering)
        return Row(
            (self.offset, *(0.0,) * 6, *law.parameters, *factors[0], *factors[1]), indices, law.extra
        )  # fmt: skip


are(LINEAR, bristle_coordinate_contact_kernel, coordinate_contact_kernel, sliding_coordinate_contact_kernel)
