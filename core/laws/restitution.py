"""Contact as a constraint (CCM): impact laws, and gap >= 0 held exactly while the contact lasts."""

from typing import Annotated, Literal

from pydantic import Field

from ..model.base import Record, Restitution


class ImpactLaw(Record):
    """Base of the laws of contacts that are constraints; a closed one opens when its force would become tensile.

    Rest rule: an impact whose separation speed would be below `rest_ratio` times the largest approach speed that
    the contact has seen, and whose gap would close again (g'' < 0), closes the contact for good: e = 0 there.
    """

    restitution: Restitution
    rest_ratio: Annotated[float, Field(ge=0.0, lt=1.0)] = 1e-6


class NewtonImpact(ImpactLaw):
    """Newton (1687): g' after = -e g' before, for each contact that takes part with an impulse.

    Several contacts at once: `simultaneous` solves one complementarity problem, 0 <= g'^+ + e g'^- and P >= 0 (Moreau
    1988; three equal balls with e = 1: (1, 0, 0) -> (-1/3, 2/3, 2/3)). `sequential` strikes one contact after another,
    the fastest first, until none approaches ((1, 0, 0) -> (0, 0, 1)).
    """

    type: Literal["NewtonImpact"] = "NewtonImpact"
    propagation: Literal["simultaneous", "sequential"] = "simultaneous"


class PoissonImpact(ImpactLaw):
    """Poisson (1817): a phase of compression that ends with g' >= 0, then at least e times its impulse is given back.

    Equal to Newton's law for one contact without friction. With friction it does not create energy where Newton's law
    may (Kane and Levinson 1985); several contacts: Glocker and Pfeiffer (1995).
    """

    type: Literal["PoissonImpact"] = "PoissonImpact"
