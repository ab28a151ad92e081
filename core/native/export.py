"""From a model to its image: built, rehearsed, written, and proved."""

import logging
from collections.abc import Callable, Iterable, Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..compiled.library import Library
from ..errors import SimulationError
from ..multibody_model import Model
from ..simulation.simulation import Simulation
from .beginning import let_begin
from .beginnings import as_far_as_it_begins, prove_beginning, prove_together
from .errors import NativeError
from .image_file import native_image, own_library, refuse_motions
from .in_process import NativeModel, NativeRun
from .parameter_dependence import Memory, parameter_of
from .parameters import Parameter, Setting, Tried, settings_of, startable
from .prepare import channels_at, points, rehearse, start_inputs
from .together import together
from .trials import Trials

logger = logging.getLogger(__name__)

FOR_PROOFS = 3
"""Of the progress: the proofs count as so many parameters."""
SHARE = 0.125
"""Of the run: as far as it is compared for most parameters."""
MOST_STEPS = 1_000_000
"""Steps of the solver within one call, unless settings say otherwise."""


def image_of(model: Any, t_end: float, *, parameters: Iterable[str | Setting] | None = None, **settings: Any) -> bytes:
    """The image of a model at its start, proved by a run to `t_end` (s) that gives the same bits as in Python.

    Parameters
    ----------
    parameters : names of the model's parameters, or places of numbers ("ball.mass"), that shall be parameters of the
        image; all of the model's if left out. Those that cannot be (`parameters.py`) are fixed, and named in the log.
    settings : of `Simulation`.

    Raises
    ------
    NativeError : if the model needs Python when it runs; it says for what.
    ModelError, ConsistencyError, SimulationError : as `Simulation`, and if the run to `t_end` fails.
    """
    return image_and_parameters(model, t_end, parameters, **settings)[0]


def image_and_parameters(
    model: Any,
    t_end: float,
    parameters: Iterable[str | Setting] | None = None,
    *,
    progress: Callable[[float], None] | None = None,
    **settings: Any,
) -> tuple[bytes, list[Parameter], dict[str, str]]:
    """`image_of`; the parameters that it has; and why the others are fixed, by name. `progress` is called with the part
    of the work that is done."""
    library = own_library()
    full = {"max_steps": MOST_STEPS, **settings}
    sim = Simulation(model, **full)
    full |= sim.settings.of_choice  # variants are solved by the formula of the image
    if isinstance(model, Model):
        refuse_motions(sim)
        let_begin(sim, full)
    done = progress or (lambda part: None)
    most = sim.settings.max_steps or MOST_STEPS
    wanted = _wanted(model, parameters)
    # which redundant rows are left out is found in Python
    begins = not sim.workspace.dropped
    tried: dict[str, Tried] = {}
    fixed: dict[str, str] = {}
    found: list[Parameter] = []
    expected = rehearse(sim, t_end)
    if wanted:
        trials = Trials(model, full)
        memory = Memory(sim, trials)
        for k, setting in enumerate(wanted):
            logger.info("parameter %d of %d: what follows from '%s'", k + 1, len(wanted), setting.name)
            try:
                tried[setting.name] = startable(trials, setting, begins)
                found.append(parameter_of(memory, setting, tried[setting.name]))
            except NativeError as error:
                fixed[setting.name] = str(error)
            trials.forget()
            done((k + 1) / (len(wanted) + FOR_PROOFS))
        found = together(memory, found, {setting.name: setting for setting in wanted})
        found, refused = _that_begin(sim, most, library, found, tried, begins)
        fixed |= refused
    for name, why in fixed.items():
        logger.info("parameter '%s' is fixed at its value: %s", name, why)
    for p in found:
        for name in sorted(p.excludes):
            logger.info("parameters '%s' and '%s' exclude each other: one of them keeps its value", p.name, name)
    image = native_image(sim, most, found, begins)
    native = NativeModel(image, library)
    if begins:
        prove_beginning(sim, native)
    _prove(sim, NativeRun(native), t_end, iter(expected))
    prove_together(native, found, {setting.name: setting for setting in wanted}, lambda x: Simulation(x, **full))
    proved = False
    for k, p in enumerate(found):
        # from memory that is the same there is but one way on: one run that begins anew to the end, the others a part
        whole = p.begins and not proved
        end = t_end if whole else sim.t + SHARE * (t_end - sim.t)
        proved = (_prove_parameter(full, native, k, p, tried[p.name], end) and whole) or proved
        done((len(wanted) + FOR_PROOFS * (k + 1) / len(found)) / (len(wanted) + FOR_PROOFS))
    return image, found, fixed


