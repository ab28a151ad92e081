"""Inputs of one run along courses.

A motion that a course leads is a polynomial from each time of the course to the next, so that position, rate and
acceleration are those of one function of time:

* positions alone: straight lines, whose jumps in rate are impacts of the driver, as at the ends of a `Ramp`, or with
  "spline" the not-a-knot cubic spline through them;
* positions and rates: the cubics that have both at the times;
* rates alone: straight lines, or with "hold" steps, whose integral the position is;
* positions that are held: no motion does that, so each jump is closed until the next time, as that of an FMU's input
  until the next communication point (`model/motion.py`).
"""

import logging
import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from .errors import ModelError
from .input_signals import Courses
from .model.motion import InputMotion, said
from .motion_profiles import Derivatives, Way, hermite, spline, straight
from .simulation.advance import restart_at
from .simulation.motions import close_jumps
from .simulation.restore import restart_here
from .simulation.simulation import Simulation
from .simulation.start import start_again

logger = logging.getLogger(__name__)

SAME_RATE = 1e-12
"""Of their size: rates that differ by no more are the same but for rounding."""

Row = tuple[float, float, float, float]


@dataclass(frozen=True)
class Led:
    """A motion that a course leads; `at`(t) is what its channels say from t on, in their units."""

    motion: InputMotion
    at: Callable[[float], Derivatives]


def _row(t: float, value: float, first: float, second: float) -> Row:
    """An input with these derivatives at time `t`, s; since when does not matter to what stays as it is."""
    return value, first, second, t if first or second else 0.0


