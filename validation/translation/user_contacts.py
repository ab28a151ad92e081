"""Contacts whose law or friction exudyn does not have: an ObjectGenericODE2 that shares the bodies' nodes.

It has no mass, only the contact's generalised force F_N grad g + F_T grad s as its user function, so that the bodies
feel equal and opposite forces at the place of contact. The deflection of LuGre's bristles is no coordinate: its law is
linear in it, so that the trapezoidal rule over the step gives it from the state at the step's end.
"""

import math
from collections.abc import Sequence
from operator import add, mul
from typing import Any

import numpy as np

from ...core.laws.friction import LuGreFriction
from .formulas import StickingCoulomb, friction_force, lugre, normal_force, spring_energy
from .laid_contacts import Laid
from .registry import Build, UserContact
from .user_gaps import UserGap, user_gap

Array = np.ndarray
Numbers = Sequence[float]


class Memory:
    """What a contact remembers from step to step: whether it is touching, and the speed with which it came."""

    def __init__(self, least: float, laid: Laid | None = None) -> None:
        self.least, self.touching, self.speed = least, laid is not None, least if laid is None else laid.speed
        self.laid_mass = 0.0 if laid is None else laid.mass
        self.gap, self.rate = 0.0, 0.0
        self.t, self.end = 0.0, 0.0
        self.deflection, self.bending = 0.0, 0.0
        self.slides, self.speed_along = 0.0, 0.0

    def approach(self, gap: float, rate: float) -> float:
        """The speed at gap zero: by the line from the last step's end, outside, to this state inside."""
        if self.touching:
            return self.speed
        share = self.gap / (self.gap - gap) if self.gap > 0.0 else 0.0
        return max(-(self.rate + share * (rate - self.rate)), self.least)

    def after_step(self, gap: float, rate: float) -> None:
        """Called with the state at the end of each step."""
        if gap > 0.0 or (gap == 0.0 and self.laid_mass == 0.0):
            self.touching, self.laid_mass = False, 0.0
        elif gap < 0.0 and not self.touching:
            self.touching, self.speed = True, self.approach(gap, rate)
        self.gap, self.rate = gap, rate


def add_user_contact(record: Any, build: Build, own: "Force | None" = None) -> None:
    """Contact, friction and their recording; `own` in place of the force of a contact in the plane."""
    force = Force(record, user_gap(record, build)) if own is None else own
    if record.name in build.laid:
        force.lay(build.laid[record.name])
        build.notes.append(
            f"{record.name}: it starts without an approach, which exudyn's own law would take for a very small one; "
            "the damping is that of the blow as deep as the contact, with mass and settling speed of our start"
        )
    if record.name in build.clamped:
        build.notes.append(
            f"{record.name}: exudyn's own contact pulls where shapes are drawn apart fast; the law does not"
        )
    gap, kinds = force.gap, build.exudyn.core.OutputVariableType
    build.add(
        "ObjectGenericODE2",
        nodeNumbers=list(gap.nodes),
        forceUserFunction=lambda mbs, t, item, q, v: force(t, list(q), list(v)),
        jacobianUserFunction=lambda mbs, t, item, q, v, by_q, by_v: force.jacobian(t, list(q), list(v), by_q, by_v),
    )

    def state(mbs: Any) -> list[list[float]]:
        found: list[list[float]] = [[], []]
        for values, kind in zip(found, (kinds.Coordinates, kinds.Coordinates_t), strict=True):
            for node in gap.nodes:
                values += np.atleast_1d(mbs.GetNodeOutput(node, kind)).tolist()
        return found

    build.before_step.append(lambda mbs, t: force.before_step(t, *state(mbs)))
    if build.sensors:
        sensor = build.mbs.AddSensor(
            build.exudyn.items.SensorUserFunction(
                sensorNumbers=[],
                sensorUserFunction=lambda mbs, t, sensors, factors, configuration: force.measure(t, *state(mbs)),
                storeInternal=True,
                writeToFile=False,
            )
        )
        build.user_contacts.append(UserContact(record.name, sensor, record.friction is not None))
    what = type(record.law).__name__ + ("" if record.friction is None else f" with {record.friction.type} friction")
    build.notes.append(f"{record.name}: {what} by user function")


