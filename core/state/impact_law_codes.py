"""How the impact of a contact is solved, as a number that compiled code asks for."""

from ..errors import ModelError
from ..laws import ForceLaw, ImpactLaw, NewtonImpact, PoissonImpact

BY_FORCE, AT_MASSLESS, BY_NEWTON, BY_POISSON, BY_NEWTON_IN_TURN = range(5)
"""Not at all, since it is a force, or at a massless end; by Newton's law at once, by Poisson's, or by Newton's one blow
after another."""


def code_of(law: ImpactLaw | ForceLaw, massless: bool) -> int:
    """The code of a contact's law; `massless`: it is at a massless end.

    Raises
    ------
    ModelError : for another law.
    """
    if isinstance(law, ForceLaw):
        return BY_FORCE
    if massless:
        return AT_MASSLESS
    if isinstance(law, NewtonImpact):
        return BY_NEWTON if law.propagation == "simultaneous" else BY_NEWTON_IN_TURN
    if isinstance(law, PoissonImpact):
        return BY_POISSON
    raise ModelError(f"impact law {type(law).__name__} is not known: give NewtonImpact or PoissonImpact")
