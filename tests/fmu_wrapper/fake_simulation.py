"""A stand-in for `tlismni.core.Simulation`: the bouncing ball in closed form, with failures on demand.

For the tests of everything around the solver: it needs no compilation, and it fails when told to.
"""

import math
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np
from tlismni.core.errors import ModelError, SimulationError
from tlismni.core.events import Event
from tlismni.core.model.channels import Channel, Enumeration

CHANNELS = (
    Channel("ball.y", "m", "height"),
    Channel("ball.vy", "m/s", "velocity"),
    Channel("ball.ay", "m/s2", "acceleration"),
    Channel("floor.in_contact", "1", "never, in this model", "boolean"),
    Channel("floor.mode", "1", "bounces so far", "integer"),
    Channel("floor.state", "1", "one of two", "integer", Enumeration("FloorState", ("untouched", "touched"))),
)


@dataclass(frozen=True)
class FakeState:
    t: float
    y: float
    v: float
    push: float
    bounces: int

    def to_bytes(self) -> bytes:
        return repr(list(asdict(self).values())).encode()

    @classmethod
    def from_bytes(cls, data: bytes) -> "FakeState":
        t, y, v, push, bounces = (float.fromhex(float(x).hex()) for x in data.decode().strip("[]").split(","))
        return cls(t, y, v, push, int(bounces))


class FakeSimulation:
    """Ball of the model's mass under gravity and the input force `push`; bounces on y = 0."""

    channels = CHANNELS

    def __init__(
        self,
        model: Any,
        method: str = "auto",
        rtol: float = 1e-6,
        atol: float = 1e-9,
        step: float | None = None,
        t0: float = 0.0,
        order: int = 3,
        variant: str = "plain",
        light: bool = False,
        fail_at: float = 1e9,
        nan_at: float = 1e9,
        max_steps: int | None = None,
        **unknown: Any,
    ) -> None:
        if method not in ("auto", "ebdf", "bdf") or unknown:
            raise ModelError(f"unknown method '{method}' or options {sorted(unknown)}; known are auto, bdf, ebdf")
        ball = model.bodies[0]
        self.mass, self.gravity = ball.mass * (0.5 if light else 1.0), -model.gravity[1]
        self.restitution = model.contacts[0].law.restitution
        self.fail_at, self.nan_at, self.order, self.variant = fail_at, nan_at, order, variant
        self.rtol, self.atol, self.step = rtol, atol, step
        self.events: list[Event] = []
        self._state = FakeState(t0, ball.position[1], ball.velocity[1], model.inputs[0].start, 0)

    @property
    def t(self) -> float:
        return self._state.t

    def set_inputs(self, values: dict[str, float]) -> None:
        self._state = replace(self._state, push=values["push"])

    def input_derivatives(self, direction: dict[str, float]) -> np.ndarray:
        slope = np.zeros(len(CHANNELS))
        slope[2] = direction.get("push", 0.0) / self.mass
        return slope

    def close_start(self) -> None:
        pass

    def output_rates(self) -> np.ndarray:
        rates = np.full(len(CHANNELS), np.nan)
        rates[:2] = self._state.v, self._acceleration()
        return rates

    def _acceleration(self) -> float:
        return self._state.push / self.mass - self.gravity

    @property
    def step_size(self) -> float:
        return 1e-3

    @property
    def horizon(self) -> float:
        return self.t

    def next_point(self, t: float) -> float:
        return min(self.t + 0.03, t)

    def advance(self, t: float) -> None:
        while self.advance_to_event(t):
            self.handle_event()

    def advance_to_event(self, t: float) -> bool:
        if t >= self.fail_at:
            raise SimulationError("the outer loop diverged at t = 0.5 s: use smaller steps", t=0.5, loop="outer")
        self.handle_event()
        s, a = self._state, self._acceleration()
        fall = (-s.v - math.sqrt(max(s.v * s.v - 2.0 * a * s.y, 0.0))) / a if a < 0.0 else math.inf
        if s.t + fall <= t:
            speed = s.v + a * fall
            if self.restitution * -speed < 1e-6:
                self._state = replace(s, t=t, y=0.0, v=0.0)
                return False
            self._state = replace(s, t=s.t + fall, y=0.0, v=speed)
            return True
        h = t - s.t
        self._state = replace(s, t=t, y=s.y + s.v * h + 0.5 * a * h * h, v=s.v + a * h)
        return False

    def handle_event(self) -> bool:
        s = self._state
        if s.y == 0.0 and s.v < 0.0:  # an impact is due
            speed = self.restitution * -s.v
            self.events.append(Event(s.t, "impact", "floor", impulse=2.0 * self.mass * speed))
            self._state = replace(s, v=speed, bounces=s.bounces + 1)
        return False

    def values(self) -> np.ndarray:
        s = self._state
        y = math.nan if s.t >= self.nan_at else s.y
        return np.array([y, s.v, self._acceleration(), 0.0, s.bounces, min(s.bounces, 1)])

    def state(self) -> FakeState:
        return self._state

    def restore(self, state: FakeState) -> None:
        self._state = state
        self.events = self.events[: state.bounces] or [Event(0.0, "impact", "floor")] * state.bounces
