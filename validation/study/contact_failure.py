"""C4: what methods do at contact, with the velocity jump of an impact law and without.

Three problems: impacts with restitution (`pendulum_stop`, `double_pendulum_wall`) and plastic ones, after which the
contact stays closed until its force vanishes (`double_pendulum_wall` with restitution 0). Every setting runs with fixed
and with error-controlled steps, once as the core has it and once as `NoVelocityJump`. The reference is TLISMNI(EBDF) at
rtol 1e-12; it agrees with minimal coordinates to 1e-9 (`DoublePendulum`).

What to expect without the jump, for approach speed v and nothing else acting (m the effective mass at the contact):
 * Baumgarte with alpha = beta: g = -v t exp(-alpha t) until the force, m (g'' from it), changes its sign at t =
   2/alpha: separation with exp(-2) v whatever alpha is, impulse (1 + exp(-2)) m v, penetration v/(alpha e).
 * HHT on index 3: g_{n+1} = 0 = -h v + h^2 beta a_{n+1} gives v_{n+1} = (gamma/beta - 1) v: nearly elastic.
 * With the velocity constraint (GGL, index 2): the first step ends with v = 0: plastic, whatever the restitution.
 * TLISMNI: the dependent velocities are made to fit the independent ones without any momentum balance.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...core import Simulation, SimulationError
from .cases import Setting
from .naive_contact import NoVelocityJump
from .problems import Problem

STEPS = (1e-3, 2.5e-4, None)
"""s: an error that does not fall from one to the other is not the step's. None: error-controlled, rtol RTOL."""
RTOL = 1e-6
PROBLEMS = (
    Problem("pendulum_stop", {"restitution": 0.7}, 2.5),
    Problem("double_pendulum_wall", {"restitution": 0.8}, 4.0),
    Problem("double_pendulum_wall", {"restitution": 0.0, "wall": 0.2}, 2.5),
)
SETTINGS = (
    Setting("ebdf", {"k": 4}),
    Setting("hht"),
    Setting("baumgarte"),
    Setting("baumgarte", {"alpha": 50.0, "beta": 50.0}),
    Setting("baumgarte", {"rule": "step"}),
    Setting("hht_ggl"),
    Setting("hht_i3"),
    Setting("generalized_alpha"),
    Setting("generalized_alpha", {"form": "index3"}),
)
REFERENCE = Setting("ebdf", {"k": 6})
CLOSE = 0.01
"""Of the impulse and of the kinetic energy: what an engineer would still call right."""
DEEP = 1e-4
"""m."""
LATE = 5e-3
"""s: of the release."""


@dataclass(frozen=True)
class Contact:
    """The first contact of a run, and what the whole run shows."""

    contacts: int
    """How often the contact closed (impacts included)."""
    impulse: float
    """Of the first contact, until it ends, N s."""
    restitution: float
    """Separation over approach speed of the first contact; NaN if it does not end."""
    released: float
    """When it ended, s; infinite if it does not."""
    energy: float
    """Stored right after the first contact, J."""
    kinetic: float
    """Kinetic energy right before it, J."""
    penetration: float
    """Deepest, m."""
    unaccounted: float
    """Largest |energy.balance|, J."""
    position: float
    velocity: float
    """Largest violations of joints and closed contacts, m and m/s."""
    end: NDArray[np.float64]
    """Coordinates at the end."""


@dataclass(frozen=True)
class ContactRow:
    """A run against the reference."""

    problem: str
    setting: Setting
    jump: bool
    step: float | None
    found: Contact | None
    """None: the run fails."""
    exact: Contact
    failure: str = ""

    @property
    def impulse_error(self) -> float:
        """Relative."""
        return math.nan if self.found is None else self.found.impulse / self.exact.impulse - 1.0

    @property
    def energy_error(self) -> float:
        """Stored energy after the first contact, relative to the kinetic energy before it."""
        return math.nan if self.found is None else (self.found.energy - self.exact.energy) / self.exact.kinetic

    @property
    def release_error(self) -> float:
        """s."""
        return math.nan if self.found is None else self.found.released - self.exact.released

    @property
    def end_error(self) -> float:
        """Of the coordinates, relative to the largest."""
        if self.found is None:
            return math.nan
        return float(np.max(np.abs(self.found.end - self.exact.end)) / np.max(np.abs(self.exact.end)))

    @property
    def faults(self) -> tuple[str, ...]:
        """What is not reasonable."""
        if self.found is None:
            return ("fails",)
        checks = (
            ("impulse", not abs(self.impulse_error) <= CLOSE),
            ("energy", not abs(self.energy_error) <= CLOSE),
            ("release", not abs(self.release_error) <= LATE),
            ("penetration", self.found.penetration > DEEP),
            ("number of contacts", self.found.contacts != self.exact.contacts),
        )
        return tuple(name for name, wrong in checks if wrong)

    def to_dict(self) -> dict[str, Any]:
        """Plain data."""
        found = None if self.found is None else {**vars(self.found), "end": self.found.end.tolist()}
        return {
            "problem": self.problem, "method": self.setting.method, "options": dict(self.setting.options),
            "label": self.setting.label, "velocity_jump": self.jump, "step": self.step, "found": found,
            "exact": {**vars(self.exact), "end": self.exact.end.tolist()}, "impulse_error": self.impulse_error,
            "energy_error": self.energy_error, "release_error": self.release_error, "end_error": self.end_error,
            "faults": list(self.faults), "failure": self.failure,
        }  # fmt: skip


