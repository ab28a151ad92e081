"""C7: what the choice of a contact force and of its parameters does to an impact."""

from collections.abc import Sequence

from ...core import simulate
from ...models import load
from .claims import Claim
from .stiffness import ATOL, RTOL, StiffnessRow

CLAIM = "A continuous contact force of the same impact depends on the choice of its parameters, its weak point"
LAWS = (
    "kelvin_voigt", "tsuji", "hunt_crossley", "herbert_mcwhannell", "lee_wang", "lankarani_nikravesh", "gonthier",
    "gonthier_approximate", "zhiying_qishao", "flores", "hu_guo",
)  # fmt: skip
"""Those that take a restitution."""
ASKED = 0.5
"""Restitution that each is given; the constraint gives it exactly."""
MEANT = 0.02
"""A law whose restitution is off by less gives what it was asked for."""


def restitutions(asked: float = ASKED) -> dict[str, float]:
    """Separation over approach speed of the first blow of a ball, by law."""
    found = {}
    for law in ("newton", *LAWS):
        scenario = load("bouncing_ball", law=law, restitution=asked)
        events = simulate(scenario.model, 0.7, rtol=RTOL, atol=ATOL).events
        begins = next(event for event in events if event.kind in ("impact", "close"))
        ends = next(event for event in events if event.kind in ("impact", "open"))
        found[law] = ends.separation_speed / begins.approach_speed
    return found


def seventh_claim(rows: Sequence[StiffnessRow], found: dict[str, float]) -> Claim:
    """C7: duration, place and impulse by stiffness; the restitution that laws give for the one that is asked for."""
    right = sum(row.ok for row in rows)
    forces = {law: value for law, value in found.items() if law != "newton"}
    off = [law for law, value in forces.items() if abs(value - ASKED) > MEANT]
    depends = right == len(rows) and bool(off)
    places = [abs(row.differences[-1][1]) for row in rows]
    exponents = {
        n: [rate for row in rows if row.case.exponent == n for rate in row.rates[:2]]
        for n in dict.fromkeys(row.case.exponent for row in rows)
    }
    least, most = min(forces, key=forces.__getitem__), max(forces, key=forces.__getitem__)
    return Claim(
        "C7",
        CLAIM,
        "holds" if depends else "holds in part" if right or off else "does not hold",
        (
            "duration and place come to the constraint's as K^p, p = "
            + "; ".join(f"{min(x):.3f} ... {max(x):.3f} for n = {n:g}" for n, x in exponents.items())
            + f"; {right} of {len(rows)} cases as in theory",
            f"at K = {rows[0].stiffnesses[-1]:.0e} N/m^n, 1 kg, places still differ by {min(places):.1e} ... "
            f"{max(places):.1e} m or rad",
            f"asked for a restitution of {ASKED:g}, {len(forces)} laws give {forces[least]:.3f} ({least}) ... "
            f"{forces[most]:.3f} ({most}), {len(off)} of them off by more than {MEANT:g}; the constraint gives "
            f"{found['newton']:.6f}",
        ),
        {"restitutions": found, "exponents": {f"{n:g}": x for n, x in exponents.items()}, "places": places},
    )
