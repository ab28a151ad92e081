"""What all comparisons share: rows with verdicts, our run on a time grid, exudyn's step size."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from typing import Any, Literal

import numpy as np

from ...core import Event, Result, simulate
from ...core.elements import AxialRod, Cable2D, FloatingBody2D
from ...core.multibody_model import Model
from ...models.scenario import Scenario
from ..metrics import hermite

RTOL, ATOL = 1e-9, 1e-11
"""Our tolerances in a cross-check: our error must not matter beside exudyn's."""
FLEXIBLE_RTOL, FLEXIBLE_ATOL = 1e-7, 1e-10
"""The same for cables and beams, whose fast waves would cost the most."""
LOOSER = 10.0
"""Our error bar is what this factor on our tolerances changes: an error in proportion to them is a ninth of it."""
MOST_BARS = 3.0
"""Times the tolerance: beside larger error bars a small difference says nothing, and the row is undecided."""
STILL = 1e-7
"""Of the largest value in a unit: what moves less is at rest."""
ROUNDING = 1e-14
"""Relative: what no run can be better than."""
RATES = {"x": "vx", "y": "vy", "angle": "angular_velocity", "gap": "gap_rate"}
RATES |= {"vx": "ax", "vy": "ay", "angular_velocity": "angular_acceleration"}

Verdict = Literal["agree", "undecided", "differ", "not comparable"]
Progress = Callable[[str], None]


@dataclass(frozen=True)
class Row:
    """One compared quantity.

    verdict : "agree" within `tolerance`; "undecided" if the difference is larger, but not larger than the error bars
    of both sides together (`uncertainty`, `ours_uncertainty`), or smaller beside bars above MOST_BARS tolerances;
    "not comparable" if `reason` says why it cannot be decided at all; "undecided" too if `doubt` says why a difference
    would tell nothing about the models; "differ" otherwise.
    """

    quantity: str
    unit: str
    ours: float
    exudyn: float
    tolerance: float
    tolerance_kind: Literal["absolute", "relative"]
    uncertainty: float = 0.0
    """Absolute, from exudyn's own convergence."""
    scale: float | None = None
    """What relative values refer to; left out: |exudyn|."""
    required: bool = True
    """False for rows that inform but do not decide."""
    ours_uncertainty: float = 0.0
    """Absolute, from our own convergence."""
    reason: str = ""
    """Why the two cannot be compared."""
    doubt: str = ""
    """Why a difference is one of the comparison, not of the models: a limit that is not reached, a run that ends."""
    channel: str = ""
    at: float | None = None
    """The channel and the time (s) that the row is about, where it is about a trajectory."""
    third: float | None = None
    """A third opinion on the quantity, and in `third_source` where it comes from."""
    third_source: str = ""

    @property
    def difference(self) -> float:
        return abs(self.ours - self.exudyn)

    @property
    def size(self) -> float:
        """What relative values refer to."""
        return abs(self.exudyn) if self.scale is None else self.scale

    @property
    def relative(self) -> float:
        size = self.size
        return self.difference / size if size > 0.0 else math.inf if self.difference > 0.0 else 0.0

    @property
    def allowed(self) -> float:
        """The tolerance in the row's unit."""
        return self.tolerance * (1.0 if self.tolerance_kind == "absolute" else self.size)

    @property
    def within_bars(self) -> bool:
        """Whether the difference is within the error bars of both sides together."""
        return bool(self.difference <= self.uncertainty + self.ours_uncertainty)

    @property
    def evident(self) -> bool:
        """Whether the difference is so far beyond tolerance and error bars that no smaller step will change it."""
        return bool(self.difference > 10.0 * (self.allowed + self.uncertainty + self.ours_uncertainty))

    @property
    def verdict(self) -> Verdict:
        measured = self.difference if self.tolerance_kind == "absolute" else self.relative
        # a NaN is never an agreement; nor is a difference that is small by chance, beside bars that are far larger
        if measured <= self.tolerance:
            told = self.uncertainty + self.ours_uncertainty <= MOST_BARS * self.allowed
            return "agree" if told or self.difference == 0.0 or not self.required else "undecided"
        if self.reason:
            return "not comparable"
        return "undecided" if self.within_bars or self.doubt else "differ"

    @property
    def why(self) -> str:
        """Why the row does not decide; empty where it does."""
        if self.verdict == "not comparable":
            return self.reason
        if self.verdict != "undecided":
            return ""
        bars, allowed = self.uncertainty + self.ours_uncertainty, self.allowed
        wide = f"error bars of {bars:.2g} {self.unit}".rstrip()
        if self.difference <= allowed:
            return f"{wide} are {bars / allowed:.2g} times the tolerance" if allowed > 0.0 else f"{wide}, no tolerance"
        return self.doubt or f"the difference is {self.difference:.2g} {self.unit}".rstrip() + f", within {wide}"

    def to_dict(self) -> dict[str, Any]:
        """Plain data, verdict and differences included."""
        derived = {"difference": self.difference, "relative": self.relative, "verdict": self.verdict}
        return {**asdict(self), **derived, "allowed": self.allowed, "within_bars": self.within_bars}


