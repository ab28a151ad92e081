"""Elastic rods that strike: our constraint and exudyn's penalty, both on two meshes and extrapolated to the rod itself.

Neither has the force history of the rod: ours loses a node's energy at the touch and the force rings; a penalty must
not be stiffer than an element (EA/l), else the end node chatters. What both must give in the limit of fine meshes is
the mean force on the plateau, the time in contact and the impulse (exudyn's penalty, 0.5 EA/l, goes with its mesh).
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from ...core import Result, simulate
from ...core.contact.laws import Hertz, ImpactLaw
from ...core.description import Model
from ...core.elements import AxialRod
from ...models import Scenario, load
from ..errors import NotTranslatable
from ..exudyn_run import ExudynResult, run_exudyn, settings_for
from .common import Comparison, Curve, Panel, Row, Task, energy_panel, residual_panel, unit_of

SOFT, STIFF = 0.5, 10.0
"""Stiffness of exudyn's contact in parts of an element's: below the bound, and above it to show what happens there."""
COURANT = 0.2
FORCE, TIME, IMPULSE = 1e-2, 1e-2, 2e-3
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
    """Plateau, time in contact and impulse, each extrapolated from the mesh and one twice as fine.

    Raises
    ------
    NotTranslatable : for a model that is no scenario with a number of `elements`: nobody knows its finer mesh.
    """
    coarse = task.scenario
    if "elements" not in coarse.parameters or len(coarse.model.contacts) != 1:
        raise NotTranslatable(
            f"'{coarse.name}' has rods that strike; they are compared on two meshes, for which a scenario with a "
            "parameter `elements` and one contact is needed: register yours with @scenario, or compare it by force "
            "(law Hertz with exponent 1 and a stiffness of at most EA/l)"
        )
    given = {k: v for k, v in coarse.parameters.items() if v is not None and k != "step"}
    name = coarse.model.contacts[0].name
    fine = load(coarse.name, **{**given, "elements": 2 * int(coarse.parameters["elements"])})
    ours: list[Result] = []
    runs: list[ExudynResult] = []
    for scenario in (coarse, fine):
        task.progress(f"our run, {scenario.parameters['elements']} elements")
        ours.append(_our_run(scenario))
    # a fault that a test seeds into exudyn's model goes into both of its meshes
    fault = _fault(task)
    for scenario in (coarse, fine):
        task.progress(f"exudyn, {scenario.parameters['elements']} elements")
        runs.append(_run(fault(scenario.model), scenario.t_end, SOFT))
    task.progress("exudyn, with a contact that is too stiff")
    stiff = _run(fault(coarse.model), coarse.t_end, STIFF)
    task.progress("our run without mass at the contact's node")
    calm = _our_run(load(coarse.name, **{**given, "massless_contact": True, "mass_matrix": "lumped"}))
    mine = [_ours(r, name) for r in ours]
    theirs = [_exudyn(r, name) for r in runs]
    rows = [
        *_rows(name, mine, theirs),
        *_ripples(name, mine[0], _ours(calm, name), theirs[0], _exudyn(stiff, name)),
    ]
    notes = (
        f"both sides on {coarse.parameters['elements']} and {fine.parameters['elements']} elements, extrapolated to "
        "none in the first order of their length; the error bars are what the extrapolation adds to the finer mesh",
        f"exudyn's contact is a spring of {SOFT:g} of an element's stiffness, and {STIFF:g} of it where that is said",
        *runs[-1].notes,
    )
    panels = _panels(name, coarse, ours[0], calm, runs[0], stiff)
    return Comparison(
        "impact of elastic rods: plateau and momentum in the limit of fine meshes",
        tuple(rows),
        (*panels, energy_panel(ours[0]), residual_panel(ours[0])),
        notes,
        tuple(r.step for r in (*runs, stiff)),
        stiff.version,
        sum(r.stats["wall_time"] for r in (*ours, calm)),
        sum(r.wall_time for r in (*runs, stiff)),
        events=tuple(ours[0].events),
        result=ours[0],
    )


def _our_run(scenario: Scenario) -> Result:
    return simulate(
        scenario.model, scenario.t_end, scenario.method, scenario.rtol, scenario.atol, **dict(scenario.options)
    )


def _fault(task: Task) -> Any:
    """What makes exudyn's model of ours: nothing, but in tests of faults other fields of the rods."""
    changes: dict[str, dict[str, Any]] = {}
    for given, used in zip(task.scenario.model.bodies, task.exudyn_model.bodies, strict=True):
        changes[given.name] = {k: v for k, v in used.__dict__.items() if v != given.__dict__.get(k)}

    def change(model: Model) -> Model:
        bodies = tuple(b.model_copy(update=changes.get(b.name, {})) for b in model.bodies)
        return model.model_copy(update={"bodies": bodies})

    return change


