"""Eigenmodes: small free vibrations about a place of rest, in the independent coordinates.

With q = q0 + N y: N^T M N y'' + N^T D N y' + N^T K N y = 0. K holds the multipliers' part, so that a pendulum's
frequency comes from the force in its rod. Contacts that carry force at rest stay closed.
"""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import ModelError
from .at_rest import coordinate_names, matrices
from .equilibrium import Equilibrium, static_equilibrium

Floats = NDArray[np.float64]

NO_DAMPING = 1e-12
"""Part of D or of the skew part of K, relative to sqrt(|K| |M|) and |K|, that counts as none."""
FREE = 1e-9
"""Square of a frequency, relative to the largest, that is that of a free motion."""


@dataclass(frozen=True)
class Eigenmodes:
    """Modes, lowest first; of each conjugate pair the one with positive imaginary part.

    Attributes
    ----------
    eigenvalues : (k,) 1/s: the motion is Re(shape exp(eigenvalue t)).
    shapes : (k, n) in all coordinates; the largest entry, in parts of the coordinates' scales, is 1.
    coordinates : names of the coordinates (n,).
    equilibrium : the place of rest.
    """

    eigenvalues: NDArray[np.complex128]
    shapes: NDArray[np.complex128]
    coordinates: tuple[str, ...]
    equilibrium: Equilibrium

    @property
    def frequencies(self) -> Floats:
        """(k,) Hz, of the vibration as it is seen: |Im|/(2 pi). 0: it creeps or goes away without vibrating."""
        return np.abs(self.eigenvalues.imag) / (2.0 * math.pi)

    @property
    def damping_ratios(self) -> Floats:
        """(k,) -Re/|eigenvalue|; NaN for free motions, whose eigenvalue is 0."""
        size = np.abs(self.eigenvalues)
        return np.divide(0.0 - self.eigenvalues.real, size, out=np.full(len(size), np.nan), where=size > 0.0)

    @property
    def stable(self) -> bool:
        """False if some motion grows exponentially."""
        fastest = float(np.max(np.abs(self.eigenvalues), initial=0.0))
        return bool(np.all(self.eigenvalues.real <= math.sqrt(FREE) * fastest))


def eigenmodes(system: Any, *, settle: bool = True, t: float = 0.0, count: int | None = None) -> Eigenmodes:
    """The modes of small vibrations of `system` about its place of rest.

    Parameters
    ----------
    system : Model, EquationSystem, or an Equilibrium that has been found.
    settle : find the place of rest from the start first; False: the start must be one.
    t : time at which loads and drivers are taken, s.
    count : how many modes, from the lowest; left out: all.

    Raises
    ------
    ModelError : if the start is no place of rest and settle = False, or if drivers move at t. Else as
        `static_equilibrium`.
    """
    rest = resting(system, settle, t)
    found = matrices(rest.sim)
    mass, damping, stiffness = found.reduced()
    # internal states of friction laws have no place: they make no modes
    moving = ~rest.sim.assembly.is_internal[found.independent]
    mass, damping, stiffness = (x[np.ix_(moving, moving)] for x in (mass, damping, stiffness))
    values, shapes = _conservative(mass, stiffness) if _plain(mass, damping, stiffness) else _damped(
        mass, damping, stiffness
    )  # fmt: skip
    order = np.lexsort((values.real, np.round(np.abs(values), 12)))[:count]
    whole = (found.basis[:, moving] @ shapes[:, order]).T
    parts = whole / rest.sim.assembly.coordinate_scale
    largest = np.argmax(np.abs(parts), axis=1) if len(parts) else np.zeros(0, dtype=int)
    whole = whole / parts[np.arange(len(parts)), largest][:, None] if len(parts) else whole
    return Eigenmodes(values[order], whole, coordinate_names(rest.sim), rest)


def resting(system: Any, settle: bool, t: float) -> Equilibrium:
    """The place of rest that an analysis is about.

    Raises
    ------
    ModelError : if the start is none and settle = False, or if drivers move on.
    """
    found = system if isinstance(system, Equilibrium) else static_equilibrium(system, t)
    if not settle and found.iterations > 1:
        raise ModelError(
            "the start is no place of rest: with settle=True the place that the system creeps to from there is found "
            "first"
        )
    workspace = found.sim.workspace
    rates = np.abs(workspace.arrays["phid"][workspace.structure.active])
    if np.any(rates > 0.0):
        driver = found.sim.assembly.row_names[workspace.structure.active[int(np.argmax(rates))]]
        raise ModelError(
            f"'{driver}' moves at t = {found.sim.t:g} s, so there is no rest to vibrate about: take a time t at which "
            "it stands still, or ask floquet_multipliers about a periodic motion"
        )
    return found


def _plain(mass: Floats, damping: Floats, stiffness: Floats) -> bool:
    """True without damping and circulatory forces: modes are real."""
    k, m = float(np.max(np.abs(stiffness), initial=0.0)), float(np.max(np.abs(mass), initial=0.0))
    skew = float(np.max(np.abs(stiffness - stiffness.T), initial=0.0))
    return float(np.max(np.abs(damping), initial=0.0)) <= NO_DAMPING * math.sqrt(k * m) and skew <= NO_DAMPING * k


def _conservative(mass: Floats, stiffness: Floats) -> tuple[NDArray[np.complex128], NDArray[np.complex128]]:
    from scipy.linalg import LinAlgError, eigh

    if not len(mass):
        return np.zeros(0, complex), np.zeros((0, 0), complex)
    try:
        squares, shapes = eigh(0.5 * (stiffness + stiffness.T), mass)
    except LinAlgError:
        raise ModelError(
            "some motion that the joints allow has no mass, so it has no frequency: give its body a mass, or hold it"
        ) from None
    squares = np.where(np.abs(squares) <= FREE * np.max(np.abs(squares)), 0.0, squares)
    # a motion that falls away grows with +sqrt and comes back with -sqrt: the growing one stands for the pair
    roots = np.where(squares >= 0.0, 1j * np.sqrt(np.abs(squares)), np.sqrt(np.abs(squares)))
    return roots, shapes.astype(complex)


def _damped(mass: Floats, damping: Floats, stiffness: Floats) -> tuple[NDArray[np.complex128], NDArray[np.complex128]]:
    from scipy.linalg import eig

    f = len(mass)
    # time in units of the system's own, so that y and y' are of one size
    rate = math.sqrt(max(float(np.max(np.abs(stiffness))), 1e-300) / max(float(np.max(np.abs(mass))), 1e-300))
    zero, one = np.zeros((f, f)), np.eye(f)
    left = np.block([[zero, one], [-stiffness / rate**2, -damping / rate]])
    values, vectors = eig(left, np.block([[one, zero], [zero, mass]]))
    values = values * rate
    kept = np.isfinite(values) & (values.imag >= 0.0)
    values, shapes = values[kept], vectors[:f, kept]
    largest = float(np.max(np.abs(values), initial=0.0))
    values = np.where(np.abs(values) <= math.sqrt(FREE) * largest, 0.0, values)
    return values, shapes
