"""Channels of the frame of an interface: the load that it hands on to its body."""

from collections.abc import Sequence
from typing import Any

from ..compiled.jit import internal
from ..model.channels import Channel
from ..model.derived import NOT_KNOWN, Derived, Places
from ..model.frame3d import four_of
from ..model.rotation3d import body_rate, of_body_torque, turned, turning


@internal
def interface_load(row: Any, places: Any, numbers: Any, out: Any) -> None:
    f, p = four_of(row, places, 0, 1.0), four_of(row, places, 4, 1.0)
    moment = row[places[11]], row[places[12]], row[places[13]]
    # of a turn of the frame by d, in its axes, 2 G(p) f changes by G(p) G(f)^T d
    torque = turned(turning(f, body_rate(f, of_body_torque(p, moment))), f)
    for i in range(3):
        out[i], out[3 + i] = row[places[8 + i]], torque[i]


class InterfaceLoad(Derived):
    """Force (N) and torque (N m) on the body at the interface, along the axes of space."""

    kernel = interface_load

    def __init__(self, name: str, own: Sequence[int], body: Sequence[int], rows: Sequence[int]) -> None:
        self._turns, self._rows = (*own, *body), tuple(rows)
        self.channels = tuple(
            Channel(f"{name}.{what}_{axis}", unit, f"{what} at {name} on its body, along {axis} of space")
            for what, unit in (("force", "N"), ("torque", "N.m"))
            for axis in "xyz"
        )
        self.rate_of = (NOT_KNOWN,) * 6

    def places(self, at: Places) -> list[int]:
        return [*at.of(at.q, self._turns), *(at.multipliers + row for row in self._rows[:6])]
