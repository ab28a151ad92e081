"""How large positions, rates, accelerations and forces are now, in parts of the model's own scales.

Everything that asks whether a number is rounding compares it with a part (`tlismni.core.rounding`) of one of these
levels, times the scale of the coordinate or of the row. Without units, and the same for every unit.
"""

from typing import Any

from ..compiled.jit import compiled, internal
from ..compiled.views import ivec, vec
from ..state.workspace_records import CONTROL_SIZE, ENERGY_SCALE, RATE_SCALE


@internal
def _level(ws: Any, x: Any, least: float) -> float:
    """Largest |x_i| / scale_i, at least `least`; of angles less (`ANGLES`)."""
    scale, largest = vec(ws.level_scale, ws.n), least
    for i in range(ws.n):
        y = abs(x[i]) / scale[i]
        if y > largest:
            largest = y
    return largest


@compiled
def position_level(ws: Any) -> float:
    """Of the coordinates, at least 1."""
    return _level(ws, vec(ws.q, ws.n), 1.0)


@internal
def position_level_at(ws: Any, q: Any) -> float:
    """The same of other coordinates than the present ones."""
    return _level(ws, q, 1.0)


@compiled
def rate_level(ws: Any) -> float:
    """Of the velocities, at least what the model's own time makes, 1/s."""
    return _level(ws, vec(ws.v, ws.n), vec(ws.control, CONTROL_SIZE)[RATE_SCALE])


@internal
def rate_size(ws: Any, k: int) -> float:
    """What the rates of gap and sliding distance of contact k are small or large against, m/s."""
    scale, slide = vec(ws.row_scale, ws.m_ext), ivec(ws.contact_slide_rows, ws.n_contacts)[k]
    along = scale[slide] if slide >= 0 else 0.0
    return rate_level(ws) * max(scale[ivec(ws.contact_rows, ws.n_contacts)[k]], along)


@compiled
def acceleration_level(ws: Any) -> float:
    """Of the accelerations, at least what the model's own time makes, 1/s^2."""
    rate = vec(ws.control, CONTROL_SIZE)[RATE_SCALE]
    return _level(ws, vec(ws.a, ws.n), rate * rate)


@compiled
def force_level(ws: Any) -> float:
    """Of the multipliers, as the work that they do over the scale of their rows: at least the model's own, J."""
    lam, row_scale = vec(ws.lam, ws.m_ext), vec(ws.row_scale, ws.m_ext)
    largest = vec(ws.control, CONTROL_SIZE)[ENERGY_SCALE]
    for i in range(ws.m_ext - 1):
        y = abs(lam[i]) * row_scale[i]
        if y > largest:
            largest = y
    return largest
