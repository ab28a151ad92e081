"""Derivatives of outputs with respect to inputs at the present time.

Of inputs that are forces: at given coordinates, velocities and contact modes, accelerations and multipliers solve

    [M Phi_q^T; Phi_q 0] [a; lambda] = [Q + B u; gamma]

so that every output is an affine function of the inputs u, closed contacts and joints included. The difference between
the outputs at u + d and u - d is therefore the derivative to rounding, however large d is; no truncation enters.

An input that drives a motion, Phi = q - u, is refused: it stands in Phi, which held coordinates do not feel, so that
all would come out as zero although the next step moves them.
"""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from ..core.description import Model
from ..core.model.signals import InputSignal
from .errors import FmuError, FmuValueError
from .variables import Variable


def driven_motions(model: Model) -> dict[str, list[str]]:
    """The inputs that a constraint of `model` follows, by name, with the names of the drivers that do."""
    drivers: dict[str, list[str]] = {}
    for element in model.elements():
        for signal in element.signals() if element.constraint_rows else ():
            if isinstance(signal, InputSignal):
                drivers.setdefault(signal.channel, []).append(element.name)
    return drivers


def check_knowns(
    knowns: tuple[Variable, ...], seed: npt.NDArray[np.float64], drivers: Mapping[str, Sequence[str]]
) -> None:
    """Refuse what is no input or drives a motion (`drivers` as `driven_motions` gives them), and a seed that is not one
    finite number each, with FmuValueError."""
    for variable in knowns:
        if variable.role != "input":
            raise FmuValueError(
                f"'{variable.name}' is of role {variable.role}: derivatives are with respect to inputs only"
            )
        if variable.name in drivers:
            raise FmuValueError(
                f"input '{variable.name}' is the motion of {list(drivers[variable.name])}: derivatives are those with "
                "respect to forces and torques at held coordinates, and a motion moves these; take the difference of "
                "two steps from a stored state, or move the body by an input of a CoordinateLoad"
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


def along(simulation: Any, inputs: Mapping[str, float], direction: Mapping[str, float]) -> npt.NDArray[np.float64]:
    """Derivatives of all channels (N,) along `direction`, at the values `inputs`, both by input name. The simulation is
    left as it was, bit for bit.

    Raises
    ------
    SimulationError : if the accelerations cannot be computed.
    """
    size = max((abs(x) for x in direction.values()), default=0.0)
    if size == 0.0:
        return np.zeros(len(simulation.channels))
    # as large as the inputs themselves, or 1 in their unit, so that rounding of the outputs does not show
    step = 1.0 + max(abs(inputs[name]) for name in direction)
    state = simulation.state()
    try:
        sides = []
        for sign in (1.0, -1.0):
            simulation.set_inputs({name: inputs[name] + sign * step * (x / size) for name, x in direction.items()})
            sides.append(np.array(simulation.values(), dtype=np.float64))
    finally:
        simulation.restore(state)
    with np.errstate(all="ignore"):  # what is not finite is reported below
        found = (sides[0] - sides[1]) / (2.0 * step) * size
    return np.asarray(found)


def check_finite(outputs: Sequence[Variable], found: npt.NDArray[np.float64]) -> None:
    """Refuse derivatives that are not finite, with FmuError."""
    bad = [f"{v.name}: {x}" for v, x in zip(outputs, found, strict=True) if not np.isfinite(x)]
    if bad:
        raise FmuError(f"derivatives are not finite ({', '.join(bad)}): inputs or seed are too large for the outputs")
