"""Which contacts slide: while any does, each step is looked at, whether it has gone over a place where friction jams
(`simulation/painleve.py` says what that means)."""

from typing import Any

from ..compiled.jit import internal
from ..state.modes import CLOSED, memories_at


@internal
def slides(workspace: Any, k: int) -> bool:
    """True if the friction of closed contact k is in proportion to its normal force because it slides."""
    memory = memories_at(workspace.memory, workspace.n_contacts)[k]
    return memory.mode == CLOSED and abs(memory.slide_mode) == 1.0 and memory.friction_ratio != 0.0


@internal
def any_slides(workspace: Any) -> bool:
    """True if a closed contact slides."""
    found = False
    for k in range(workspace.n_contacts):
        found = found or slides(workspace, k)
    return found
