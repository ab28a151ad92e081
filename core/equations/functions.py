"""Own equations of motion: residuals and tangents from a user's functions of scalars and arrays."""

from collections.abc import Callable
from typing import Any

import numpy as np

from .constraints import ConstraintFunctions
from .errors import EquationError
from .seeding import Array
from .user_function import UserFunction


class EquationFunctions:
    """M(t,q) a + Phi_q^T lam = Q(t,q,v) with Phi(t,q) = 0, from functions given by the user.

    Levels of the constraints: Phi = 0, Phi_q v = -Phi_t, Phi_q a = gamma with
    gamma = -(Phi_q v)_q v - 2 Phi_qt v - Phi_tt
    (Haug, Computer Aided Kinematics and Dynamics of Mechanical Systems (1989), section 3.6).

    Parameters
    ----------
    mass : M(t, q) -> (n, n), or a constant array.
    force : Q(t, q, v) -> (n,), or a constant array.
    constraint : Phi(t, q) -> (m,), a number for m = 1; None: unconstrained.
    constraint_jacobian : Phi_q(t, q) -> (m, n), or a constant array; formed where not given.
    gamma : gamma(t, q, v) -> (m,), right-hand side of Phi_q a = gamma; formed where not given.
    constraint_rate : Phi_t(t, q) -> (m,); formed where not given. Only a constraint that depends on time and
        cannot be differentiated needs it.
    n : number of coordinates.

    Functions are plain Python or compiled with numba and return arrays, lists or tuples. Derivatives not
    given are formed by automatic differentiation, or where that fails by the complex step: exact to rounding.
    Values and derivatives may be inf or nan where the functions are; what to do then is the caller's choice.

    Raises
    ------
    EquationError : here and in every method, if a function gives something unusable or cannot be
        differentiated. An exception that a function itself raises passes through, with a note of the function
        and its arguments.
    """

    def __init__(
        self,
        mass: Any,
        force: Any,
        constraint: Callable[..., Any] | None = None,
        constraint_jacobian: Any = None,
        gamma: Any = None,
        *,
        n: int,
        constraint_rate: Any = None,
    ) -> None:
        if not isinstance(n, int | np.integer) or isinstance(n, bool) or n < 1:
            raise EquationError(f"n is {n!r}; needed is the number of coordinates, an integer of at least 1")
        for name, f in (("mass", mass), ("force", force)):
            if f is None:
                raise EquationError(f"{name} is None; needed is a function or a constant array")
        self.n = int(n)
        self._mass = UserFunction("mass", "t, q", mass, (self.n, self.n))
        self._force = UserFunction("force", "t, q, v", force, (self.n,))
        self._constraints = ConstraintFunctions(constraint, constraint_jacobian, gamma, constraint_rate, self.n)

    @property
    def m(self) -> int:
        """Number of constraints, known after `check` or any evaluation of the constraint."""
        return self._constraints.m

    @property
    def constraints(self) -> ConstraintFunctions:
        """The constraints with their derivatives."""
        return self._constraints

    def mass(self, t: float, q: Array) -> Array:
        """M, (n, n)."""
        return self._mass.value(t, q)

    def mass_rate(self, t: float, q: Array, v: Array) -> Array:
        """dM/dt along the motion, M_q v + M_t, (n, n)."""
        return self._mass.slope((t, q), (1.0, v))[1]

    @property
    def mass_is_constant(self) -> bool:
        """Whether M was given as an array."""
        return self._mass.constant is not None

    def force(self, t: float, q: Array, v: Array) -> Array:
        """Q, (n,)."""
        return self._force.value(t, q, v)

    def constraint(self, t: float, q: Array) -> Array:
        """Phi, (m,)."""
        return self._constraints.value(t, q)

    def jacobian(self, t: float, q: Array) -> Array:
        """Phi_q, (m, n)."""
        return self._constraints.jacobian(t, q)

    def velocity_offset(self, t: float, q: Array) -> Array:
        """Phi_t, (m,): the constrained velocities satisfy Phi_q v = -Phi_t."""
        return self._constraints.rate(t, q)

    def gamma(self, t: float, q: Array, v: Array) -> Array:
        """Right-hand side gamma of Phi_q a = gamma, (m,)."""
        return self._constraints.gamma(t, q, v)

    def residuals(self, t: float, q: Array, v: Array, a: Array, lam: Array) -> tuple[Array, Array, Array, Array]:
        """Residuals of the equations of motion and of the constraints at the three levels.

        Parameters
        ----------
        t : time. q, v, a : (n,) coordinates, velocities, accelerations. lam : (m,) multipliers.

        Returns
        -------
        r : (n,) M a + Phi_q^T lam - Q.
        phi, phid, phidd : (m,) Phi, Phi_q v + Phi_t, Phi_q a - gamma.
        """
        r = self._mass.value(t, q) @ a - self._force.value(t, q, v)
        jacobian, phi, phid, phidd = self._constraints.levels(t, q, v, a)
        if phi.size:
            r = r + jacobian.T @ lam
        return r, phi, phid, phidd

    def tangent(
        self, t: float, q: Array, v: Array, a: Array, lam: Array, c_q: float, c_v: float
    ) -> tuple[Array, Array]:
        """Blocks of the Newton matrix [S, J^T; J, 0] of a stage.

        Returns
        -------
        S : (n, n) M + c_v D + c_q K, with K and D the derivatives of M a + Phi_q^T lam - Q by q and v.
        J : (m, n) Phi_q.
        """
        n = self.n
        if self._mass.constant is not None:
            s = self._mass.constant.copy()
        else:
            mass, mass_q = self._mass.gradient((t, q), (1,))
            s = mass + c_q * np.einsum("ijk,j->ik", mass_q, a)
        if self._force.constant is None:
            _, force_qv = self._force.gradient((t, q, v), (1, 2))
            s -= c_q * force_qv[:, :n] + c_v * force_qv[:, n:]
        jacobian, curvature = self._constraints.jacobian_and_curvature(t, q, lam)
        if len(jacobian):
            s += c_q * curvature
        return s, jacobian

    def check(self, t0: float, q0: Array, v0: Array) -> None:
        """Validate the functions at an initial state; see `checking.check_functions`."""
        from .checking import check_functions

        check_functions(self, t0, q0, v0)
