"""The problems of `accuracy_per_time.py`: a model, where it is looked at, and the exact answer."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray
from reference import chain_reference, slider_crank_reference
from tlismni.core import Model
from tlismni.models import load

Array = NDArray[np.float64]

LINKS = 10
CRANK, ROD = 0.15, 0.5
SPEED = 20.0
STIFFNESS = 1e8
T_END = 2.0
SLIDER_CRANK = {"crank_length": CRANK, "rod_length": ROD, "crank_speed": SPEED}


@dataclass(frozen=True)
class Problem:
    """A benchmark problem; `point(q)` is what the error is measured on, in m."""

    name: str
    title: str
    model: Model
    t_end: float
    point: Callable[[Array], Array]
    exact: Callable[[float], Array]
    """The point at a time, s."""
    stiff: bool = False

    @property
    def bodies(self) -> int:
        """Number of bodies."""
        return len(self.model.bodies)

    @cached_property
    def reference(self) -> Array:
        """The point at the end, at least 100 times as exact as what is compared with it."""
        return self.exact(self.t_end)

    def error(self, q: Array) -> float:
        """Distance from the reference, m."""
        return float(np.linalg.norm(self.point(q) - self.reference))


def _free_end(q: Array) -> Array:
    """The free end of the chain."""
    return np.array([q[-3] + 0.5 * math.cos(q[-1]), q[-2] + 0.5 * math.sin(q[-1])])


def _pins(q: Array) -> Array:
    """The crank's pin and the slider: (x, y, x)."""
    return np.array([CRANK * math.cos(q[2]), CRANK * math.sin(q[2]), q[6]])


def _deflection(crank: Any, rod: Any, slider: Any) -> tuple[float, float, float, float]:
    """(x, y, x', y') of the slider against the end of the rod."""
    points, rates = [], []
    for body, length in ((crank, CRANK), (rod, ROD)):
        c, s = math.cos(body.angle), math.sin(body.angle)
        points.append((length * c, length * s))
        rates.append((-length * s * body.angular_velocity, length * c * body.angular_velocity))
    return (
        slider.position[0] - points[0][0] - points[1][0],
        -points[0][1] - points[1][1],
        slider.velocity[0] - rates[0][0] - rates[1][0],
        -rates[0][1] - rates[1][1],
    )


def _slider_crank(name: str, title: str, **parameters: Any) -> Problem:
    scenario = load("slider_crank", **SLIDER_CRANK, **parameters)
    crank, rod, slider = scenario.model.bodies
    stiff = "bushing_stiffness" in parameters
    # following the vibration is slow, and its errors do not grow
    tolerance = 1e-12 if stiff else 1e-13

    def exact(t: float) -> Array:
        angle, x = slider_crank_reference(
            t,
            lengths=(CRANK, ROD),
            masses=(crank.mass, rod.mass, slider.mass),
            crank=(crank.angle, crank.angular_velocity),
            stiffness=parameters.get("bushing_stiffness", 0.0),
            deflection=_deflection(crank, rod, slider),
            rtol=tolerance,
            atol=tolerance,
        )
        return np.array([CRANK * math.cos(angle), CRANK * math.sin(angle), x])

    return Problem(name, title, scenario.model, T_END, _pins, exact, stiff)


def problems() -> tuple[Problem, ...]:
    """The three problems: an open chain, a closed loop, a stiff one."""
    return (
        Problem(
            "chain",
            f"chain of {LINKS} links: error of the free end at 2 s",
            load("chain", links=LINKS).model,
            T_END,
            _free_end,
            lambda t: np.array(chain_reference(LINKS, [0.0, t]).tip[:, -1]),
        ),
        _slider_crank("slider_crank", "slider-crank, 20 rad/s: error of crank pin and slider at 2 s"),
        _slider_crank(
            "slider_crank_stiff",
            f"slider-crank, wrist pin elastic with {STIFFNESS:g} N/m: error of crank pin and slider at 2 s",
            bushing_stiffness=STIFFNESS,
        ),
    )
