"""What a run is summed up in: events, residuals, energy, statistics."""

from typing import Any

import numpy as np

from ..core import Result
from ..models import Scenario
from .screen import number, print_table, shortened, stdout
from .source import solver_settings

LEVELS = (("position", "m"), ("velocity", "m/s"), ("acceleration", "m/s^2"))
STORED = ("energy.kinetic", "energy.potential", "energy.strain")


def summarise(scenario: Scenario, result: Result) -> dict[str, Any]:
    """The figures of a run as plain data, SI units."""
    residuals = {level: float(np.max(np.abs(result[f"residual.{level}"]))) for level, _ in LEVELS}
    residuals["velocity_increment"] = max((e.velocity_increment_residual for e in result.events), default=0.0)
    balance = result["energy.balance"]
    return {
        "scenario": scenario.name,
        "parameters": dict(scenario.parameters),
        "t_end": scenario.t_end,
        "solver": solver_settings(scenario) | ({"chosen": result.method_chosen} if result.method_chosen else {}),
        "samples": len(result),
        "events": [event.to_dict() for event in result.events],
        "event_units": event_units(result),
        "residuals": residuals,
        "energy": {
            "initial": float(sum(result[name][0] for name in STORED)),
            **{name.removeprefix("energy."): float(result[name][-1]) for name in STORED},
            "input_work": float(result["energy.input_work"][-1]),
            "dissipation": float(result["energy.dissipation"][-1]),
            "impact_loss": float(result["energy.impact_loss"][-1]),
            "balance": float(balance[-1]),
            "largest_balance": float(np.max(np.abs(balance))),
        },
        "final": {name: float(result[name][-1]) for name in scenario.compare if name in result.channels},
        "statistics": dict(result.stats),
    }


def event_units(result: Result) -> dict[str, tuple[str, str]]:
    """Units of impulses and speeds in the events of each contact."""
    units = {channel.name: channel.unit for channel in result.channel_records}
    return {
        e.contact: (units.get(f"{e.contact}.impulse", ""), units.get(f"{e.contact}.gap_rate", ""))
        for e in result.events
    }


def print_summary(figures: dict[str, Any]) -> None:
    """The figures as tables."""
    solver = figures["solver"]
    control = (
        f"fixed step {solver['step']:g} s"
        if solver["step"] is not None
        else f"rtol {solver['rtol']:g}, atol {solver['atol']:g}"
    )
    options = "".join(f", {name} {value}" for name, value in solver["options"].items())
    stdout().print(
        f"{figures['scenario']}: 0 to {number(figures['t_end'])} s with {solver['method']} ({control}{options})\n",
        markup=False,
    )
    if "chosen" in solver:
        stdout().print(f"auto took {solver['chosen']}\n", markup=False)
    _print_events(figures["events"], figures["event_units"])
    units = dict(LEVELS) | {"velocity_increment": "m/s"}
    print_table(
        "largest constraint residuals",
        ("level", "residual", "unit"),
        [(level.replace("_", " "), number(value, 3), units[level]) for level, value in figures["residuals"].items()],
    )
    _print_energy(figures["energy"])
    if figures["final"]:
        print_table("at the end", ("channel", "value"), list(figures["final"].items()))
    print_table(
        "statistics",
        ("what", "count"),
        [(name.replace("_", " "), _statistic(name, value)) for name, value in figures["statistics"].items()],
    )


def _statistic(name: str, value: float) -> str:
    return f"{number(float(value), 3)} s" if name == "wall_time" else str(value)


def _print_events(events: list[dict[str, Any]], units: dict[str, tuple[str, str]]) -> None:
    """One unit for a column if all contacts have it, else one for each number."""
    if not events:
        stdout().print("no contact events\n")
        return
    common = len(set(units.values())) == 1
    impulse, speed = next(iter(units.values())) if common else ("", "")
    columns = ("time s", "kind", "contact", f"impulse {impulse}", f"approach {speed}", f"separation {speed}", "loss J")
    fields = ("t", "kind", "contact", "impulse", "approach_speed", "separation_speed", "energy_loss")
    rows = []
    for event in events:
        cells = [number(event["t"], 9), *(event[field] for field in fields[1:])]
        if not common:
            own = units[event["contact"]]
            cells[3:6] = (f"{number(x)} {unit}" for x, unit in zip(cells[3:6], (own[0], own[1], own[1]), strict=True))
        rows.append(tuple(cells))
    print_table(f"{len(events)} events", tuple(c.strip() for c in columns), shortened(rows), left=3)


def _print_energy(energy: dict[str, float]) -> None:
    rows = [
        ("stored at the start", energy["initial"]),
        ("kinetic at the end", energy["kinetic"]),
        ("potential at the end", energy["potential"]),
        ("strain at the end", energy["strain"]),
        ("work put in", energy["input_work"]),
        ("dissipated", energy["dissipation"]),
        ("lost at impacts", energy["impact_loss"]),
        ("balance at the end", number(energy["balance"], 3)),
        ("largest balance", number(energy["largest_balance"], 3)),
    ]
    print_table("energy", ("account", "J"), rows)