def _run(model: Model, t_end: float, share: float) -> ExudynResult:
    rods = [b for b in model.bodies if isinstance(b, AxialRod)]
    stiffness = share * min(r.axial_stiffness * r.elements / r.length for r in rods)
    step = min(COURANT * r.length / r.elements / r.wave_speed for r in rods)
    (contact,) = model.contacts
    law = Hertz(stiffness=stiffness, exponent=1.0)
    changed = model.model_copy(update={"contacts": (contact.model_copy(update={"law": law}),), "parameters": ()})
    settings = settings_for(model, relative_tolerance=1e-6, absolute_tolerance=1e-6, contact_tolerance=1.0)
    return run_exudyn(changed, t_end, step, settings)


def _ours(run: Result, contact: str) -> Blow:
    opened = sum(e.kind == "open" and e.contact == contact for e in run.events)
    return _blow(run.t, run[f"{contact}.normal_force"], float(run[f"{contact}.impulse"][-1]), opened)


def _exudyn(run: ExudynResult, contact: str) -> Blow:
    inside = run[f"{contact}.gap"] < 0.0
    opened = int(np.sum(inside[:-1] & ~inside[1:]))
    return _blow(run.t, run[f"{contact}.normal_force"], float(run[f"{contact}.impulse"][-1]), opened)


def _blow(t: np.ndarray, force: np.ndarray, impulse: float, openings: int) -> Blow:
    """By shares of the impulse, not by the first and last touch: before it ends the force may graze zero."""
    handed = np.concatenate(([0.0], np.cumsum(0.5 * (force[1:] + force[:-1]) * np.diff(t))))
    first, low, high, last = (
        float(np.interp(share * handed[-1], handed, t)) for share in (*ENDS[:1], *MIDDLE, ENDS[1])
    )
    middle = (t >= low) & (t <= high)
    span = t[middle][-1] - t[middle][0]
    mean = (MIDDLE[1] - MIDDLE[0]) * float(handed[-1]) / (high - low)
    ripple = float(np.sqrt(np.trapezoid((force[middle] - mean) ** 2, t[middle]) / span))
    return Blow(last - first, mean, ripple, impulse, openings)


def _rows(name: str, mine: list[Blow], theirs: list[Blow]) -> list[Row]:
    rows = []
    for title, field, unit, tolerance in (
        ("mean force between a quarter and three quarters of the impulse", "mean", "N", FORCE),
        ("time from 5 % to 95 % of the impulse", "duration", "s", TIME),
        ("impulse", "impulse", "N s", IMPULSE),
    ):
        (a, b), (c, d) = ([getattr(blow, field) for blow in side] for side in (mine, theirs))
        rows.append(
            Row(f"{name}: {title}, in the limit of fine meshes", unit, 2.0 * b - a, 2.0 * d - c, tolerance, "relative",
                abs(d - c), ours_uncertainty=abs(b - a))
        )  # fmt: skip
    return rows


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
