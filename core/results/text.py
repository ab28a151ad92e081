"""A result in words."""

import html
from collections import Counter
from typing import TYPE_CHECKING

import numpy as np

from ..multibody_model import Model
from .names import owners

if TYPE_CHECKING:
    from .result import Result

MOST_OWNERS = 10
COLUMNS = (
    ("t", "time s"), ("kind", "kind"), ("contact", "contact"), ("impulse", "impulse"), ("approach_speed", "approach"),
    ("separation_speed", "separation"), ("energy_loss", "loss J"),
)  # fmt: skip


def facts(result: "Result") -> list[tuple[str, str]]:
    """What a result is, as pairs of a word and its meaning."""
    t = result.t
    span = f"{t[0]:.6g} to {t[-1]:.6g} s, {len(t)} samples" if len(t) else "no samples"
    steps = f", {int(result.stats['steps'])} steps" if "steps" in result.stats else ""
    wall = f" in {result.stats['wall_time']:.3g} s" if "wall_time" in result.stats else ""
    found = [("time", f"{span}{steps}{wall}")]
    if result.settings:
        chosen = result.settings
        step = chosen.get("step")
        control = f"step {step:g} s" if step is not None else f"rtol {chosen['rtol']:g}, atol {chosen['atol']!r}"
        found.append(("method", f"{chosen['method']} ({control})"))
        if result.method_chosen:
            found.append(("auto", result.method_chosen))
    kinds = Counter((event.kind, event.contact) for event in result.events)
    listed = [f"{kind} of {contact} {count}" for (kind, contact), count in kinds.most_common(6)]
    more = f" and {len(kinds) - 6} more kinds" if len(kinds) > 6 else ""
    found.append(("events", f"{len(result.events)}: {', '.join(listed)}{more}" if result.events else "none"))
    names = [owner for owner in owners(result.channels) if owner]
    shown = ", ".join(names[:MOST_OWNERS]) + (" ..." if len(names) > MOST_OWNERS else "")
    found.append(("channels", f"{len(result.channels)}{' of ' + shown if shown else ''}"))
    errors = [("constraints", "residual.position", "m")]
    if isinstance(result.system, Model):  # nobody knows the potential energy of user-written equations
        errors.insert(0, ("energy balance", "energy.balance", "J"))
    sizes = [
        f"{what} {float(np.max(np.abs(result[name]))):.1e} {unit}"
        for what, name, unit in errors
        if len(t) and name in result.channels
    ]
    if sizes:
        found.append(("errors", f"{', '.join(sizes)} at most"))
    if result.redundant:
        found.append(("redundant", f"{len(result.redundant)} constraint rows that others imply"))
    return found


def summary(result: "Result") -> str:
    """A result in a few lines."""
    lines = [f"  {word:<10}{meaning}" for word, meaning in facts(result)]
    return "\n".join([f"Result of {name_of(result)}", *lines])


def name_of(result: "Result") -> str:
    """The model's name, or what stands for it."""
    return getattr(result.system, "name", None) or (
        "a system of equations" if result.system is not None else "a stored run"
    )


def summary_html(result: "Result") -> str:
    """The same as a table, for notebooks."""
    rows = "".join(f"<tr><th>{html.escape(w)}</th><td>{html.escape(m)}</td></tr>" for w, m in facts(result))
    return f"<p><b>Result</b> of {html.escape(name_of(result))}</p><table>{rows}</table>"


def event_list(result: "Result", most: int | None = None) -> str:
    """The events as a table of text, the first `most` of them."""
    events = result.events if most is None else result.events[:most]
    rows = [[title for _, title in COLUMNS]]
    rows += [[_cell(getattr(event, name)) for name, _ in COLUMNS] for event in events]
    widths = [max(len(row[k]) for row in rows) for k in range(len(COLUMNS))]
    lines = [
        "  ".join(
            cell.ljust(w) if k in (1, 2) else cell.rjust(w) for k, (cell, w) in enumerate(zip(row, widths, strict=True))
        )
        for row in rows
    ]
    left = len(result.events) - len(events)
    return "\n".join([*(line.rstrip() for line in lines), *([f"... and {left} more"] if left else [])])


def _cell(value: float | str) -> str:
    return value if isinstance(value, str) else f"{value:.9g}" if abs(value) >= 1e-3 or value == 0.0 else f"{value:.4g}"
