"""Lines of contact that miss their nodes: by how much, at the start of a model."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from ..assembly.numbering import ModelNumbering
from ..contacts.disk_on_line import DiskOnLine2D
from ..multibody_model import Model


@dataclass(frozen=True)
class MissedNode:
    """The node of a line that its curve passes farthest.

    Attributes
    ----------
    contact : name of the contact.
    node : its number, from 0.
    distance : m.
    """

    contact: str
    node: int
    distance: float


def missed_nodes(system: Any) -> tuple[MissedNode, ...]:
    """For each contact on a line that bends at the start the node that the line passes farthest (`Line2D`); none for a
    system without elements."""
    lines = [c for c in system.contacts if isinstance(c, DiskOnLine2D)] if isinstance(system, Model) else []
    if not lines:
        return ()
    numbering, found = ModelNumbering(system), []
    for contact in lines:
        missed = contact.line.missed(contact.corners_at_start(numbering))
        worst = int(np.argmax(missed))
        if missed[worst] > 0.0:
            found.append(MissedNode(contact.name, worst, float(missed[worst])))
    return tuple(found)
