"""One co-simulation instance behind one interface, whatever its FMI version and wherever it runs.

Under it is an instance of fmpy: FMU2Slave or FMU3Slave on an FMU's binary, or their subclasses InProcess and InProcess3
on a slave in this process.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .errors import MasterError, near
from .variable import Variable


@dataclass(frozen=True)
class Abilities:
    """What an instance declares that it can do."""

    state: bool = False
    """Get and set the state: rollback."""
    variable_step: bool = False
    derivatives: bool = False
    """Directional derivatives."""
    courses: bool = False
    """Inputs may go on with a derivative in time (FMI 2.0)."""


class Instance(ABC):
    """An instance with its variables. All calls raise MasterError with the instance's own message.

    Parameters
    ----------
    name : of the instance in its system.
    fmu : the instance of fmpy.
    variables : its scalar variables by name.
    abilities : what it declares.
    dependencies : for outputs that declare it, the names of the inputs that they depend on at once.
    last_message : gives the last message of the instance's log.
    """

    def __init__(
        self,
        name: str,
        fmu: Any,
        variables: Mapping[str, Variable],
        abilities: Abilities,
        dependencies: Mapping[str, frozenset[str]],
        last_message: Callable[[], str],
    ) -> None:
        self.name = name
        self.fmu = fmu
        self.variables = dict(variables)
        self.abilities = abilities
        self.dependencies = dict(dependencies)
        self.steps = 0
        """Calls of doStep so far."""
        self._last_message = last_message

    def variable(self, name: str) -> Variable:
        """The variable `name`. Raises MasterError, which offers names near it."""
        try:
            return self.variables[name]
        except KeyError:
            raise MasterError(
                f"instance '{self.name}' has no variable '{name}'; {near(name, self.variables)}"
            ) from None

    def names(self, *causalities: str) -> list[str]:
        """Names of the variables of some causalities."""
        return [name for name, v in self.variables.items() if v.causality in causalities]

    # life

    def set_start(self, values: Mapping[str, Any]) -> None:
        """Set start values by name."""
        for name, value in values.items():
            variable = self.variable(name)
            is_text = variable.kind == "String"
            if isinstance(value, str) != is_text:
                wanted = "text" if is_text else "number"
                raise MasterError(f"start value of '{self.name}.{name}': a {wanted} is needed, not {value!r}")
            if variable.kind not in ("String", "Boolean", "Real", "Float64", "Float32"):
                value = int(value)
            self._call(f"set '{name}'", getattr(self.fmu, f"set{variable.kind}"), [variable.reference], [value])

    def initialize(self, start: float, stop: float) -> None:
        """Go to initialization mode, for a run from `start` to `stop`, s."""
        self._call("enter initialization mode", self._enter, start, stop)

    def finish_initialization(self) -> None:
        """Go to step mode."""
        self._call("exit initialization mode", self.fmu.exitInitializationMode)

    def close(self) -> None:
        """Terminate and free the instance; what goes wrong in that does not matter any more."""
        for call in (self.fmu.terminate, self.fmu.freeInstance):
            try:
                call()
            except Exception:  # an instance that failed may refuse
                continue

    # values

    def get(self, references: Sequence[int]) -> NDArray[np.float64]:
        """Values of real variables."""
        return np.array(self._call("get values", self._get, references), dtype=np.float64)

    def set(self, references: Sequence[int], values: Iterable[float]) -> None:
        """Set real variables."""
        self._call("set inputs", self._set, references, [float(x) for x in values])

    def set_slopes(self, references: Sequence[int], slopes: Iterable[float]) -> None:
        """Let real inputs that have just been set go on with these derivatives in time."""
        self._call("set input derivatives", self._set_slopes, references, [float(x) for x in slopes])

    def numbers(self, variables: Sequence[Variable]) -> list[float]:
        """Values of variables of all kinds but strings, as floats."""
        found: dict[str, float] = {}
        for kind in dict.fromkeys(v.kind for v in variables):
            of_kind = [v for v in variables if v.kind == kind]
            values = self._call("get values", getattr(self.fmu, f"get{kind}"), [v.reference for v in of_kind])
            found.update((v.name, float(x)) for v, x in zip(of_kind, values, strict=True))
        return [found[v.name] for v in variables]

    def derivative(self, unknowns: Sequence[int], known: int, seed: float = 1.0) -> NDArray[np.float64]:
        """Derivatives of real outputs along one real input, at the present time."""
        found = self._call("get derivatives", self.fmu.getDirectionalDerivative, list(unknowns), [known], [seed])
        return np.array(found, dtype=np.float64)

    # steps and states

    def step(self, t: float, h: float) -> None:
        """Advance from `t` by `h`, s."""
        self.steps += 1
        self._call(f"step from t = {t!r} s by {h!r} s", self._step, t, h)

    def state(self) -> Any:
        """The whole state, to go back to; free it after use."""
        return self._call("get the state", self._get_state)

    def restore(self, state: Any) -> None:
        """Go back to a state."""
        self._call("set the state", self._set_state, state)

    def free(self, state: Any) -> None:
        """Free a state."""
        self._call("free a state", self._free_state, state)

    def _call(self, what: str, call: Callable[..., Any], *arguments: Any) -> Any:
        try:
            return call(*arguments)
        except MasterError:
            raise
        except Exception as error:
            reason = self._last_message() or str(error)
            raise MasterError(f"instance '{self.name}' cannot {what}: {reason}") from error

    @abstractmethod
    def _enter(self, start: float, stop: float) -> None: ...

    @abstractmethod
    def _get(self, references: Sequence[int]) -> Sequence[float]: ...

    @abstractmethod
    def _set(self, references: Sequence[int], values: Sequence[float]) -> None: ...

    def _set_slopes(self, references: Sequence[int], slopes: Sequence[float]) -> None:
        raise MasterError(f"instance '{self.name}' takes no derivatives of inputs")

    @abstractmethod
    def _step(self, t: float, h: float) -> None: ...

    @abstractmethod
    def _get_state(self) -> Any: ...

    @abstractmethod
    def _set_state(self, state: Any) -> None: ...

    @abstractmethod
    def _free_state(self, state: Any) -> None: ...


class Fmi2Instance(Instance):
    """An instance of FMI 2.0."""

    def _enter(self, start: float, stop: float) -> None:
        self.fmu.setupExperiment(startTime=start, stopTime=stop)
        self.fmu.enterInitializationMode()

    def _get(self, references: Sequence[int]) -> Sequence[float]:
        return self.fmu.getReal(references)

    def _set(self, references: Sequence[int], values: Sequence[float]) -> None:
        self.fmu.setReal(references, values)

    def _set_slopes(self, references: Sequence[int], slopes: Sequence[float]) -> None:
        self.fmu.setRealInputDerivatives(references, [1] * len(references), slopes)

    def _step(self, t: float, h: float) -> None:
        self.fmu.doStep(currentCommunicationPoint=t, communicationStepSize=h)

    def _get_state(self) -> Any:
        return self.fmu.getFMUstate()

    def _set_state(self, state: Any) -> None:
        self.fmu.setFMUstate(state)

    def _free_state(self, state: Any) -> None:
        self.fmu.freeFMUstate(state)


class Fmi3Instance(Instance):
    """An instance of FMI 3.0, without event mode and early return."""

    def _enter(self, start: float, stop: float) -> None:
        self.fmu.enterInitializationMode(startTime=start, stopTime=stop)

    def _get(self, references: Sequence[int]) -> Sequence[float]:
        return self.fmu.getFloat64(references)

    def _set(self, references: Sequence[int], values: Sequence[float]) -> None:
        self.fmu.setFloat64(references, values)

    def _step(self, t: float, h: float) -> None:
        _, terminate, _, reached = self.fmu.doStep(t, h)
        if terminate:
            raise MasterError(f"instance '{self.name}' wants the simulation to end at t = {reached!r} s")

    def _get_state(self) -> Any:
        return self.fmu.getFMUState()

    def _set_state(self, state: Any) -> None:
        self.fmu.setFMUState(state)

    def _free_state(self, state: Any) -> None:
        self.fmu.freeFMUState(state)
