"""From a model to its image: built, rehearsed, written, and proved."""

from typing import Any

import numpy as np

from ..errors import SimulationError
from ..run.simulation import Simulation
from .errors import NativeError
from .image_file import native_image, own_library
from .in_process import NativeModel, NativeRun
from .prepare import points, rehearse, start_inputs

MOST_STEPS = 1_000_000
"""Steps of the solver within one call, unless settings say otherwise."""


def image_of(model: Any, t_end: float, **settings: Any) -> bytes:
    """The image of a model at its start, proved by a run to `t_end` (s) that gives the same bits as in Python.

    Parameters
    ----------
    settings : of `Simulation`.

    Raises
    ------
    NativeError : if the model needs Python when it runs; it says for what.
    ModelError, ConsistencyError, SimulationError : as `Simulation`, and if the run to `t_end` fails.
    """
    library = own_library()
    sim = Simulation(model, **{"max_steps": MOST_STEPS, **settings})
    rehearse(sim, t_end)
    image = native_image(sim, sim.settings.max_steps or MOST_STEPS)
    _prove(sim, NativeRun(NativeModel(image, library)), t_end)
    return image


def _prove(sim: Any, run: NativeRun, t_end: float) -> None:
    """Let both go to `t_end` (s). Raises NativeError if one does what the other does not."""
    inputs = start_inputs(sim)
    for t in points(sim.t, t_end):
        quick = sim.exchange(inputs, t)
        wanted = sim.values() if quick is None else quick
        try:
            found = run.step(t, inputs)
        except SimulationError as error:
            raise NativeError(f"the run from the start to {t_end:.6g} s takes Python: {error}") from error
        if found.tobytes() != wanted.tobytes():
            k = int(np.flatnonzero(found.view(np.int64) != wanted.view(np.int64))[0])
            raise NativeError(
                f"at t = {t:.9g} s '{sim.channels[k].name}' is {found[k]!r} without Python and {wanted[k]!r} with it: "
                "please report this model; the FMU that runs with Python is not concerned"
            )
