"""Contact as a constraint (CCM): impact law of Newton, gap >= 0 held exactly while the contact lasts."""

from typing import Annotated, Literal

from pydantic import Field

from ...model.base import Record, Restitution


class NewtonImpact(Record):
    """g' after = -e g' before; closed contact is a constraint, opened when its force would become tensile.

    Rest rule: an impact whose separation speed would be below `rest_ratio` times the largest approach speed that
    the contact has seen, and whose gap would close again (g'' < 0), closes the contact for good: e = 0 there.
    """

    type: Literal["NewtonImpact"] = "NewtonImpact"
    restitution: Restitution
    rest_ratio: Annotated[float, Field(ge=0.0, lt=1.0)] = 1e-6
