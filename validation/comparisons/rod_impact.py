"""Elastic rods that strike: our constraint and exudyn's penalty, on four meshes and extrapolated to the rod itself.

Neither has the force history of the rod: ours loses a node's energy at the touch and the force rings; a penalty must
not be stiffer than an element (EA/l), else the end node chatters. What both must give in the limit of fine meshes is
the mean force on the plateau, the time in contact and the impulse (exudyn's penalty, 0.5 EA/l, goes with its mesh).
"""

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ...core import Result, simulate
from ...core.elements import AxialRod
from ...core.laws import Hertz, ImpactLaw
from ...core.multibody_model import Model
from ...models import Scenario, load
from ..errors import NotTranslatable
from ..exudyn_run import ExudynResult, run_exudyn, settings_for
from .common import Comparison, Curve, Panel, Row, Task, energy_panel, residual_panel, unit_of

SOFT, STIFF = 0.5, 10.0
"""Stiffness of exudyn's contact in parts of an element's: below the bound, and above it to show what happens there."""
COURANT = 0.2
RELATIVE = 1e-3
LEAST_RATIO, LARGEST_RATIO = 1.2, 16.0
"""Of two successive changes, for which they show an order."""
LEAST_ORDER = 0.5
"""Of an error that a sharp front leaves: after the way x its width is as (x l)^(1/2) where the mesh or the step damps
it, and as (x l^2)^(1/3) where it disperses."""
MESHES = (1, 2, 4, 8)
"""Numbers of elements, in parts of the scenario's."""
ENDS, MIDDLE = (0.05, 0.95), (0.25, 0.75)
"""Shares of the impulse that have been handed over where the contact counts as begun and ended, and between which the
plateau is averaged."""


@dataclass(frozen=True)
class Blow:
    """What a run of a rod's impact gives."""

    duration: float
    mean: float
    """Mean force over the middle of the contact, N."""
    ripple: float
    """Root mean square deviation from it there, N."""
    impulse: float
    openings: int
    """How often the contact opens."""


def strikes_rods(model: Model) -> bool:
    """Whether a contact as a constraint strikes a rod."""
    rods = {b.name for b in model.bodies if isinstance(b, AxialRod)}
    return any(
        isinstance(c.law, ImpactLaw) and rods & {body for body, _ in c.moved_coordinates()}
        for c in model.contacts
        if hasattr(c, "terms")
    )


def compare_rods(task: Task) -> Comparison:
    """Plateau, time in contact and impulse, each extrapolated from the mesh and three finer ones.

    Raises
    ------
    NotTranslatable : for a model that is no scenario with a number of `elements`: nobody knows its finer mesh.
    """
    coarse = task.scenario
    if "elements" not in coarse.parameters or len(coarse.model.contacts) != 1:
        raise NotTranslatable(
            f"'{coarse.name}' has rods that strike; they are compared on four meshes, for which a scenario with a "
            "parameter `elements` and one contact is needed: register yours with @scenario, or compare it by force "
            "(law Hertz with exponent 1 and a stiffness of at most EA/l)"
        )
    given = {k: v for k, v in coarse.parameters.items() if v is not None and k != "step"}
    name = coarse.model.contacts[0].name
    number = int(coarse.parameters["elements"])
    meshes = [
        replace(load(coarse.name, **{**given, "elements": factor * number}), t_end=coarse.t_end) for factor in MESHES
    ]
    task.progress(f"our run, {number} elements")
    first = _our_run(meshes[0])
    mine, wall_time = [blow_of_ours(first, name)], first.stats["wall_time"]
    theirs: list[Blow] = []
    runs: list[ExudynResult] = []
    for factor, scenario in zip(MESHES[1:], meshes[1:], strict=True):
        task.progress(f"our run, {scenario.parameters['elements']} elements")
        # as many samples as of the coarse mesh: all steps of the finest would be gigabytes
        run = _our_run(scenario, record=factor)
        mine.append(blow_of_ours(run, name))
        wall_time += run.stats["wall_time"]
    # a fault that a test seeds into exudyn's model goes into all of its meshes
    fault = _fault(task)
    for scenario in meshes:
        task.progress(f"exudyn, {scenario.parameters['elements']} elements")
        found = run_penalty(fault(scenario.model), scenario.t_end, SOFT)
        theirs.append(blow_of_exudyn(found, name))
        runs.append(replace(found, channels={}) if runs else found)
    task.progress("exudyn, with a contact that is too stiff")
    stiff = run_penalty(fault(coarse.model), coarse.t_end, STIFF)
    task.progress("our run without mass at the contact's node")
    massless = load(coarse.name, **{**given, "massless_contact": True, "mass_matrix": "lumped"})
    calm = _our_run(replace(massless, t_end=coarse.t_end))
    rows = [
        *_rows(name, mine, theirs),
        *_ripples(name, mine[0], blow_of_ours(calm, name), theirs[0], blow_of_exudyn(stiff, name)),
    ]
    notes = (
        f"both sides on {', '.join(str(factor * number) for factor in MESHES)} elements, extrapolated with the order "
        f"that they show; the error bars are what an order of {LEAST_ORDER:g}, the least that a sharp front has, "
        "leaves open after the last change, or where the meshes show no order after the largest",
        "without damping the fronts are sharp: no mesh resolves them, and time in contact and impulse converge with "
        "an order below one. The case with damping has no such fronts, and is compared on one mesh",
        f"exudyn's contact is a spring of {SOFT:g} of an element's stiffness, and {STIFF:g} of it where that is said",
        *runs[-1].notes,
    )
    panels = _panels(name, coarse, first, calm, runs[0], stiff)
    return Comparison(
        "impact of elastic rods: plateau and momentum in the limit of fine meshes",
        tuple(rows),
        (*panels, energy_panel(first), residual_panel(first)),
        notes,
        tuple(r.step for r in (*runs, stiff)),
        stiff.version,
        wall_time + calm.stats["wall_time"],
        sum(r.wall_time for r in (*runs, stiff)),
        events=tuple(first.events),
        result=first,
    )