@dataclass(frozen=True)
class Curve:
    """One line of a figure."""

    label: str
    t: np.ndarray
    y: np.ndarray
    ours: bool


@dataclass(frozen=True)
class Panel:
    """One axes of a figure: what is drawn over time."""

    title: str
    unit: str
    curves: tuple[Curve, ...]
    window: tuple[float, float] | None = None
    logarithmic: bool = False
    """Zeros are not drawn then."""
    origin: float | None = None
    """The first touch, s, from which a window's time is counted."""
    points: bool = False
    """True if samples are drawn as points: values without a course in time between them."""


@dataclass(frozen=True)
class Comparison:
    """What a comparison found."""

    kind: str
    rows: tuple[Row, ...]
    panels: tuple[Panel, ...]
    notes: tuple[str, ...]
    steps: tuple[float, ...]
    """exudyn's step sizes, s."""
    version: str
    our_seconds: float
    exudyn_seconds: float
    events: tuple[Event, ...] = ()
    """Of our run."""
    result: Result | None = None
    """Our run on a grid, for the animation."""


@dataclass(frozen=True)
class Task:
    """What is to be compared: our scenario, and the model that exudyn gets (the same, but in tests of faults)."""

    scenario: Scenario
    exudyn_model: Model
    step: float | None = None
    progress: Progress = field(default=lambda text: None)
    refine: bool = True
    """Whether exudyn's step is halved until its error bars are below the tolerances."""

    def settled(self, rows: Sequence[Row]) -> bool:
        """Whether smaller steps are of no use: the error bars are small enough, or a difference is evident."""
        if not self.refine:
            return True
        return all(row.uncertainty <= row.allowed for row in rows) or any(row.evident for row in rows)


def our_run(scenario: Scenario, times: Sequence[float] | np.ndarray | None = None, looser: float = 1.0) -> Result:
    """Our run with tight tolerances (times `looser`, or with twice a fixed step); at every step, or at `times` (s).

    A scenario with fixed steps of a low-order method is run with error control instead, unless it is one of rods,
    whose wave fronts error control would follow with tiny steps.
    """
    flexible = any(isinstance(b, Cable2D | FloatingBody2D) for b in scenario.model.bodies)
    least = (FLEXIBLE_RTOL, FLEXIBLE_ATOL) if flexible else (RTOL, ATOL)
    rtol, atol = looser * min(least[0], scenario.rtol), looser * min(least[1], scenario.atol)
    grid = None if times is None else np.unique(np.clip(np.asarray(times), 0.0, scenario.t_end))
    method, options = scenario.method, dict(scenario.options)
    if "step" in options:
        if any(isinstance(b, AxialRod) for b in scenario.model.bodies):
            options["step"] = options["step"] if looser == 1.0 else 2.0 * options["step"]
        else:
            method, options = "irk", {}
    return simulate(scenario.model, scenario.t_end, method, rtol, atol, t_eval=grid, **options)


def our_looser_run(task: "Task", times: np.ndarray) -> Result:
    """Our run with LOOSER times the tolerance, at `times` (s): its difference to our run is our error bar."""
    task.progress(f"our run with {LOOSER:g} times the tolerance")
    return our_run(task.scenario, times, looser=LOOSER)


def own_bar(tight: Any, loose: Any) -> Any:
    """Our error bar: how far a value moves with the looser tolerances, and no less than rounding."""
    return np.maximum(np.abs(np.subtract(tight, loose)), ROUNDING * np.abs(tight))


def our_error(task: "Task", ours: Result, channels: Sequence[str]) -> dict[str, np.ndarray]:
    """How far each of our channels moves with LOOSER times the tolerance, over the times of `ours`."""
    other = our_looser_run(task, ours.t)
    if len(other.t) != len(ours.t):
        return {}
    return {c: own_bar(ours[c], other[c]) for c in channels if c in ours.channels}


