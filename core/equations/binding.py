"""What the kernel of user-written equations calls back to: the user's functions, put into a workspace's arrays."""

from collections.abc import Callable
from typing import TYPE_CHECKING, Any
from weakref import ref

import numpy as np
from numpy.typing import NDArray

from ..compiled.from_python import address_of
from ..compiled.kernels import ENERGY, POWER, RESIDUAL, TANGENT
from ..compiled.weakly import Weakly
from ..laws import ForceLaw
from ..state.modes import ACTIVE, CLOSED, contact_memories
from .errors import EquationError
from .kernel import CALLBACK

if TYPE_CHECKING:
    from .system import EquationSystem


class EquationBinding:
    """Connects the kernel's callback with one workspace."""

    def __init__(self, system: "EquationSystem") -> None:
        self.system = system
        self.errors: list[BaseException] = []
        # the workspace holds this, through its assembly
        self._workspace: Callable[[], Any] = lambda: None
        self._callback = CALLBACK(Weakly(self._call))
        self.address = address_of(self._callback)

    def bind(self, workspace: Any) -> None:
        self._workspace = ref(workspace)

    @property
    def workspace(self) -> Any:
        """That of the run; None before there is one."""
        return self._workspace()

    def _call(self, job: int, t: float) -> int:
        try:
            self._act(job, t)
        except BaseException as error:  # it must not cross the compiled frames: it is raised when they have returned
            self.errors.append(error)
            return 1
        return 0

    def _act(self, job: int, t: float) -> None:
        system, arrays = self.system, self.workspace.arrays
        n, m, functions = system.n, system.m, self.system.functions
        q, v, a = arrays["q"][:n].copy(), arrays["v"][:n].copy(), arrays["a"][:n].copy()
        lam = arrays["lam"][:m].copy()
        if job == RESIDUAL:
            r, phi, phid, phidd = functions.residuals(t, q, v, a, lam)
            arrays["r"][:n] += r
            arrays["phi"][:m], arrays["phid"][:m], arrays["phidd"][:m] = phi, phid, phidd
            self._gap_residuals(t, q, v, a)
        elif job == TANGENT:
            self._tangent(t, q, v, a, lam)
        elif job == ENERGY:
            arrays["energy"][0] += 0.5 * float(v @ functions.mass(t, q) @ v)
            if system.potential is not None:
                arrays["energy"][1] += float(np.asarray(system.potential(t, q)).reshape(()))
            self._strain(t, q)
        elif job == POWER:
            self._power(t, q, v, a)

    def _strain(self, t: float, q: NDArray) -> None:
        """What the springs of the force laws hold."""
        arrays = self.workspace.arrays
        for k, gap in enumerate(self.system.gaps):
            if contact_memories(arrays["memory"]).mode[k] == ACTIVE:
                arrays["energy"][2] += self._force(k, float(gap.value(t, q)[0]), 0.0)[4]

    def _force(self, k: int, gap: float, rate: float) -> tuple[float, ...]:
        law = self.system.contacts[k].law
        approach = float(contact_memories(self.workspace.arrays["memory"]).approach_speed[k])
        if not isinstance(law, ForceLaw):
            raise EquationError(f"contact '{self.system.contacts[k].name}' has no force law")
        return law.evaluate(max(-gap, 0.0), -rate, approach)

    def _gap_residuals(self, t: float, q: NDArray, v: NDArray, a: NDArray) -> None:
        arrays, m = self.workspace.arrays, self.system.m
        for k, gap in enumerate(self.system.gaps):
            gradient, g, gd, gdd = (np.asarray(x).reshape(-1) for x in gap.levels(t, q, v, a))
            row = m + k
            arrays["phi"][row], arrays["phid"][row], arrays["phidd"][row] = g[0], gd[0], gdd[0]
            mode = contact_memories(arrays["memory"]).mode[k]
            if isinstance(self.system.contacts[k].law, ForceLaw):
                force = self._force(k, g[0], gd[0])[0]
                arrays["monitor"][k] = force
                if mode == ACTIVE:
                    arrays["r"][: len(q)] -= force * gradient
            elif mode == CLOSED:
                arrays["monitor"][k] = -arrays["lam"][row]
                arrays["r"][: len(q)] += arrays["lam"][row] * gradient
            else:
                arrays["monitor"][k] = 0.0

    def _tangent(self, t: float, q: NDArray, v: NDArray, a: NDArray, lam: NDArray) -> None:
        arrays, m, n = self.workspace.arrays, self.system.m, self.system.n
        c_q, c_v = arrays["coef"]
        stiffness, jacobian = self.system.functions.tangent(t, q, v, a, lam, c_q, c_v)
        rows = np.zeros((m + len(self.system.gaps), n))
        rows[:m] = jacobian
        for k, gap in enumerate(self.system.gaps):
            mode = contact_memories(arrays["memory"]).mode[k]
            if mode == CLOSED:
                gradient, curvature = gap.jacobian_and_curvature(t, q, arrays["lam"][[m + k]])
                rows[m + k] = gradient.reshape(-1)
                stiffness = stiffness + c_q * curvature
            elif mode == ACTIVE:
                gradient = np.asarray(gap.jacobian(t, q)).reshape(-1)
                _, g, gd, _ = (np.asarray(x).reshape(-1) for x in gap.levels(t, q, v, a))
                _, f_d, f_dd, _, _ = self._force(k, g[0], gd[0])
                # the curvature of the gap is left out: it changes the rate of convergence, not the solution
                stiffness = stiffness + (c_q * f_d + c_v * f_dd) * np.outer(gradient, gradient)
        # compiled code may have taken another structure since
        self.workspace.sync()
        structure, values = self.workspace.structure, arrays["values"]
        values[structure.slot_s[0][0]] += stiffness.ravel()
        if rows.size:
            values[structure.slot_j[0][0]] += rows.ravel()
            values[structure.slot_jt[0][0]] += rows.ravel()

    def _power(self, t: float, q: NDArray, v: NDArray, a: NDArray) -> None:
        arrays, m = self.workspace.arrays, self.system.m
        for k, contact in enumerate(self.workspace.assembly.contacts):
            mode = contact_memories(arrays["memory"]).mode[k]
            if mode == CLOSED:
                arrays["a"][contact.impulse_account] -= arrays["lam"][m + k]
            elif mode == ACTIVE:
                _, g, gd, _ = (np.asarray(x).reshape(-1) for x in self.system.gaps[k].levels(t, q, v, a))
                force, _, _, elastic, _ = self._force(k, g[0], gd[0])
                arrays["a"][contact.impulse_account] += force
                arrays["a"][contact.dissipation_account] += (elastic - force) * gd[0]
