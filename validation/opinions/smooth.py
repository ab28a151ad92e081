"""Third opinions on motion without contact: scipy in minimal coordinates."""

import math

import numpy as np
from scipy.integrate import solve_ivp

from ...models import Scenario
from ..third_opinion import Opinion, opinion
from .mechanism import ATOL, RTOL, Mechanism, run


@opinion("pendulum")
def pendulum(scenario: Scenario) -> Opinion | None:
    """The angle by scipy."""
    p = scenario.parameters
    q, v = scenario.model.bodies[0].initial_state()
    (x, y), (vx, vy) = q[:2], v[:2]
    length, gravity = math.hypot(x, y), float(p["gravity"])
    if "length" in p and not math.isclose(length, float(p["length"])):
        return None
    angle, rate = math.atan2(y, x), (x * vy - y * vx) / length**2
    run = solve_ivp(
        lambda t, s: [s[1], -gravity / length * math.cos(s[0])], (0.0, scenario.t_end), [angle, rate], "DOP853",
        rtol=RTOL, atol=ATOL, dense_output=True,
    )  # fmt: skip
    return Opinion(
        "scipy, the angle",
        channels={
            "bob.x": lambda t: length * math.cos(run.sol(t)[0]),
            "bob.y": lambda t: length * math.sin(run.sol(t)[0]),
            "bob.vx": lambda t: -length * math.sin(run.sol(t)[0]) * run.sol(t)[1],
            "bob.vy": lambda t: length * math.cos(run.sol(t)[0]) * run.sol(t)[1],
        },
    )


@opinion("chain")
def chain(scenario: Scenario) -> Opinion | None:
    """The links' angles by scipy: M_ij = (n - max(i, j) - 1/2 or - 2/3) m L^2 cos(a_i - a_j)."""
    p = scenario.parameters
    n, length, gravity = int(p["links"]), float(p["length"]), float(p["gravity"])
    i = np.arange(n)
    beyond = n - 1.0 - np.maximum(i[:, None], i[None, :])
    share = beyond + np.where(i[:, None] == i[None, :], 1.0 / 3.0, 0.5)
    weight = (n - 1.0 - i) + 0.5

    def motion(t: float, s: np.ndarray) -> np.ndarray:
        a, w = s[:n], s[n:]
        apart = a[:, None] - a[None, :]
        force = -(share * np.sin(apart)) @ w**2 - gravity / length * weight * np.cos(a)
        return np.concatenate([w, np.linalg.solve(share * np.cos(apart), force)])

    run = solve_ivp(motion, (0.0, scenario.t_end), np.zeros(2 * n), "DOP853", rtol=1e-11, atol=1e-11,
                    dense_output=True)  # fmt: skip
    half = np.append(np.ones(n - 1), 0.5) * length
    last = f"link{n}"
    return Opinion(
        "scipy, the links' angles",
        channels={
            f"{last}.x": lambda t: float(half @ np.cos(run.sol(t)[:n])),
            f"{last}.y": lambda t: float(half @ np.sin(run.sol(t)[:n])),
            f"{last}.angle": lambda t: float(run.sol(t)[n - 1]),
            f"{last}.angular_velocity": lambda t: float(run.sol(t)[2 * n - 1]),
        },
    )


@opinion("four_bar")
def four_bar(scenario: Scenario) -> Opinion | None:
    """The common angle of the cranks, while the couplers stay level: each crank's is a'' = -(g/L) cos(a) f."""
    p = scenario.parameters
    loops, length, gravity = int(p["loops"]), float(p["length"]), float(p["gravity"])
    factor = (0.5 * (loops + 1) + loops) / ((loops + 1) / 3.0 + loops)
    cranks = Mechanism(
        mass=lambda q: np.eye(1), force=lambda t, q, v: -gravity / length * factor * np.cos(q)
    )  # fmt: skip
    course = run(cranks, (0.5 * math.pi,), (-float(p["speed"]) / length,), scenario.t_end)
    angle, rate = course.q(0), course.v(0)
    return Opinion(
        "scipy, the cranks' angle",
        channels={
            "crank0.angle": angle,
            "crank0.angular_velocity": rate,
            "crank0.x": lambda t: 0.5 * length * math.cos(angle(t)),
            "crank0.y": lambda t: 0.5 * length * math.sin(angle(t)),
            f"coupler{loops}.angle": lambda t: 0.0,
        },
    )
