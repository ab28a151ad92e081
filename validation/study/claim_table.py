"""C1 to C7 at once: each claim with its verdict, the figures that it follows from, and the command that makes them."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any

from ...core import ModelError
from .claims import Claim, first_claim, second_claim
from .contact_claim import fourth_claim
from .contact_failure import ContactRow, contact_study
from .contact_levels import contact_levels, sixth_claim
from .damping import damping_study, fifth_claim
from .force_claim import restitutions, seventh_claim
from .iterations import iteration_study
from .orders import order_table
from .stiffness import stiffness_study

NAMES = ("C1", "C2", "C3", "C4", "C5", "C6", "C7")
DAMPING_CLAIM = "HHT damps the oscillation that an impact excites differently inside TLISMNI and on GGL"
VERDICTS = {
    "holds": "reproduced", "holds in part": "in part", "does not hold": "not", "does not hold here": "not",
    "open": "open",
}  # fmt: skip


@dataclass(frozen=True)
class ClaimRow:
    """A row of the table."""

    claim: Claim

    @property
    def verdict(self) -> str:
        """ "reproduced", "in part", "not" or "open"."""
        return VERDICTS[self.claim.verdict]

    @property
    def command(self) -> str:
        """What makes this row's figures."""
        return f"tlismni study claims {self.claim.name}"

    def to_dict(self) -> dict[str, Any]:
        """Plain data."""
        return {**self.claim.to_dict(), "verdict": self.verdict, "command": self.command}


def claim_table(
    only: Iterable[str] | None = None, *, quick: bool = False, tell: Callable[[str, float], None] | None = None
) -> tuple[ClaimRow, ...]:
    """Run what the claims need, and judge them.

    Parameters
    ----------
    only : "C1" ... "C7"; None: all. quick : the short form of each study: a first look, not for quoting.
    tell : called with what has been done, and the share of it (0 ... 1).

    Raises
    ------
    ModelError : for a claim that there is not.
    """
    chosen = tuple(dict.fromkeys(only or NAMES))
    unknown = [name for name in chosen if name not in NAMES]
    if unknown:
        raise ModelError(f"there is no claim {unknown}; there are {list(NAMES)}")
    contact: list[tuple[ContactRow, ...]] = []
    rows = []
    for k, name in enumerate(chosen):
        rows.append(ClaimRow(_claim(name, quick, contact)))
        if tell is not None:
            tell(name, (k + 1) / len(chosen))
    return tuple(rows)


def _claim(name: str, quick: bool, contact: list[tuple[ContactRow, ...]]) -> Claim:
    if name in ("C4", "C6") and not contact:
        contact.append(contact_study(quick=quick))
    if name == "C1":
        return first_claim(order_table(["newmark", "hht"], quick=quick))
    if name == "C2":
        return second_claim(order_table(["bdf", "ebdf"], quick=quick))
    if name == "C3":
        return iteration_study(None, ["hht", "ebdf"], quick=quick).claims[-1]
    if name == "C4":
        return fourth_claim(contact[0])
    if name == "C5":
        verdict, observed = fifth_claim(damping_study(quick=quick))
        return Claim("C5", DAMPING_CLAIM, verdict, tuple(observed), {})
    if name == "C6":
        return sixth_claim(contact[0], contact_levels())
    return seventh_claim(stiffness_study(quick=quick), restitutions())