class CourseRun:
    """The inputs of `sim` along `course`: they are set at once, and change as the run goes on.

    Raises
    ------
    ModelError : for inputs that the model does not have, and for one that would have to lead two motions differently.
    ConsistencyError, SimulationError : for a start that does not fit.
    """

    def __init__(self, course: Courses, sim: Simulation) -> None:
        self.course, self.sim = course, sim
        names = sim.assembly.input_names
        course.check(names)
        self._numbers = {name: k for k, name in enumerate(names)}
        self._led: list[Led] = []
        self._held: list[InputMotion] = []
        self._find_motions()
        self._said_jump = False
        if not self._leads:
            sim.set_inputs(*course.at(sim.t))
            return
        # a cubic without a channel for its rate has no place at a start, which begins motions without jumps
        self._write(self._rows(sim.t, whole=False))
        start_again(sim)
        if self._bends(sim.t):
            self._write(self._rows(sim.t))
            restart_here(sim)

    @property
    def _leads(self) -> bool:
        return bool(self._led or self._held)

    def run_to(self, t_end: float, until: float) -> None:
        """Integrate to `until` (s), with the inputs changing on the way; no step goes beyond t_end or a change.

        Where motions are led, what changes from `t_end` on changes no more: the rates there are those that lead to it.
        """
        sim, times = self.sim, self.course.times
        while True:
            ahead = times[times > sim.t]
            stop = float(ahead[0]) if len(ahead) else math.inf
            last = self._leads and stop >= t_end
            jumps = {} if last or stop == math.inf else self._rate_jumps(stop)
            # steps end just before a time at which the rate of a driver jumps, and go on from there (`breakpoint.py`)
            limit = math.nextafter(stop, -math.inf) if jumps else stop
            if last or stop > until:
                sim.run_to(min(limit, t_end), until=until)
                return
            sim.run_to(limit)
            if self._leads:
                self._change(stop, jumps)
            else:
                sim.set_inputs(*self.course.at(stop))

    def _find_motions(self) -> None:
        values, between, times = self.course.values, self.course.between, self.course.times
        names = self.sim.assembly.input_names
        for motion in self.sim.assembly.motions:
            x = values.get(names[motion.position])
            v = None if motion.rate < 0 else values.get(names[motion.rate])
            if x is None:
                if v is None:
                    continue
                rate = straight(times, v) if between != "hold" else None
                self._led.append(Led(motion, self._integral(motion, names[motion.rate], rate)))
            elif between == "hold" and len(times) > 1:
                self._held.append(motion)
            elif v is not None:
                self._led.append(Led(motion, hermite(times, x, v).at))
            else:
                self._led.append(Led(motion, (spline if between == "spline" else straight)(times, x).at))
        self._refuse_shared()

    def _refuse_shared(self) -> None:
        """Refuse channels whose rows two motions would need differently."""
        names = self.sim.assembly.input_names
        kinds: dict[int, int] = {}
        rates: dict[int, int] = {}
        for motion in (*(led.motion for led in self._led), *self._held):
            if kinds.setdefault(motion.position, motion.rate) != motion.rate:
                shared = names[motion.position]
            elif motion.rate >= 0 and rates.setdefault(motion.rate, motion.position) != motion.position:
                shared = names[motion.rate]
            else:
                continue
            raise ModelError(
                f"input '{shared}' leads two motions with different positions or rates: give each motion its own inputs"
            )

    def _integral(self, motion: InputMotion, name: str, rate: Way | None) -> Callable[[float], Derivatives]:
        """A motion that goes on from where it is, with the rate of the course."""

        def at(t: float) -> Derivatives:
            inputs = self.sim.workspace.arrays["inputs"]
            since = float(inputs[motion.jumps, 2])
            x, _, _ = said.py_func(inputs.reshape(-1), motion.position, motion.rate, since, t)
            v, a = (self.course.at(t)[0][name], 0.0) if rate is None else rate.at(t)[:2]
            return float(x), v, a, 0.0

        return at

    def _bends(self, t: float) -> bool:
        """Whether from `t` on some motion is a cubic that takes jumps to write down."""
        return any(led.motion.rate < 0 and led.at(t)[3] != 0.0 for led in self._led)

    def _rows(self, t: float, whole: bool = True) -> dict[int, Row]:
        """Rows of the array of inputs from time `t` on. `whole`: cubics without a channel for their rate, too, which
        else have their position, rate and acceleration at `t`."""
        values, rates = self.course.at(t)
        rows = {self._numbers[name]: _row(t, x, *rates[name], 0.0) for name, x in values.items()}
        inputs = self.sim.workspace.arrays["inputs"]
        before = {motion.jumps: motion.state(inputs, t) for motion in self._held}
        after = self.course.times[self.course.times > t]
        for led in self._led:
            motion, (x, v, a, j) = led.motion, led.at(t)
            rows[motion.jumps] = (0.0, 0.0, t, 0.0)
            if motion.rate >= 0:
                rows[motion.position], rows[motion.rate] = _row(t, x, v, a), _row(t, v, a, j)
            elif j == 0.0 or not whole:
                rows[motion.position] = _row(t, x, v, a)
            else:
                # the parabola that joins the cubic at its end T, and c(s) = -j/6 (T - s)^3 of `model/motion.py`
                h = float(after[0]) - t
                c0, c1 = -j * h**3 / 6.0, 0.5 * j * h**2
                rows[motion.position] = _row(t, x - c0, v - c1, a + j * h)
                rows[motion.jumps] = (motion.gain * c0, motion.gain * c1, t, h)
        for motion in self._held:
            (x, v), (new_x, new_v) = before[motion.jumps], self._said(rows, motion)
            rows[motion.jumps] = (x - new_x, v - new_v, t, 0.0) if self.sim.started else (0.0, 0.0, t, 0.0)
        return rows

    @staticmethod
    def _said(rows: dict[int, Row], motion: InputMotion) -> tuple[float, float]:
        """Position and rate of a motion that is held, from the time of these rows on."""
        rate = 0.0 if motion.rate < 0 else rows.get(motion.rate, (0.0,))[0]
        return motion.gain * rows[motion.position][0], motion.gain * rate

    def _write(self, rows: dict[int, Row]) -> None:
        inputs = self.sim.workspace.arrays["inputs"]
        for k, row in rows.items():
            inputs[k] = row

    def _change(self, t: float, jumps: dict[int, float]) -> None:
        """Go on from time `t` (s) by what the course says from there, after jumps of rates."""
        sim = self.sim
        if jumps:
            before, rows = sim.t, self._rows(t, whole=False)
            self._write(rows | {k: (0.0, jump, before, t - before) for k, jump in jumps.items()})
            self._restart_at(t)
        if not jumps or self._bends(t):
            self._write(self._rows(t))
            restart_here(sim)
        if self._held:
            ahead, gone = self.course.times[self.course.times > t], self.course.times[self.course.times <= t]
            close_jumps(sim, float(ahead[0]) if len(ahead) else t + float(np.diff(gone)[-1]))

    def _rate_jumps(self, t: float) -> dict[int, float]:
        """By how much the rates of motions jump down at `t`, by the row of their jumps."""
        inputs, found = self.sim.workspace.arrays["inputs"], {}
        for led in self._led:
            old, new = led.motion.state(inputs, t)[1], led.motion.gain * led.at(t)[1]
            if abs(old - new) > SAME_RATE * (abs(old) + abs(new)):
                found[led.motion.jumps] = old - new
        return found

    def _restart_at(self, t: float) -> None:
        """Pass jumps of rates, and say so once."""
        drive = self.sim.drive
        drive.says_jumps = not self._said_jump
        try:
            restart_at(self.sim, t)
        finally:
            drive.says_jumps = True
        self.sim.t = t
        if not self._said_jump:
            self._said_jump = True
            logger.warning(
                "positions of inputs go along straight lines, and where these meet the driver strikes: this is said "
                "once. Courses(times, values, 'spline'), or `--spline`, leads smoothly through the same positions"
            )
