"""The variables that an FMU of a model has: solver settings, parameters, contact laws, inputs, channels."""

from collections.abc import Iterable, Iterator
from itertools import count
from typing import Any

from ..core.errors import ModelError
from ..core.laws import LAWS
from ..core.methods.automatic import METHOD_NAMES, described
from ..core.model.channels import Channel, Input, Parameter
from ..core.multibody_model import Model
from .origin import Origin
from .scales import Scales, parameter_limits
from .settings import Settings
from .variables import EVENTS, TIME, Variable, VariableTable, kind_of


def build_table(
    model: Model, settings: Settings, channels: Iterable[Channel], origin: Origin | None = None
) -> VariableTable:
    """The variables of a slave for `model` with `settings`, whose simulation has `channels`, and which comes from
    `origin`.

    Raises
    ------
    ModelError : for an unknown method.
    """
    scales = Scales.of(model, settings.t_end)
    laws = tuple(dict.fromkeys([*LAWS, *(type(c.law).__name__ for c in model.contacts)]))
    channels = tuple(channels)
    number = count(1)  # value references: the index of each variable
    own = [
        Variable(next(number), TIME, "real", "independent", "time", "s", "simulation time"),
        *_solver(settings, number),
        Variable(next(number), EVENTS, "integer", "output", "figure", None, "contact events so far", minimum=0),
    ]
    taken = {n.name for n in model.inputs} | {c.name for c in channels}
    built = [] if origin is None else list(origin.variables(taken, number))
    known = {v.name for v in built}
    return VariableTable(
        [
            *own,
            *built,
            *(_parameter(next(number), p, model) for p in model.parameters if p.name not in known),
            *(_law(next(number), contact, laws) for contact in model.contacts),
            *(_input(next(number), n, scales) for n in model.inputs),
            *(_channel(next(number), c, scales) for c in channels),
        ]
    )


def _parameter(reference: int, p: Parameter, model: Model) -> Variable:
    value = model.parameter_value(p.name)
    low, high = parameter_limits(model, p)
    return Variable(
        reference, p.name, "real", "parameter", "parameter", p.unit, p.description, value, low, high,
        nominal=abs(value) or None,
    )  # fmt: skip


def _law(reference: int, contact: Any, laws: tuple[str, ...]) -> Variable:
    return Variable(
        reference, f"{contact.name}.law", "integer", "constant", "law", None, f"contact law of {contact.name}",
        laws.index(type(contact.law).__name__), enumeration="ContactLaw", items=laws,
    )  # fmt: skip


def _input(reference: int, n: Input, scales: Scales) -> Variable:
    nominal = abs(n.start) or scales.nominal(n.unit)
    return Variable(reference, n.name, "real", "input", "input", n.unit, n.description, n.start, nominal=nominal)


def _channel(reference: int, c: Channel, scales: Scales) -> Variable:
    residual, real = c.name.startswith("residual."), c.kind == "real"
    return Variable(
        reference,
        c.name,
        c.kind,
        "output",
        "channel",
        c.unit if real else None,
        # the type of an enumeration says what its values mean
        c.description.split(":")[0] if c.enumeration else c.description,
        # a violation is no length of the mechanism, and never negative
        minimum=0.0 if residual else None,
        enumeration=c.enumeration.name if c.enumeration else None,
        items=c.enumeration.items if c.enumeration else (),
        nominal=scales.nominal(c.unit) if real and not residual else None,
    )


def _solver(settings: Settings, number: Iterator[int]) -> list[Variable]:
    names = METHOD_NAMES
    if settings.method not in names:
        raise ModelError(f"unknown method '{settings.method}'; known are {sorted(names)}")
    method = Variable(
        next(number), "solver.method", "integer", "parameter", "solver", None, "integration method",
        names.index(settings.method), enumeration="SolverMethod", items=names,
    )  # fmt: skip
    numbers = (
        ("rtol", settings.rtol, "1", "relative tolerance of the error control"),
        ("atol", settings.atol, "1", "absolute tolerance of the error control; 1e-9: of the model's own scales"),
        ("step", settings.step, "s", "fixed internal step; 0 for error control"),
    )
    return [
        method,
        *(
            Variable(next(number), f"solver.{name}", "real", "parameter", "solver", unit, text, start, 0.0,
                     nominal=start or None)
            for name, start, unit, text in numbers
        ),
        *_options(settings, number),
    ]  # fmt: skip


def _options(settings: Settings, number: Iterator[int]) -> list[Variable]:
    """The options of the method that are one value; a list or the like stays as exported."""
    known = described(settings.method).options
    variables: list[Variable] = []
    for name in sorted(settings.options):
        value = settings.options[name]
        kind = kind_of(value)
        if kind is None:
            continue
        option = known.get(name)
        text = option.description if option else name
        numeric = option is not None and option.numeric and kind in ("real", "integer")
        limits = (option.minimum, option.maximum) if option is not None and numeric else ()
        unit = "1" if kind == "real" else None
        text = f"option of method {settings.method}: {text}"
        name = f"solver.{name}"
        variables.append(Variable(next(number), name, kind, "parameter", "solver", unit, text, value, *limits))
    return variables
