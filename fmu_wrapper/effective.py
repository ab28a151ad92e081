"""The model and the settings that the parameter values of a slave stand for."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any, NamedTuple

from ..core.multibody_model import Model
from .origin import Origin
from .settings import OWN, Settings
from .values import Values
from .variables import Variable

SOLVER = "solver."


class Effective(NamedTuple):
    """What a simulation is built from. `following` are values that differ from those set, by value reference: of
    parameters that nobody changed, and that the scenario's builder derives from changed ones."""

    model: Model
    settings: Settings
    following: Mapping[int, Any]


def effective(model: Model, settings: Settings, values: Values, origin: Origin | None = None) -> Effective:
    """Model and settings with the parameter values in `values` in place of the exported ones.

    Parameters of a scenario go through its builder; what it derives from them, the solver's settings among it, holds
    where it was not changed itself. The options belong to the exported method: another method runs with its own
    defaults.

    Raises
    ------
    ModelError : for a value that the model or the builder refuses.
    """
    table = values.table
    built = {v.name: values[v] for v in table.block("scenario") if values[v] != v.start}
    derived: dict[str, Any] = {}
    changed = {v.name: values[v] for v in table.block("parameter") if values[v] != model.parameter_value(v.name)}
    if built and origin is not None:
        scenario = origin.changed(built, model)
        model, settings = scenario.model, origin.settings(settings, scenario)
        derived = origin.derived(scenario)
    if changed:
        model = model.with_parameters(changed)
    for v in table.block("parameter"):
        derived[v.name] = model.parameter_value(v.name)
    arguments = settings.as_arguments()
    derived |= {SOLVER + name: value for name, value in arguments.items()}
    followers = {v: _value(v, derived[v.name]) for v in table.of_role("parameter") if v.name in derived}
    following = {v.reference: x for v, x in followers.items() if values[v] == v.start != x}
    solver: dict[str, Any] = {
        v.name.removeprefix(SOLVER): _item(v, following.get(v.reference, values[v])) for v in table.block("solver")
    }
    own = {name: solver.pop(name) for name in OWN if name in solver}
    options = {**settings.options, **solver} if own["method"] == settings.method else {}
    return Effective(model, replace(settings, options=options, **own), following)


def _value(variable: Variable, value: Any) -> Any:
    """`value` as the variable holds it."""
    return variable.items.index(value) if variable.items else value


def _item(variable: Variable, value: Any) -> Any:
    """What a value of the variable means."""
    return variable.item(value) if variable.items else value
