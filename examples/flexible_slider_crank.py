"""A slider-crank with a flexible connecting rod whose slider strikes a stop: the blow bends the rod."""

import sys
from pathlib import Path
from typing import Any

import numpy as np
from tlismni.core import simulate
from tlismni.models import load

STIFF = 2e13
"""Young's modulus a hundred times that of steel, Pa."""


def run() -> dict[str, Any]:
    """The same with a rod of steel and with one that hardly bends."""
    found: dict[str, Any] = {}
    for name, modulus in (("result", 2e11), ("stiff", STIFF)):
        s = load("flexible_slider_crank_stop", youngs_modulus=modulus)
        times = np.linspace(0.0, s.t_end, 801)
        found[name] = simulate(s.model, s.t_end, atol=s.atol, t_eval=times, **s.options)
    blows = [next(event for event in found[name].events if event.kind == "impact") for name in ("result", "stiff")]
    return {
        **found,
        "blow": blows[0],
        "separation_over_approach": blows[0].separation_speed / blows[0].approach_speed,
        "stiff_blow": blows[1],
        "balance": float(np.abs(found["result"]["energy.balance"]).max()),
        "energy": float(found["result"]["energy.kinetic"].max()),
    }


def plot(figures: dict[str, Any], path: Path) -> None:
    figures["result"].plot("slider.x", "middle.y", "stop.gap", path=path)


if __name__ == "__main__":
    file = Path(sys.argv[1] if len(sys.argv) > 1 else "flexible_slider_crank.html")
    found = run()
    plot(found, file) if file.suffix == ".png" else found["result"].animate(file, channels=["slider.x"])
    print(f"blow at {found['blow'].t:.5f} s of {found['blow'].impulse:.4f} N s; the rod hardly bending: ", end="")
    print(f"{found['stiff_blow'].t:.5f} s, {found['stiff_blow'].impulse:.4f} N s; wrote {file}")
