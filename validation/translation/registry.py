"""Which function translates which record, and what the functions share while a model is built."""

import weakref
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, TypeVar

import numpy as np

from ...core.contacts.contact2d import Disk2D, HalfPlane2D
from ...core.contacts.coordinate_contact import CoordinateContact
from ...core.model.markers import GROUND, Marker2D
from ...core.multibody_model import Model
from ..errors import NotTranslatable
from ..exudyn_import import Exudyn
from .laid_contacts import Laid

Translator = Callable[[Any, "Build"], None]
_TRANSLATORS: dict[type, Translator] = {}
_OF_HEIRS: dict[type, Translator] = {}
_ROUTES: dict[type, str] = {}
_FREES: set[type] = set()
T = TypeVar("T", bound=Translator)


def translates(*records: type, heirs: bool = False) -> Callable[[T], T]:
    """Decorator: the function translates records of these types; of heirs too, if it says so, of which nothing else is
    known."""

    def register(function: T) -> T:
        (_OF_HEIRS if heirs else _TRANSLATORS).update(dict.fromkeys(records, function))
        return function

    return register


def frees(*records: type) -> None:
    """Say that the translators of these types leave out redundant equations, as `Build.redundant` says."""
    _FREES.update(records)


def can_free(record: Any) -> bool:
    """Whether the translator of `record` leaves out redundant equations."""
    return type(record) in _FREES or (_heir_of(record) in _FREES and not _is_known(record))


def _is_known(record: Any) -> bool:
    return type(record) in _TRANSLATORS or type(record) in _ROUTES


def _heir_of(record: Any) -> type | None:
    return next((base for base in type(record).__mro__ if base in _OF_HEIRS), None)


def no_equal(route: str, *records: type) -> None:
    """Say that exudyn has no equal of records of these types, and the nearest `route` to a comparison."""
    for record in records:
        _ROUTES[record] = route


def translate(record: Any, build: "Build") -> None:
    """Add the exudyn equal of `record`. Raises NotTranslatable if there is none, or a redundant equation stays."""
    translator = find_translator(record)
    if getattr(record, "surface_speed", None) is not None:
        raise NotTranslatable(
            f"contact '{record.name}' has a surface that moves past its body (surface_speed), of which exudyn's "
            "contacts have no equal. The nearest route: a half-plane, half-space or disk on a body that a driver "
            "moves, as long as the shape does not end"
        )
    if getattr(record, "name", None) in build.redundant and not can_free(record):
        rows = ", ".join(str(row) for row in sorted(build.redundant[record.name]))
        raise NotTranslatable(
            f"equation {rows} of '{record.name}' is redundant, and exudyn, whose {type(record).__name__} keeps all of "
            "them, has a singular matrix then. Joints that can leave equations out there are "
            f"{sorted(t.__name__ for t in _FREES & _TRANSLATORS.keys())}, and those in space that are made of points "
            "and axes across each other, such as Revolute3D; make this joint hold less, or put one of those in the loop"
        )
    translator(record, build)


def find_translator(record: Any) -> Translator:
    """The function that translates `record`. Raises NotTranslatable if there is none."""
    translator = _TRANSLATORS.get(type(record))
    if translator is not None:
        return translator
    what = f"'{getattr(record, 'name', record)}' is a {type(record).__name__}"
    if type(record) in _ROUTES:
        raise NotTranslatable(f"{what}, of which exudyn has no equal. The nearest route: {_ROUTES[type(record)]}")
    base = _heir_of(record)
    if base is not None:
        return _OF_HEIRS[base]
    known = sorted(t.__name__ for t in (*_TRANSLATORS, *_OF_HEIRS))
    raise NotTranslatable(f"{what}, for which no translation to exudyn is written; there are translations of {known}")


