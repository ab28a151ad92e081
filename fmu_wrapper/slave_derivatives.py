"""What a slave tells and is told of derivatives: of outputs by inputs, and of outputs and inputs in time."""

import math
from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from ..core.model.signals import MOST_DERIVATIVES
from .derivatives import check_knowns, check_unknowns
from .errors import FmuValueError
from .output_derivatives import check_known, check_orders
from .phases import EVENT_PHASES, SETTABLE, Phase
from .slave_state import SlaveState


class SlaveDerivatives(SlaveState):
    """Base of `Slave`: derivatives at the present time."""

    def directional_derivative(
        self,
        unknowns: npt.NDArray[np.uint32],
        knowns: npt.NDArray[np.uint32],
        seed: npt.NDArray[np.float64],
    ) -> npt.NDArray[np.float64]:
        """Derivatives of the outputs behind `unknowns` along `seed` in the inputs behind `knowns`, at the present time.

        Coordinates, velocities and contact modes are held: the derivatives are those of accelerations and forces.

        Raises
        ------
        CallOrderError : outside initialization, step and event mode.
        FmuValueError : for what is no real output or input, a motion that makes the start yet, a wrong seed.
        SimulationError : if there are no accelerations; if that is so for the inputs set, it has `failed`, as in `get`.
        """
        self._need("get derivatives", Phase.INITIALIZATION, Phase.STEP, *EVENT_PHASES)
        outputs, inputs = (self.variables.plan("real", references).variables for references in (unknowns, knowns))
        check_unknowns(outputs)
        check_knowns(inputs, seed, self.drivers if self._phase == Phase.INITIALIZATION else {})
        if self._stale:
            self._refresh()
        direction: dict[str, float] = {}
        for variable, x in zip(inputs, seed.tolist(), strict=True):
            direction[variable.name] = direction.get(variable.name, 0.0) + x
        return self._engine().derivatives(outputs, direction)

    def output_derivatives(self, references: npt.NDArray[np.uint32], orders: Sequence[int]) -> npt.NDArray[np.float64]:
        """First time derivatives of the real outputs behind `references`, after initialization.

        Raises
        ------
        CallOrderError : before the end of initialization.
        FmuValueError : for what is no real output, and for other orders than 1.
        UnavailableError : for outputs whose derivative is not known.
        """
        self._need("get output derivatives", Phase.STEP, Phase.INTERMEDIATE, *EVENT_PHASES, Phase.TERMINATED)
        outputs = self.variables.plan("real", references).variables
        if len(outputs) != len(references) == len(orders):  # the order of an array is that of its elements
            sizes = [len(self.variables.plan("real", references[i : i + 1]).variables) for i in range(len(references))]
            orders = np.repeat(np.asarray(orders), sizes).tolist()
        check_orders(outputs, orders)
        if self._stale:
            self._refresh()
        return check_known(outputs, self._engine().rates(outputs))

    def set_input_derivatives(
        self, references: npt.NDArray[np.uint32], orders: Sequence[int], values: Sequence[float]
    ) -> None:
        """Let the inputs behind `references` go on, from the present time, with these time derivatives of the given
        orders, 1 or 2: all of them or, on an error, none.

        The value of such an input moves along. Its derivatives hold until, at a later time, it is set without new
        ones or is given others.

        Raises
        ------
        CallOrderError, FmuValueError
        """
        plan = self.variables.plan("real", references)
        self._need("set input derivatives", *SETTABLE)
        given = [float(value) for value in values]
        rows = []
        for variable, order, value in zip(plan.variables, orders, given, strict=True):
            if variable.role != "input":
                raise FmuValueError(f"'{variable.name}' is of role {variable.role}: only inputs take derivatives")
            if not 1 <= order <= MOST_DERIVATIVES:
                raise FmuValueError(
                    f"a derivative of order {order} of input '{variable.name}' was given: orders 1 to "
                    f"{MOST_DERIVATIVES} are taken"
                )
            if not math.isfinite(value):
                raise FmuValueError(f"a derivative of input '{variable.name}' is {value!r}: a finite number is needed")
            rows.append(self._input_rows[variable.reference])
        self._values.set_slopes(rows, orders, given, self._time)
        self._stale = self._untold = True
