"""Figures of analyses."""

import math
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..core.analysis import Eigenmodes, Equilibrium, Mobility, ParameterSensitivities, StateSpace
from ..core.elements import Cable2D
from ..core.extras import require
from ..models import Scenario
from ..viewer.build import scene_of_start
from ..viewer.drawing.shapes import Circle, Drawing, Label
from ..viewer.still import still
from .plots import save

MOST_SHAPES = 6
SWING = 0.12
"""Size of a drawn mode, in parts of the mechanism's."""
PIECES = 16
"""Of the line between two nodes of a cable."""
POINTS = 2000
"""Frequencies of a Bode diagram."""


def _figure(width: float, height: float) -> Any:
    require("a plot", "plot", matplotlib="")
    from matplotlib.figure import Figure

    return Figure(figsize=(width, height), layout="constrained")


def plot_mobility(found: Mobility, name: str, path: Path) -> Path:
    """Singular values of the scaled constraints: one near zero tells of a singular position."""
    figure = _figure(7.0, 3.5)
    axis = figure.subplots()
    values = np.maximum(found.singular_values, 1e-17)
    axis.bar(np.arange(1, len(values) + 1), values, color="0.4", width=0.7)
    axis.set(yscale="log", xlabel="number", ylabel="singular value of the scaled $\\Phi_q$")
    axis.xaxis.get_major_locator().set_params(integer=True)
    axis.grid(alpha=0.3, axis="y")
    figure.suptitle(
        f"{name}: {found.coordinates} coordinates, {found.rank} independent equations, "
        f"{found.freedom} degrees of freedom",
        fontsize=10,
    )
    return save(figure, path)


def plot_equilibrium(found: Equilibrium, scenario: Scenario, path: Path) -> Path:
    """The mechanism at rest, and faintly where it started."""
    figure = _figure(7.0, 5.5)
    axis = figure.subplots()
    _draw(axis, still(scene_of_start(scenario.model, sketches=scenario.sketches), 0), 0.25)
    _draw(axis, still(scene_of_start(found.model, sketches=scenario.sketches), 0), 1.0)
    axis.set_aspect("equal", "datalim")
    axis.set(xlabel="x, m", ylabel="y, m")
    axis.autoscale_view()
    figure.suptitle(f"{scenario.name}: at rest, and where it started", fontsize=10)
    return save(figure, path)


def _draw(axis: Any, drawing: Drawing, strength: float) -> None:
    for shape in drawing.shapes:
        if isinstance(shape, Label):
            continue
        if isinstance(shape, Circle):
            angles = np.linspace(0.0, 2.0 * math.pi, 49)
            x, y = np.array(shape.centre)[:, None] + shape.radius * np.array([np.cos(angles), np.sin(angles)])
        else:
            x, y = np.array([*shape.points, *(shape.points[:1] if shape.closed else ())]).T
        if shape.fill:
            axis.fill(x, y, color=shape.fill, alpha=0.6 * strength, lw=0)
        if shape.stroke:
            axis.plot(x, y, color=shape.stroke, lw=1.2, alpha=strength)


