"""The angle between two markers in space at the start, whole turns included.

Axes tell it but for whole turns. These are said, in this order, by `start_angle` of a joint, stop or spring, or by the
value of a driver, between the same two bodies about the same axis; by the angles of attitudes, where their turns about
that axis add up to it; else there are none: the angle is between -pi and pi.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..compiled.jit import interpreted
from ..errors import ModelError
from ..model.attitude import rotation_matrix
from ..model.markers import GROUND, Marker3D
from ..model.said_angle import SaidAngle
from ..model.signals import InputSignal, Signal, evaluate_signal
from ..rounding import NEARLY_PARALLEL
from .base import NO_INPUTS, BodyElement
from .spatial_body import angle_between, start_of_marker

WHOLE_TURN = 2.0 * math.pi
FITS = 1e-2
"""rad; how far a said angle may be from that of the attitudes, but for whole turns: both are rounded by who writes
them."""
SAME = 1e-6
"""rad; how well the turns of attitudes must add up to be taken."""


def value_at_start(signal: Signal, inputs: Mapping[str, float], t: float) -> float:
    """A time function at time t, with these start values of the inputs."""
    if isinstance(signal, InputSignal):
        return signal.gain * inputs[signal.channel]
    return float(interpreted(evaluate_signal)(np.array(signal.pool({})), np.zeros(0), 0, t)[0])


def check_start_angle(
    name: str, a: Marker3D, b: Marker3D, said: float | None, bodies: Mapping[str, BodyElement]
) -> None:
    """Raise ValueError if the attitudes do not put the markers at the angle that the element `name` says."""
    if said is None or not all(marker.body == GROUND or marker.body in bodies for marker in (a, b)):
        return  # the model says which name is unknown
    found = angle_between(a, b, bodies)
    off = math.remainder(said - found, WHOLE_TURN)
    if abs(off) > FITS:
        raise ValueError(
            f"'{name}' has start_angle = {said:g} rad, but the attitudes put the x axis of marker b at {found:.6g} rad "
            f"about the z axis of marker a, or whole turns from there, {abs(off):.3g} rad away: say "
            f"{said - off:.6g}, or turn a body or a marker"
        )


def start_angle(
    a: Marker3D, b: Marker3D, bodies: Mapping[str, BodyElement], said: Sequence[SaidAngle], user: str | None = None
) -> float:
    """The angle of marker b about the z axis of marker a at the start, rad.

    Raises
    ------
    ModelError : if two elements say angles whole turns apart; and for an element `user` that acts on the angle, if
        attitudes have turns beyond half a turn about the axis that do not say which angle is meant.
    """
    found, by_words = angle_between(a, b, bodies), _said(a, b, bodies, said)
    if by_words is not None:
        return by_words
    turned = _turned(a, b, bodies)
    total = math.fsum(turned)
    if abs(math.remainder(total - found, WHOLE_TURN)) <= SAME:
        return _nearest(found, total)
    if user is not None and any(abs(angle) > math.pi for angle in turned):
        near = round(found, 9) + 0.0
        raise ModelError(
            f"'{user}' counts whole turns, and an attitude has more than half a turn about its axis, but the markers "
            f"stand at {near:.6g} rad or whole turns from there, so nobody knows which is meant: say it by "
            f"`start_angle`, {near:.6g} or {near + WHOLE_TURN:.6g} or so, of '{user}' or of the joint about that axis"
        )
    return found


def start_angle_elsewhere(
    a: Marker3D, b: Marker3D, bodies: Mapping[str, BodyElement], said: Sequence[SaidAngle], usual: float
) -> float:
    """The same where bodies start elsewhere than the model says: as start values say it, else the one nearest to that
    of the model. Raises ModelError as that does."""
    by_words = _said(a, b, bodies, said)
    return _nearest(angle_between(a, b, bodies), usual) if by_words is None else by_words


class Elsewhere(BodyElement):
    """A body for the question where its markers are, with other coordinates at the start than its own."""

    q: tuple[float, ...]

    def start_in(
        self, bodies: Mapping[str, BodyElement], inputs: Mapping[str, float] = NO_INPUTS
    ) -> tuple[tuple[float, ...], tuple[float, ...]]:
        return self.q, ()


@dataclass(frozen=True)
class DriverTurn:
    """An angle at the start whose whole turns a driver says: of those that differ from `angle` by whole turns the one
    nearest to sign (signal + more - less)."""

    angle: float
    seen: "Seen"
    signal: Signal

    def numbers(self) -> list[float]:
        """The same as numbers, the signal last."""
        return [self.angle, *self.seen, *map(float, self.signal.pool({}))]


def driver_turn(
    a: Marker3D, b: Marker3D, bodies: Mapping[str, BodyElement], said: Sequence[SaidAngle]
) -> DriverTurn | None:
    """How the angle of marker b about the z axis of marker a follows from a driver; None if none decides it."""
    heard = [(one, seen) for one in said if (seen := _seen(a, b, one, bodies)) is not None]
    if not heard or any(one.firm for one, _ in heard):
        return None
    one, seen = heard[0]
    return None if one.signal is None else DriverTurn(angle_between(a, b, bodies), seen, one.signal)


def _said(a: Marker3D, b: Marker3D, bodies: Mapping[str, BodyElement], said: Sequence[SaidAngle]) -> float | None:
    found = angle_between(a, b, bodies)
    heard = [(one, seen.of(one.angle)) for one in said if (seen := _seen(a, b, one, bodies)) is not None]
    meant = [(_nearest(found, angle), one.by) for one, angle in heard if one.firm]
    if not meant:
        return next((_nearest(found, angle) for _, angle in heard), None)
    value, by = meant[0]
    for other, who in meant[1:]:
        if abs(other - value) > math.pi:
            raise ModelError(
                f"{by} says that '{b.body}' starts {value:.6g} rad about the axis from '{a.body}', {who} that it "
                f"starts at {other:.6g} rad: let both say the same whole turns, or one nothing"
            )
    return value


def _nearest(angle: float, to: float) -> float:
    """Of the angles that differ from `angle` by whole turns, the nearest."""
    return angle + WHOLE_TURN * round((to - angle) / WHOLE_TURN)


class Seen(NamedTuple):
    """How an angle follows from a said one."""

    sign: float
    more: float
    less: float

    def of(self, said: float) -> float:
        """The angle, rad."""
        return self.sign * (said + self.more - self.less)


def _seen(a: Marker3D, b: Marker3D, said: SaidAngle, bodies: Mapping[str, BodyElement]) -> Seen | None:
    """How the angle of b about a follows from a said one, if that is of the same bodies about the same axis."""
    if {a.body, b.body} != {said.a.body, said.b.body}:
        return None
    axes = {m: start_of_marker(m, bodies)[1] for m in (a, b, said.a, said.b)}
    axis, own = axes[said.a][:, 2], axes[a][:, 2]
    if float(np.linalg.norm(np.cross(axis, own))) > SAME:
        return None

    def offset(first: Marker3D, second: Marker3D) -> float:
        """Angle about the axis between the x axes of two markers of one body."""
        x, y = axes[first][:, 0], axes[second][:, 0]
        return math.atan2(axis @ np.cross(x, y), x @ y - (axis @ x) * (axis @ y))

    sign = 1.0 if axis @ own > 0.0 else -1.0
    if a.body == said.a.body:
        return Seen(sign, offset(said.b, b), offset(said.a, a))
    return Seen(-sign, offset(said.b, a), offset(said.a, b))


def _turned(a: Marker3D, b: Marker3D, bodies: Mapping[str, BodyElement]) -> list[float]:
    """Those turns of the attitudes of both bodies and markers that are about the axis, rad."""
    axis = start_of_marker(a, bodies)[1][:, 2]
    found = []
    for sign, marker in ((-1.0, a), (1.0, b)):
        body: Any = None if marker.body == GROUND else getattr(bodies[marker.body], "attitude", None)
        frame: NDArray[np.float64] = np.eye(3)
        for attitude in (body, marker.attitude):
            if attitude is None:
                continue
            for direction, angle in attitude.turns():
                cosine = float(axis @ (frame @ np.array(direction)))
                if abs(angle) > 0.0 and abs(cosine) > 1.0 - NEARLY_PARALLEL:
                    found.append(sign * math.copysign(angle, angle * cosine))
            frame = frame @ rotation_matrix(attitude.parameters())
    return found
