"""Cross-check: a scenario rerun in exudyn, quantity by quantity, with a verdict for each."""

import json
import logging
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from ..core.laws import ImpactLaw
from ..core.multibody_model import Model
from ..models import Scenario, load
from .comparisons.common import Comparison, Progress, Row, Task
from .comparisons.constraint_contact import compare_constraints
from .comparisons.force_contact import compare_forces
from .comparisons.persistent_contact import compare_persistent, persists
from .comparisons.rod_impact import compare_rods, strikes_rods
from .comparisons.rod_limit import compare_damped_rods, damped
from .comparisons.smooth_motion import compare_motion
from .comparisons.whole_run import with_whole_run
from .exudyn_import import import_exudyn
from .provenance import provenance
from .third_opinion import with_third_opinion
from .translation import find_translator

log = logging.getLogger(__name__)


@dataclass(frozen=True)
class CrossCheck:
    """What a cross-check found.

    Attributes
    ----------
    scenario : name; `parameters` its parameters.
    comparison : how it was compared, rows with verdicts, notes, and what the figures show.
    figures : files written into the report folder; empty without one.
    """

    scenario: str
    description: str
    parameters: Mapping[str, Any]
    comparison: Comparison
    name: str = ""
    why: str = ""
    settings: Mapping[str, Any] = field(default_factory=dict)
    model: Model | None = None
    figures: tuple[Path, ...] = ()
    report: Path | None = None
    machine: Mapping[str, Any] = field(default_factory=provenance)
    """What it was made with, and when."""

    @property
    def rows(self) -> tuple[Row, ...]:
        return self.comparison.rows

    @property
    def ok(self) -> bool:
        """True if no required quantity differs. What exudyn's own error leaves undecided is no difference."""
        return not any(row.verdict == "differ" for row in self.rows if row.required)

    @property
    def undecided(self) -> tuple[Row, ...]:
        """Rows in which exudyn's own step error is larger than the tolerance."""
        return tuple(row for row in self.rows if row.verdict == "undecided")

    def to_dict(self) -> dict[str, Any]:
        """Plain data: verdict, rows, notes, settings, files."""
        c = self.comparison
        return {
            "scenario": self.scenario,
            "description": self.description,
            "parameters": dict(self.parameters),
            "ok": self.ok,
            "kind": c.kind,
            "rows": [row.to_dict() for row in c.rows],
            "notes": list(c.notes),
            "exudyn": {"version": c.version, "steps": list(c.steps), "seconds": c.exudyn_seconds},
            "seconds": c.our_seconds,
            "settings": dict(self.settings),
            "machine": dict(self.machine),
            "name": self.name,
            "why": self.why,
            "figures": [str(path) for path in self.figures],
            "report": None if self.report is None else str(self.report),
        }


