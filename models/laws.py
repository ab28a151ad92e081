"""Contact laws by their plain names, with the parameters that scenarios share."""

import math

from ..core.laws import LAWS, ContactLaw, NewtonImpact
from ..core.laws.damping_ratio import damping_ratio_without_pull
from ..core.model.channels import Parameter
from .parameters import ScenarioError, ScenarioParameter

HUNT_CROSSLEY_FAMILY = {
    "hunt_crossley": "HuntCrossley",
    "herbert_mcwhannell": "HerbertMcWhannell",
    "lee_wang": "LeeWang",
    "lankarani_nikravesh": "LankaraniNikravesh",
    "gonthier": "Gonthier",
    "gonthier_approximate": "Gonthier",
    "zhiying_qishao": "ZhiyingQishao",
    "flores": "Flores",
    "hu_guo": "HuGuo",
    "carvalho_martins": "CarvalhoMartins",
}
LAW_NAMES = ("newton", "hertz", "kelvin_voigt", "kelvin_voigt_gap", "tsuji", "kuwabara_kono", *HUNT_CROSSLEY_FAMILY)
"""kelvin_voigt ends at zero force, kelvin_voigt_gap at zero penetration."""
DAMPED = ("kelvin_voigt", "kelvin_voigt_gap", "tsuji")
"""The laws that can be given a damping."""
RELAXATION_TIME = 1e-4
"""s; of kuwabara_kono, if none is given."""


def law_parameters(restitution: float, stiffness: float = 1e7) -> tuple[ScenarioParameter, ...]:
    """The parameters that choose and set a contact law."""
    return (
        ScenarioParameter("law", "newton", "-", "newton is a constraint, the others are forces", choices=LAW_NAMES),
        ScenarioParameter(
            "restitution", restitution, "-", "coefficient of restitution (not of hertz, kuwabara_kono)", 0.0, 1.0
        ),
        ScenarioParameter(
            "stiffness",
            stiffness,
            "N/m^n",
            "stiffness of the force laws (kelvin_voigt: N/m; tsuji, kuwabara_kono: n = 1.5)",
            0.0,
            exclusive=True,
        ),
        ScenarioParameter("exponent", 1.5, "-", "n of hertz and of the hunt_crossley family", 1.0),
        ScenarioParameter(
            "damping",
            None,
            "N.s/m",
            "of kelvin_voigt and tsuji (N.s/m^1.25); none: so that the restitution comes out",
            0.0,
            optional=True,
        ),
        ScenarioParameter(
            "relaxation_time",
            None,
            "s",
            f"of kuwabara_kono; none: {RELAXATION_TIME:g}",
            0.0,
            optional=True,
        ),
    )


def contact_law(
    law: str,
    *,
    restitution: float,
    stiffness: float,
    exponent: float,
    damping: float | None,
    relaxation_time: float | None = None,
    mass: float,
) -> ContactLaw:
    """The contact law named `law`. Only the module of that one is imported.

    `mass` (kg) is the effective mass at the contact, from which the damping of Kelvin-Voigt and Tsuji follows if not
    given.

    Raises
    ------
    ScenarioError : for a restitution that the law cannot have, or damping given to a law without any.
    """
    if damping is not None and law not in DAMPED:
        raise ScenarioError(f"law '{law}' takes no damping (given: {damping:g}); laws that do: {', '.join(DAMPED)}")
    if relaxation_time is not None and law != "kuwabara_kono":
        raise ScenarioError(f"law '{law}' takes no relaxation_time (given: {relaxation_time:g}): kuwabara_kono does")
    if law == "newton":
        return NewtonImpact(restitution=restitution)
    if law == "hertz":
        return LAWS["Hertz"](stiffness=stiffness, exponent=exponent)
    if law == "kuwabara_kono":
        time = RELAXATION_TIME if relaxation_time is None else relaxation_time
        return LAWS["KuwabaraKono"](stiffness=stiffness, relaxation_time=time)
    if law == "kelvin_voigt":
        if damping is None:
            damping = 2.0 * kelvin_voigt_damping_ratio(restitution) * math.sqrt(stiffness * mass)
        return LAWS["KelvinVoigt"](stiffness=stiffness, damping=damping)
    if restitution == 0.0 and damping is None and _dissipates_by_restitution(law):
        raise ScenarioError(f"law '{law}' cannot have restitution 0: its damping would be infinite")
    if law == "kelvin_voigt_gap":
        if damping is None:
            loss = -math.log(restitution)
            damping = 2.0 * loss / math.hypot(math.pi, loss) * math.sqrt(stiffness * mass)
        return LAWS["KelvinVoigt"](stiffness=stiffness, damping=damping, release_rule="gap")
    if law == "tsuji":
        if damping is None:
            return LAWS["Tsuji"](stiffness=stiffness, mass=mass, restitution=restitution)
        return LAWS["Tsuji"](stiffness=stiffness, damping=damping)
    if law == "gonthier_approximate":
        return LAWS["Gonthier"](stiffness=stiffness, restitution=restitution, exponent=exponent, variant="approximate")
    return LAWS[HUNT_CROSSLEY_FAMILY[law]](stiffness=stiffness, restitution=restitution, exponent=exponent)


def _dissipates_by_restitution(law: str) -> bool:
    """Whether the law's damping grows beyond all bounds as the restitution goes to zero."""
    from ..core.laws.hunt_crossley import DissipativeFamily

    family = HUNT_CROSSLEY_FAMILY.get(law)
    return family is None or issubclass(LAWS[family], DissipativeFamily)


def kelvin_voigt_damping_ratio(restitution: float) -> float:
    """Damping ratio with which Kelvin-Voigt, released at zero force, gives `restitution` (without gravity).

    Raises
    ------
    ScenarioError : for restitution 0, which needs infinite damping.
    """
    if restitution == 1.0:
        return 0.0
    if restitution < 0.01:
        raise ScenarioError(
            f"law 'kelvin_voigt' reaches restitution {restitution:g} only with extreme damping: "
            "give restitution >= 0.01, or damping"
        )
    return damping_ratio_without_pull(restitution)


def law_model_parameters(contact: str, law: ContactLaw, *others: str) -> tuple[Parameter, ...]:
    """The model parameters that stand as plain fields in the law of `contact`, and of `others` with the same law."""
    rows = (
        ("restitution", "1", 0.0, 1.0, "coefficient of restitution"),
        ("stiffness", "N/m^n", 0.0, None, "contact stiffness"),
        ("damping", "N.s/m", 0.0, None, "contact damping"),
        ("relaxation_time", "s", 0.0, None, "relaxation time of the contact's loss"),
    )
    return tuple(
        Parameter(
            name=name,
            unit=unit,
            minimum=low,
            maximum=high,
            description=text,
            targets=tuple(f"{of}.law.{name}" for of in (contact, *others)),
        )
        for name, unit, low, high, text in rows
        if getattr(law, name, None) is not None
    )