class Force:
    """The contact's generalised force as a function of exudyn's coordinates and rates."""

    def __init__(self, record: Any, gap: UserGap) -> None:
        self.gap = gap
        self.law, self.release, self.energy = normal_force(record.law), record.law.release, spring_energy(record.law)
        self.memory = Memory(record.law.least_approach_speed())
        bristle = isinstance(record.friction, LuGreFriction)
        self.bristles = lugre(record.friction) if bristle else None
        self.rubs = record.friction is not None
        self.coulomb = record.friction if isinstance(record.friction, StickingCoulomb) else None
        smooth = record.friction is not None and not bristle and self.coulomb is None
        self.friction = friction_force(record.friction) if smooth else None

    def lay(self, laid: Laid) -> None:
        """Let it press from the start on, without an approach."""
        self.memory = Memory(self.memory.least, laid)

    def normal(self, gap: float, rate: float) -> float:
        """N; positive where it pushes."""
        if gap >= 0.0:
            return 0.0
        speed = self.memory.approach(gap, rate)
        if self.memory.laid_mass > 0.0:
            # m v^2/2 is what the spring holds at this depth
            speed = max(speed, math.sqrt(2.0 * self.energy(-gap) / self.memory.laid_mass))
        force = self.law(-gap, -rate, speed)
        return max(force, 0.0) if self.release == "force" else force

    def tangential(self, t: float, speed: float, normal: float) -> float:
        """N along the sliding direction."""
        if normal <= 0.0:
            return 0.0
        if self.friction is not None:
            return self.friction(speed, normal)
        if self.coulomb is not None:
            return self._stick_or_slip(self.coulomb, t, speed, normal)
        return self._bend(t, speed, normal)[2] if self.bristles is not None else 0.0

    def _bend(self, t: float, speed: float, normal: float) -> tuple[float, float, float]:
        """(deflection, its rate, force) of the bristles at the end of the step from the memory's time to t."""
        law, m = self.bristles or _no_bristles, self.memory
        half = 0.5 * (t - m.t)
        free, _ = law(0.0, speed, normal)
        slope = law(1.0, speed, normal)[0] - free
        z = (m.deflection + half * (m.bending + free)) / (1.0 - half * slope)
        rate, force = law(z, speed, normal)
        return z, rate, force

    def _stick_or_slip(self, law: StickingCoulomb, t: float, speed: float, normal: float) -> float:
        """Spring and damper while the memory says that it sticks, else the kinetic friction."""
        m = self.memory
        if m.slides:
            return -m.slides * law.coefficient * normal
        stretch = m.deflection + 0.5 * (t - m.t) * (m.speed_along + speed)
        return -law.stiffness * stretch - law.damping * speed

    def _change_stick(self, law: StickingCoulomb, t: float, speed: float, normal: float) -> None:
        """Between steps: let go where it holds more than it can, hold where the sliding has turned round."""
        m = self.memory
        if normal <= 0.0:
            m.slides, m.deflection = math.copysign(1.0, speed), 0.0
        elif m.slides:
            if m.slides * speed <= 0.0:
                m.slides, m.deflection = 0.0, 0.0
        else:
            m.deflection += 0.5 * (t - m.t) * (m.speed_along + speed)
            force = -law.stiffness * m.deflection - law.damping * speed
            if abs(force) > law.sticking_coefficient * normal:
                m.slides = -math.copysign(1.0, force)
        m.speed_along = speed

    def parts(self, t: float, q: Numbers, v: Numbers) -> tuple[float, float, float, float, float, Numbers, Numbers]:
        """(gap, rate, F_N, F_T, sliding speed, gradients of gap and sliding)."""
        gap, along, across = self.gap.evaluate(list(map(add, self.gap.reference, q)))
        rate = sum(map(mul, along, v))
        normal, speed, tangential = self.normal(gap, rate), 0.0, 0.0
        if self.rubs:
            speed = sum(map(mul, across, v))
            tangential = self.tangential(t, speed, normal)
        return gap, rate, normal, tangential, speed, along, across

    def __call__(self, t: float, q: Numbers, v: Numbers) -> list[float]:
        _, _, normal, tangential, _, along, across = self.parts(t, q, v)
        if tangential == 0.0:
            return [normal * a for a in along]
        return [normal * a + tangential * b for a, b in zip(along, across, strict=True)]

    def jacobian(self, t: float, q: Numbers, v: Numbers, by_q: float, by_v: float) -> Array:
        """by_q d/dq + by_v d/dv of the force on the left-hand side, the gradients held: for Newton's iteration only."""
        gap, rate, normal, tangential, speed, along, across = self.parts(t, q, v)
        n = len(q)
        if gap >= 0.0:
            return np.zeros((n, n))
        push_along, rub_along = np.array(along), np.array(across)
        small_gap, small_rate = -1e-6 * gap, 1e-6 * (abs(rate) + abs(speed)) + 1e-12
        by_gap = (normal - self.normal(gap - small_gap, rate)) / small_gap if small_gap else 0.0
        by_rate = (self.normal(gap, rate + small_rate) - normal) / small_rate
        push = np.outer(push_along, push_along)
        found = (by_q * by_gap + by_v * by_rate) * push
        if tangential != 0.0:
            by_speed = (self.tangential(t, speed + small_rate, normal) - tangential) / small_rate
            ratio = tangential / normal
            found += by_v * by_speed * np.outer(rub_along, rub_along)
            found += ratio * (by_q * by_gap + by_v * by_rate) * np.outer(rub_along, push_along)
        return -found

    def before_step(self, end: float, q: Numbers, v: Numbers) -> None:
        """Remember the state in which a step to time `end` begins; exudyn gives its end as the time then."""
        m = self.memory
        gap, rate, normal, _, speed, _, _ = self.parts(m.end, q, v)
        if self.bristles is not None:
            m.deflection, m.bending, _ = self._bend(m.end, speed, normal) if normal > 0.0 else (0.0, 0.0, 0.0)
        if self.coulomb is not None:
            self._change_stick(self.coulomb, m.end, speed, normal)
        m.t, m.end = m.end, end
        m.after_step(gap, rate)

    def measure(self, t: float, q: Numbers, v: Numbers) -> list[float]:
        """What the sensor records."""
        return list(self.parts(t, q, v)[:4])


def _no_bristles(z: float, v: float, n: float) -> tuple[float, float]:
    return 0.0, 0.0