def crosscheck(
    scenario: str | Scenario | Model,
    report_dir: str | Path | None = None,
    progress: Progress | None = None,
    *,
    t_end: float | None = None,
    step: float | None = None,
    exudyn_model: Model | None = None,
    name: str | None = None,
    why: str = "",
    least_tolerance: float = 0.0,
    whole: bool = False,
    refine: bool = True,
    **parameters: Any,
) -> CrossCheck:
    """Run a scenario here and in exudyn, and compare.

    Parameters
    ----------
    scenario : name in the catalogue (with `parameters`), a Scenario, or a Model (with `t_end`).
    report_dir : folder for the report (HTML), the figures and the numbers (JSON); left out: none is written.
    progress : called with a line of text before each run.
    t_end : end time in s, if not the scenario's.
    step : exudyn's step in s; left out: from the duration of the contacts, or of the run.
    exudyn_model : the model that exudyn gets, if not the same one (to see that a fault is found, or `as_cables`).
    least_tolerance : relative; of every quantity, where the two sides are different models of one thing.
    whole : compare the whole run too, through all its impacts, up to some Lyapunov times (see `predictability`).
    refine : halve exudyn's step until its error bars are below the tolerances.
    name, why : what its files are called (the scenario), and what its report says about the choice of parameters.

    Returns
    -------
    CrossCheck. Contact by force is compared like for like; contact as a constraint with the penalty limit;
    motion without contact with exudyn's trajectories extrapolated to step zero.

    Raises
    ------
    ExudynUnavailable : if exudyn cannot be used. NotTranslatable : if the model has no equal in exudyn.
    ScenarioError : for unknown scenarios and parameters. ValueError : for a Model without t_end.
    OSError : if `report_dir` cannot be made, before anything is run.
    """
    chosen = _scenario(scenario, t_end, parameters)
    import_exudyn()  # before our own run: say at once if it is missing, or if something has no equal there
    for element in (exudyn_model or chosen.model).elements():
        find_translator(element)
    folder = None if report_dir is None else Path(report_dir)
    if folder is not None:
        folder.mkdir(parents=True, exist_ok=True)
    task = Task(chosen, exudyn_model or chosen.model, step, progress or log.info, refine)
    if not chosen.model.contacts:
        comparison = compare_motion(task)
    elif strikes_rods(chosen.model):
        comparison = compare_damped_rods(task) if damped(chosen) else compare_rods(task)
    elif persists(chosen.model):
        comparison = compare_persistent(task)
    elif any(isinstance(c.law, ImpactLaw) for c in chosen.model.contacts):
        comparison = compare_constraints(task)
    else:
        comparison = compare_forces(task)
    if whole:
        comparison = with_whole_run(task, comparison)
    if least_tolerance:
        comparison = replace(comparison, rows=tuple(_widened(row, least_tolerance) for row in comparison.rows))
    comparison = with_third_opinion(chosen, comparison)
    settings = {"method": chosen.method, "t_end": chosen.t_end, **dict(chosen.options)}
    found = CrossCheck(
        chosen.name, chosen.description, chosen.parameters, comparison, name or chosen.name, why, settings, chosen.model
    )
    return found if folder is None else _reported(found, folder)


def _widened(row: Row, least: float) -> Row:
    size = abs(row.exudyn) if row.tolerance_kind == "absolute" else 1.0
    return replace(row, tolerance=max(row.tolerance, least * size))


def _scenario(scenario: str | Scenario | Model, t_end: float | None, parameters: Mapping[str, Any]) -> Scenario:
    if isinstance(scenario, str):
        chosen = load(scenario, **parameters)
    elif parameters:
        raise ValueError(f"parameters {sorted(parameters)} are for scenarios given by name; change the model instead")
    elif isinstance(scenario, Model):
        if t_end is None:
            raise ValueError(f"model '{scenario.name}' needs t_end, the time to which it shall be compared (s)")
        chosen = Scenario(scenario.name, scenario.description, scenario, t_end, compare=_channels(scenario))
    else:
        chosen = scenario
    return chosen if t_end is None else replace(chosen, t_end=float(t_end))


def _channels(model: Model) -> tuple[str, ...]:
    """What to compare of a model that does not say: the coordinates of its last body, forces and gaps."""
    names: list[str] = []
    for body in model.bodies[-1:]:
        names += [f"{body.name}.{k}" for c in body.coordinate_records() for k in (c.name, c.rate)]
    for contact in model.contacts:
        names += [f"{contact.name}.normal_force", f"{contact.name}.gap"]
    return tuple(names)


def _reported(found: CrossCheck, folder: Path) -> CrossCheck:
    from .plots import save_figures
    from .report import write_report

    figures = save_figures(found, folder)
    written = replace(found, figures=figures, report=folder / f"{found.name}_crosscheck.html")
    write_report(written)
    numbers = folder / f"{found.name}_crosscheck.json"
    numbers.write_text(json.dumps(written.to_dict(), indent=2), encoding="utf-8")
    return written
