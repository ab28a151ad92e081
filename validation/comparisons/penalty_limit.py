"""The penalty limit of a contact as a constraint: exudyn with growing stiffnesses, and what they tend to.

exudyn has no unilateral constraints and no impact law. But a force law whose rebound is exactly e tends to the
impact with restitution e as its stiffness K grows: with F = K d^n (1 + D d'/v0) and D the exact root for e
(Gonthier), duration and depth of the contact fall as x = K^(-1/(n+1)), and with them what gravity and the motion
add during it. So every quantity is a + b x + c x^2 + ..., and a is what the constraint must give.

The stiffnesses follow from the model: the softest contact takes a small part of the time to the next impact, since a
penalty that lasts as long as the mechanism's own motion has no such series. exudyn's steps are the same part of a
contact for every stiffness, so that they change the limit as much as one run: what twice the step changes with the
softest contact goes into the error bar, beside what the extrapolation leaves open and, with more than three
stiffnesses, how far the limit has moved with the last of them.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ...core import Gonthier, NewtonImpact, Result
from ...core.laws.friction import CoulombFriction
from ...core.multibody_model import Model
from ..errors import NotTranslatable
from ..exudyn_run import ExudynResult
from ..metrics import ContactInterval, contact_intervals, impulse, power_limit, speeds
from .common import Row, Task, Touch

SOFTEST = 1e6
"""N/m^1.5: of the first run, where its contact then takes a small part of the time that there is."""
LONGEST, SHORTEST = 0.05, 1e-4
"""Parts of the time to the next impact that the softest contact may take."""
DECADE = 10.0
RUNS = 3
EXPONENT = 1.5
STEPS_IN_CONTACT = 100
SURE = 3.0
"""Times both error bars and the tolerance: a larger difference from a confirmed limit is one of the models."""
LOWEST_RESTITUTION = 0.05
SAME_BLOW = 1e-9
"""Of the run: touches nearer than this are one blow."""


@dataclass(frozen=True)
class PenaltyRun:
    """A run of exudyn with one stiffness, and its contacts in time."""

    stiffness: float
    result: ExudynResult
    contacts: list[tuple[str, ContactInterval]]

    @property
    def x(self) -> float:
        return float(self.stiffness ** (-1.0 / (EXPONENT + 1.0)))

    def intervals(self, contact: str) -> list[ContactInterval]:
        """The contacts of one contact element."""
        return [interval for name, interval in self.contacts if name == contact]

    def first_of(self, contact: str) -> ContactInterval | None:
        """The first contact of a contact element."""
        return next(iter(self.intervals(contact)), None)


@dataclass(frozen=True)
class Sides:
    """What is compared: our run on a grid, the same with looser tolerances, exudyn's of growing stiffness, and one of
    the softest with twice the step."""

    task: Task
    found: list[Touch]
    ours: Result
    loose: Result
    runs: list[PenaltyRun]
    doubled: PenaltyRun

    @property
    def latest(self) -> list[PenaltyRun]:
        """The runs that make the limit."""
        return self.runs[-RUNS:]

    @property
    def confirmed(self) -> bool:
        """Whether the limit has been found twice."""
        return len(self.runs) > RUNS

    def limit(self, values: list[np.ndarray], doubled: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """(the limit, its error bar) of values, one for each run."""
        found, open_ = latest_limit(np.array([r.x for r in self.runs]), np.array(values))
        return found, open_ + np.abs(values[0] - doubled)

    def doubts(self) -> list[str]:
        """Why the contacts of the last three runs are not that impact of ours."""
        told = [text for run in self.latest if (text := self._doubt(run))]
        without = [not run.first_of(self.found[0].contact) for run in (*self.runs, self.doubled)]
        if any(without) and not all(without):
            told.append(f"with some stiffnesses exudyn has no contact of '{self.found[0].contact}', with others it has")
        return told[-1:]

    def _doubt(self, run: PenaltyRun) -> str:
        first, stiffness = self.found[0], f"with K = {run.stiffness:.0e} N/m^1.5"
        mine = run.first_of(first.contact)
        if mine is None:
            return ""
        if mine.end is None:
            return (
                f"{stiffness} the contact '{first.contact}' is not over when exudyn's run ends: no rebound to compare"
            )
        near = SAME_BLOW * float(run.result.t[-1])
        later = [touch for touch in self.found[1:] if touch.start > first.start + near]
        merged = [touch for touch in later if touch.start < mine.end]
        if merged:
            return (
                f"{stiffness} the contact '{first.contact}' still lasts when '{merged[0].contact}' strikes at "
                f"{merged[0].start:.5g} s: two impacts of ours are one in exudyn"
            )
        lasting = mine.end - mine.start
        pieces = [x for x in run.intervals(first.contact)[1:] if x.start < mine.end + lasting]
        mates = [touch for touch in later if touch.contact == first.contact and touch.start < mine.end + 2.0 * lasting]
        if pieces and not mates:
            return f"{stiffness} the contact '{first.contact}' comes in pieces, where ours is one impact"
        return ""


def latest_limit(x: np.ndarray, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(limit, what it leaves open) of the last three of a row of runs; with more of them that it moves with the last
    counts too: then it has been found twice."""
    found, open_ = power_limit(x[-RUNS:], values[-RUNS:])
    if len(x) > RUNS:
        open_ = open_ + np.abs(found - power_limit(x[-RUNS - 1 : -1], values[-RUNS - 1 : -1])[0])
    return found, open_


