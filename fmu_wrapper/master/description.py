"""The description of a coupled system as records, and its file (TOML).

name = "two_masses"

[instances.left]
fmu = "left.fmu"                    # or scenario = "NAME" with parameters = {...}, or model = "left.json"

[instances.right]
scenario = "impact_oscillator"
start = { mass = 2.0 }

[[connections]]
from = "left.mass.x"
to = "right.wall"

[master]
algorithm = "gauss-seidel"
step = 1e-3
t_end = 1.0
"""

import tomllib
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import ConfigDict, Field, field_validator, model_validator

from ...core.errors import ModelError
from ...core.model.base import Name, NonNegative, Positive, Record
from .errors import MasterError

Algorithm = Literal["jacobi", "gauss-seidel", "iterated", "newton"]
Hold = Literal["start", "mean", "end", "linear"]
ARROW = "->"


class InstanceRecord(Record):
    """Where an instance comes from: one of `fmu`, `scenario` and `model`."""

    fmu: str | None = None
    """Path of an FMU, from the folder of the system file."""
    scenario: str | None = None
    """Name of a scenario of the catalogue: its slave runs in this process."""
    model: str | None = None
    """Path of a model file, likewise."""
    in_process: bool = False
    """The FMU's slave runs in this process, without its binary. Only for FMUs of this package."""
    fmi: Literal["2.0", "3.0"] = "3.0"
    """FMI version through which a slave in this process is driven; an FMU has its own."""
    parameters: dict[str, float | int | bool | str] = Field(default_factory=dict)
    """Of a scenario."""
    solver: dict[str, float | int | bool | str] = Field(default_factory=dict)
    """Method, tolerances, step and options of a slave in this process."""
    start: dict[str, float | int | bool | str] = Field(default_factory=dict)
    """Start values of variables: parameters and inputs."""

    @model_validator(mode="after")
    def _check(self) -> "InstanceRecord":
        given = [name for name in ("fmu", "scenario", "model") if getattr(self, name) is not None]
        if len(given) != 1:
            raise ValueError(f"give one of fmu, scenario and model, not {given or 'none'}")
        if self.parameters and self.scenario is None:
            raise ValueError("parameters belong to a scenario; use start for the variables of an FMU or a model")
        if self.solver and self.fmu is not None:
            raise ValueError("solver belongs to a slave in this process; an FMU has variables solver.* for start")
        return self


class Connection(Record):
    """An output that feeds an input: input = factor * output."""

    model_config = ConfigDict(populate_by_name=True)

    source: str = Field(alias="from")
    """"instance.variable" of an output."""
    target: str = Field(alias="to")
    """"instance.variable" of an input."""
    factor: float = 1.0
    unit: str = "1"
    """Unit of the factor, e.g. "N/m" if a displacement feeds a force."""
    hold: Hold | Literal["meet"] | None = None
    """What the input is during a step of an iterated algorithm; left out: the master's `hold`. `meet` is for a position
    that its instance carries on with the velocity that is connected beside it: it starts from where it comes to the
    value and velocity of the step's end."""

    @classmethod
    def between(
        cls, source: str, target: str, factor: float = 1.0, unit: str = "1", hold: Hold | Literal["meet"] | None = None
    ) -> "Connection":
        """The connection from the output `source` to the input `target`."""
        data: dict[str, Any] = {"from": source, "to": target, "factor": factor, "unit": unit, "hold": hold}
        return cls(**data)

    @model_validator(mode="before")
    @classmethod
    def _from_text(cls, data: Any) -> Any:
        if isinstance(data, str):
            source, arrow, target = (part.strip() for part in data.partition(ARROW))
            if not arrow:
                raise ValueError(f"a connection reads 'a.output {ARROW} b.input', not '{data}'")
            return {"from": source, "to": target}
        return data

    @field_validator("source", "target")
    @classmethod
    def _has_instance(cls, text: str) -> str:
        instance, dot, variable = text.partition(".")
        if not (instance and dot and variable):
            raise ValueError(f"'{text}' must read 'instance.variable'")
        return text


