"""Conservation of momentum in exudyn runs."""

import numpy as np
from tlismni.core.elements import RigidBody2D
from tlismni.core.multibody_model import Model
from tlismni.validation.exudyn_run import run_exudyn


def momentum_drift(model: Model, t_end: float, step: float) -> float:
    """Largest change of linear and angular momentum about the origin, in a run without outer forces."""
    r = run_exudyn(model, t_end, step)
    px = py = spin = np.zeros(len(r.t))
    for b in model.bodies:
        vx, vy = r[f"{b.name}.vx"], r[f"{b.name}.vy"]
        px, py = px + b.mass * vx, py + b.mass * vy
        spin = spin + b.mass * (r[f"{b.name}.x"] * vy - r[f"{b.name}.y"] * vx)
        if isinstance(b, RigidBody2D):
            spin = spin + b.inertia * r[f"{b.name}.angular_velocity"]
    return max(float(np.ptp(x)) for x in (px, py, spin))
