"""An elastic rod strikes a wall: the waves in it, and the force that they make.

A rod of length L flies against a rigid wall with speed v. From the touch on a wave of compression runs through it with
c = sqrt(E/rho); behind it the rod stands still under the force EA v/c. At the free end the wave turns round and
relieves it; when it is back, after 2 L/c, the contact ends, and the whole rod flies back with speed v. No restitution
is given: the contact's is 0. The mesh shows the same, but for what it takes at the touch (the kinetic energy of the
contact's node, 1/(2 N) of the rod's) and for the oscillation behind the front. Without mass at that node nothing is
lost.
"""

import math
import sys
from pathlib import Path
from typing import Any

import numpy as np
from tlismni.core import Result, simulate
from tlismni.core.flexible import RodFields, rod_fields
from tlismni.models import Scenario, load

ELEMENTS = 100
SHOWN = 400
"""Times in the wave diagram."""


def strike(massless: bool) -> tuple[Scenario, Result]:
    """The scenario and its run."""
    scenario = load("rod_wall", elements=ELEMENTS, mass_matrix="lumped", massless_contact=massless)
    return scenario, simulate(scenario.model, scenario.t_end, scenario.method, **scenario.options)


def run() -> dict[str, Any]:
    """Figures of both runs beside St. Venant's."""
    scenario, result = strike(massless=False)
    _, massless = strike(massless=True)
    p = scenario.parameters
    wave = math.sqrt(p["youngs_modulus"] / p["density"])
    force = p["area"] * p["velocity"] * math.sqrt(p["youngs_modulus"] * p["density"])
    energy = 0.5 * p["density"] * p["area"] * p["length"] * p["velocity"] ** 2
    touch, leave = (next(e.t for e in result.events if e.kind == kind) for kind in ("close", "open"))
    plateau = (result.t > touch + 0.5 / wave) & (result.t < touch + 1.5 / wave)
    return {
        "results": {"lumped mass": result, "no mass at the contact node": massless},
        "fields": rod_fields(result, scenario.model.bodies[0], SHOWN),
        "area": p["area"],
        "touch": touch,
        "unit": p["length"] / wave,
        "duration": leave - touch,
        "expected_duration": 2.0 * p["length"] / wave,
        "force": float(np.mean(result["wall.normal_force"][plateau])),
        "expected_force": force,
        "loss": float(result["energy.impact_loss"][-1]) / energy,
        "expected_loss": 1.0 / (2.0 * ELEMENTS),
        "massless_loss": float(massless["energy.impact_loss"][-1]) / energy,
        "impulse": float(result["wall.impulse"][-1]) / (p["density"] * p["area"] * p["length"] * p["velocity"]),
    }


def plot(figures: dict[str, Any], path: Path) -> None:
    """The stress over place and time, and the contact's force over time."""
    from matplotlib.figure import Figure

    fields: RodFields = figures["fields"]
    figure = Figure(figsize=(9.0, 4.2), layout="constrained")
    waves, forces = figure.subplots(1, 2)
    time = (fields.t - figures["touch"]) / figures["unit"]
    stress = 1e-6 * fields.stress(figures["area"])
    most = 1.1e-6 * figures["expected_force"] / figures["area"]
    image = waves.pcolormesh(
        fields.middle, time, stress, cmap="RdBu_r", vmin=-most, vmax=most, shading="nearest", rasterized=True
    )
    figure.colorbar(image, ax=waves, label="axial stress, MPa")
    waves.set(xlabel="distance from the free end, m", ylabel="time after the touch, L/c", ylim=(-0.2, 2.6))
    for label, result in figures["results"].items():
        x = (result.t - figures["touch"]) / figures["unit"]
        forces.plot(x, result["wall.normal_force"] / figures["expected_force"], lw=0.8, label=label)
    forces.plot([0.0, 0.0, 2.0, 2.0], [0.0, 1.0, 1.0, 0.0], "k--", lw=0.8, label="St. Venant")
    forces.set(xlabel="time after the touch, L/c", ylabel="force, EA v/c", xlim=(-0.2, 2.6))
    forces.legend(fontsize=8)
    figure.savefig(path, dpi=150)


if __name__ == "__main__":
    file = Path(sys.argv[1] if len(sys.argv) > 1 else "rod_wall.png")
    found = run()
    plot(found, file)
    print(f"contact lasts {1e6 * found['duration']:.2f} us, 2 L/c is {1e6 * found['expected_duration']:.2f} us")
    print(f"mean force {found['force']:.2f} N, EA v/c is {found['expected_force']:.2f} N")
    print(f"rebound with {found['impulse'] - 1.0:.4f} of the speed")
    print(
        f"energy lost at the touch {found['loss']:.6f}, 1/(2 N) is {found['expected_loss']:.6f} of the kinetic energy;"
    )
    print(f"without mass at the contact node {found['massless_loss']:.1e}; wrote {file}")