@dataclass(frozen=True)
class BodyItems:
    """What stands for a body in exudyn."""

    node: int
    item: int
    rigid: bool
    nodes: tuple[int, ...] = ()
    """All nodes of a flexible body, in their order; `coordinates_each` coordinates each."""
    elements: tuple[int, ...] = ()
    coordinates_each: int = 0
    local: tuple[float, float] = (0.0, 0.0)
    """Where a material point lies in its element `item`, m."""
    reference: tuple[float, ...] = ()
    """What exudyn's coordinates are displacements from, node after node."""
    sizes: tuple[int, ...] = ()
    """Coordinates of each node, where they are not `coordinates_each`."""
    order: tuple[int, ...] = ()
    """Where each coordinate of the record stands in `reference`; left out: in its order."""
    mesh_points: tuple[int, ...] = ()
    """Points of the superelement `item` that carry the frame which markers take."""

    @property
    def all_nodes(self) -> tuple[int, ...]:
        return self.nodes or (self.node,)

    def node_slices(self) -> dict[int, slice]:
        """Which part of `reference` belongs to each node."""
        nodes = self.all_nodes
        sizes = self.sizes or (self.coordinates_each or len(self.reference),) * len(nodes)
        ends = np.cumsum(sizes).tolist()
        return {node: slice(end - size, end) for node, size, end in zip(nodes, sizes, ends, strict=True)}

    def place(self, k: int) -> tuple[int, int, float]:
        """(node, place among its coordinates, reference) of the record's coordinate k."""
        at = self.order[k] if self.order else k
        node, part = next((node, part) for node, part in self.node_slices().items() if at < part.stop)
        return node, at - part.start, self.reference[at]


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


@dataclass(frozen=True)
class UserContact:
    """A contact by user function: its sensor records gap, gap rate, normal force and friction force."""

    name: str
    sensor: int
    friction: bool


@dataclass(frozen=True)
class CoordinateColumns:
    """A contact between coordinates, with the force of its law (penetration, its rate, any speed)."""

    record: CoordinateContact
    law: Callable[[float, float, float], float]


@dataclass(frozen=True)
class Derived:
    """A channel that follows from others."""

    channel: str
    function: Callable[[dict[str, np.ndarray]], np.ndarray]


def _reset(container: Any, mbs: Any) -> None:
    """Let exudyn free a system; its `container` is there until then."""
    mbs.Reset()


