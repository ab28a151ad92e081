"""How the impact of a contact is solved, as a number that compiled code asks for."""

from ..errors import ModelError
from ..laws import ForceLaw, ImpactLaw, NewtonImpact, PoissonImpact

FORCE, MASSLESS, NEWTON, POISSON, SEQUENTIAL = range(5)
"""Not at all, since it is a force, or at a massless end; by Newton's law at once, by Poisson's, or by Newton's one blow
after another."""


def code_of(law: ImpactLaw | ForceLaw, massless: bool) -> int:
    """The code of a contact's law; `massless`: it is at a massless end.

    Raises
    ------
    ModelError : for another law.
    """
    if isinstance(law, ForceLaw):
        return FORCE
    if massless:
        return MASSLESS
    if isinstance(law, NewtonImpact):
        return NEWTON if law.propagation == "simultaneous" else SEQUENTIAL
    if isinstance(law, PoissonImpact):
        return POISSON
    raise ModelError(f"impact law {type(law).__name__} is not known: give NewtonImpact or PoissonImpact")
