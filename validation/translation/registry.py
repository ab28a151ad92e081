"""Which function translates which record, and what the functions share while a model is built."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, TypeVar

import numpy as np

from ...core.contact.contact2d import Disk2D, HalfPlane2D
from ...core.description import Model
from ...core.elements import RigidBody2D
from ...core.model.markers import GROUND, Marker2D
from ..errors import NotTranslatable
from ..exudyn_import import Exudyn
from .kinematics import States

Translator = Callable[[Any, "Build"], None]
_TRANSLATORS: dict[type, Translator] = {}
T = TypeVar("T", bound=Translator)


def translates(*records: type) -> Callable[[T], T]:
    """Decorator: the function translates records of these types."""

    def register(function: T) -> T:
        for record in records:
            _TRANSLATORS[record] = function
        return function

    return register


def translate(record: Any, build: "Build") -> None:
    """Add the exudyn equal of `record`. Raises NotTranslatable if there is none."""
    find_translator(record)(record, build)


def find_translator(record: Any) -> Translator:
    """The function that translates `record`. Raises NotTranslatable if there is none."""
    translator = _TRANSLATORS.get(type(record))
    friction = getattr(record, "friction", None)
    if friction is not None:
        raise NotTranslatable(
            f"contact '{record.name}' has friction '{friction.type}', which is not translated to exudyn; leave it out "
            "(friction=None) to compare the rest"
        )
    if translator is None:
        known = sorted(t.__name__ for t in _TRANSLATORS)
        raise NotTranslatable(
            f"'{getattr(record, 'name', record)}' is a {type(record).__name__}, for which no translation to "
            f"exudyn is written; there are translations of {known}"
        )
    return translator


@dataclass(frozen=True)
class BodyItems:
    """What stands for a body in exudyn."""

    node: int
    item: int
    rigid: bool


@dataclass(frozen=True)
class Column:
    """A result channel: component `component` of a sensor, times `factor`, plus `offset`."""

    channel: str
    sensor: int
    component: int
    factor: float = 1.0
    offset: float = 0.0


@dataclass(frozen=True)
class ContactColumns:
    """A contact: its shapes (gap and normal follow from the motion) and the sensor of its force."""

    name: str
    shapes: tuple[HalfPlane2D, Disk2D] | tuple[Disk2D, Disk2D]
    sensor: int
    sign: float
    """+1 if the sensor gives the force on the second shape's body."""


@dataclass
class Build:
    """A model under construction in exudyn."""

    exudyn: Exudyn
    mbs: Any
    model: Model
    sensors: bool
    ground: int
    ground_node: int
    bodies: dict[str, BodyItems] = field(default_factory=dict)
    columns: list[Column] = field(default_factory=list)
    contacts: list[ContactColumns] = field(default_factory=list)
    before_step: list[Callable[[Any, float], None]] = field(default_factory=list)
    """Called at the start of each step with (mbs, t)."""
    notes: list[str] = field(default_factory=list)
    """What a reader of the comparison should know."""

    def add(self, item_name: str, **fields: Any) -> Any:
        """Add an item of exudyn's item interface; returns its index."""
        item = getattr(self.exudyn.items, item_name)(**fields)
        adders = {"Object": "AddObject", "Node": "AddNode", "Load": "AddLoad", "Marker": "AddMarker"}
        adder = next(method for prefix, method in adders.items() if item_name.startswith(prefix))
        return getattr(self.mbs, adder)(item)

    def point(self, marker: Marker2D) -> Any:
        """A position marker."""
        local = [*marker.point, 0.0]
        if marker.body != GROUND and not self.bodies[marker.body].rigid:
            return self.add("MarkerBodyPosition", bodyNumber=self.bodies[marker.body].item, localPosition=local)
        return self.add("MarkerBodyRigid", bodyNumber=self._item(marker.body), localPosition=local)

    def frame(self, marker: Marker2D, user: str) -> Any:
        """A position and orientation marker. Raises NotTranslatable on a point mass, which has none."""
        if marker.body != GROUND and not self.bodies[marker.body].rigid:
            raise NotTranslatable(
                f"'{user}' needs the orientation of '{marker.body}', a point mass: make it a RigidBody2D"
            )
        return self.point(marker)

    def sensor(self, item: Any, output: str, *, of_node: bool = False) -> int:
        """A sensor that stores `output` of an object (or node) at every step; returns its index."""
        kind = "SensorNode" if of_node else "SensorObject"
        target = {"nodeNumber": item} if of_node else {"objectNumber": item}
        output_type = getattr(self.exudyn.core.OutputVariableType, output)
        make = getattr(self.exudyn.items, kind)
        return self.mbs.AddSensor(make(**target, outputVariableType=output_type, storeInternal=True, writeToFile=False))

    def start_angle(self, body: str) -> float:
        """Angle of a body at the start, rad; 0 for the ground and for point masses."""
        return next((b.angle for b in self.model.bodies if b.name == body and isinstance(b, RigidBody2D)), 0.0)

    def _item(self, body: str) -> int:
        return self.ground if body == GROUND else self.bodies[body].item


@dataclass(frozen=True)
class Recording:
    """What a run recorded: the time and the channels."""

    t: np.ndarray
    channels: dict[str, np.ndarray]
    states: States
