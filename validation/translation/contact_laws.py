"""Contact force laws as parameters of exudyn's contact objects.

exudyn (1.13): F = k d^n (1 + chi d'/v0) + c d', with chi = 0 (model 0), chi = 3 (1 - e)/2 (model 1), or
chi = 3 (1 - e)(11 - e)/(2 (1 + 9 e)) for e > 1/3 and (1 - e^2)/e below (model 2). Ours is the same form with
D for chi. Hunt-Crossley is exudyn's model 1 and Carvalho-Martins its model 2 with the same e; the other laws of the
family become model 2 with the e whose chi is their D: model 2 reaches every D >= 0, so the law is exact, not
approximated.
"""

import math
from typing import Any

from ...core.laws import CarvalhoMartins, Hertz, HuntCrossley, ImpactLaw, KelvinVoigt
from ...core.laws.hunt_crossley import HuntCrossleyFamily
from ..errors import NotTranslatable

_LARGEST_CHI_OF_FIRST_BRANCH = 8.0 / 3.0  # both branches of model 2 give this at e = 1/3
_NEARLY_ELASTIC = 1.0 - 1e-15


def is_native(record: Any, on_flexible: bool) -> bool:
    """Whether exudyn's contact objects have the law of a contact, and it has no friction.

    Raises NotTranslatable for constraint contact.
    """
    if isinstance(record.law, ImpactLaw):
        contact_parameters(record.law, record.name)
    law = record.law
    # letting go early needs the state of bodies, which points of flexible bodies do not have in exudyn
    early = on_flexible and law.release == "force" and type(law) is KelvinVoigt
    family = isinstance(law, HuntCrossleyFamily) and type(law).formula is HuntCrossleyFamily.formula
    return record.friction is None and (family or type(law) in (KelvinVoigt, Hertz)) and not early


def contact_parameters(law: object, contact: str) -> dict[str, float | int]:
    """Fields of exudyn's contact objects that make up `law`.

    Of Kelvin-Voigt only the force: exudyn holds on until the gap opens, the law may let go at zero force.

    Raises
    ------
    NotTranslatable : for constraint contact and for laws that are not of exudyn's form.
    """
    if isinstance(law, ImpactLaw):
        raise NotTranslatable(
            f"contact '{contact}' is a constraint ({type(law).__name__}), and exudyn has contact by force only. "
            "`crosscheck` compares it with the limit of three force laws of growing stiffness instead"
        )
    # a subclass may have a formula of its own: only the family's members are known by more than their type
    if type(law) is KelvinVoigt:
        fields = _fields(law.stiffness, 1.0, 0, 1.0, law.least_approach_speed())
        return {**fields, "contactDamping": law.damping}
    if type(law) is Hertz:
        return _fields(law.stiffness, law.exponent, 0, 1.0, law.least_approach_speed())
    if not isinstance(law, HuntCrossleyFamily) or type(law).formula is not HuntCrossleyFamily.formula:
        raise NotTranslatable(f"contact '{contact}' has law {type(law).__name__}, which exudyn has no form of")
    if type(law) is HuntCrossley and law.restitution > 0.0:
        model, e = 1, law.restitution
    elif type(law) is CarvalhoMartins:
        model, e = 2, min(law.restitution, _NEARLY_ELASTIC)
    else:
        model, e = 2, restitution_for(law.damping_factor())
    return _fields(law.stiffness, law.exponent, model, e, law.least_approach_speed())


def restitution_for(damping_factor: float) -> float:
    """The e with which exudyn's model 2 has chi = damping_factor >= 0."""
    d = damping_factor
    if d > _LARGEST_CHI_OF_FIRST_BRANCH:
        return 0.5 * (math.sqrt(d * d + 4.0) - d)
    b = 18.0 + 9.0 * d
    # smaller root of 3 e^2 / 2 - b e + 33/2 - d = 0, written without cancellation
    c = 16.5 - d
    return min(2.0 * c / (b + math.sqrt(b * b - 6.0 * c)), _NEARLY_ELASTIC)


def _fields(stiffness: float, exponent: float, model: int, e: float, minimum: float) -> dict[str, float | int]:
    return {
        "contactStiffness": stiffness,
        "contactStiffnessExponent": exponent,
        "impactModel": model,
        "restitutionCoefficient": e,
        "minimumImpactVelocity": minimum,
    }
