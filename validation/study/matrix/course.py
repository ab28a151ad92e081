"""A recorded run as piecewise smooth functions of time, and how another run differs from it."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import BPoly, PchipInterpolator

from ....core import Simulation

Array = NDArray[np.float64]

STARTS = ("impact", "close")
"""Events whose times are compared: a contact begins."""
ATOL_SHARE = 0.01
"""atol over the tolerance, in units of the scenario's motion."""
LEAST_RTOL = 1e-13
"""What rounding allows."""
LEAST_SCALES = (1e-9, 1e-6)
"""m and rad: what moves less does not move."""


@dataclass(frozen=True)
class Course:
    """Samples of a run: times (N,) ascending, twice where velocities jump."""

    t: Array
    q: Array
    v: Array
    a: Array
    joints: Array
    """Multipliers of the joints (N, m)."""
    impulses: Array
    """Of each contact up to each time, N s (N, c)."""
    angle: NDArray[np.bool_]
    """Which coordinates are angles (n,)."""
    event_times: Array
    event_contacts: tuple[str, ...]
    """Of impacts and closings."""
    residuals: tuple[float, float, float]
    balance: float
    """Largest |energy.balance|, J."""
    kinetic: float
    """Largest kinetic energy, J."""
    redundant: bool
    """True if constraints repeat others: multipliers are not unique then."""

    @classmethod
    def of(cls, sim: Simulation) -> "Course":
        """What `sim` has recorded."""
        sim.flush()
        samples, layout = np.concatenate(sim.samples), sim.table.layout
        contacts = [contact.name for contact in sim.assembly.contacts]

        def channel(name: str) -> Array:
            return sim.table.column(samples, name)

        multipliers = samples[:, layout.multipliers]
        impulses = [channel(f"{name}.impulse") for name in contacts]
        starts = [event for event in sim.events if event.kind in STARTS]
        residuals = tuple(
            float(channel(f"residual.{level}").max()) for level in ("position", "velocity", "acceleration")
        )
        return cls(
            samples[:, 0].copy(), samples[:, layout.q], samples[:, layout.v], samples[:, layout.a],
            multipliers[:, : multipliers.shape[1] - len(contacts)],
            np.stack(impulses, axis=1) if impulses else np.zeros((len(samples), 0)),
            np.asarray(sim.assembly.is_angle, dtype=bool)[: samples[:, layout.q].shape[1]],
            np.array([event.t for event in starts]), tuple(event.contact for event in starts),
            residuals,  # type: ignore[arg-type]
            float(np.abs(channel("energy.balance")).max()), float(channel("energy.kinetic").max()),
            bool(sim.redundant),
        )  # fmt: skip

    def until(self, t_end: float) -> "Course":
        """The part up to `t_end` (s); residuals and energies stay those of the whole."""
        keep, early = self.t <= t_end, self.event_times <= t_end
        parts = {name: getattr(self, name)[keep] for name in ("t", "q", "v", "a", "joints", "impulses")}
        contacts = tuple(name for name, is_early in zip(self.event_contacts, early, strict=True) if is_early)
        return Course(**{**vars(self), **parts, "event_times": self.event_times[early], "event_contacts": contacts})

    @property
    def scales(self) -> tuple[float, float]:
        """Half the largest range of a length (m) and of an angle (rad)."""
        return self._by_kind(0.5 * np.ptp(self.q, axis=0), LEAST_SCALES)

    def scale_of_coordinates(self, scales: tuple[float, float]) -> Array:
        """The scale of each coordinate (n,)."""
        return np.where(self.angle, scales[1], scales[0])

    def tolerances(self, tolerance: float, least: float = LEAST_RTOL) -> tuple[float, dict[str, float]]:
        """rtol (at least `least`) and atol that stand for `tolerance` in parts of how far this run moves.

        atol is a hundredth of it in units of the motion; rtol is less than it where coordinates are larger than what
        they move (a rod of 1 m that is struck moves by micrometres).
        """
        length, angle = self.scales
        largest = self._by_kind(np.abs(self.q).max(axis=0), LEAST_SCALES)
        speed, angular = self._by_kind(np.abs(self.v).max(axis=0), LEAST_SCALES)
        share = min(1.0, length / largest[0], angle / largest[1])
        rtol = max(least, share * tolerance)
        kinds = {
            "length": (length, largest[0]), "angle": (angle, largest[1]),
            "speed": (speed, speed), "angular_speed": (angular, angular),
        }  # fmt: skip
        return rtol, {kind: ATOL_SHARE * max(tolerance * scale, least * most) for kind, (scale, most) in kinds.items()}

    def _by_kind(self, values: Array, least: tuple[float, float]) -> tuple[float, float]:
        return (
            float(max(least[0], np.max(values[~self.angle], initial=0.0))),
            float(max(least[1], np.max(values[self.angle], initial=0.0))),
        )

    def spline(self) -> BPoly:
        """The coordinates as quintics between the samples: q, v and a agree at both ends of each."""
        h = np.diff(self.t)
        i = np.flatnonzero(h > 0.0)
        h, j = h[i, None], i + 1
        q, v, a = self.q, self.v, self.a
        # Bernstein coefficients from value and two derivatives at either end
        c = np.stack([
            q[i], q[i] + h * v[i] / 5.0, q[i] + 0.4 * h * v[i] + h**2 * a[i] / 20.0,
            q[j] - 0.4 * h * v[j] + h**2 * a[j] / 20.0, q[j] - h * v[j] / 5.0, q[j],
        ])  # fmt: skip
        return BPoly(c, np.append(self.t[i], self.t[-1]))

    def segments(self) -> list[slice]:
        """The samples between two jumps of the velocities."""
        jumps = np.flatnonzero(np.diff(self.t) == 0.0) + 1
        edges = [0, *(int(k) for k in jumps), len(self.t)]
        return [slice(a, b) for a, b in pairwise(edges) if b - a > 1]