@dataclass
class Build:
    """A model under construction in exudyn."""

    exudyn: Exudyn
    mbs: Any
    model: Model
    sensors: bool
    ground: int
    ground_node: int
    container: Any
    """exudyn's container of the system, which lives in it."""
    bodies: dict[str, BodyItems] = field(default_factory=dict)
    columns: list[Column] = field(default_factory=list)
    contacts: list[ContactColumns] = field(default_factory=list)
    user_contacts: list[UserContact] = field(default_factory=list)
    coordinate_contacts: list[CoordinateColumns] = field(default_factory=list)
    derived: list[Derived] = field(default_factory=list)
    flexible: bool = False
    """Whether a body is flexible, so that exudyn should keep its Jacobian."""
    laid: Mapping[str, Laid] = field(default_factory=dict)
    """Contacts that start without an approach, and whose law refers to one."""
    clamped: frozenset[str] = frozenset()
    """Contacts whose force exudyn's own objects would let pull where the law does not: user functions."""
    redundant: Mapping[str, frozenset[int]] = field(default_factory=dict)
    """Equations of joints, counted from 0 in each, that others imply and exudyn must not get."""
    sharing: frozenset[str] = frozenset()
    """Joints that repeat each other, and share their loads."""
    before_step: list[Callable[[Any, float], None]] = field(default_factory=list)
    """Called at the start of each step with (mbs, t)."""
    notes: list[str] = field(default_factory=list)
    """What a reader of the comparison should know."""

    def __post_init__(self) -> None:
        # no user function may refer to this object, or it is never freed
        self._freed = weakref.finalize(self, _reset, self.container, self.mbs)
        self._freed.atexit = False

    def release(self) -> None:
        """Let exudyn free the system, as when this object is freed: it keeps items, user functions and what sensors
        have stored, 10 to 200 MB, until it is told to let go of them."""
        self._freed()

    def add(self, item_name: str, **fields: Any) -> Any:
        """Add an item of exudyn's item interface; returns its index."""
        item = getattr(self.exudyn.items, item_name)(**fields)
        adders = {"Object": "AddObject", "Node": "AddNode", "Load": "AddLoad", "Marker": "AddMarker"}
        adder = next(method for prefix, method in adders.items() if item_name.startswith(prefix))
        return getattr(self.mbs, adder)(item)

    def point(self, marker: Marker2D) -> Any:
        """A position marker. Raises NotTranslatable for a point beside a material point, along its axis."""
        if marker.body == GROUND:
            return self.add("MarkerBodyRigid", bodyNumber=self.ground, localPosition=[*marker.point, 0.0])
        body = self.bodies[marker.body]
        if body.elements and marker.point[0] != 0.0:
            raise NotTranslatable(
                f"a marker on '{marker.body}' lies {marker.point[0]:g} m beyond it along the axis, where exudyn's "
                "cable elements have no point: put a MaterialPoint2D there, or a light RigidBody2D on a Clamp2D"
            )
        if body.mesh_points:
            return self.mesh_frame(body, (*marker.point, 0.0), np.eye(3))
        local = [body.local[0] + marker.point[0], body.local[1] + marker.point[1], 0.0]
        kind = "MarkerBodyRigid" if body.rigid else "MarkerBodyPosition"
        return self.add(kind, bodyNumber=body.item, localPosition=local)

    def mesh_frame(self, body: BodyItems, point: Sequence[float], axes: np.ndarray) -> int:
        """A rigid marker on the frame that points of a superelement carry, at `point` (3,) in m, with `axes` (3, 3)."""
        place, points = np.eye(4), list(body.mesh_points)
        place[:3, :3], place[:3, 3] = axes, point
        return int(
            self.add(
                "MarkerSuperElementRigid", bodyNumber=body.item, localHT=place, meshNodeNumbers=points,
                weightingFactors=[1.0 / len(points)] * len(points),
            )
        )  # fmt: skip

    def frame(self, marker: Marker2D, user: str) -> Any:
        """A position and orientation marker. Raises NotTranslatable on a point mass, which has none."""
        if marker.body != GROUND and not self.bodies[marker.body].rigid:
            raise NotTranslatable(
                f"'{user}' needs the orientation of '{marker.body}', a point mass: make it a RigidBody2D"
            )
        return self.point(marker)

    def coordinate(self, body: str, coordinate: str, user: str) -> tuple[Any, float]:
        """(marker of a coordinate, its reference: exudyn's coordinates are displacements from there).

        Raises NotTranslatable if the body has no such coordinate of its own.
        """
        record = next(b for b in self.model.bodies if b.name == body)
        items = self.bodies[body]
        if coordinate not in record.coordinate_names or not items.reference:
            raise NotTranslatable(f"'{user}' takes '{coordinate}' of '{body}', which is no coordinate there")
        node, k, reference = items.place(record.coordinate_names.index(coordinate))
        return self.add("MarkerNodeCoordinate", nodeNumber=node, coordinate=k), reference

    def ground_coordinate(self) -> Any:
        """A coordinate that is always zero."""
        return self.add("MarkerNodeCoordinate", nodeNumber=self.ground_node, coordinate=0)

    def sensor(self, item: Any, output: str, *, of_node: bool = False) -> int:
        """A sensor that stores `output` of an object (or node) at every step; returns its index."""
        kind = "SensorNode" if of_node else "SensorObject"
        target = {"nodeNumber": item} if of_node else {"objectNumber": item}
        output_type = getattr(self.exudyn.core.OutputVariableType, output)
        make = getattr(self.exudyn.items, kind)
        return self.mbs.AddSensor(make(**target, outputVariableType=output_type, storeInternal=True, writeToFile=False))

    def body_sensor(self, item: int, local: tuple[float, float], output: str) -> int:
        """A sensor of `output` at a point of a body; returns its index."""
        output_type = getattr(self.exudyn.core.OutputVariableType, output)
        return self.mbs.AddSensor(
            self.exudyn.items.SensorBody(
                bodyNumber=item, localPosition=[*local, 0.0], outputVariableType=output_type, storeInternal=True,
                writeToFile=False,
            )
        )  # fmt: skip

    def start(self, body: str) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """(x, y, angle), and their rates, of a body with a place at the start; zero for the ground."""
        records = {b.name: b for b in self.model.bodies}
        if body not in records:
            return (0.0,) * 3, (0.0,) * 3
        q, v = records[body].start_in(records)
        return (*q, 0.0)[:3], (*v, 0.0)[:3]

    def start_angle(self, body: str) -> float:
        """Angle of a body at the start, rad; 0 for the ground and for point masses."""
        return self.start(body)[0][2]