@dataclass(frozen=True)
class Touch:
    """One contact in our run, from first touch to release; times in s, speeds in m/s, impulse in N s."""

    contact: str
    start: float
    end: float
    approach_speed: float
    separation_speed: float
    impulse: float


def touches(events: Sequence[Event]) -> list[Touch]:
    """Contacts of a run: impacts have no duration; force contacts go from "close" to "open"."""
    found, opened = [], {}
    for event in events:
        if event.kind == "impact":
            found.append(
                Touch(event.contact, event.t, event.t, event.approach_speed, event.separation_speed, event.impulse)
            )
        elif event.kind == "close":
            opened[event.contact] = event
        elif event.kind == "open" and event.contact in opened:
            first = opened.pop(event.contact)
            found.append(
                Touch(event.contact, first.t, event.t, first.approach_speed, event.separation_speed, event.impulse)
            )
    return sorted(found, key=lambda touch: touch.start)


def blows(found: Sequence[Touch]) -> list[Touch]:
    """Those that begin with an approach and push: others have no speed or duration of a blow."""
    return [touch for touch in found if touch.approach_speed > 0.0 and touch.impulse > 0.0]


def nice_step(limit: float) -> float:
    """The largest of 1, 2, 5 times a power of ten that is not above `limit`."""
    power = 10.0 ** math.floor(math.log10(limit))
    return max(k * power for k in (1.0, 2.0, 5.0) if k * power <= limit * (1.0 + 1e-12))


def at_times(t: np.ndarray, channels: Mapping[str, np.ndarray], channel: str, times: np.ndarray) -> np.ndarray:
    """A channel at other times: by Hermite interpolation where its rate is known, else linearly."""
    body, _, name = channel.rpartition(".")
    rate = next(
        (r for r in (f"{body}.{RATES.get(name, '')}", f"{body}.d_{name}", f"{body}.v{name}") if r in channels), ""
    )
    if rate in channels:
        return hermite(t, channels[channel], channels[rate], times)
    return np.interp(times, t, channels[channel])


def unit_of(result: Result, channel: str) -> str:
    """Unit of one of our channels."""
    return next((c.unit for c in result.channel_records if c.name == channel), "")


@dataclass(frozen=True)
class ContactUnits:
    """Units of what is compared of a contact: of a stop of an angle they are rad/s, N.m and N.m.s."""

    speed: str
    force: str
    impulse: str


def contact_units(result: Result, contact: str) -> ContactUnits:
    """Units of the contact's speeds, forces and impulses."""
    force = unit_of(result, f"{contact}.normal_force")
    return ContactUnits(unit_of(result, f"{contact}.gap_rate"), force, f"{force}.s")


def course_scale(result: Result, channel: str, own: float) -> float:
    """What relative differences of a course in `result`, ours, refer to: its `own` scale, but at least STILL of the
    largest value in that unit, since what stays at rest differs by rounding, and ATOL, below which our runs know
    nothing: where all is at rest there is no larger value."""
    unit = unit_of(result, channel)
    courses = [result[c.name] for c in result.channel_records if c.unit == unit]
    largest = max((float(np.max(np.abs(x))) for x in courses if x.size), default=0.0)
    return max(own, STILL * largest, ATOL)


def residual_panel(result: Result) -> Panel:
    """Our constraint residuals at the three levels, logarithmically."""
    levels = (("position", "m"), ("velocity", "m/s"), ("acceleration", "m/s²"))
    curves = tuple(Curve(f"{level} ({unit})", result.t, result[f"residual.{level}"], True) for level, unit in levels)
    return Panel("our constraint residuals", "largest residual", curves, None, True, points=True)


def energy_panel(result: Result) -> Panel:
    """How far our energy ledger is from closing."""
    curve = Curve("|energy - start - input work + losses|", result.t, np.abs(result["energy.balance"]), True)
    return Panel("our energy balance", "J", (curve,), None, True, points=True)


def reasons_of(rows: Sequence[Row]) -> set[str]:
    """Why quantities are not comparable, or undecided beyond what error bars say (they stand beside the figures)."""
    told = {row.reason for row in rows if row.verdict == "not comparable"}
    return told | {row.doubt for row in rows if row.verdict == "undecided" and row.doubt}


def is_contact_channel(task: Task, channel: str) -> bool:
    """True if the channel belongs to a contact, not to a body or joint."""
    return channel.split(".")[0] in {c.name for c in task.scenario.model.contacts}
