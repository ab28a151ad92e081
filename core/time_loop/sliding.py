"""Which contacts slide: while any does, each step is looked at, whether it has gone over a place where friction jams
(`simulation/painleve.py` says what that means)."""

from typing import Any

from ..compiled.jit import internal
from ..compiled.views import mat
from ..state.modes import CLOSED, MEMORY_SIZE, MODE, RATIO, SLIDE


@internal
def slides(ws: Any, k: int) -> bool:
    """True if the friction of closed contact k is in proportion to its normal force because it slides."""
    memory = mat(ws.memory, ws.n_contacts, MEMORY_SIZE)[k]
    return memory[MODE] == CLOSED and abs(memory[SLIDE]) == 1.0 and memory[RATIO] != 0.0


@internal
def any_slides(ws: Any) -> bool:
    """True if a closed contact slides."""
    found = False
    for k in range(ws.n_contacts):
        found = found or slides(ws, k)
    return found
