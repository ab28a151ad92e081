"""EquationSystem: equations of motion from a user's functions instead of elements."""

import hashlib
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..assembly.assembly import AT_REST, Assembly, Batch, ContactInfo
from ..compiled.kernels import kernel_address
from ..laws import ContactLaw
from ..model.channels import Channel
from ..model.signals import Step
from .binding import EquationBinding
from .constraints import ConstraintFunctions
from .errors import EquationError, NotDifferentiableError
from .functions import EquationFunctions
from .kernel import equations_kernel
from .signals_used import signals_used
from .user_function import UserFunction

SMALL = 1e-3
"""Coordinates and gaps that all begin below this are those of a small system."""


@dataclass(frozen=True)
class GapContact:
    """A contact of user-written equations: a gap function and a law.

    gap : g(t, q), m; >= 0 outside contact.
    law : NewtonImpact (constraint) or a continuous force law.
    """

    name: str
    gap: Callable[..., Any]
    law: ContactLaw


class EquationSystem:
    """M(t,q) a + Phi_q^T lambda = Q(t,q,v) with Phi(t,q) = 0, from functions.

    Parameters
    ----------
    mass : M(t, q) -> (n, n), or a constant array.
    force : Q(t, q, v) -> (n,), or a constant array.
    constraint : Phi(t, q) -> (m,), or None.
    q0, v0 : start, (n,) each; moved onto the constraints within `start_tolerance` of the simulation.
    constraint_jacobian, gamma, constraint_rate : Phi_q(t, q), gamma(t, q, v), Phi_t(t, q); what is not given is formed
        by automatic differentiation, exact to rounding.
    contacts : `GapContact`s.
    potential : V(t, q) for the energy channels; left out, the potential energy counts as zero.
    coordinates : names of the coordinates (default q0, q1, ...).
    scale : typical magnitudes of the coordinates (n,), so that units choose neither the partition nor what rounding
        is (default 1; of systems that start nearer to zero than 1e-3 in all coordinates and gaps, the largest of
        these).
    t0 : time at which the functions are checked.
    times : times, s, at which a function jumps in time, such as the ends of a pulse: steps end there, and go on from
        there. Those of time functions (`Step`, `Ramp`, ...) that the functions refer to are known: `push =
        Step(time=0.5)` and `force=lambda t, q, v: [push(t)]`.

    Raises
    ------
    EquationError : if the functions do not fit together; says what was given, what was needed and how to mend it.

    Examples
    --------
    A point on a circle whose radius breathes:

    >>> import numpy as np
    >>> from tlismni.core import EquationSystem
    >>> system = EquationSystem(
    ...     mass=np.eye(2),
    ...     force=lambda t, q, v: np.array([0.0, -9.81]),
    ...     constraint=lambda t, q: q[0] ** 2 + q[1] ** 2 - (1.0 + 0.1 * np.sin(t)) ** 2,
    ...     q0=[1.0, 0.0],
    ...     v0=[0.1, 0.0],
    ... )
    """

    def __init__(
        self,
        mass: Any,
        force: Any,
        constraint: Callable[..., Any] | None = None,
        *,
        q0: ArrayLike,
        v0: ArrayLike,
        constraint_jacobian: Any = None,
        gamma: Any = None,
        constraint_rate: Any = None,
        contacts: Sequence[GapContact] = (),
        potential: Callable[..., Any] | None = None,
        coordinates: Sequence[str] | None = None,
        scale: ArrayLike | None = None,
        t0: float = 0.0,
        times: ArrayLike = (),
    ) -> None:
        self.q0 = _vector("q0", q0, None)
        n = len(self.q0)
        self.v0, self.t0 = _vector("v0", v0, n), t0
        self.coordinates = tuple(f"q{k}" for k in range(n)) if coordinates is None else tuple(coordinates)
        if len(self.coordinates) != n or len(set(self.coordinates)) != n:
            raise EquationError(f"coordinates must be {n} different names, they are {self.coordinates}")
        self.functions = EquationFunctions(
            mass, force, constraint, constraint_jacobian, gamma, n=n, constraint_rate=constraint_rate
        )
        self.functions.check(t0, self.q0, self.v0)
        self.contacts = tuple(contacts)
        self._check_contacts()
        self.gaps = [
            ConstraintFunctions(c.gap, None, None, None, n, f"gap of contact '{c.name}'") for c in self.contacts
        ]
        for contact, gap in zip(self.contacts, self.gaps, strict=True):
            value = gap.value(t0, self.q0)
            if value.shape != (1,):
                raise EquationError(f"gap of contact '{contact.name}' must be one number, it has shape {value.shape}")
        self.scale = np.full(n, self._size()) if scale is None else _vector("scale", scale, n)
        if np.any(self.scale <= 0.0):
            raise EquationError(f"scale must be positive, it is {self.scale}")
        self.potential = potential
        if potential is not None:
            self._check_potential(t0)
        self._given = (mass, force, constraint, constraint_jacobian, gamma, constraint_rate)
        gaps = [c.gap for c in self.contacts]
        if any(isinstance(signal, Step) for signal in signals_used([constraint, *gaps])):
            raise EquationError(
                "a constraint or a gap follows a Step: a jump in position is no motion; use a Ramp, a Polynomial or a "
                "Table"
            )
        self.signals = tuple(signals_used([*self._given, potential, *gaps]))
        given = [] if np.size(times) == 0 else _vector("times", times, None).tolist()
        self.times = tuple(sorted({*given, *(t for signal in self.signals for t in signal.breakpoints())}))

    def _size(self) -> float:
        """Typical magnitude of coordinates that nobody told: 1, but for small systems how far they and their gaps are
        from zero at the start."""
        sizes = [float(np.max(np.abs(self.q0)))]
        for gap in self.gaps:
            slope = float(np.max(np.abs(gap.jacobian(self.t0, self.q0))))
            sizes += [abs(float(gap.value(self.t0, self.q0)[0])) / slope] if slope > 0.0 else []
        size = max(x for x in sizes if math.isfinite(x))
        return size if 0.0 < size < SMALL else 1.0

    def _check_potential(self, t0: float) -> None:
        if not callable(self.potential):
            raise EquationError(f"potential is {self.potential!r}; needed is a function of (t, q)")
        value = UserFunction("potential", "t, q", self.potential, None).value(t0, self.q0)
        if value.shape != (1,):
            raise EquationError(f"potential(t, q) must be one number, it has shape {value.shape}")

    def _check_contacts(self) -> None:
        for contact in self.contacts:
            if not isinstance(contact, GapContact):
                raise EquationError(f"contacts must be GapContact records, not {contact!r}")
            if not contact.name.isidentifier() or contact.name in ("energy", "residual", "time"):
                raise EquationError(
                    f"contact name {contact.name!r} cannot be used: letters, digits and underscores, and not energy, "
                    "residual or time, which name channels already"
                )
        names = [contact.name for contact in self.contacts]
        if len(set(names)) < len(names):
            raise EquationError(f"contacts must have different names, they are {names}")

    @property
    def n(self) -> int:
        """Number of coordinates."""
        return len(self.q0)

    @property
    def m(self) -> int:
        """Number of constraints, contacts not counted."""
        return self.functions.m

    inputs: tuple[Any, ...] = ()

    def identity(self) -> str:
        """Hash of the functions' source (or byte code) and the start: a state fits only the same equations."""
        parts = [self.q0.tobytes().hex(), self.v0.tobytes().hex()]
        for given in (*self._given, *(c.gap for c in self.contacts)):
            function = getattr(given, "py_func", given)
            code = getattr(function, "__code__", None)
            parts.append(repr(given) if code is None else code.co_code.hex() + repr(code.co_consts))
        parts += [c.name + repr(c.law) for c in self.contacts]
        parts += [repr(self.times), *map(repr, self.signals)] if self.times or self.signals else []
        return hashlib.sha256("|".join(parts).encode()).hexdigest()

    def _row_scale(self) -> NDArray[np.float64]:
        """How far constraints and gaps move when the coordinates move by their scales, curvature included, (rows,)."""
        found = []
        constraints = [] if self.functions.m == 0 else [self.functions.constraints]
        for functions in (*constraints, *self.gaps):
            for k in range(functions.m):
                row = np.zeros(functions.m)
                row[k] = 1.0
                try:
                    jacobian, curvature = functions.jacobian_and_curvature(self.t0, self.q0, row)
                except NotDifferentiableError:
                    jacobian, curvature = functions.jacobian(self.t0, self.q0), np.zeros((self.n, self.n))
                by_gradient = np.abs(np.reshape(jacobian, (functions.m, self.n))[k]) * self.scale
                by_curvature = np.abs(curvature) * np.outer(self.scale, self.scale)
                found.append(max(np.max(by_gradient), np.max(by_curvature)))
        return np.array(found, dtype=np.float64)

    def assemble(self) -> Assembly:
        """One batch whose kernel calls the functions."""
        n, m, contacts = self.n, self.m, len(self.contacts)
        rows = m + contacts
        full = tuple((i, j) for i in range(n) for j in range(n))
        work_names = [f"{c.name}.{what}" for c in self.contacts for what in ("impulse", "dissipation")]
        first = n + AT_REST
        binding = EquationBinding(self)
        assembly = Assembly(
            n=n,
            m=rows,
            m_joints=m,
            batches=[
                Batch(
                    kernel_address(equations_kernel),
                    np.zeros((1, 1)),
                    np.arange(n, dtype=np.int64)[None, :],
                    np.arange(rows, dtype=np.int64)[None, :],
                    np.array([[binding.address]], dtype=np.int64),
                    full,
                    tuple((k, j) for k in range(rows) for j in range(n)),
                    np.full(1, -1, dtype=np.int64),
                )
            ],
            q0=self.q0.copy(),
            v0=self.v0.copy(),
            row_names=[f"constraint[{k}]" for k in range(m)] + [c.name for c in self.contacts],
            coordinate_names=list(self.coordinates),
            contacts=[
                ContactInfo(c.name, m + k, c.law, first + 2 * k, first + 2 * k + 1) for k, c in enumerate(self.contacts)
            ],
            work_names=work_names,
            signals=np.zeros(1),
            input_names=[],
            input_start=np.zeros(0),
            breakpoints=list(self.times),
            longest_step=min((signal.longest_step() for signal in self.signals), default=np.inf),
            multiplier_channels={k: Channel(f"lambda{k}", "1", f"multiplier of constraint {k}") for k in range(m)},
            body_columns=[],
            coordinate_scale=self.scale,
            length=float(np.max(self.scale)),
            row_scale=self._row_scale(),
            bind=binding.bind,
        )
        binding.errors = assembly.user_error
        return assembly

    def coordinate_channels(self, assembly: Assembly, layout: Any) -> Any:
        """Channels of the coordinates, their rates and second rates."""
        columns = []
        for part, prefix, what in (
            (layout.q, "", "coordinate"),
            (layout.v, "d_", "rate"),
            (layout.a, "dd_", "second rate"),
        ):
            for k, name in enumerate(self.coordinates):
                columns.append((Channel(prefix + name, "1", f"{what} {name}"), part.start + k))
        return columns


def _vector(name: str, given: ArrayLike, n: int | None) -> NDArray[np.float64]:
    try:
        x = np.array(given, dtype=float, ndmin=1)
    except (TypeError, ValueError) as error:
        raise EquationError(f"{name} must be a list of numbers, not {given!r}") from error
    if x.ndim != 1 or (n is not None and len(x) != n) or len(x) == 0:
        raise EquationError(f"{name} must have shape ({'n' if n is None else n},), it has {x.shape}")
    if not np.all(np.isfinite(x)):
        raise EquationError(f"{name} must be finite, it is {x}")
    return x
