"""What a model and its start say about the method to take (`methods/automatic.py`), measured before there is a run."""

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..assembly.assembly import Assembly
from ..assembly.evaluate import evaluate_residuals, evaluate_tangent
from ..assembly.scales import MOST_TIMES
from ..assembly.workspace import Workspace
from ..errors import CallbackError, ModelError
from ..laws import ForceLaw
from ..methods.automatic import AUTO, Choice, Start, choose, choose_by_settings, choose_unmeasured
from ..methods.registry import METHODS
from ..rounding import NO_STIFFNESS
from .settings import Settings

Array = NDArray[np.float64]
PROBES = 4
"""Pseudo-random motions from which the sizes of rows are taken."""


class _Point:
    """The start as it is given, without multipliers and at rest in accelerations: residuals and matrices of a model."""

    def __init__(self, assembly: Assembly, t0: float, workspace: Workspace) -> None:
        self.workspace, self.n, self.rows = workspace, assembly.n, assembly.m_joints
        self.arrays = self.workspace.arrays
        self.arrays["t"][0] = t0
        self.arrays["q"][: self.n] = assembly.q0
        self.reach = self.arrays["level_scale"][: self.n].copy()

    def at(self, t: float) -> None:
        """Go to another time, s."""
        self.arrays["t"][0] = t

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


def measure_start(assembly: Assembly, t0: float, workspace: Workspace | None = None) -> Start:
    """Its contacts, the rate of its motion, the fastest vibration and decay, measured in the memory of a run that has
    not begun (left out: in memory of its own), which is left as it was.

    Rate and vibration are those of the run's scales (`assembly/measure.py`): the vibration is the root of the largest
    ratio of stiffness to mass of a coordinate, at rest; forces and drivers that rest at first are looked at when they
    have begun. The decay is that of damping to mass, at rest or with the start's velocities, whichever is more: what is
    nearly dry friction damps slow motion alone.

    Raises
    ------
    FloatingPointError : if forces or constraints are no finite numbers there.
    """
    workspace = workspace or Workspace(assembly)
    kept, counted = workspace.state_bytes.copy(), workspace.arrays["counters"].copy()
    try:
        return _measured(_Point(assembly, t0, workspace), assembly, t0)
    finally:
        workspace.state_bytes[:], workspace.arrays["counters"][:] = kept, counted


def _measured(point: _Point, assembly: Assembly, t0: float) -> Start:
    v0, rest = np.asarray(assembly.v0, dtype=float), np.zeros(assembly.n)
    scale = np.where(assembly.is_internal, 0.0, np.asarray(assembly.coordinate_scale, dtype=float))
    mass, sizes = np.abs(point.diagonal(rest, 0.0, 0.0)), point.row_sizes(scale)
    moves = (mass > 0.0) & (scale > 0.0)
    with np.errstate(all="ignore"):
        stiffness = np.abs(point.diagonal(rest, 1.0, 0.0) - point.diagonal(rest, 0.0, 0.0)) / mass
        dampings = [np.abs(point.diagonal(v, 0.0, 1.0) - point.diagonal(v, 0.0, 0.0)) / mass for v in (rest, v0)]
        squares = [(v0 / point.reach) ** 2]
        for later in _later_times(assembly, t0):
            point.at(t0 + later)
            for v in (rest, v0):
                r, phid, phidd = point.look(v)
                if not (np.all(np.isfinite(r)) and np.all(np.isfinite(phid)) and np.all(np.isfinite(phidd))):
                    raise FloatingPointError(f"forces or constraints at t = {t0 + later:g} s are no finite numbers")
                squares += [(np.abs(r) / (mass * point.reach))[moves], np.abs(phidd) / sizes]
                squares += [(phid / sizes) ** 2] if v is rest else []
    stiffness = stiffness[moves & (stiffness > NO_STIFFNESS)]
    return Start(
        contacts=len(assembly.contacts),
        force_laws=any(isinstance(contact.law, ForceLaw) for contact in assembly.contacts),
        creep=any(contact.resists_turning or contact.bristles for contact in assembly.contacts),
        rate=float(np.sqrt(max(_largest(x) for x in squares))),
        vibration=float(np.sqrt(_largest(stiffness))),
        slowest=float(np.sqrt(np.min(stiffness, initial=_largest(stiffness)))),
        decay=max(_largest(damping[mass > 0.0]) for damping in dampings),
        waves=assembly.has_waves,
    )


def _later_times(assembly: Assembly, t0: float) -> list[float]:
    """Now, and times after t0 at which forces and drivers that rest at first have begun, s."""
    ahead = [t - t0 for t in assembly.breakpoints if t > t0]
    longest = [0.5 * assembly.longest_step, assembly.longest_step] if np.isfinite(assembly.longest_step) else []
    return [0.0, *ahead[:: max(1, -(-len(ahead) // MOST_TIMES))], *longest]


def _largest(x: Any) -> float:
    finite = np.asarray(x)[np.isfinite(x)]
    return float(np.max(finite, initial=0.0))


def decided(settings: Settings) -> Settings:
    """Settings with the method that `method="auto"` takes whatever the model; the same if the model decides.

    Raises
    ------
    ModelError : for options that belong to another method.
    """
    if settings.method != AUTO.name:
        return settings
    choice = choose_by_settings(settings.method_options, settings.step, settings.outer)
    if choice is None and settings.method_options:
        raise _no_options(settings)
    return settings if choice is None else _with(settings, choice)


def decided_by_start(settings: Settings, assembly: Assembly, workspace: Workspace) -> Settings:
    """Settings with the method that `method="auto"` takes for a model, in the memory of its run."""
    if settings.method != AUTO.name:
        return settings
    try:
        choice = choose(measure_start(assembly, settings.t0, workspace), settings.rtol)
    except (CallbackError, FloatingPointError) as error:
        own = assembly.user_error[-1] if assembly.user_error else error
        assembly.user_error.clear()
        choice = choose_unmeasured(f"{type(own).__name__}: {own}")
    return _with(settings, choice)


def _with(settings: Settings, choice: Choice) -> Settings:
    return replace(settings, method=choice.method, method_options=choice.options, method_chosen=str(choice))


def _no_options(settings: Settings) -> ModelError:
    names = sorted(settings.method_options)
    owners = [name for name, method in METHODS.items() if set(names) <= set(method.options)]
    return ModelError(
        f"method '{AUTO.name}' has no option {names}: options belong to the method that it takes; give a method by its "
        f"name" + (f", here one of {owners}" if owners else "")
    )
