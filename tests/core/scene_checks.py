"""How far runs of a random scene are from one another and from the dense reference."""

from dataclasses import dataclass

import numpy as np
from dense_contacts import contact_problem, is_planar
from indeterminate_scenes import Scene, permuted, turned
from regularised_contacts import rigid_forces
from tlismni.core import Result, simulate
from units import Units

SI = Units()
SAME, FORCES, TIGHT = 1e-9, 1e-6, 1e-10
"""Deviations of motions and of forces that are none; the tolerance with which motions that differ are repeated."""
SHRINKS = 0.1
"""By so much the difference of two motions falls at least where it is the error of integration: the choice of dependent
coordinates, and with it the steps, may depend on the order of the list."""


@dataclass
class Deviations:
    """Of a scene; parts of its scales."""

    order: float
    """Of the motion at the end among orders of the list."""
    units: float
    """Of the motion at the end in other units."""
    forces: float
    """Of normal and friction forces at the start from the dense reference."""
    motion: float
    """Of the accelerations at the start from those of the reference."""
    events: int

    def __str__(self) -> str:
        parts = [f"{name} {getattr(self, name):.1e}" for name in ("order", "units", "forces", "motion")]
        return f"{', '.join(parts)}, {self.events} events"


def at_end(result: Result, names, units: Units = SI) -> np.ndarray:
    """Places, attitudes and their rates of the bodies at the end, in m, rad and s."""
    found = []
    for name in names:
        for record in result.channel_records:
            part = record.name.removeprefix(f"{name}.")
            if part == record.name or (part.startswith(("a", "body")) and part not in ("angle", "angular_velocity")):
                continue
            if part.endswith("acceleration") or part in ("ax", "ay", "az"):
                continue
            found.append(result[record.name][-1] / units.of(record.unit))
    return np.array(found)


def first_forces(result: Result, names, planar: bool) -> np.ndarray:
    """(contacts, 2): normal force and friction (in space its size) at the start, N."""
    return np.array([[result[f"{name}.{kind}_force"][0] for kind in ("normal", "friction")] for name in names])


def reference_forces(forces, planar: bool) -> np.ndarray:
    """The same of the dense reference."""
    values = forces.values.astype(float)
    friction = values[:, 1] if planar else np.linalg.norm(values[:, 1:], axis=1)
    return np.stack((values[:, 0], friction), axis=1)


def first_motion(result: Result, names, planar: bool) -> np.ndarray:
    """(bodies, 6): accelerations at the start."""
    along = ("ax", "ay") if planar else ("ax", "ay", "az")
    turn = ("angular_acceleration",) if planar else tuple(f"angular_acceleration_{axis}" for axis in "xyz")
    found = np.zeros((len(names), 6))
    for i, name in enumerate(names):
        found[i, : len(along)] = [result[f"{name}.{part}"][0] for part in along]
        found[i, 6 - len(turn) :] = [result[f"{name}.{part}"][0] for part in turn]
    return found


def examine(scene: Scene, orders: int = 2, rtol: float = 1e-6) -> Deviations:
    """Run a scene in several orders and in other units, and compare."""
    rng = np.random.default_rng(scene.seed + 2**40)
    planar, end = is_planar(scene.model), scene.end
    problem = contact_problem(scene.model)
    forces = rigid_forces(problem)
    names = [body.name for body in scene.model.bodies]
    times = np.linspace(0.0, end, 5)
    first = simulate(scene.model, end, scene.method, t_eval=times, rtol=rtol)
    load = max(float(np.max(np.abs(forces.values))), 1e-6)
    wanted, got = reference_forces(forces, planar), first_forces(first, problem.names, planar)
    accelerations = np.array([problem.motion(forces.values)[name] for name in names], float)
    motion = np.abs(first_motion(first, names, planar) - accelerations).max() / max(np.abs(accelerations).max(), 9.81)
    worst = {"order": 0.0, "units": 0.0, "forces": np.abs(wanted - got).max() / load}
    scale = np.maximum(np.abs(at_end(first, names)), 1.0)
    for _ in range(orders):
        other = simulate(permuted(scene.model, rng), end, scene.method, t_eval=times, rtol=rtol)
        worst["order"] = max(worst["order"], np.max(np.abs(at_end(other, names) - at_end(first, names)) / scale))
        got = first_forces(other, problem.names, planar)
        worst["forces"] = max(worst["forces"], np.abs(wanted - got).max() / load)
    model = scene.model if rng.random() < 0.5 else turned(scene.model, rng)
    base = first if model is scene.model else simulate(model, end, scene.method, t_eval=times, rtol=rtol)
    length = 10.0 ** rng.uniform(-6.0, 3.0)
    units = Units(length, 10.0 ** rng.uniform(-6.0, 6.0), np.sqrt(length) * 10.0 ** rng.uniform(-1.0, 1.0))
    small = simulate(
        permuted(units.model(model), rng), end * units.time, scene.method, t_eval=times * units.time, rtol=rtol
    )
    worst["units"] = np.max(np.abs(at_end(small, names, units) - at_end(base, names)) / scale)
    got = first_forces(small, problem.names, planar) / units.factor((1, 1, -2))
    worst["forces"] = max(worst["forces"], np.abs(wanted - got).max() / load)
    return Deviations(**worst, motion=float(motion), events=len(first.events))


def deviations(scene: Scene, orders: int = 2) -> tuple[Deviations, Deviations | None]:
    """Of a scene, and where its motion in other orders or units differs, those with a tight tolerance."""
    found = examine(scene, orders)
    return found, examine(scene, orders, TIGHT) if max(found.order, found.units) > SAME else None


def wrong(found: Deviations, tight: Deviations | None) -> list[str]:
    """What of a scene is not as it should be."""
    names = [name for name in ("forces", "motion") if getattr(found, name) > FORCES]
    if tight is not None:
        for name in ("order", "units"):
            if getattr(tight, name) > max(SAME, SHRINKS * getattr(found, name)):
                names.append(name)
    return names
