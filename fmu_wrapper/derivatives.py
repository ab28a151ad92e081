"""Derivatives of outputs with respect to inputs at the present time: what can be asked.

The simulation gives them through its augmented system (`tlismni.core.simulation.sensitivity`). A position or velocity
that an input leads goes on as it was when the input changes, and is met at the end of the next step, so that outputs
at the present time do not depend on it: its derivatives are zero. In initialization mode the start itself follows it;
these derivatives are refused.
"""

from collections.abc import Mapping, Sequence

import numpy as np
import numpy.typing as npt

from ..core.multibody_model import Model
from .errors import FmuError, FmuValueError
from .variables import Variable


def driven_motions(model: Model) -> dict[str, list[str]]:
    """The inputs that motions of `model` follow, positions and velocities, by name, with the names of what does."""
    drivers: dict[str, list[str]] = {}
    for element in model.elements():
        for signal in element.motions():
            for channel in signal.channels():
                drivers.setdefault(channel, []).append(element.name)
    return drivers


def check_knowns(
    knowns: tuple[Variable, ...], seed: npt.NDArray[np.float64], drivers: Mapping[str, Sequence[str]]
) -> None:
    """Refuse what is no input or leads a start (`drivers` as `driven_motions` gives them, in initialization mode), and
    a seed that is not one finite number each, with FmuValueError."""
    for variable in knowns:
        if variable.role != "input":
            raise FmuValueError(
                f"'{variable.name}' is of role {variable.role}: derivatives are with respect to inputs only"
            )
        if variable.name in drivers:
            raise FmuValueError(
                f"input '{variable.name}' is the motion of {list(drivers[variable.name])}, which start where it says: "
                "derivatives with respect to it are there after initialization mode, where they are zero"
            )
    if len(seed) != len(knowns):
        raise FmuValueError(f"a seed of {len(seed)} numbers was given for {len(knowns)} inputs")
    if not np.isfinite(seed).all():
        raise FmuValueError(f"the seed {seed.tolist()} is not finite")


def check_unknowns(unknowns: tuple[Variable, ...]) -> None:
    """Refuse what is no output, with FmuValueError."""
    for variable in unknowns:
        if variable.role != "output":
            raise FmuValueError(f"'{variable.name}' is of role {variable.role}: derivatives are those of outputs only")


def check_finite(outputs: Sequence[Variable], found: npt.NDArray[np.float64]) -> None:
    """Refuse derivatives that are not finite, with FmuError."""
    bad = [f"{v.name}: {x}" for v, x in zip(outputs, found, strict=True) if not np.isfinite(x)]
    if bad:
        raise FmuError(f"derivatives are not finite ({', '.join(bad)}): inputs or seed are too large for the outputs")
