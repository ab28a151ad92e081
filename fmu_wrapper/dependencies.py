"""Which outputs feel which inputs at once, at the present time: what `ModelStructure` says of dependencies.

A force or torque changes, at held coordinates and velocities, the accelerations of the bodies that constraints tie to
its own (joints, contacts that are constraints), the forces in these constraints, and whether such a contact opens; the
forces of springs, dampers and contact laws wait for the motion. What moves a constraint (an input that a driver or a
wall follows) can change all of what it is connected with.
"""

from collections.abc import Callable, Iterator

from ..core.contact.laws import ForceLaw
from ..core.description import Model
from ..core.elements import Element
from ..core.model.markers import GROUND
from ..core.model.signals import InputSignal
from .variables import EVENTS, Variable, VariableTable

FELT_BY_CONTACT = ("normal_force", "friction_force", "in_contact", "mode")


class Dependencies:
    """What the outputs in `table` depend on, for the FMU of `model`."""

    def __init__(self, model: Model, table: VariableTable) -> None:
        self._model, self._table = model, table
        self._inputs = {v.name: v for v in table.block("input")}
        self._parameters = table.block("parameter")
        tied = _groups(model, lambda e: bool(e.constraint_rows) or _is_impact_contact(e))
        connected = _groups(model, lambda e: True)
        self._felt: dict[str, set[str]] = {}
        for element in model.elements():
            moves = bool(element.constraint_rows) or element in model.contacts
            for channel in _inputs_of(element):
                reached = _reached(element, connected if moves else tied)
                for other in model.elements():
                    if bodies_of(other) & reached:
                        self._note(other, channel, everything=moves)
                if moves:
                    for v in table.block("channel"):
                        if v.name.startswith(("energy.", "residual.")):
                            self._felt.setdefault(v.name, set()).add(channel)
                self._felt.setdefault("residual.acceleration", set()).add(channel)
                if model.contacts:
                    self._felt.setdefault(EVENTS, set()).add(channel)

    def of_output(self, output: Variable) -> list[Variable]:
        """The inputs that `output` feels at once, in the order of their references."""
        felt = self._felt.get(output.name, set())
        return [v for name, v in self._inputs.items() if name in felt]

    def at_start(self, output: Variable) -> list[Variable]:
        """The parameters and inputs that its initial value depends on; solver settings do not change it."""
        if output.name == EVENTS:
            return []
        return [*self._parameters, *self.of_output(output)]

    def _note(self, element: Element, channel: str, everything: bool) -> None:
        for name in _all_channels(element, self._table) if everything else _felt_channels(element):
            self._felt.setdefault(name, set()).add(channel)


def bodies_of(element: Element) -> set[str]:
    """The bodies that an element acts on, a body itself included; without the ground."""
    found = {marker.body for marker in element.markers()} | {body for body, _ in element.moved_coordinates()}
    found |= {name for name in (getattr(element, "body", None), getattr(element, "cable", None)) if name}
    if hasattr(element, "coordinate_records"):
        found.add(element.name)
    return found - {GROUND}


def _felt_channels(element: Element) -> Iterator[str]:
    """Names of the channels of an element that feel a force at once."""
    if hasattr(element, "coordinate_records"):
        yield from (f"{element.name}.{c.acceleration}" for c in element.coordinate_records())
    if element.constraint_rows:
        yield from (channel.name for channel in element.multiplier_channels())
    if _is_impact_contact(element):
        yield from (f"{element.name}.{name}" for name in FELT_BY_CONTACT)


def _all_channels(element: Element, table: VariableTable) -> Iterator[str]:
    return (v.name for v in table.block("channel") if v.name.startswith(f"{element.name}."))


def _inputs_of(element: Element) -> list[str]:
    return [s.channel for s in element.signals() if isinstance(s, InputSignal)]


def _is_force_contact(element: Element) -> bool:
    return isinstance(getattr(element, "law", None), ForceLaw)


def _is_impact_contact(element: Element) -> bool:
    return hasattr(element, "law") and not _is_force_contact(element)


def _groups(model: Model, ties: Callable[[Element], bool]) -> list[set[str]]:
    """Sets of bodies that elements for which `ties` holds connect, directly or by others."""
    groups = [{body.name} for body in model.bodies]
    for element in model.elements():
        if ties(element):
            bodies = bodies_of(element)
            met = [g for g in groups if g & bodies]
            groups = [g for g in groups if not g & bodies] + ([set().union(*met)] if met else [])
    return groups


def _reached(element: Element, groups: list[set[str]]) -> set[str]:
    bodies = bodies_of(element)
    return set().union(*(g for g in groups if g & bodies)) if bodies else set()
