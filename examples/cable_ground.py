"""A rope on a pin falls on the ground: a hundred impacts of its nodes, and where its energy goes.

The rope is let go horizontally and swings down; a node in its middle strikes the ground first, then one after the
other. Every node is a contact with restitution 0: it loses its own speed, and what bounces comes from the rope behind
it. The ledger knows where the energy is at any time: in the motion, in height, in strain, lost at the impacts, lost in
the material.
"""

import sys
from pathlib import Path
from typing import Any

import numpy as np
from tlismni.core import axial_force, deformed_shape, simulate
from tlismni.models import load

ELEMENTS = 8
TIMES = np.linspace(0.0, 0.6, 13)
POINTS = np.linspace(0.0, 1.0, 81)


def run() -> dict[str, Any]:
    """The run, shapes and axial forces at some times, and the energies at its end."""
    scenario = load("cable_ground", elements=ELEMENTS)
    result = simulate(scenario.model, scenario.t_end, scenario.method, scenario.rtol, scenario.atol)
    cable = scenario.model.bodies[0]
    impacts = [event for event in result.events if event.kind == "impact"]
    height = scenario.parameters["height"]
    return {
        "result": result,
        "shapes": deformed_shape(result, cable, POINTS, TIMES),
        "forces": axial_force(result, cable, POINTS, TIMES),
        "impacts": len(impacts),
        "first": impacts[0].t,
        "lost_at_impacts": sum(event.energy_loss for event in impacts),
        "lost_in_material": float(result["energy.dissipation"][-1]),
        "largest_balance": float(np.max(np.abs(result["energy.balance"]))),
        "start": cable.mass_per_length * cable.length * 9.81 * height,
        "deepest": min(float(result[f"ground{k}.gap"].min()) for k in range(1, ELEMENTS + 1)),
    }


def plot(figures: dict[str, Any], path: Path) -> None:
    """The rope at some times, and the energies over time."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(9.0, 3.8), layout="constrained")
    shapes, energies = figure.subplots(1, 2)
    for k, (t, shape) in enumerate(zip(TIMES, figures["shapes"], strict=True)):
        shade = k / (len(TIMES) - 1)
        shapes.plot(shape[:, 0], shape[:, 1], color=(shade, 0.3, 1.0 - shade), lw=1.0, label=f"{t:.2f} s")
    shapes.axhline(0.0, color="k", lw=0.8)
    shapes.set(xlabel="x, m", ylabel="y, m", aspect="equal", ylim=(-0.05, 0.75))
    shapes.legend(fontsize=6, ncols=5, loc="upper center")
    result = figures["result"]
    for name, label in (
        ("kinetic", "motion"),
        ("potential", "height"),
        ("strain", "strain"),
        ("impact_loss", "lost at impacts"),
        ("dissipation", "lost in the material"),
    ):
        energies.plot(result.t, result[f"energy.{name}"], lw=1.0, label=label)
    energies.set(xlabel="time, s", ylabel="energy, J")
    energies.legend(fontsize=8)
    figure.savefig(path, dpi=150)


if __name__ == "__main__":
    file = Path(sys.argv[1] if len(sys.argv) > 1 else "cable_ground.png")
    found = run()
    plot(found, file)
    print(f"{found['impacts']} impacts, the first at {found['first']:.4f} s")
    print(
        f"lost: {found['lost_at_impacts']:.4f} J at impacts, {found['lost_in_material']:.4f} J in the material, "
        f"of {found['start']:.4f} J of height; energy balance within {found['largest_balance']:.1e} J; wrote {file}"
    )