def course_difference(run: Course, spline: BPoly, scale: Array) -> Array:
    """|q - q_ref| over the scale, the largest over the coordinates, at each sample of `run` (N,)."""
    if not run.q.shape[1]:
        return np.zeros(len(run.t))
    return np.asarray(np.max(np.abs(run.q - spline(run.t)) / scale, axis=1))


def event_errors(run: Course, reference: Course) -> tuple[float | None, float | None]:
    """Errors (s) of the first beginning of a contact, and the largest of all; None without a counterpart."""
    if not len(run.event_times) or not len(reference.event_times):
        return None, None
    first = float(abs(run.event_times[0] - reference.event_times[0]))
    if run.event_contacts != reference.event_contacts:
        return first, None
    return first, float(np.max(np.abs(run.event_times - reference.event_times)))


def mean_difference(run: Course, reference: Course, name: str) -> float | None:
    """Mean |x - x_ref| over time of the worst column of `name`, over the mean |x_ref| of the largest.

    Each stretch between two jumps is compared with its counterpart, so that a jump a little too early counts for its
    time, not for its height; None if the numbers of stretches differ, or there is nothing to compare.
    """
    ours, theirs = run.segments(), reference.segments()
    x, y = getattr(run, name), getattr(reference, name)
    if len(ours) != len(theirs) or not x.shape[1]:
        return None
    difference, size = np.zeros(x.shape[1]), np.zeros(x.shape[1])
    for here, there in zip(ours, theirs, strict=True):
        at = np.clip(run.t[here], reference.t[there][0], reference.t[there][-1])
        exact = PchipInterpolator(reference.t[there], y[there])(at)
        difference += np.trapezoid(np.abs(x[here] - exact), run.t[here], axis=0)
        size += np.trapezoid(np.abs(exact), run.t[here], axis=0)
    return float(difference.max() / size.max()) if size.max() > 0.0 else None


def save(course: Course, path: Any) -> None:
    """Write `course` to an NPZ file."""
    arrays = {name: value for name, value in vars(course).items() if name != "event_contacts"}
    np.savez(path, **arrays, event_contacts=np.array(course.event_contacts, dtype=str))


def load(path: Any) -> Course:
    """Read what `save` has written."""
    with np.load(path) as data:
        arrays: dict[str, Any] = {name: data[name] for name in data.files}
    contacts: Sequence[str] = arrays.pop("event_contacts").tolist()
    plain = {name: float(arrays.pop(name)) for name in ("balance", "kinetic")}
    residuals = tuple(float(x) for x in arrays.pop("residuals"))
    redundant = bool(arrays.pop("redundant"))
    return Course(**arrays, **plain, residuals=residuals, redundant=redundant, event_contacts=tuple(contacts))  # type: ignore[arg-type]