def plot_modes(found: Eigenmodes, name: str, path: Path) -> Path:
    """Eigenvalues in the complex plane, and the shapes of the lowest vibrations at places x, y of the coordinates."""
    points = _points(found.coordinates)
    vibrating = [k for k in range(len(found.eigenvalues)) if found.frequencies[k] > 0.0][:MOST_SHAPES]
    shown = vibrating if points else []
    figure = _figure(9.0, 3.4 + 2.6 * math.ceil(len(shown) / 3))
    grid = figure.add_gridspec(
        1 + math.ceil(len(shown) / 3), 3, height_ratios=[1.3] + [1.0] * math.ceil(len(shown) / 3)
    )
    plane = figure.add_subplot(grid[0, :])
    plane.axvline(0.0, color="0.6", lw=0.6)
    plane.plot(found.eigenvalues.real, found.eigenvalues.imag, "o", ms=5, color="tab:blue")
    plane.set(xlabel="real part, 1/s", ylabel="imaginary part, rad/s")
    plane.grid(alpha=0.3)
    rest = found.equilibrium.q
    for i, k in enumerate(shown):
        axis = figure.add_subplot(grid[1 + i // 3, i % 3])
        place = np.array([[rest[x], rest[y]] for x, y in points])
        shape = found.shapes[k].real
        moved = np.array([[shape[x], shape[y]] for x, y in points])
        size = max(float(np.max(np.ptp(place, axis=0), initial=0.0)), 1e-300)
        largest = float(np.max(np.hypot(*moved.T), initial=0.0))
        factor = SWING * size / largest if largest > 0.0 else 0.0
        for line in _lines(found.coordinates, points):
            for sign, colour in ((0.0, "0.75"), (1.0, "tab:blue"), (-1.0, "tab:orange")):
                q = rest + sign * factor * shape
                axis.plot(*(place + sign * factor * moved)[line].T, ".", color=colour, ms=4)
                axis.plot(*_course(found, [points[i] for i in line], q).T, "-", color=colour, lw=1.0)
        axis.set_aspect("equal", "datalim")
        axis.set_title(f"{found.frequencies[k]:.4g} Hz, damping {found.damping_ratios[k]:.2g}", fontsize=9)
        axis.tick_params(labelsize=7)
    figure.suptitle(f"{name}: modes about rest", fontsize=10)
    return save(figure, path)


def _points(names: tuple[str, ...]) -> list[tuple[int, int]]:
    """Pairs of coordinates that are a place: body.x with body.y, node by node."""
    index = {name: k for k, name in enumerate(names)}
    found = []
    for name, k in index.items():
        body, _, coordinate = name.rpartition(".")
        if coordinate.startswith("x") and (partner := f"{body}.y{coordinate[1:]}") in index:
            found.append((k, index[partner]))
    return found


def _lines(names: tuple[str, ...], points: list[tuple[int, int]]) -> list[list[int]]:
    """Which points a line joins: the nodes of a body; where every body has one point only, all of them."""
    bodies: dict[str, list[int]] = {}
    for i, (x, _) in enumerate(points):
        bodies.setdefault(names[x].rpartition(".")[0], []).append(i)
    if all(len(nodes) == 1 for nodes in bodies.values()):
        return [list(range(len(points)))]
    return list(bodies.values())


def _course(found: Eigenmodes, nodes: list[tuple[int, int]], q: NDArray[np.float64]) -> NDArray[np.float64]:
    """Points (n, 2) of the line through nodes: cubics by the slopes of a cable's nodes, straight without."""
    place = np.array([[q[x], q[y]] for x, y in nodes])
    body = found.coordinates[nodes[0][0]].rpartition(".")[0]
    index = {name: k for k, name in enumerate(found.coordinates)}
    numbers = [found.coordinates[x].rpartition(".x")[2] for x, _ in nodes]
    slopes = [(index.get(f"{body}.slope_x{n}"), index.get(f"{body}.slope_y{n}")) for n in numbers]
    record = next((b for b in found.equilibrium.model.bodies if b.name == body), None)
    if len(nodes) < 2 or not isinstance(record, Cable2D) or any(None in pair for pair in slopes):
        return place
    tangent = np.array([[q[x], q[y]] for x, y in slopes]) * record.length / record.elements
    s = np.linspace(0.0, 1.0, PIECES + 1)[:, None]
    h = 2.0 * s**3 - 3.0 * s**2 + 1.0, s**3 - 2.0 * s**2 + s, 3.0 * s**2 - 2.0 * s**3, s**3 - s**2
    parts = zip(place, tangent, place[1:], tangent[1:], strict=False)
    return np.concatenate([h[0] * a + h[1] * da + h[2] * b + h[3] * db for a, da, b, db in parts])


def plot_bode(found: StateSpace, name: str, path: Path) -> Path:
    """Magnitude and phase of the transfer functions, at most eight of them, over a decade around the poles."""
    speeds = np.abs(found.poles)
    speeds = speeds[speeds > 1e-6 * max(float(np.max(speeds, initial=0.0)), 1e-300)] / (2.0 * math.pi)
    low, high = (float(speeds.min()) / 10.0, float(speeds.max()) * 10.0) if len(speeds) else (0.01, 100.0)
    frequencies = np.geomspace(low, high, POINTS)
    transfer = found.transfer(frequencies)
    figure = _figure(8.0, 6.0)
    upper, lower = figure.subplots(2, 1, sharex=True)
    pairs = [(o, i) for o in range(len(found.outputs)) for i in range(len(found.inputs))]
    pairs = [pair for pair in pairs if float(np.max(np.abs(transfer[:, pair[0], pair[1]]))) > 1e-12][:8]
    for o, i in pairs:
        label = f"{found.outputs[o]} / {found.inputs[i]}"
        upper.loglog(frequencies, np.abs(transfer[:, o, i]), lw=1.0, label=label)
        lower.semilogx(frequencies, np.degrees(np.unwrap(np.angle(transfer[:, o, i]))), lw=1.0)
    upper.set_ylabel("magnitude, SI units")
    lower.set(ylabel="phase, degrees", xlabel="frequency, Hz")
    for axis in (upper, lower):
        axis.grid(alpha=0.3, which="both")
    if pairs:
        upper.legend(fontsize=8)
    figure.suptitle(f"{name}: transfer functions about rest", fontsize=10)
    return save(figure, path)


def plot_sensitivities(found: ParameterSensitivities, name: str, path: Path) -> Path:
    """Change of each channel for a change of each parameter by its own value: over time, or as bars."""
    relative = found.relative
    unsure = found.errors * np.abs(found.values)[:, None, None]
    figure = _figure(8.0, 1.0 + 2.4 * len(found.channels))
    for c, axis in enumerate(figure.subplots(len(found.channels), 1, squeeze=False)[:, 0]):
        if len(found.t) > 1:
            for p, parameter in enumerate(found.parameters):
                clear = np.where(unsure[p, :, c] <= np.max(np.abs(relative[p, :, c])), relative[p, :, c], np.nan)
                axis.plot(found.t, clear, lw=1.0, label=parameter)
            axis.set_xlabel("time, s")
            axis.legend(fontsize=7)
        else:
            order = np.argsort(np.abs(relative[:, 0, c]))
            values: NDArray[np.float64] = relative[order, 0, c]
            axis.barh([found.parameters[p] for p in order], values, xerr=unsure[order, 0, c], color="tab:blue")
        axis.set_ylabel(found.channels[c], fontsize=8)
        axis.grid(alpha=0.3)
    figure.suptitle(f"{name}: change for a parameter's own value", fontsize=10)
    return save(figure, path)
