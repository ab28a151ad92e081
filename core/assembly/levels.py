"""How large positions, rates, accelerations and forces are now, in parts of the model's own scales.

Everything that asks whether a number is rounding compares it with a part (`tlismni.core.rounding`) of one of these
levels, times the scale of the coordinate or of the row. Without units, and the same for every unit.
"""

from typing import Any

from ..compiled.jit import compiled, internal
from ..compiled.views import ivec, vec
from ..state.workspace_records import control_at


@internal
def _level(workspace: Any, x: Any, least: float) -> float:
    """Largest |x_i| / scale_i, at least `least`; of angles less (`ANGLES`)."""
    scale, largest = vec(workspace.level_scale, workspace.n), least
    for i in range(workspace.n):
        y = abs(x[i]) / scale[i]
        if y > largest:
            largest = y
    return largest


@compiled
def position_level(workspace: Any) -> float:
    """Of the coordinates, at least 1."""
    return _level(workspace, vec(workspace.q, workspace.n), 1.0)


@internal
def position_level_at(workspace: Any, q: Any) -> float:
    """The same of other coordinates than the present ones."""
    return _level(workspace, q, 1.0)


@compiled
def rate_level(workspace: Any) -> float:
    """Of the velocities, at least what the model's own time makes, 1/s."""
    return _level(workspace, vec(workspace.v, workspace.n), control_at(workspace.control).rate_scale)


@internal
def rate_size(workspace: Any, k: int) -> float:
    """What the rates of gap and sliding distance of contact k are small or large against, m/s."""
    scale, slide = (
        vec(workspace.row_scale, workspace.m_ext),
        ivec(workspace.contact_slide_rows, workspace.n_contacts)[k],
    )
    along = scale[slide] if slide >= 0 else 0.0
    return rate_level(workspace) * max(scale[ivec(workspace.contact_rows, workspace.n_contacts)[k]], along)


@compiled
def acceleration_level(workspace: Any) -> float:
    """Of the accelerations, at least what the model's own time makes, 1/s^2."""
    rate = control_at(workspace.control).rate_scale
    return _level(workspace, vec(workspace.a, workspace.n), rate * rate)


@compiled
def force_level(workspace: Any) -> float:
    """Of the multipliers, as the work that they do over the scale of their rows: at least the model's own, J."""
    lam, row_scale = vec(workspace.lam, workspace.m_ext), vec(workspace.row_scale, workspace.m_ext)
    largest = control_at(workspace.control).energy_scale
    for i in range(workspace.m_ext - 1):
        y = abs(lam[i]) * row_scale[i]
        if y > largest:
            largest = y
    return largest
