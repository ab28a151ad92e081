"""Validation of a user's equations at the initial state."""

from typing import TYPE_CHECKING, Any

import numpy as np

from ..rounding import AGREEMENT, CANCELLED, DEFINITE, SYMMETRY
from .errors import EquationError, NotDifferentiableError
from .seeding import Array

if TYPE_CHECKING:
    from .functions import EquationFunctions


def check_functions(functions: "EquationFunctions", t0: float, q0: Array, v0: Array) -> None:
    """Check shapes, finite values, the mass matrix and the derivatives that the user gives.

    The mass matrix must be symmetric and positive semidefinite, and positive definite on the null space of
    Phi_q: then the accelerations are determined. Given derivatives must agree with those formed from the
    constraint, where they can be formed. Redundant constraints are not refused here.

    Raises
    ------
    EquationError : with the name, the value found, what is needed and how to get there.
    """
    n = functions.n
    q, v = _state("q0", q0, n), _state("v0", v0, n)
    t = _state("t0", [t0], 1)[0].item()
    mass = _finite("mass(t, q)", functions.mass(t, q))
    _finite("force(t, q, v)", functions.force(t, q, v))
    _finite("constraint(t, q)", functions.constraint(t, q))
    _check_given(functions, t, q, v)
    jacobian = _finite("the Jacobian Phi_q of constraint(t, q)", functions.jacobian(t, q))
    _finite("the time derivative Phi_t of constraint(t, q)", functions.velocity_offset(t, q))
    _finite("gamma(t, q, v)", functions.gamma(t, q, v))
    check_mass(mass, jacobian)
    # Whatever cannot be differentiated shows now, not in the middle of a run.
    tangent, _ = functions.tangent(t, q, v, np.ones(n), np.ones(functions.m), 1.0, 1.0)
    _finite("the derivatives of mass, force and constraint", tangent)


def check_mass(mass: Array, jacobian: Array) -> None:
    """Refuse a mass matrix (n, n) that is not symmetric, or not positive on the free motions."""
    size = np.max(np.abs(mass))
    skew = np.abs(mass - mass.T)
    if np.max(skew) > SYMMETRY * size:
        i, j = np.unravel_index(np.argmax(skew), skew.shape)
        raise EquationError(
            f"mass(t, q) must be symmetric: mass[{i}, {j}] = {mass[i, j]:.17g}, "
            f"mass[{j}, {i}] = {mass[j, i]:.17g}; fill both triangles alike"
        )
    # Coordinates of different units are made comparable by a unit diagonal.
    diagonal = np.diag(mass)
    scale = np.sqrt(np.where(diagonal > 0.0, diagonal, 1.0))
    scaled = 0.5 * (mass + mass.T) / np.outer(scale, scale)
    eigenvalues = np.linalg.eigvalsh(scaled)
    largest = max(np.max(np.abs(scaled)), 1e-300)
    if eigenvalues[0] < -DEFINITE * len(mass) * largest:
        raise EquationError(
            f"mass(t, q) must be positive (semi)definite: its smallest eigenvalue, scaled to a unit "
            f"diagonal, is {eigenvalues[0]:.6g}, diagonal {diagonal.tolist()}; check the signs"
        )
    free = _null_space(jacobian / scale)
    if free.shape[1] == 0:
        return
    reduced = np.linalg.eigvalsh(free.T @ scaled @ free)
    if reduced[0] <= DEFINITE * largest:
        where = "on the motions that the constraints leave free" if len(jacobian) else "(there are no constraints)"
        raise EquationError(
            f"mass(t, q) must be positive definite {where}: its smallest eigenvalue there, scaled to a unit "
            f"diagonal, is {reduced[0]:.6g}; give every free coordinate a mass or constrain it"
        )


def _null_space(jacobian: Array) -> Array:
    m, n = jacobian.shape
    if m == 0:
        return np.eye(n)
    _, singular, vt = np.linalg.svd(jacobian)
    rank = int(np.sum(singular > 1e-12 * max(singular[0], 1e-300))) if singular.size else 0
    return vt[rank:].T


def _state(name: str, given: Any, n: int) -> Array:
    try:
        array = np.array(given, dtype=float)
    except (TypeError, ValueError) as error:
        raise EquationError(f"{name} is {given!r}; needed are {n} real numbers") from error
    if array.shape != (n,):
        raise EquationError(f"{name} has shape {array.shape}; needed is ({n},), one entry for each coordinate")
    return _finite(name, array)


def _finite(name: str, array: Array) -> Array:
    bad = np.argwhere(~np.isfinite(array))
    if len(bad):
        index = tuple(int(i) for i in bad[0])
        raise EquationError(
            f"{name} is {array[index]} at entry {list(index)} for the initial state; needed are finite "
            "values: check for a division by zero, a root of a negative number, or start from another state"
        )
    return array


def _check_given(functions: "EquationFunctions", t: float, q: Array, v: Array) -> None:
    """Compare what the user gives with what the constraint alone gives, where that can be differentiated."""
    given = functions.constraints
    if not (given.jacobian_given or given.gamma_given or given.rate_given):
        return
    formed = given.without_given()
    try:
        jacobian, rate = formed.jacobian(t, q), formed.rate(t, q)
    except NotDifferentiableError:
        return
    if given.jacobian_given:
        _agree("constraint_jacobian", functions.jacobian(t, q), jacobian, 0.0)
    size = float(np.max(np.abs(jacobian), initial=0.0))
    if given.rate_given:
        _agree("constraint_rate", functions.velocity_offset(t, q), rate, CANCELLED * size)
    if given.gamma_given:
        # At rest gamma has few terms: compare in motion as well.
        for velocity in (v, v + (1.0 + np.max(np.abs(v))) * np.cos(1.0 + np.arange(len(v)))):
            try:
                gamma = formed.gamma(t, q, velocity)
            except NotDifferentiableError:
                return
            floor = CANCELLED * size * (1.0 + float(np.max(np.abs(velocity)))) ** 2
            at = f" with v = {velocity.tolist()}"
            _agree("gamma", functions.gamma(t, q, velocity), gamma, floor, at)


def _agree(name: str, given: Array, formed: Array, floor: float, at: str = "") -> None:
    _finite(name, given)
    if not np.all(np.isfinite(formed)):
        return  # nothing to compare with
    difference = np.abs(given - formed)
    size = max(np.max(np.abs(given), initial=0.0), np.max(np.abs(formed), initial=0.0))
    if np.max(difference, initial=0.0) <= AGREEMENT * size + floor:
        return
    index = np.unravel_index(np.argmax(difference), difference.shape)
    entry = ", ".join(str(int(i)) for i in index)
    raise EquationError(
        f"{name} disagrees with constraint at the initial state{at}: {name}[{entry}] = {given[index]:.15g}, "
        f"automatic differentiation of constraint gives {formed[index]:.15g}; correct it, or leave {name} out"
    )