class StepControl(Record):
    """A communication step that follows an estimate of the coupling error."""

    estimate: Literal["doubling", "iteration"] = "doubling"
    """`doubling`: one step against two halves, with rollback. `iteration`: the first pass of an iterated algorithm
    against the last."""
    tolerance: Positive = 1e-4
    """Allowed error of a step, relative to the largest value of each coupling variable so far."""
    absolute: Positive = 1e-9
    """Error that is allowed besides, in the unit of the variable."""
    smallest: Positive = 1e-9
    """s; below it the run ends with an error."""
    largest: Positive | None = None
    """s; left out: a tenth of the run."""


class MasterSettings(Record):
    """How the instances are driven."""

    algorithm: Algorithm = "gauss-seidel"
    step: Positive
    """Communication step, s; the first one if it is controlled."""
    t_end: Positive
    """s."""
    order: tuple[str, ...] = ()
    """Order of the instances in Gauss-Seidel sweeps; left out: that of the file."""
    hold: Hold = "mean"
    """Iterated algorithms: the inputs during a step. `mean` of its ends gives order 2, `start` and `end` 1; `linear`
    goes from one end to the other, order 2, for instances that take derivatives of inputs (FMI 2.0)."""
    extrapolation: Literal["constant", "linear"] = "constant"
    """Of `jacobi` and `gauss-seidel`: what goes on beyond the known values, `linear` by their last change, for
    instances that take derivatives of inputs."""
    sweep: Literal["jacobi", "gauss-seidel"] = "gauss-seidel"
    """One pass of `iterated`."""
    relaxation: Annotated[float, Field(gt=0.0, lt=2.0)] = 1.0
    """Of `iterated`: factor of the correction."""
    aitken: bool = False
    """Of `iterated`: Aitken's factor in place of a fixed one."""
    tolerance: Positive = 1e-8
    """Of the iterations, relative to the largest value of each coupling variable so far."""
    absolute: NonNegative = 1e-12
    """Of the iterations, in the unit of the variable."""
    iterations: int = Field(default=50, ge=1)
    """Largest number of passes in a step."""
    jacobian: Literal["derivatives", "steps"] = "derivatives"
    """Of `newton`: from directional derivatives at the end of a step, or from steps done again with one input moved."""
    predictor: Literal["constant", "linear"] = "linear"
    """First guess of the inputs at the end of a step of an iterated algorithm."""
    control: StepControl | None = None
    """Left out: all steps are equal."""

    @model_validator(mode="after")
    def _check(self) -> "MasterSettings":
        explicit = self.algorithm in ("jacobi", "gauss-seidel")
        if self.control is not None and self.control.estimate == "iteration" and explicit:
            raise ValueError(f"{self.algorithm} does not iterate: use estimate = 'doubling', or an iterated algorithm")
        return self


class SystemDescription(Record):
    """Instances, their connections and how they are driven."""

    name: Name = "system"
    description: str = ""
    instances: dict[Name, InstanceRecord] = Field(min_length=1)
    connections: tuple[Connection, ...] = ()
    record: tuple[str, ...] = ("*",)
    """What is recorded: patterns of "instance.variable"; outputs and connected inputs."""
    plot: tuple[str, ...] = ()
    """What is drawn; left out: what is coupled."""
    master: MasterSettings


def read_system(path: str | Path) -> SystemDescription:
    """The description in a TOML file.

    Raises
    ------
    MasterError : if the file cannot be read, is no TOML, or describes no system.
    """
    try:
        with open(path, "rb") as stream:
            data = tomllib.load(stream)
    except OSError as error:
        raise MasterError(f"system file '{path}' cannot be read: {error.strerror or error}") from None
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise MasterError(f"system file '{path}' is no TOML: {error}") from None
    try:
        return SystemDescription(**{"name": Path(path).stem, **data})
    except ModelError as error:
        raise MasterError(f"system file '{path}': {error}") from None