def _our_run(scenario: Scenario, record: int = 1) -> Result:
    return simulate(
        scenario.model, scenario.t_end, scenario.method, scenario.rtol, scenario.atol, record=record,
        **dict(scenario.options),
    )  # fmt: skip


def _fault(task: Task) -> Any:
    """What makes exudyn's model of ours: nothing, but in tests of faults other fields of the rods."""
    changes: dict[str, dict[str, Any]] = {}
    for given, used in zip(task.scenario.model.bodies, task.exudyn_model.bodies, strict=True):
        changes[given.name] = {k: v for k, v in used.__dict__.items() if v != given.__dict__.get(k)}

    def change(model: Model) -> Model:
        bodies = tuple(b.model_copy(update=changes.get(b.name, {})) for b in model.bodies)
        return model.model_copy(update={"bodies": bodies})

    return change


def run_penalty(model: Model, t_end: float, share: float, courant: float = COURANT) -> ExudynResult:
    """exudyn with a spring of `share` of an element's stiffness as contact, and steps of `courant` of an element."""
    rods = [b for b in model.bodies if isinstance(b, AxialRod)]
    stiffness = share * min(r.axial_stiffness * r.elements / r.length for r in rods)
    step = min(courant * r.length / r.elements / r.wave_speed for r in rods)
    (contact,) = model.contacts
    law = Hertz(stiffness=stiffness, exponent=1.0)
    changed = model.model_copy(update={"contacts": (contact.model_copy(update={"law": law}),), "parameters": ()})
    settings = settings_for(model, relative_tolerance=1e-6, absolute_tolerance=1e-6, contact_tolerance=1.0)
    return run_exudyn(changed, t_end, step, settings)


def blow_of_ours(run: Result, contact: str) -> Blow:
    """Of our run; the blow that closes the contact counts in its impulse."""
    opened = sum(e.kind == "open" and e.contact == contact for e in run.events)
    return _blow(run.t, run[f"{contact}.normal_force"], run[f"{contact}.impulse"], opened)


def blow_of_exudyn(run: ExudynResult, contact: str) -> Blow:
    """Of a run of exudyn."""
    inside = run[f"{contact}.gap"] < 0.0
    opened = int(np.sum(inside[:-1] & ~inside[1:]))
    return _blow(run.t, run[f"{contact}.normal_force"], run[f"{contact}.impulse"], opened)


