"""What a slave tells of derivatives: of outputs by inputs, and of outputs in time."""

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from .derivatives import check_knowns, check_unknowns
from .output_derivatives import check_known, check_orders
from .phases import EVENT_PHASES, Phase
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