def contact_study(*, quick: bool = False, progress: Callable[[float], None] | None = None) -> tuple[ContactRow, ...]:
    """All runs. `quick` takes the coarse steps only; `progress` is called with the share that is done (0 ... 1)."""
    steps: tuple[float | None, ...] = STEPS[:1] if quick else STEPS
    rows: list[ContactRow] = []
    total = len(PROBLEMS) * len(SETTINGS) * 2 * len(steps)
    for problem in PROBLEMS:
        exact = _exact(problem)
        for setting in SETTINGS:
            for jump in (True, False):
                for step in steps:
                    rows.append(measure(problem, setting, jump, step, exact))
                    if progress is not None:
                        progress(len(rows) / total)
    return tuple(rows)


def measure(
    problem: Problem, setting: Setting, jump: bool, step: float | None, exact: Contact | None = None
) -> ContactRow:
    """One run; `exact` is made if it is not given."""
    exact = exact or _exact(problem)
    run = start(problem, setting, jump, step)
    try:
        run.run_to(problem.t_end or 0.0)
    except SimulationError as error:
        return ContactRow(problem.label, setting, jump, step, None, exact, str(error))
    if divided := run.stats["divided_steps"]:
        return ContactRow(problem.label, setting, jump, step, None, exact, f"{divided} steps do not converge")
    return ContactRow(problem.label, setting, jump, step, first_contact(run), exact)


def start(problem: Problem, setting: Setting, jump: bool, step: float | None) -> Simulation:
    """The run, ready to go."""
    kind = Simulation if jump else NoVelocityJump
    return kind(problem.load().model, setting.method, RTOL, 0.01 * RTOL, step=step, record=True, **setting.options)


def _exact(problem: Problem) -> Contact:
    run = Simulation(problem.load().model, REFERENCE.method, 1e-12, 1e-14, record=True, **REFERENCE.options)
    run.run_to(problem.t_end or 0.0)
    return first_contact(run)


def first_contact(run: Simulation) -> Contact:
    """What a run with one contact shows, from its recorded samples and events."""
    run.flush()
    samples = np.concatenate(run.samples)
    name = run.assembly.contacts[0].name

    def channel(channel_name: str) -> NDArray[np.float64]:
        return run.table.column(samples, channel_name)

    t, rate, mode = samples[:, 0], channel(f"{name}.gap_rate"), channel(f"{name}.mode")
    begins = _beginnings(run.events)
    before = int(np.searchsorted(t, begins[0]))
    after = int(np.searchsorted(t, begins[0], side="right")) - 1
    ends = np.flatnonzero(mode[after:] == 0.0)
    apart = after + int(ends[0]) if len(ends) else len(t) - 1
    stored = channel("energy.kinetic") + channel("energy.potential")
    return Contact(
        len(begins),
        float(channel(f"{name}.impulse")[apart]),
        float(-rate[apart] / rate[before]) if len(ends) else math.nan,
        float(t[apart]) if len(ends) else math.inf,
        float(stored[apart]),
        float(channel("energy.kinetic")[before]),
        max(0.0, -float(channel(f"{name}.gap").min())),
        float(np.abs(channel("energy.balance")).max()),
        float(channel("residual.position").max()),
        float(channel("residual.velocity").max()),
        samples[-1, run.table.layout.q],
    )


def _beginnings(events: Sequence[Any]) -> list[float]:
    """Times at which the contact closed: an impact and the closing that follows it count once."""
    times: list[float] = []
    for event in events:
        if event.kind in ("impact", "close", "rest") and (not times or event.t > times[-1]):
            times.append(event.t)
    return times
