"""Which of the touching contacts press: forces that are more than rounding."""

from typing import Any

from ..assembly.levels import position_level
from ..compiled.jit import internal
from ..compiled.views import ivec, vec
from ..rounding import FORCE_ROUNDING
from ..state.workspace_records import control_at
from .records import scalars, touching


@internal
def note_loaded(instant: Any, workspace: Any) -> None:
    """Which touching contacts press, to `loaded`."""
    count, contacts, largest = (
        scalars(instant).count,
        ivec(instant.contacts, instant.most),
        control_at(workspace.control).energy_scale,
    )
    level, rows, scale = (
        position_level(workspace),
        ivec(workspace.contact_rows, workspace.n_contacts),
        vec(workspace.row_scale, workspace.m_ext),
    )
    f_n, loaded = touching(instant).normal_force, vec(instant.loaded, instant.most)
    for i in range(count):
        largest = max(largest, f_n[i] * level * scale[rows[contacts[i]]])
    for i in range(count):
        loaded[i] = f_n[i] > FORCE_ROUNDING * largest / (level * scale[rows[contacts[i]]])


@internal
def is_loaded(instant: Any, i: int) -> bool:
    """True if touching contact i presses."""
    return bool(vec(instant.loaded, instant.most)[i] != 0.0)
