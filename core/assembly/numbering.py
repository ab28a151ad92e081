"""Numbers of coordinates, signals and work accounts while a model's tables are built."""

from collections.abc import Mapping, Sequence
from types import MappingProxyType

from ..elements.base import BodyElement, JointElement
from ..laws import ForceLaw, law_address
from ..laws.friction import FrictionLaw, friction_address
from ..model.base import Vector3, in_space
from ..model.markers import GROUND, Marker, Marker2D, Marker3D
from ..model.motion import InputMotion
from ..model.said_angle import CountsTurns, SaidAngle, SaysAngle
from ..model.signals import InputSignal, Signal
from ..rounding import AT_ORIGIN
from .parts import Parts, TabulatedElements
from .start_turns import Watched

NO_START: Mapping[str, float] = MappingProxyType({})
AT_REST = 1
"""Extended vectors end in one place that stays zero, for what does not move, and the work accounts."""


class ModelNumbering:
    """Numbers coordinates, rows, signals and work accounts while the elements' tables are built."""

    def __init__(self, model: Parts, start: Mapping[str, float] = NO_START, t0: float = 0.0) -> None:
        self.tabulated = TabulatedElements(model)
        self.gravity: Vector3 = in_space(model.gravity)
        self.length = _length(model)
        self.bodies: dict[str, BodyElement] = {body.name: body for body in model.bodies}
        self.joints = {e.name: e for e in self.tabulated.all if isinstance(e, JointElement)}
        self.index: dict[str, tuple[int, ...]] = {}
        self.starts: dict[str, tuple[float, ...]] = {GROUND: ()}
        self.inputs = {record.name: k for k, record in enumerate(model.inputs)}
        self.input_start = {record.name: record.start for record in model.inputs}
        self.motions: list[InputMotion] = []
        self.rows: dict[str, Sequence[int]] = {}
        self.pool: list[float] = []
        self.work_numbers: dict[str, int] = {}
        self.work_sizes: dict[str, float] = {}
        self.contact_numbers = {record.name: k for k, record in enumerate(self.tabulated.contacts)}
        self.names = {body.name: body.coordinate_names for body in model.bodies}
        n_bodies = sum(len(names) for names in self.names.values())
        self.places: dict[str, dict[str, int]] = {}
        self.internals: dict[str, tuple[int, ...]] = {}
        self.internal_names: list[str] = []
        for element in self.tabulated.all:
            states = element.internal_coordinates()
            first = n_bodies + len(self.internal_names)
            self.internals[element.name] = tuple(range(first, first + len(states)))
            self.internal_names += [f"{element.name}.{name}" for name in states]
        self.n = n_bodies + len(self.internal_names)
        self.index[GROUND] = ()
        at = 0
        for body in model.bodies:
            count = len(self.names[body.name])
            self.index[body.name] = tuple(range(at, at + count))
            if body.carries is not None:
                self.starts[body.name] = tuple(body.start_in(self.bodies, self.input_start)[0])
            at += count
        self._elements, self._start_values, self._asked = model.elements, start, False
        self._t0 = t0
        self._watch = model if isinstance(model, Watched) else None
        self._said: list[SaidAngle] = []
        self._said_now: list[SaidAngle] = []
        self._moved: dict[str, BodyElement] = {}

    def coordinates(self, body: str) -> tuple[int, ...]:
        carried = self._carried(body)
        return self.index[body] if carried is None else self._frame(body, carried)

    def frame(self, marker: Marker) -> tuple[int, ...]:
        return self._frame(marker.body, type(marker))

    def own_frame(self, marker: Marker) -> tuple[int, ...]:
        return tuple(k if k < self.n else -1 for k in self.frame(marker))

    def at_rest(self, marker: Marker) -> tuple[float, ...]:
        own = len(self.index[marker.body])
        return (0.0,) * min(own, len(marker.rest)) + marker.rest[own:]

    def _frame(self, body: str, marker: type[Marker]) -> tuple[int, ...]:
        """The body's coordinates as far as markers need them, and the place at rest for those that it lacks."""
        most = len(marker.rest)
        own = self.index[body][:most]
        return own + (self.n,) * (most - len(own))

    def _carried(self, body: str) -> type[Marker] | None:
        """The markers that a body carries; elements that ask for the ground by its name are planar ones."""
        return Marker2D if body == GROUND else self.bodies[body].carries

    def coordinate(self, body: str, name: str) -> int:
        if body not in self.places:
            self.places[body] = dict(zip(self.names[body], self.index[body], strict=False))
        return self.places[body][name]

    def initial(self, body: str) -> tuple[float, ...]:
        carried = self._carried(body)
        assert carried is not None  # the model has checked that its markers are on bodies that carry such
        return self._start(body, carried)

    def start(self, marker: Marker) -> tuple[float, ...]:
        return self._start(marker.body, type(marker))

    def _start(self, body: str, marker: type[Marker]) -> tuple[float, ...]:
        own = self.starts[body][: len(marker.rest)]
        return own + marker.rest[len(own) :]

    def start_angle(self, a: Marker3D, b: Marker3D, user: str | None = None) -> float:
        # models of the plane never ask
        from ..elements.start_angle3d import driver_turn, start_angle, start_angle_elsewhere

        if not self._asked:
            self._ask()
        usual = start_angle(a, b, self.bodies, self._said, user)
        if self._watch is not None:
            return self._watch.seen(usual, driver_turn(a, b, self.bodies, self._said))
        return start_angle_elsewhere(a, b, self._moved, self._said_now, usual) if self._start_values else usual

    def _ask(self) -> None:
        """What elements say of angles at the start, and start values of them."""
        from ..elements.start_angle3d import Elsewhere

        self._asked, values = True, self._start_values
        for element in self._elements():
            if isinstance(element, SaysAngle):
                self._said += element.said_angles(self.input_start, self._t0)
            if values and isinstance(element, CountsTurns):
                counted = (angle for angle in element.counted_angles() if angle.name in values)
                self._said_now += [SaidAngle(c.a, c.b, values[c.name], f"start value '{c.name}'") for c in counted]
        if values:
            for name, q in self.starts.items():
                if name != GROUND:
                    now = [values.get(f"{name}.{c}", x) for c, x in zip(self.names[name], q, strict=True)]
                    self._moved[name] = Elsewhere(name=name, q=tuple(now))

    def signal(self, signal: Signal) -> int:
        offset = len(self.pool)
        self.pool.extend(float(x) for x in signal.pool(self.inputs))
        return offset

    def motion(self, signal: Signal) -> int:
        if not isinstance(signal, InputSignal):
            return self.signal(signal)
        offset = len(self.pool)
        found = InputMotion.of(signal, self.inputs, len(self.motions))
        self.motions.append(found)
        self.pool.extend(found.pool())
        return offset

    def internal(self, name: str) -> tuple[int, ...]:
        return self.internals[name]

    def contact(self, name: str) -> int:
        return self.contact_numbers[name]

    def constraint_rows(self, name: str) -> Sequence[int]:
        return self.rows[name]

    def law_address(self, law: ForceLaw) -> int:
        return law_address(law)

    def friction_address(self, law: FrictionLaw) -> int:
        return friction_address(law)

    def work(self, name: str, size: float | None = None) -> int:
        if size is not None:
            self.work_sizes[name] = size
        return self.n + AT_REST + self.work_numbers.setdefault(name, len(self.work_numbers))


def _length(model: Parts) -> float:
    """Size of the mechanism, m: how far its points reach; of one whose points are all at the origin, its longest rod or
    largest disk. 1 if it says none."""
    points = [point for body in model.bodies for point in body.extent()]
    points += [point for e in model.elements() for point in e.reach()]
    size = max((abs(x) for point in points for x in point), default=0.0)
    longest = max((x for e in model.elements() for x in e.lengths()), default=0.0)
    return (size if size > AT_ORIGIN * longest else longest) or 1.0
