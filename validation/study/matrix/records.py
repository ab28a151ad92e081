"""The figures of the matrix as validated records: one JSON line each, so that a run that was stopped goes on."""

import math
from typing import Any, Literal

from pydantic import BaseModel, ConfigDict, model_validator

from ..cases import Setting


class _Record(BaseModel):
    # figures that do not exist are None; infinite ones stay so in JSON
    model_config = ConfigDict(frozen=True, extra="forbid", ser_json_inf_nan="constants")


BLEW_UP = "blew up"
"""Failure of a run that came to its end, but nowhere."""
SPENT = ("tolerance", "steps", "rejected", "outer_iterations", "evaluations", "factorizations", "cpu_time")
"""What such a run still tells."""


class MatrixRun(_Record):
    """One run of a method on a scenario with one tolerance. Figures that do not exist are None.

    A run whose error is not finite is a failed one, whoever makes or reads it.
    """

    tolerance: float
    """Of the error control, in parts of how far the scenario moves (`Course.tolerances`)."""
    failure: str = ""
    """Why there are no figures, in one sentence; empty if there are."""
    kind: Literal["", "refused", "failed", "limit", "broken"] = ""
    """Of failure: the method does not take the problem; the run failed; it cost too much; an error of another kind."""
    steps: int = 0
    rejected: int = 0
    outer_iterations: int = 0
    evaluations: int = 0
    factorizations: int = 0
    cpu_time: float = 0.0
    """s, without compilation."""
    error: float | None = None
    """Of the coordinates, largest over all steps, in parts of how far the scenario moves."""
    residuals: tuple[float, float, float] | None = None
    """Largest of the constraints at position, velocity and acceleration level."""
    first_event_error: float | None = None
    """Of the time of the first impact or closing, s, absolute."""
    event_error: float | None = None
    """Largest of all impacts' and closings' times, s; None if their sequence is not the reference's."""
    events: int = 0
    """Impacts and closings."""
    joint_force_error: float | None = None
    """Mean over time of the difference of the joints' multipliers over the mean of the largest; None if redundant
    constraints leave them open, or the sequence of events is another."""
    impulse_error: float | None = None
    """The same of the contacts' impulse up to each time, over the largest impulse."""
    energy_drift: float | None = None
    """Largest |energy.balance| over the largest kinetic energy."""

    @model_validator(mode="before")
    @classmethod
    def _finite(cls, data: Any) -> Any:
        if not isinstance(data, dict) or data.get("error") is None:
            return data
        try:
            finite = math.isfinite(float(data["error"]))
        except (TypeError, ValueError, OverflowError):
            return data  # no number: the field's own validation says so
        if finite:
            return data
        # nothing else that was measured on such a course means anything
        spent = {name: data[name] for name in SPENT if name in data}
        return {**spent, "kind": data.get("kind") or "failed", "failure": data.get("failure") or BLEW_UP}

    @property
    def ok(self) -> bool:
        """True if the run came to its end, with a finite error if it has one."""
        return not self.failure


class Pair(_Record):
    """A method with options on a scenario: its runs from loose to tight."""

    scenario: str
    method: str
    options: dict[str, float | str]
    runs: tuple[MatrixRun, ...]

    @property
    def setting(self) -> Setting:
        """The method with its options."""
        return Setting(self.method, self.options)

    @property
    def failure(self) -> MatrixRun | None:
        """The run that says why the pair has no figure, or not more of them: its last failed one."""
        return next((run for run in reversed(self.runs) if not run.ok), None)


class ReferenceFigures(_Record):
    """What the runs of a scenario are compared with."""

    scenario: str
    failure: str = ""
    """Why there is none."""
    first: str = ""
    second: str = ""
    """The method whose run is the reference, and that whose run says how exact it is."""
    accuracy: float = 0.0
    """Largest difference of the two, in the measure of `MatrixRun.error`."""
    t_end: float = 0.0
    """s: up to here runs are compared."""
    asked: float = 0.0
    """s: the time that was asked for; longer than t_end where the two references part."""
    events: int = 0
    """Impacts and closings up to t_end."""
    scales: tuple[float, float] = (1.0, 1.0)
    """How far the scenario moves: half the largest range of a length (m) and of an angle (rad)."""
    cpu_time: float = 0.0
    """s, of both."""

    @property
    def ok(self) -> bool:
        """True if there is a reference."""
        return not self.failure


class Header(_Record):
    """What the records of a file were made with: others do not go on from them."""

    sweep: dict[str, Any]
    versions: dict[str, str]
