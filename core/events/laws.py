"""How the impact of a contact is solved, as a number that compiled code asks for."""

from ..contact.laws import ForceLaw, ImpactLaw, NewtonImpact, PoissonImpact

OTHER, UNTOUCHED, NEWTON, POISSON, SEQUENTIAL = range(5)
"""By Python; not at all (force laws, contacts at massless ends); by Newton's law at once, by Poisson's, or by Newton's
one blow after another."""


def code_of(law: ImpactLaw | ForceLaw, massless: bool) -> int:
    """The code of a contact's law; `massless`: it is at a massless end."""
    if isinstance(law, ForceLaw) or massless:
        return UNTOUCHED
    if isinstance(law, NewtonImpact):
        return NEWTON if law.propagation == "simultaneous" else SEQUENTIAL
    return POISSON if isinstance(law, PoissonImpact) else OTHER
