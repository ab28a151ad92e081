"""A model compiled once for many runs: they share its tables, and a run takes numbers only."""

import math
from collections.abc import Mapping
from numbers import Real
from threading import Lock
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .assembly.assembly import Assembly
from .compiled.image import twin
from .compiled.notices import compile_notices
from .errors import ModelError
from .model.said_angle import CountsTurns
from .multibody_model import Model
from .simulation.blueprint import Blueprint, Unstarted, can_be_copied, take_numbers, what_differs
from .simulation.simulation import Simulation

Numbers = Mapping[str, float]
_POSITIONAL = ("method", "rtol", "atol")
"""Arguments of `Simulation` after the system that may be given without their names."""


class CompiledModel:
    """What runs of one system with one method share. `compile_model` makes it. `method="auto"` is chosen once, for the
    system as it is given here: variants are solved with the same.

    Runs of a `Model` share its tables. Of an `EquationSystem`, whose functions work in the memory of one run, each is
    built anew: the same results, at the cost of `Simulation`.

    Attributes
    ----------
    system : the Model or EquationSystem.
    channels : names of its output channels.
    start_names : names of the start values: coordinates and their rates, as the channels that show them, and angles
        whose whole turns are counted.
    """

    @compile_notices("this model")
    def __init__(self, system: Any, *arguments: Any, **settings: Any) -> None:
        bare = Unstarted(system, *arguments, **settings)
        self._chosen = bare.settings
        self._settings = dict(zip(_POSITIONAL, arguments, strict=False)) | settings | bare.settings.of_choice
        self.system, self._assembly = bare.system, bare.assembly
        self.channel_records = tuple(bare.table.channels)
        self.channels = tuple(channel.name for channel in self.channel_records)
        self.t0 = bare.settings.t0
        self._places = _start_places(bare)
        self._counted = counted_names(self.system)
        self.start_names = (*self._places, *self._counted)
        self._bare = Blueprint(bare) if can_be_copied(bare.assembly) else None
        self._begun: Blueprint | None = None
        self._lock = Lock()

    def variant(self, parameters: Numbers | None = None, inputs: Numbers | None = None) -> Any:
        """The system with other parameters and start values of inputs.

        Raises
        ------
        ModelError : for an unknown name, or a value that the model refuses.
        """
        if not parameters and not inputs:
            return self.system
        if not isinstance(self.system, Model):
            raise ModelError(
                f"parameters and inputs belong to a Model, a {type(self.system).__name__} has none: let its functions "
                "read their numbers, and simulate one after the other"
            )
        model = self.system
        if inputs:
            known = [record.name for record in model.inputs]
            for name, value in inputs.items():
                if name not in known:
                    raise ModelError(f"model '{model.name}' has no input '{name}'; it has {known}")
                _finite("input", name, value)
            changed = [
                record.model_copy(update={"start": float(inputs.get(record.name, record.start))})
                for record in model.inputs
            ]
            model = model.model_copy(update={"inputs": tuple(changed)})
        return model.with_parameters(parameters) if parameters else model

    def check_start(self, start: Numbers) -> None:
        """Raise ModelError for start values of unknown name, or that are not finite."""
        for name, value in start.items():
            if name not in self.start_names:
                raise ModelError(f"there is no start value '{name}'; there are {list(self.start_names)}")
            _finite("start value", name, value)

    def simulation(
        self, parameters: Numbers | None = None, start: Numbers | None = None, inputs: Numbers | None = None
    ) -> Simulation:
        """A run of its own, at its start: the same, bit for bit, as a `Simulation` built for these numbers.

        Parameters
        ----------
        parameters : by name, or by place ("ball.mass"), see `Model.with_parameters`.
        start : coordinates and rates at the start by the names of their channels ("ball.y", "ball.vy"), in place of
            those of the model. Its scales, and where bodies are when nothing else is said, stay the model's.
        inputs : what inputs are at the start, in place of `Input.start`.

        Raises
        ------
        ModelError : for an unknown name or a value that the model refuses.
        ConsistencyError, SimulationError : if the run cannot start there.
        """
        return self.run_of(self.variant(parameters, inputs), start)

    def run_of(self, system: Any, start: Numbers | None = None) -> Simulation:
        """`simulation` of a `variant` of the system."""
        self.check_start(start or {})
        if self._bare is None:
            sim = self._unstarted(system)
            sim.assembly = self._with_start(sim.assembly, start or {})
            sim.begin()
            return sim
        if system is self.system and not start:
            if self._begun is None:
                begun = self._bare.simulation()
                begun.begin()
                self._give_room(begun)
                self._begun = Blueprint(begun)
            return self._begun.simulation()
        sim = self._bare.simulation()
        turned = bool(start) and bool(self._counted)
        if system is not self.system or turned:
            of_model = isinstance(system, Model)
            assembly = system.assemble(start if turned else None, self.t0) if of_model else system.assemble()
            differs = what_differs(self._assembly, assembly)
            if differs:
                return self._built_anew(system, start or {})
            take_numbers(sim, system, assembly)
        sim.assembly = self._with_start(sim.assembly, start or {})
        sim.begin()
        self._give_room(sim)
        return sim

    def _give_room(self, sim: Simulation) -> None:
        """Runs after this one have the memory for structures from the start that it had to ask for."""
        with self._lock:
            if self._bare is not None:
                self._bare = self._bare.with_room(sim)

    def _unstarted(self, system: Any) -> Simulation:
        """A run that has not begun, with the method that was chosen for the system as it was given."""
        sim = Unstarted(system, **self._settings)
        if self._chosen.method_chosen:
            sim.settings = self._chosen
        return sim

    def _built_anew(self, system: Any, start: Numbers) -> Simulation:
        sim = self._unstarted(system)
        sim.assembly = self._with_start(sim.assembly, start)
        sim.begin()
        return sim

    def _with_start(self, assembly: Assembly, start: Numbers) -> Assembly:
        if not start:
            return assembly
        assembly = twin(assembly)
        assembly.q0, assembly.v0 = assembly.q0.copy(), assembly.v0.copy()
        values: tuple[NDArray[np.float64], ...] = (assembly.q0, assembly.v0)
        for name, value in start.items():
            if name in self._places:
                level, index = self._places[name]
                values[level][index] = value
        return assembly


