"""Constraints given as a function Phi(t, q), with whatever derivatives the user gives and those formed."""

from typing import Any

import numpy as np

from .errors import EquationError, NotDifferentiableError
from .seeding import Array
from .user_function import UserFunction


class ConstraintFunctions:
    """Phi(t, q) and its derivatives; see `EquationFunctions` for parameters and conventions."""

    def __init__(self, constraint: Any, jacobian: Any, gamma: Any, rate: Any, n: int, name: str = "constraint") -> None:
        self.n = n
        self._name = name
        self._function: UserFunction | None = None
        self._jacobian: UserFunction | None = None
        self._gamma: UserFunction | None = None
        self._rate: UserFunction | None = None
        self._given = {"constraint_jacobian": jacobian, "gamma": gamma, "constraint_rate": rate}
        if constraint is None:
            for name, f in self._given.items():
                if f is not None:
                    raise EquationError(f"{name} is given without constraint; give constraint=, the function Phi(t, q)")
            return
        if not callable(constraint):
            raise EquationError(f"{name} is {constraint!r}; needed is a function of (t, q)")
        self._function = UserFunction(name, "t, q", constraint, None)
        self._depends_on_time = self._function.uses_first_argument()

    @property
    def m(self) -> int:
        """Number of constraints."""
        if self._function is None:
            return 0
        if self._function.shape is None:
            raise EquationError("the number of constraints is not known yet; call check(t0, q0, v0) first")
        return self._function.shape[0]

    @property
    def jacobian_given(self) -> bool:
        """Whether the user gave Phi_q."""
        return self._given["constraint_jacobian"] is not None

    @property
    def gamma_given(self) -> bool:
        """Whether the user gave gamma."""
        return self._given["gamma"] is not None

    @property
    def rate_given(self) -> bool:
        """Whether the user gave Phi_t."""
        return self._given["constraint_rate"] is not None

    def without_given(self) -> "ConstraintFunctions":
        """The same constraint with every derivative formed from it."""
        constraint = None if self._function is None else self._function.original
        return ConstraintFunctions(constraint, None, None, None, self.n, self._name)

    def _prepare(self, function: UserFunction, t: float, q: Array) -> UserFunction:
        """The constraint's `function`; wraps the given derivatives as soon as the number of constraints is known."""
        if function.shape is None:
            function.value(t, q)
        if any(f is not None for f in self._given.values()) and not (self._jacobian or self._gamma or self._rate):
            m = self.m
            given = self._given
            if given["constraint_jacobian"] is not None:
                jacobian = given["constraint_jacobian"]
                self._jacobian = UserFunction("constraint_jacobian", "t, q", jacobian, (m, self.n))
            if given["gamma"] is not None:
                self._gamma = UserFunction("gamma", "t, q, v", given["gamma"], (m,))
            if given["constraint_rate"] is not None:
                self._rate = UserFunction("constraint_rate", "t, q", given["constraint_rate"], (m,))
        return function

    def value(self, t: float, q: Array) -> Array:
        """Phi, (m,)."""
        return np.zeros(0) if self._function is None else self._function.value(t, q)

    def jacobian(self, t: float, q: Array) -> Array:
        """Phi_q, (m, n)."""
        if self._function is None:
            return np.zeros((0, self.n))
        function = self._prepare(self._function, t, q)
        if self._jacobian is not None:
            return self._jacobian.value(t, q)
        return function.gradient((t, q), (1,))[1]

    def rate(self, t: float, q: Array) -> Array:
        """Phi_t, (m,)."""
        if self._function is None:
            return np.zeros(0)
        return self._value_and_rate(self._prepare(self._function, t, q), t, q)[1]

    def _value_and_rate(self, function: UserFunction, t: float, q: Array) -> tuple[Array, Array]:
        if self._rate is not None:
            return function.value(t, q), self._rate.value(t, q)
        if not self._depends_on_time:
            return function.value(t, q), np.zeros(self.m)
        # Only the time is a jet here: what does not depend on it is evaluated plainly.
        return function.slope((t, q), (1.0, None))

    def gamma(self, t: float, q: Array, v: Array) -> Array:
        """gamma = -(Phi_q v)_q v - 2 Phi_qt v - Phi_tt, (m,): minus the second derivative along (v, 1)."""
        if self._function is None:
            return np.zeros(0)
        function = self._prepare(self._function, t, q)
        if self._gamma is not None:
            return self._gamma.value(t, q, v)
        try:
            return -function.along((t, q), (1.0, v), (0.0, np.zeros(self.n)))[2]
        except NotDifferentiableError:
            if self._jacobian is None or (self._depends_on_time and self._rate is None):
                raise
        # d/ds (Phi_q v + Phi_t) along (v, 1), from the derivatives given.
        turning = self._jacobian.slope((t, q), (1.0, v))[1] @ v
        return -turning - (self._rate.slope((t, q), (1.0, v))[1] if self._rate is not None else 0.0)

    def levels(self, t: float, q: Array, v: Array, a: Array) -> tuple[Array, Array, Array, Array]:
        """Phi_q (m, n), Phi, Phi_q v + Phi_t and Phi_q a - gamma (m,), in few evaluations."""
        if self._function is None:
            return np.zeros((0, self.n)), np.zeros(0), np.zeros(0), np.zeros(0)
        function = self._prepare(self._function, t, q)
        if self._gamma is None:
            try:
                # The curve q + s v + s^2 a / 2 at the time t + s has all three levels as its derivatives.
                phi, phid, phidd = function.along((t, q), (1.0, v), (0.0, a))
                return self.jacobian(t, q), phi, phid, phidd
            except NotDifferentiableError:
                pass  # gamma() has another way, or says what is missing
        elif self._jacobian is None and self._depends_on_time and self._rate is None:
            phi, both = function.gradient((t, q), (1, 0))
            jacobian, rate = both[:, : self.n], both[:, self.n]
            return jacobian, phi, jacobian @ v + rate, jacobian @ a - self._gamma.value(t, q, v)
        gamma = self.gamma(t, q, v)
        jacobian = self.jacobian(t, q)
        phi, rate = self._value_and_rate(function, t, q)
        return jacobian, phi, jacobian @ v + rate, jacobian @ a - gamma

    def jacobian_and_curvature(self, t: float, q: Array, lam: Array) -> tuple[Array, Array]:
        """Phi_q (m, n) and (Phi_q^T lam)_q (n, n)."""
        if self._function is None:
            return np.zeros((0, self.n)), np.zeros((self.n, self.n))
        function = self._prepare(self._function, t, q)
        if self._jacobian is not None:
            if self._jacobian.constant is not None:
                return self._jacobian.value(t, q), np.zeros((self.n, self.n))
            try:
                jacobian, jacobian_q = self._jacobian.gradient((t, q), (1,))
                return jacobian, np.einsum("ijk,i->jk", jacobian_q, lam)
            except NotDifferentiableError as error:
                try:
                    hessian = function.hessian((t, q), (1,))[2]
                except NotDifferentiableError:
                    raise error from None
                return self._jacobian.value(t, q), np.einsum("ijk,i->jk", hessian, lam)
        _, jacobian, hessian = function.hessian((t, q), (1,))
        return jacobian, np.einsum("ijk,i->jk", hessian, lam)
