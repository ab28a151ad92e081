"""Numbers of coordinates, signals and work accounts while a model's tables are built."""

from ..contact.friction import FrictionLaw, friction_address
from ..contact.laws import ForceLaw, law_address
from ..elements.base import BodyElement
from ..elements.planar_body import PlanarFrame
from ..model.markers import GROUND
from ..model.motion import InputMotion
from ..model.signals import InputSignal, Signal
from .parts import Parts

GROUND_SLOTS = 3
"""Extended vectors end in the ground's (x, y, angle), which stay zero, and the work accounts."""


class ModelNumbering:
    """Numbers coordinates, rows, signals and work accounts while the elements' tables are built."""

    def __init__(self, model: Parts) -> None:
        self.gravity = model.gravity
        self.length = _length(model)
        self.bodies: dict[str, BodyElement] = {body.name: body for body in model.bodies}
        self.index: dict[str, tuple[int, ...]] = {}
        self.initial_positions: dict[str, tuple[float, float, float]] = {GROUND: (0.0, 0.0, 0.0)}
        self.inputs = {record.name: k for k, record in enumerate(model.inputs)}
        self.input_start = {record.name: record.start for record in model.inputs}
        self.motions: list[InputMotion] = []
        self.pool: list[float] = []
        self.work_names: list[str] = []
        self.contact_numbers = {record.name: k for k, record in enumerate(model.contacts)}
        self.names = {body.name: body.coordinate_names for body in model.bodies}
        n_bodies = sum(len(names) for names in self.names.values())
        self.places: dict[str, dict[str, int]] = {}
        self.internals: dict[str, tuple[int, ...]] = {}
        self.internal_names: list[str] = []
        for element in model.elements():
            states = element.internal_coordinates()
            first = n_bodies + len(self.internal_names)
            self.internals[element.name] = tuple(range(first, first + len(states)))
            self.internal_names += [f"{element.name}.{name}" for name in states]
        self.n = n = n_bodies + len(self.internal_names)
        self.index[GROUND] = (n, n + 1, n + 2)
        start = 0
        for body in model.bodies:
            count = len(self.names[body.name])
            own = tuple(range(start, start + count))
            if isinstance(body, PlanarFrame):
                own += tuple(range(n + count, n + GROUND_SLOTS))
                q0 = body.start_in(self.bodies, self.input_start)[0]
                self.initial_positions[body.name] = (q0[0], q0[1], q0[2] if count > 2 else 0.0)
            self.index[body.name] = own
            start += count

    def coordinates(self, body: str) -> tuple[int, ...]:
        planar = body in self.initial_positions
        return self.index[body][:GROUND_SLOTS] if planar else self.index[body]

    def coordinate(self, body: str, name: str) -> int:
        if body not in self.places:
            self.places[body] = dict(zip(self.names[body], self.index[body], strict=False))
        return self.places[body][name]

    def place(self, body: str) -> tuple[int, int, int]:
        """Indices of a frame's own (x, y, angle); -1 for those that it does not have."""
        x, y, angle = (k if k < self.n else -1 for k in self.coordinates(body))
        return x, y, angle

    def initial(self, body: str) -> tuple[float, float, float]:
        return self.initial_positions[body]

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

    def law_address(self, law: ForceLaw) -> int:
        return law_address(law)

    def friction_address(self, law: FrictionLaw) -> int:
        return friction_address(law)

    def work(self, name: str) -> int:
        if name not in self.work_names:
            self.work_names.append(name)
        return self.n + GROUND_SLOTS + self.work_names.index(name)


def _length(model: Parts) -> float:
    """Size of the mechanism, m: how far its points reach; of one whose points are all at the origin, its longest rod or
    largest disk. 1 if it says none."""
    points = [point for body in model.bodies for point in body.extent()]
    points += [point for e in model.elements() for point in e.reach()]
    size = max((max(abs(x), abs(y)) for x, y in points), default=0.0)
    return size or max((x for e in model.elements() for x in e.lengths()), default=0.0) or 1.0
