"""CCFM towards CCM: how fast a contact force of growing stiffness comes to the impact of a constraint.

With F = K d^n (1 + damping) a blow lasts T_c = c_n(e) d_max/v, d_max ~ (m v^2/K)^(1/(n+1)): proportional to
K^(-1/(n+1)) (K^(-1/2) for n = 1, K^(-2/5) for n = 3/2). Meanwhile the constraint's impact is over: what flies off
afterwards is late by T_c, and a force F_0 that acts all the time (weight) has changed the momentum by the order of
F_0 T_c. So duration, trajectory and, where such a force acts along the normal, the impulse approach the impact as
K^(-1/(n+1)). At the lowest point of a pendulum no such force acts: there its impulse comes nearer faster.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ...core import Result, simulate
from ...models import load

STIFFNESSES = tuple(10.0**k for k in range(5, 11))
"""N/m^n, for masses of 1 kg."""
QUICK_STIFFNESSES = STIFFNESSES[:4]
RTOL, ATOL = 1e-10, 1e-13
QUANTITIES = ("duration", "position", "impulse")
WITHIN = 0.03
"""How far an observed exponent may lie from -1/(n + 1)."""


@dataclass(frozen=True)
class StiffnessCase:
    """A scenario with a force law, and what it tends to."""

    scenario: str
    law: str
    exponent: float
    """n."""
    restitution: float
    coordinate: str
    contact: str
    settings: dict[str, Any] = field(default_factory=dict, hash=False)

    @property
    def theory(self) -> float:
        """-1/(n + 1)."""
        return -1.0 / (self.exponent + 1.0)

    @property
    def label(self) -> str:
        """As it stands in tables."""
        settings = "".join(f" {name}={value:g}" for name, value in self.settings.items())
        return f"{self.scenario}{settings}, {self.law} n={self.exponent:g} e={self.restitution:g}"


def _cases() -> tuple[StiffnessCase, ...]:
    laws = (("hertz", 1.5, 1.0), ("kelvin_voigt", 1.0, 0.7), ("gonthier", 1.5, 0.7), ("gonthier", 1.0, 0.7))
    ball = tuple(StiffnessCase("bouncing_ball", *law, "ball.y", "floor") for law in laws)
    rod = tuple(
        StiffnessCase("pendulum_stop", *law, "pendulum.angle", "stop", {"stop_angle": -1.0}) for law in laws[:3]
    )
    return (*ball, *rod, StiffnessCase("pendulum_stop", "gonthier", 1.5, 0.7, "pendulum.angle", "stop"))


CASES = _cases()


@dataclass(frozen=True)
class StiffnessRow:
    """One case: what differs from the constraint's impact at each stiffness."""

    case: StiffnessCase
    stiffnesses: tuple[float, ...]
    differences: tuple[tuple[float, float, float], ...]
    """Duration of the first contact (s); of the coordinate a quarter of the way to the second impact (m or rad); of
    the impulse, relative."""

    def rate(self, quantity: int) -> float:
        """Observed exponent of K, from the two decades of largest stiffness."""
        x, y = self.stiffnesses[-3:], [abs(d[quantity]) for d in self.differences[-3:]]
        return float(np.polyfit(np.log(x), np.log(y), 1)[0])

    @property
    def rates(self) -> tuple[float, float, float]:
        """Of duration, position, impulse."""
        return self.rate(0), self.rate(1), self.rate(2)

    @property
    def ok(self) -> bool:
        """True if duration and position have the rate of the theory, and the impulse at least that."""
        duration, position, impulse = self.rates
        theory = self.case.theory
        return abs(duration - theory) <= WITHIN and abs(position - theory) <= WITHIN and impulse <= theory + WITHIN

    def to_dict(self) -> dict[str, Any]:
        """Plain data."""
        return {
            "label": self.case.label, "scenario": self.case.scenario, "law": self.case.law, "n": self.case.exponent,
            "restitution": self.case.restitution, "theory": self.case.theory, "stiffness": list(self.stiffnesses),
            "observed": dict(zip(QUANTITIES, self.rates, strict=True)), "ok": self.ok,
            "differences": {name: [d[k] for d in self.differences] for k, name in enumerate(QUANTITIES)},
        }  # fmt: skip


def stiffness_study(
    *, quick: bool = False, progress: Callable[[float], None] | None = None
) -> tuple[StiffnessRow, ...]:
    """All cases; `quick` leaves out the largest stiffnesses. `progress` is called with the number of cases done."""
    rows = []
    for case in CASES:
        rows.append(measure(case, QUICK_STIFFNESSES if quick else STIFFNESSES))
        if progress is not None:
            progress(float(len(rows)))
    return tuple(rows)


def measure(case: StiffnessCase, stiffnesses: Sequence[float] = STIFFNESSES) -> StiffnessRow:
    """Run one case with the constraint and with each stiffness."""
    scenario = load(case.scenario, law="newton", restitution=case.restitution, **case.settings)
    impacts = [e for e in simulate(scenario.model, scenario.t_end, rtol=RTOL, atol=ATOL).events if e.kind == "impact"]
    # not half way: there the motion turns, and a delay does not show
    later = impacts[0].t + 0.25 * (impacts[1].t - impacts[0].t)
    exact = _at(simulate(scenario.model, later, rtol=RTOL, atol=ATOL, t_eval=[later]), case.coordinate)
    differences = []
    for stiffness in stiffnesses:
        law = {"law": case.law, "stiffness": stiffness, "restitution": case.restitution}
        if case.law != "kelvin_voigt":
            law["exponent"] = case.exponent
        model = load(case.scenario, **law, **case.settings).model
        result = simulate(model, later, rtol=RTOL, atol=ATOL, t_eval=[later])
        closed, opened = (next(e for e in result.events if e.kind == kind) for kind in ("close", "open"))
        differences.append(
            (opened.t - closed.t, _at(result, case.coordinate) - exact, opened.impulse / impacts[0].impulse - 1.0)
        )
    return StiffnessRow(case, tuple(stiffnesses), tuple(differences))


def _at(result: Result, channel: str) -> float:
    return float(result[channel][-1])


def hertz_duration(mass: float, stiffness: float, exponent: float, speed: float) -> float:
    """Duration (s) of an undamped blow of a free mass: c_n d_max/v.

    c_n = 2 sqrt(pi) Gamma(1/(n+1)) / ((n+1) Gamma(1/(n+1) + 1/2)), from m v dv = -K d^n dd.
    """
    p = 1.0 / (exponent + 1.0)
    deepest = ((exponent + 1.0) * mass * speed**2 / (2.0 * stiffness)) ** p
    factor = 2.0 * math.sqrt(math.pi) * p * math.gamma(p) / math.gamma(p + 0.5)
    return factor * deepest / speed
