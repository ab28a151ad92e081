"""A turning hub with a flexible beam, whose tip strikes a stop: two formulations of the beam, two of the contact.

The beam is one of modes in a floating frame of reference, or a chain of ANCF elements; the stop is a constraint with an
impact of restitution 0 (CCM), or Hertz's force (CCFM). What throws the hub back is the bending of the beam. The tip has
next to no mass of its own: it strikes, leaves and comes back, differently in each variant. The impulse of the whole
contact is the same: it is what turns hub and beam round, the change of their moment of momentum over its arm.
"""

import sys
from pathlib import Path
from typing import Any

import numpy as np
from tlismni.core import Result, bending_moment, deformed_shape, simulate
from tlismni.models import Scenario, load

VARIANTS = {
    "floating frame, CCM": {"formulation": "floating", "contact": "ccm"},
    "floating frame, CCFM": {"formulation": "floating", "contact": "ccfm"},
    "ANCF, CCM": {"formulation": "ancf", "contact": "ccm"},
    "ANCF, CCFM": {"formulation": "ancf", "contact": "ccfm"},
}


def swing(**parameters: Any) -> tuple[Scenario, Result]:
    """The scenario and its run."""
    s = load("hub_beam_stop", **parameters)
    return s, simulate(s.model, s.t_end, s.method, s.rtol, s.atol, **s.options)


def momentum(s: Scenario, result: Result) -> tuple[float, float]:
    """Moment of momentum about the axle at start and end, N m s: of the beam by points along it."""
    p, hub = s.parameters, s.model.bodies[0]
    beam = s.model.bodies[1]
    nodes, weights = np.polynomial.legendre.leggauss(40)
    along = 0.5 * p["beam_length"] * (nodes + 1.0)
    mass = p["density"] * p["beam_width"] * p["beam_height"] * 0.5 * p["beam_length"] * weights
    rates = 1e-6
    found = []
    for t in (0.0, result.t[-1] - rates):
        before, after = deformed_shape(result, beam, along, [t, t + rates])  # type: ignore[arg-type]
        place, speed = 0.5 * (before + after), (after - before) / rates
        turning = float(np.sum(mass * (place[:, 0] * speed[:, 1] - place[:, 1] * speed[:, 0])))
        rate = float(np.interp(t, result.t, result["hub.angular_velocity"]))
        found.append(hub.inertia * rate + turning)  # type: ignore[attr-defined]
    return found[0], found[1]


def run() -> dict[str, Any]:
    """Impulses of the four variants, and what the first of them must be by the balance of moment of momentum."""
    runs = {name: swing(**parameters) for name, parameters in VARIANTS.items()}
    first, result = runs["floating frame, CCM"]
    start, end = momentum(first, result)
    p = first.parameters
    inertia = p["hub_inertia"] + p["density"] * p["beam_width"] * p["beam_height"] * (
        (p["hub_radius"] + p["beam_length"]) ** 3 - p["hub_radius"] ** 3
    ) / 3.0  # fmt: skip
    return {
        "scenarios": {name: s for name, (s, _) in runs.items()},
        "results": {name: r for name, (_, r) in runs.items()},
        "impulses": {name: float(r["stop.impulse"][-1]) for name, (_, r) in runs.items()},
        "expected_start": inertia * p["speed"],
        "start": start,
        "expected_impulse": (start - end) / (p["hub_radius"] + p["beam_length"]),
        "largest_energy_balance": max(float(np.abs(r["energy.balance"]).max()) for _, r in runs.values()),
        "energy": 0.5 * inertia * p["speed"] ** 2,
    }


def convergence() -> list[tuple[str, str, float, float]]:
    """(what, contact, impulse, energy lost at impacts) as modes, elements, tolerances and steps change."""
    rows = []
    for contact in ("ccm", "ccfm"):
        for formulation, parameter, counts in (("floating", "modes", (2, 4, 8, 16)), ("ancf", "elements", (4, 8, 16))):
            for n in counts:
                _, r = swing(formulation=formulation, contact=contact, **{parameter: n})
                rows.append(
                    (f"{formulation}, {n} {parameter}", contact, r["stop.impulse"][-1], r["energy.impact_loss"][-1])
                )
    s = load("hub_beam_stop")
    for factor in (10.0, 1.0, 0.1):
        r = simulate(s.model, s.t_end, s.method, factor * s.rtol, factor * s.atol, **s.options)
        rows.append(
            (f"floating, rtol {factor * s.rtol:.0e}", "ccm", r["stop.impulse"][-1], r["energy.impact_loss"][-1])
        )
    for formulation in ("floating", "ancf"):
        model = load("hub_beam_stop", formulation=formulation).model
        for step in (5e-5, 2.5e-5, 1.25e-5):
            r = simulate(model, s.t_end, "hht", step=step)
            what = f"{formulation}, HHT, step {1e6 * step:g} us"
            rows.append((what, "ccm", r["stop.impulse"][-1], r["energy.impact_loss"][-1]))
    return [(what, contact, float(impulse), float(loss)) for what, contact, impulse, loss in rows]


def plot(figures: dict[str, Any], path: Path) -> None:
    """Shapes of the beam, its bending moment, the contact force and the turning of the hub."""
    from matplotlib.figure import Figure

    name = "floating frame, CCM"
    result: Result = figures["results"][name]
    beam = figures["scenarios"][name].model.bodies[1]
    along = np.linspace(0.0, beam.length, 41)
    figure = Figure(figsize=(9.0, 6.0), layout="constrained")
    axes = figure.subplots(2, 2)
    for t in np.linspace(0.005, 0.085, 9):
        x, y = deformed_shape(result, beam, along, [t])[0].T
        axes[0, 0].plot(x, 1e3 * y, lw=1.0, color=str(0.8 - 9.0 * t), label=f"{1e3 * t:.0f} ms")
    axes[0, 0].set(xlabel="x, m", ylabel="y, mm", title="shapes of the beam, dark: later")
    times = np.linspace(0.0, result.t[-1], 400)
    moment = bending_moment(result, beam, along, times)
    limit = np.abs(moment).max()
    field = axes[1, 0].pcolormesh(1e3 * times, along, moment.T, cmap="RdBu_r", vmin=-limit, vmax=limit, rasterized=True)
    figure.colorbar(field, ax=axes[1, 0], label="N m")
    axes[1, 0].set(xlabel="time, ms", ylabel="s, m", title="bending moment")
    for label, r in figures["results"].items():
        style = "--" if "CCFM" in label else "-"
        axes[0, 1].plot(1e3 * r.t, r["stop.impulse"], style, lw=1.0, label=label)
        axes[1, 1].plot(1e3 * r.t, r["hub.angular_velocity"], style, lw=1.0, label=label)
    axes[0, 1].set(xlabel="time, ms", ylabel="N s", title="impulse of the stop")
    axes[1, 1].set(xlabel="time, ms", ylabel="rad/s", title="rate of the hub")
    axes[0, 1].legend(fontsize="small")
    figure.savefig(path, dpi=130)


if __name__ == "__main__":
    file = Path(sys.argv[1] if len(sys.argv) > 1 else "hub_beam_stop.png")
    found = run()
    plot(found, file)
    for variant, impulse in found["impulses"].items():
        print(f"{variant:22s} impulse {impulse:.5f} N s")
    print(f"by the moment of momentum of the first: {found['expected_impulse']:.5f} N s; wrote {file}")
    if "--convergence" in sys.argv:
        for what, contact, impulse, loss in convergence():
            print(f"| {what} | {contact.upper()} | {impulse:.5f} | {1e3 * loss:.2f} |")
