"""What a model and its start say about the method to take (`methods/automatic.py`), measured before there is a run."""

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..assembly.assembly import Assembly
from ..assembly.evaluate import evaluate_residuals, evaluate_tangent
from ..assembly.workspace import Workspace
from ..errors import ModelError
from ..laws import ForceLaw
from ..methods.automatic import AUTO, Start, choose
from ..multibody_model import Model
from ..rounding import NO_STIFFNESS
from .settings import Settings

Array = NDArray[np.float64]
PROBES = 4
"""Pseudo-random motions from which the sizes of rows are taken."""


class _Point:
    """The start as it is given, without multipliers and at rest in accelerations: residuals and matrices of a model."""

    def __init__(self, assembly: Assembly, t0: float) -> None:
        self.workspace, self.n, self.rows = Workspace(assembly), assembly.n, assembly.m_joints
        self.arrays = self.workspace.arrays
        self.arrays["t"][0] = t0
        self.arrays["q"][: self.n] = assembly.q0
        self.reach = self.arrays["level_scale"][: self.n].copy()

    def look(self, v: Array) -> tuple[Array, Array, Array]:
        """With the velocities v (n,): -Q (n,), Phi_q v + Phi_t (rows,), and Phi'' without accelerations (rows,)."""
        self.arrays["v"][: self.n] = v
        evaluate_residuals(self.workspace.record)
        r, phid, phidd = (self.arrays[name] for name in ("r", "phid", "phidd"))
        return r[: self.n].copy(), phid[: self.rows].copy(), phidd[: self.rows].copy()

    def diagonal(self, v: Array, c_q: float, c_v: float) -> Array:
        """Diagonal of M + c_v D + c_q K (n,)."""
        self.look(v)
        evaluate_tangent(self.workspace.record, c_q, c_v)
        slots = self.arrays["mass_slot"]
        rows, cols = self.arrays["entry_row"][slots], self.arrays["entry_col"][slots]
        own, found = rows == cols, np.zeros(self.n)
        found[rows[own]] = self.arrays["values"][slots[own]]
        return found

    def row_sizes(self, scale: Array) -> Array:
        """How far rows of Phi move with coordinates that move by their scales (n,), the largest of several motions."""
        still, sizes = self.look(np.zeros(self.n))[1], np.zeros(self.rows)
        for k in range(PROBES):
            ahead = (0.6180339887498949 * np.arange(1, self.n + 1) * (2 * k + 1)) % 1.0 < 0.5
            sizes = np.maximum(sizes, np.abs(self.look(np.where(ahead, scale, -scale))[1] - still))
        return sizes


def measure_start(assembly: Assembly, t0: float) -> Start:
    """Its contacts, the rate of its motion, the fastest vibration and decay.

    Rate and vibration are those of the run's scales (`assembly/measure.py`): the vibration is the root of the largest
    ratio of stiffness to mass of a coordinate, at rest. The decay is that of damping to mass, with the start's
    velocities. What acts later is not seen.
    """
    point, v0, rest = _Point(assembly, t0), np.asarray(assembly.v0, dtype=float), np.zeros(assembly.n)
    scale = np.where(assembly.is_internal, 0.0, np.asarray(assembly.coordinate_scale, dtype=float))
    mass, sizes = np.abs(point.diagonal(rest, 0.0, 0.0)), point.row_sizes(scale)
    moves = (mass > 0.0) & (scale > 0.0)
    with np.errstate(all="ignore"):
        stiffness = np.abs(point.diagonal(rest, 1.0, 0.0) - point.diagonal(rest, 0.0, 0.0)) / mass
        damping = np.abs(point.diagonal(v0, 0.0, 1.0) - point.diagonal(v0, 0.0, 0.0)) / mass
        squares = [(v0 / point.reach) ** 2]
        for v in (rest, v0):
            r, phid, phidd = point.look(v)
            squares += [(np.abs(r) / (mass * point.reach))[moves], np.abs(phidd) / sizes]
            squares += [(phid / sizes) ** 2] if v is rest else []
    stiffness = stiffness[moves & (stiffness > NO_STIFFNESS)]
    return Start(
        contacts=len(assembly.contacts),
        force_laws=any(isinstance(contact.law, ForceLaw) for contact in assembly.contacts),
        rate=float(np.sqrt(max(_largest(x) for x in squares))),
        vibration=float(np.sqrt(_largest(stiffness))),
        slowest=float(np.sqrt(np.min(stiffness, initial=_largest(stiffness)))),
        decay=_largest(damping[mass > 0.0]),
        waves=assembly.has_waves,
    )


def _largest(x: Any) -> float:
    finite = np.asarray(x)[np.isfinite(x)]
    return float(np.max(finite, initial=0.0))


def with_choice(settings: Settings, system: Any) -> Settings:
    """Settings of `method="auto"` with the method that it takes for a Model or EquationSystem.

    Raises
    ------
    ModelError : for options, which belong to one method.
    """
    if settings.method_options:
        raise ModelError(
            f"method '{AUTO.name}' has no option {sorted(settings.method_options)}: options belong to the method that "
            "it takes; give that by its name"
        )
    # an assembly of its own: the functions of own equations work in the memory of one run
    assembly = system.assemble(t0=settings.t0) if isinstance(system, Model) else system.assemble()
    choice = choose(measure_start(assembly, settings.t0), settings.rtol, settings.step, settings.outer)
    return replace(settings, method=choice.method, method_options=choice.options, method_chosen=str(choice))
