"""Which of the touching contacts press: forces that are more than rounding."""

from typing import Any

from ..assembly.levels import position_level
from ..compiled.jit import internal
from ..compiled.views import ivec, vec
from ..rounding import FORCE_ROUNDING
from ..state.workspace_records import CONTROL_SIZE, ENERGY_SCALE
from .records import COUNT, F_N, LOADED, col, whole


@internal
def note_loaded(ev: Any, ws: Any) -> None:
    """Which touching contacts press, to `LOADED`."""
    count, contacts, largest = whole(ev)[COUNT], ivec(ev.contacts, ev.most), vec(ws.control, CONTROL_SIZE)[ENERGY_SCALE]
    level, rows, scale = position_level(ws), ivec(ws.contact_rows, ws.n_contacts), vec(ws.row_scale, ws.m_ext)
    f_n, loaded = col(ev, F_N), col(ev, LOADED)
    for i in range(count):
        largest = max(largest, f_n[i] * level * scale[rows[contacts[i]]])
    for i in range(count):
        loaded[i] = f_n[i] > FORCE_ROUNDING * largest / (level * scale[rows[contacts[i]]])


@internal
def is_loaded(ev: Any, i: int) -> bool:
    """True if touching contact i presses."""
    return bool(col(ev, LOADED)[i] != 0.0)