def _that_begin(
    sim: Any, most: int, library: Library, found: list[Parameter], tried: dict[str, Tried], begins: bool
) -> tuple[list[Parameter], dict[str, str]]:
    """The parameters with which runs begin without Python as they do with it, between the values for which that is so;
    and why the others do not count."""
    if not any(p.begins for p in found):
        return found, {}
    native = NativeModel(native_image(sim, most, found, begins), library)
    kept, refused = [], {}
    for k, p in enumerate(found):
        try:
            kept.append(as_far_as_it_begins(native, k, p, tried[p.name].starts or {}) if p.begins else p)
        except NativeError as error:
            refused[p.name] = str(error)
    return kept, refused


def _wanted(model: Any, parameters: Iterable[str | Setting] | None) -> list[Setting]:
    if not isinstance(model, Model):
        return []
    given = None if parameters is None else list(parameters)
    names = given if given is None else [x for x in given if isinstance(x, str)]
    return [*settings_of(model, names), *(x for x in given or () if isinstance(x, Setting))]


def _prove_parameter(
    settings: dict[str, Any], native: NativeModel, number: int, p: Parameter, tried: Tried, t_end: float
) -> bool:
    """A run with another value of a parameter has the bits of Python's, as far as it meets only what the image was
    prepared for: whether it has gone all the way to `t_end` (s).

    The value: the least that was tried (or the largest, where that is the present one); of those that the start follows
    from the least that is not below half of it. Words that are exact to rounding only are compared at the start alone
    (`beginnings.py`): from there on rounding grows as the motion lets it.
    """
    values = [(x, model) for x, model in tried.values if p.least <= x <= p.largest]
    if p.begins:
        values = [pair for pair in values if abs(pair[0]) >= 0.5 * abs(p.value)]
    if len(values) < 2 or not p.exact:
        return False
    run = NativeRun(native)
    value, variant = values[0] if values[0][0] != p.value else values[-1]
    run.set_parameter(number, value)
    sim = Simulation(variant, **settings)
    try:
        _prove(sim, run, t_end, (channels_at(sim, t) for t in points(sim.t, t_end)))
        return True
    except SimulationError as error:
        logger.info("with %s = %r the run ends in Python too: %s", p.name, value, error)
    except Unprepared as error:
        logger.info("with %s = %r: %s", p.name, value, error)
    return False


class Unprepared(NativeError):
    """A run without Python has come to something that takes it."""


def _prove(sim: Any, run: NativeRun, t_end: float, expected: Iterator[NDArray[np.float64]]) -> None:
    """Let a run go to `t_end` (s), where `sim` has the channels `expected` at the `points`. Raises NativeError if it
    has others: Unprepared if it fails."""
    inputs = start_inputs(sim)
    for t, wanted in zip(points(sim.t, t_end), expected, strict=True):
        try:
            found = run.step(t, inputs)
        except SimulationError as error:
            raise Unprepared(f"the run from the start to {t_end:.6g} s takes Python: {error}") from error
        if found.tobytes() != wanted.tobytes():
            k = int(np.flatnonzero(found.view(np.int64) != wanted.view(np.int64))[0])
            raise NativeError(
                f"at t = {t:.9g} s '{sim.channels[k].name}' is {found[k]!r} without Python and {wanted[k]!r} with it: "
                "please report this model; the FMU that runs with Python is not concerned"
            )
