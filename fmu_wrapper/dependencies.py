"""Which outputs feel which inputs at once, at the present time: what `ModelStructure` says of dependencies.

A force or torque changes, at held coordinates and velocities, the accelerations of the bodies that constraints tie to
its own (joints, contacts that are constraints), the forces in these constraints, and whether such a contact opens; the
forces of springs, dampers and contact laws wait for the motion. A position or velocity that a driver or a wall follows
is met by the next step: nothing feels it at once, but the start of all that is connected with it does.
"""

from collections.abc import Callable, Iterator

from ..core.contacts.element import ContactElement
from ..core.elements import Element
from ..core.elements.base import BodyElement
from ..core.laws import ForceLaw
from ..core.model.markers import GROUND
from ..core.multibody_model import Model
from .variables import EVENTS, Variable, VariableTable

ACCELERATIONS = ("ax", "ay", "angular_acceleration")
FELT_BY_CONTACT = ("normal_force", "friction_force", "in_contact", "mode")


class Dependencies:
    """What the outputs in `table` depend on, for the FMU of `model`."""

    def __init__(self, model: Model, table: VariableTable) -> None:
        self._model, self._table = model, table
        self._inputs = {v.name: v for v in table.block("input")}
        self._parameters = [v for v in table.of_role("parameter") if v.block != "solver"]
        tied = _groups(model, lambda e: bool(e.constraint_rows) or _is_impact_contact(e))
        connected = _groups(model, lambda e: True)
        self._felt: dict[str, set[str]] = {}
        self._led: dict[str, set[str]] = {}
        for element in model.elements():
            moving = {channel for motion in element.motions() for channel in motion.channels()}
            for channel in {channel for signal in element.signals() for channel in signal.channels()}:
                if channel in moving:
                    self._note_start(_reached(element, connected), channel)
                else:
                    self._note_force(_reached(element, tied), channel)

    def of_output(self, output: Variable) -> list[Variable]:
        """The inputs that `output` feels at once, in the order of their references."""
        return self._named(self._felt.get(output.name, set()))

    def at_start(self, output: Variable) -> list[Variable]:
        """The parameters and inputs that its initial value depends on; solver settings do not change it."""
        if output.name == EVENTS:
            return []
        felt = self._felt.get(output.name, set()) | self._led.get(output.name, set())
        return [*self._parameters, *self._named(felt)]

    def _named(self, channels: set[str]) -> list[Variable]:
        return [v for name, v in self._inputs.items() if name in channels]

    def _note_force(self, reached: set[str], channel: str) -> None:
        """A force on the bodies `reached`: what feels it at once."""
        names = {name for e in self._model.elements() if bodies_of(e) & reached for name in _felt_channels(e)}
        names |= {f"{o.name}.{a}" for o in self._model.outputs if o.marker.body in reached for a in ACCELERATIONS}
        names |= {"residual.acceleration"} | ({EVENTS} if self._model.contacts else set())
        for name in names:
            self._felt.setdefault(name, set()).add(channel)

    def _note_start(self, reached: set[str], channel: str) -> None:
        """A motion that leads the bodies `reached`: what starts elsewhere with it."""
        parts = {e.name for e in self._model.elements() if bodies_of(e) & reached} | {"energy", "residual"}
        parts |= {o.name for o in self._model.outputs if o.marker.body in reached}
        for v in self._table.block("channel"):
            if v.name.partition(".")[0] in parts:
                self._led.setdefault(v.name, set()).add(channel)


def bodies_of(element: Element) -> frozenset[str]:
    """The bodies that an element acts on, a body itself included; without the ground."""
    return element.acts_on() - {GROUND}


def _felt_channels(element: Element) -> Iterator[str]:
    """Names of the channels of an element that feel a force at once."""
    if isinstance(element, BodyElement):
        yield from (f"{element.name}.{c.acceleration}" for c in element.coordinate_records())
    if element.constraint_rows:
        yield from (channel.name for channel in element.multiplier_channels())
    if _is_impact_contact(element):
        yield from (f"{element.name}.{name}" for name in FELT_BY_CONTACT)


def _is_impact_contact(element: Element) -> bool:
    return isinstance(element, ContactElement) and not isinstance(element.law, ForceLaw)


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
