"""The options that commands share, as types, and how their values are read."""

import math
from collections.abc import Iterable
from pathlib import Path
from typing import Annotated, Any

import typer


def positive(value: float | None) -> float | None:
    """Refuse what is not a positive finite number (a wrong usage, exit code 2)."""
    if value is not None and not (math.isfinite(value) and value > 0.0):
        raise typer.BadParameter(f"{value!r} is not a positive number")
    return value


def pairs(given: Iterable[str], option: str) -> dict[str, str]:
    """`name=value` texts as a dict. Raises BadParameter for a text without `=` or a name given twice."""
    found: dict[str, str] = {}
    for text in given:
        name, separator, value = (part.strip() for part in text.partition("="))
        if not (name and separator):
            raise typer.BadParameter(f"'{text}' must read name=value", param_hint=option)
        if name in found:
            raise typer.BadParameter(f"'{name}' is given twice", param_hint=option)
        found[name] = value
    return found


def value_of(text: str) -> Any:
    """The number, switch or word that a text means."""
    for kind in (int, float):
        try:
            return kind(text)
        except ValueError:
            pass
    return {"true": True, "false": False}.get(text.lower(), text)


def check_suffix(path: Path | None, suffixes: tuple[str, ...], option: str) -> None:
    """Refuse a file whose kind is unknown, before any work is done."""
    if path is not None and path.suffix.lower() not in suffixes:
        raise typer.BadParameter(f"'{path}' must end in {' or '.join(suffixes)}", param_hint=option)


_SOLVER, _OUTPUT = "Solver", "Output"

Source = Annotated[
    str, typer.Argument(metavar="SCENARIO_OR_MODEL", help="Name of a scenario (see `tlismni list`), or a model file.")
]
Set = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="NAME=VALUE", help="Parameter of the scenario or model; may be repeated."),
]
EndTime = Annotated[
    float | None,
    typer.Option("--t-end", callback=positive, help="End time in s; a model file needs it."),
]
MethodName = Annotated[
    str | None,
    typer.Option("--method", "-m", help="Integration method (see `tlismni methods`).", rich_help_panel=_SOLVER),
]
Rtol = Annotated[
    float | None, typer.Option("--rtol", callback=positive, help="Relative tolerance.", rich_help_panel=_SOLVER)
]
Atol = Annotated[
    float | None, typer.Option("--atol", callback=positive, help="Absolute tolerance.", rich_help_panel=_SOLVER)
]
Step = Annotated[
    float | None,
    typer.Option("--step", callback=positive, help="Fixed step in s, no error control.", rich_help_panel=_SOLVER),
]
MethodOption = Annotated[
    list[str] | None,
    typer.Option(
        "--option", metavar="NAME=VALUE", help="Option of the method; may be repeated.", rich_help_panel=_SOLVER
    ),
]
CommunicationStep = Annotated[
    float | None,
    typer.Option("--communication-step", "-c", callback=positive, help="Communication step in s."),
]
Json = Annotated[bool, typer.Option("--json", help="One JSON object on stdout.", rich_help_panel=_OUTPUT)]
Debug = Annotated[bool, typer.Option("--debug", help="Show the traceback of a failure.", rich_help_panel=_OUTPUT)]