def compile_model(system: Any, *arguments: Any, **settings: Any) -> CompiledModel:
    """Compile a `Model` (or `EquationSystem`) for many runs with one method; arguments as those of `Simulation`.

    Examples
    --------
    >>> from tlismni.core import Model, PointMass2D, compile_model
    >>> ball = Model(name="ball", bodies=[PointMass2D(name="ball", mass=1.0, position=(0.0, 1.0))])
    >>> run = compile_model(ball, rtol=1e-8).simulation(start={"ball.vy": 2.0})
    >>> run.advance(0.1)

    Raises
    ------
    ModelError : for bad arguments.
    """
    return CompiledModel(system, *arguments, **settings)


def counted_names(system: Any) -> tuple[str, ...]:
    """Names of the angles whose turns a model counts, which coordinates do not tell."""
    elements = system.elements() if isinstance(system, Model) else ()
    return tuple(angle.name for e in elements if isinstance(e, CountsTurns) for angle in e.counted_angles())


def _start_places(sim: Simulation) -> dict[str, tuple[int, int]]:
    """Names of coordinates (level 0) and their rates (1), with their index."""
    layout, n = sim.table.layout, sim.assembly.n
    starts = (layout.q.start, layout.v.start)
    places = {}
    for channel, column in sim.system.coordinate_channels(sim.assembly, layout):
        for level, first in enumerate(starts):
            if first <= column < first + n:
                places[channel.name] = (level, column - first)
    return places


def _finite(what: str, name: str, value: Any) -> None:
    if isinstance(value, bool) or not isinstance(value, Real) or not math.isfinite(value):
        raise ModelError(f"{what} '{name}' = {value!r}: a finite number is needed")