def sure(row: Row) -> bool:
    """Whether a difference is far beyond what the two sides do not know."""
    return row.verdict == "differ" and row.difference > SURE * (row.uncertainty + row.ours_uncertainty + row.allowed)


def unless_sure(rows: Sequence[Row], confirmed: bool, doubt: str) -> list[Row]:
    """`rows` with `doubt` where a difference is not one of the models: the limit has been found once only, or lies too
    near to ours."""
    decided = [row.verdict != "differ" or (confirmed and sure(row)) for row in rows]
    return [row if known else replace(row, doubt=doubt) for row, known in zip(rows, decided, strict=True)]


def stiffer(stiffness: float, times: int) -> float:
    """A stiffness, so many decades up."""
    return stiffness * DECADE**times


def with_stiffness(model: Model, stiffness: float) -> Model:
    """`model` with every constraint contact replaced by the force law with the same restitution.

    Raises NotTranslatable for a restitution that the force law cannot have, and for Coulomb's friction.
    """
    contacts = []
    for contact in model.contacts:
        law = contact.law
        if isinstance(contact.friction, CoulombFriction):
            raise NotTranslatable(
                f"contact '{contact.name}' has Coulomb friction, and the limit of stiff contacts has none: compare it "
                "without `whole`, by the limit of contacts that stick by a spring"
            )
        if isinstance(law, NewtonImpact):
            if law.restitution < LOWEST_RESTITUTION:
                raise NotTranslatable(
                    f"contact '{contact.name}' has restitution {law.restitution:g}; below {LOWEST_RESTITUTION:g} the "
                    "contact persists and a penalty force rings in it, so there is no limit to compare with"
                )
            law = Gonthier(stiffness=stiffness, restitution=law.restitution, exponent=EXPONENT)
        # a force has no relative compliance
        contacts.append(contact.model_copy(update={"law": law, "compliance": 1.0}))
    # a restitution is no parameter of every law; the copy is for exudyn only
    return model.model_copy(update={"contacts": tuple(contacts), "parameters": ()})


def duration(first: Touch, stiffness: float) -> float:
    """Hertz' duration (s) of a contact with the effective mass of our impact."""
    mass = first.impulse / (first.approach_speed + first.separation_speed)
    depth = ((EXPONENT + 1.0) * mass * first.approach_speed**2 / (2.0 * stiffness)) ** (1.0 / (EXPONENT + 1.0))
    return 2.94 * depth / first.approach_speed


def contact_step(first: Touch, stiffness: float) -> float:
    """A step (s) that resolves a contact."""
    return duration(first, stiffness) / STEPS_IN_CONTACT


def softest_stiffness(found: list[Touch], t_end: float) -> float:
    """A power of ten, N/m^1.5, with which the first contact takes a small part of the time to the next impact."""
    first = found[0]
    near = SAME_BLOW * t_end
    room = min((touch.start for touch in found if touch.start > first.start + near), default=t_end) - first.start
    lasting = duration(first, SOFTEST)
    wanted = min(max(lasting, SHORTEST * room), LONGEST * room)
    if not wanted > 0.0 or wanted == lasting:
        return SOFTEST
    decades = (EXPONENT + 1.0) * math.log10(lasting / wanted)
    return SOFTEST * DECADE ** math.ceil(decades - 1e-9)


def contacts_of(task: Task, result: ExudynResult) -> list[tuple[str, ContactInterval]]:
    """All contacts of a run, in time."""
    found = []
    for contact in task.exudyn_model.contacts:
        intervals = contact_intervals(result.t, result[f"{contact.name}.gap"], result[f"{contact.name}.gap_rate"])
        found += [(contact.name, i) for i in intervals]
    return sorted(found, key=lambda pair: pair[1].start)


def impact_quantities(run: PenaltyRun, contact: str) -> np.ndarray:
    """(start, approach speed, impulse, separation speed) of the first contact of a contact element."""
    interval, r = run.intervals(contact)[0], run.result
    approach, separation = speeds(r.t, r[f"{contact}.gap_rate"], interval)
    pushed = impulse(r.t, r[f"{contact}.normal_force"], interval)
    return np.array([interval.start, approach, pushed, separation])
