"""Figures of a comparison of force contact."""

import numpy as np

from ...core import Result
from ..exudyn_run import ExudynResult
from .common import Curve, Panel, Task, Touch, at_times, is_contact_channel, unit_of


def force_panels(task: Task, found: list[Touch], ours: Result, fine: ExudynResult) -> list[Panel]:
    """Whole run for the motion; the first contact for its force and gap; difference of the motion."""
    panels = []
    windows: dict[str, tuple[float, float]] = {}
    origins: dict[str, float] = {}
    for touch in reversed(found):
        margin = 0.2 * (touch.end - touch.start)
        windows[touch.contact] = (touch.start - margin, touch.end + margin)
        origins[touch.contact] = touch.start
    for channel in task.scenario.compare:
        if channel not in fine.channels:
            continue
        contact = channel.split(".")[0]
        window = windows.get(contact) if is_contact_channel(task, channel) else None
        title = f"{channel}, first contact" if window else channel
        keep = slice(None) if window else slice(None, None, max(1, len(fine.t) // 20_000))
        curves = (
            Curve("tlismni", ours.t, ours[channel], True),
            Curve("exudyn", fine.t[keep], fine[channel][keep], False),
        )
        panels.append(Panel(title, unit_of(ours, channel), curves, window, origin=origins.get(contact)))
    motion = [c for c in task.scenario.compare if c in fine.channels and not is_contact_channel(task, c)]
    if motion:
        grid = ours.t[ours.t <= fine.t[-1]]
        differences = tuple(
            Curve(f"{c} ({unit_of(ours, c)})", grid, _difference(c, ours, fine, grid), True) for c in motion
        )
        panels.append(Panel("difference of the motion", "|tlismni - exudyn|", differences, None, True))
    return panels


def _difference(channel: str, ours: Result, fine: ExudynResult, grid: np.ndarray) -> np.ndarray:
    mine = ours[channel][np.searchsorted(ours.t, grid)]
    return np.abs(mine - at_times(fine.t, fine.channels, channel, grid))
