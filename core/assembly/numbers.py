"""Numbers that a workspace takes from its assembly."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..laws import ForceLaw
from ..rounding import ANGLES
from ..state.modes import AT_ZERO_FORCE, AT_ZERO_GAP, AT_ZERO_GAP_OR_FORCE, NO_FORCE_LAW
from .assembly import Assembly

CHEAP = 0.5
"""Share of the entries of all elements up to which evaluating those with constraint rows counts as cheap."""


def sticking(assembly: Assembly) -> NDArray[np.float64]:
    """Coefficients of sticking friction of the contacts, (contacts,); 0: none."""
    return np.array([c.coulomb.sticking_coefficient if c.coulomb else 0.0 for c in assembly.contacts], dtype=np.float64)


def given_compliance(assembly: Assembly) -> NDArray[np.float64]:
    """Compliance that the model gives the joint or contact of each row of Phi, relative to others, (m + 1,)."""
    given = np.ones(assembly.m + 1)
    if assembly.compliance is not None:
        given[: assembly.m] = assembly.compliance
    return given


def level_scale(assembly: Assembly) -> NDArray[np.float64]:
    """What the coordinates are small or large against, (n,)."""
    return np.where(assembly.is_angle, assembly.coordinate_scale / ANGLES, assembly.coordinate_scale)


def constraints_are_cheap(assembly: Assembly) -> bool:
    """Whether evaluating the elements with rows of Phi alone is worth while."""
    sizes = np.array([batch.coord.shape[0] * batch.coord.shape[1] ** 2 for batch in assembly.batches], dtype=float)
    bound = np.array([batch.row.size > 0 for batch in assembly.batches], dtype=bool)
    return bool(sizes[bound].sum() < CHEAP * sizes.sum())


def release(law: Any) -> int:
    """When a contact with this law ends (`modes.AT_ZERO_GAP` and the like)."""
    if not isinstance(law, ForceLaw):
        return NO_FORCE_LAW
    if law.release == "force":
        return AT_ZERO_FORCE
    return AT_ZERO_GAP_OR_FORCE if law.never_pulls else AT_ZERO_GAP
