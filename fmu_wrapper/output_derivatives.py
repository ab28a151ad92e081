"""First time derivatives of outputs at the present time: what can be asked, and which are known.

The simulation gives them (`tlismni.core.simulation.output_rates`): positions, velocities, gaps and their rates,
impulses, work and dissipation have one that is known exactly; accelerations, forces of joints and contacts, energies
and residuals have none.
"""

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from .errors import FmuValueError, UnavailableError
from .variables import Variable

HIGHEST_ORDER = 1
"""maxOutputDerivativeOrder."""


def check_orders(outputs: Sequence[Variable], orders: Sequence[int]) -> None:
    """Refuse what is no output, and other orders than 1, with FmuValueError."""
    if len(orders) != len(outputs):
        raise FmuValueError(f"{len(orders)} orders were given for {len(outputs)} outputs")
    for variable, order in zip(outputs, orders, strict=True):
        if variable.role != "output":
            raise FmuValueError(f"'{variable.name}' is of role {variable.role}: derivatives are those of outputs only")
        if order != HIGHEST_ORDER:
            raise FmuValueError(
                f"a derivative of order {order} of '{variable.name}' was asked: there are those of order "
                f"{HIGHEST_ORDER} (maxOutputDerivativeOrder)"
            )


def check_known(outputs: Sequence[Variable], found: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    """The derivatives `found`. Refuses outputs whose derivative is not known, with UnavailableError."""
    unknown = [v.name for v, x in zip(outputs, found, strict=True) if not np.isfinite(x)]
    if unknown:
        raise UnavailableError(
            f"the time derivatives of {', '.join(unknown)} are not known exactly: there are those of positions, "
            "velocities, gaps, gap rates, impulses, work and dissipation; take the difference of two steps"
        )
    return found