def _blow(t: np.ndarray, force: np.ndarray, handed: np.ndarray, openings: int) -> Blow:
    """By shares of the impulse `handed` over, not by first and last touch: near its end the force may graze zero."""
    first, low, high, last = (
        float(np.interp(share * handed[-1], handed, t)) for share in (*ENDS[:1], *MIDDLE, ENDS[1])
    )
    middle = (t >= low) & (t <= high)
    span = t[middle][-1] - t[middle][0]
    mean = (MIDDLE[1] - MIDDLE[0]) * float(handed[-1]) / (high - low)
    ripple = float(np.sqrt(np.trapezoid((force[middle] - mean) ** 2, t[middle]) / span))
    return Blow(last - first, mean, ripple, float(handed[-1]), openings)


BLOW = {
    "mean": ("mean force between a quarter and three quarters of the impulse", "N"),
    "duration": ("time from 5 % to 95 % of the impulse", "s"),
    "impulse": ("impulse", "N.s"),
}
"""What is compared of a blow: words and unit."""


def _rows(name: str, mine: list[Blow], theirs: list[Blow]) -> list[Row]:
    rows = []
    for field, (title, unit) in BLOW.items():
        (a, own), (b, bar) = (mesh_limit([getattr(blow, field) for blow in side]) for side in (mine, theirs))
        rows.append(
            Row(f"{name}: {title}, in the limit of fine meshes", unit, a, b, RELATIVE, "relative", bar,
                ours_uncertainty=own)
        )  # fmt: skip
    return rows


def mesh_limit(values: list[float]) -> tuple[float, float]:
    """(limit, error bar) from three meshes or more, each twice as fine as the one before, by the order that the last
    three show. The bar is what LEAST_ORDER would leave open after the last change, whatever higher order is seen.

    Where they show no order, because the changes fluctuate, the finest value; its bar is then what LEAST_ORDER leaves
    open after the largest change of all: errors of different signs and orders (front, spring) pass each other, and the
    last changes can be small by chance.
    """
    changes = np.diff(values)
    before, last = float(changes[-2]), float(changes[-1])
    ratio = before / last if last else math.inf
    slowest = 2.0**LEAST_ORDER - 1.0
    if not LEAST_RATIO <= ratio <= LARGEST_RATIO:
        return values[-1], float(np.abs(changes).max()) / slowest
    return values[-1] + last / (ratio - 1.0), abs(last) / min(ratio - 1.0, slowest)


def _ripples(name: str, ours: Blow, calm: Blow, soft: Blow, stiff: Blow) -> list[Row]:
    def row(title: str, unit: str, a: float, b: float) -> Row:
        return Row(f"{name}: {title}", unit, a, b, 0.0, "relative", required=False,
                   reason="a property of each side's contact, shown side by side")  # fmt: skip

    return [
        row("ripple of the plateau; exudyn with 0.5 EA/l", "N", ours.ripple, soft.ripple),
        row("ripple; ours without mass at the contact, exudyn with 10 EA/l", "N", calm.ripple, stiff.ripple),
        row("how often the contact opens; exudyn with 10 EA/l", "1", float(ours.openings), float(stiff.openings)),
    ]


def _panels(
    name: str, scenario: Scenario, ours: Result, calm: Result, soft: ExudynResult, stiff: ExudynResult
) -> list[Panel]:
    force = f"{name}.normal_force"
    pair = (
        (
            Curve("tlismni, constraint", ours.t, ours[force], True),
            Curve("exudyn, penalty 0.5 EA/l", soft.t, soft[force], False),
        ),
        (
            Curve("tlismni, no mass at the contact", calm.t, calm[force], True),
            Curve("exudyn, penalty 10 EA/l", stiff.t, stiff[force], False),
        ),
    )
    titles = ("the same mesh", "what chatters and what need not")
    panels = [
        Panel(f"{force}: {title}", unit_of(ours, force), curves) for title, curves in zip(titles, pair, strict=True)
    ]
    for channel in scenario.compare:
        if channel in soft.channels and not channel.startswith(f"{name}."):
            curves = (
                Curve("tlismni", ours.t, ours[channel], True),
                Curve("exudyn, penalty 0.5 EA/l", soft.t, soft[channel], False),
            )
            panels.append(Panel(channel, unit_of(ours, channel), curves))
    return panels
