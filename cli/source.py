"""What a command works on: a scenario of the catalogue or a model file, with the settings of the command line."""

import inspect
import os
from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import Any

import typer

from ..core import Model, ModelError, Simulation
from ..core.methods.automatic import METHOD_NAMES, described
from ..models import Scenario, load
from ..models.registry import entry_of
from .options import pairs, value_of

_MEANINGS = {
    "outer": "outer loop of the TLISMNI methods: newton, simple (the fixed point) or jfnk (Newton-Krylov)",
    "acceleration": "of outer=simple: none, aitken or anderson",
    "depth": "of acceleration=anderson: iterates that are combined, 1 to 5",
    "fallback": "true: newton takes over if the outer loop fails; it is reported",
    "controller": "step sizes of one-step methods: elementary, pi or h211b",
    "first_step": "first step under error control, s",
    "max_step": "largest step under error control, s",
    "max_steps": "most steps between two times that are asked for; no limit without it",
    "newton_tolerance": (
        "where the outer loop stops: with --step absolute and relative (1e-10), else in error weights (0.01; irk 0.001)"
    ),
    "redundant": "constraints that repeat others: drop (left out, but checked) or refuse",
    "start_tolerance": "how far the start may be moved to meet the constraints, relative",
}


def _shown(default: Any) -> str:
    """A default as it would be typed; nothing for None, which stands for a choice of the solver."""
    if default is None:
        return ""
    return str(default).lower() if isinstance(default, bool) else str(default)


_PARAMETERS = inspect.signature(Simulation).parameters
RUN_OPTIONS: Mapping[str, tuple[str, str]] = {
    name: (_shown(_PARAMETERS[name].default), meaning) for name, meaning in _MEANINGS.items()
}
"""Options of a run that every method takes: default and meaning."""


ANY_END = 1.0
"""An end time for those who do not run, s."""


def read_source(
    source: str,
    sets: Iterable[str] | None = None,
    *,
    t_end: float | None = None,
    method: str | None = None,
    rtol: float | None = None,
    atol: float | None = None,
    step: float | None = None,
    options: Iterable[str] | None = None,
) -> Scenario:
    """The scenario to run: `source` with everything that was given in place of its own settings.

    Raises
    ------
    ModelError : for an unknown scenario, parameter, method or option, or a bad value.
    BadParameter : for a model file without an end time, or a malformed name=value.
    """
    changes = pairs(sets or (), "--set")
    found = _model_file(source, changes, t_end) if is_file(source) else _scenario(source, changes)
    given = pairs(options or (), "--option")
    chosen = method or found.method
    own = dict(found.options)
    if chosen != found.method:
        # options of the scenario's own method mean nothing to another
        own = {name: value for name, value in own.items() if name in RUN_OPTIONS}
    if step is not None:
        own["step"] = step
    own |= _options(chosen, given)
    settings: dict[str, Any] = {"t_end": t_end, "rtol": rtol, "atol": atol}
    return replace(
        found, method=chosen, options=own, **{name: value for name, value in settings.items() if value is not None}
    )


def is_file(source: str) -> bool:
    """True if `source` means a model file, not a scenario's name."""
    return source.lower().endswith((".json", ".yaml", ".yml")) or "/" in source or os.sep in source


def _scenario(name: str, changes: dict[str, str]) -> Scenario:
    table = {p.name: p for p in entry_of(name).parameters}
    if any(key not in table for key in changes):
        _refuse_inputs(load(name).model, [key for key in changes if key not in table])
    return load(name, **{key: table[key].parse(text) if key in table else text for key, text in changes.items()})


def _model_file(path: str, changes: dict[str, str], t_end: float | None) -> Scenario:
    model = Model.load(path)
    if t_end is None:
        raise typer.BadParameter("a model file says nothing about how long to run: give --t-end", param_hint="--t-end")
    _refuse_inputs(model, [name for name in changes if name not in {p.name for p in model.parameters}])
    values = {name: _number(name, text) for name, text in changes.items()}
    model = model.with_parameters(values) if values else model
    parameters = {p.name: model.parameter_value(p.name) for p in model.parameters}
    return Scenario(
        model.name, model.description, model, t_end, parameters=parameters, compare=_interesting_channels(model)
    )


def _refuse_inputs(model: Model, unknown: Iterable[str]) -> None:
    """Raise ModelError for an input that is given as a parameter."""
    for name in unknown:
        if name in {record.name for record in model.inputs}:
            raise ModelError(f"'{name}' is an input, not a parameter: give it by --input {name}=VALUE, or in a file")


def _number(name: str, text: str) -> float:
    try:
        return float(text)
    except ValueError:
        raise ModelError(f"parameter '{name}': '{text}' is not a number") from None


def _interesting_channels(model: Model) -> tuple[str, ...]:
    """What to plot of a model that does not say: the last body's coordinates, then gaps and forces."""
    bodies = [f"{body.name}.{coordinate}" for body in model.bodies[-1:] for coordinate in body.coordinate_names]
    return (*bodies, *(f"{c.name}.{what}" for c in model.contacts[:2] for what in ("gap", "normal_force")))


def _options(method: str, given: dict[str, str]) -> dict[str, Any]:
    if method in METHOD_NAMES:  # the core names the methods that there are
        known = {*described(method).options, *RUN_OPTIONS}
        unknown = sorted(set(given) - known)
        if unknown:
            raise ModelError(f"method '{method}' has no option {unknown}; there are {sorted(known)}")
    return {name: value_of(text) for name, text in given.items()}


def solver_settings(scenario: Scenario) -> dict[str, Any]:
    """The settings of a run as plain data."""
    options = dict(scenario.options)
    return {
        "method": scenario.method,
        "rtol": scenario.rtol,
        "atol": scenario.atol,
        "step": options.pop("step", None),
        "options": options,
    }
