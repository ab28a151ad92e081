"""Contacts between two coordinates as exudyn's own ObjectContactCoordinate."""

import numpy as np

from ...core.contacts.coordinate_contact import CoordinateContact
from ...core.laws import ForceLaw, Hertz, KelvinVoigt
from .contact_laws import contact_parameters
from .formulas import normal_force
from .registry import Build, CoordinateColumns


def add_coordinate_contact(record: CoordinateContact, build: Build) -> bool:
    """Add the contact if exudyn's object can be it: a gap that is a difference of two coordinates (or of one and a
    constant), a force that needs no approach speed and no release of its own, no friction."""
    law, factors = record.law, sorted(term.factor for term in record.terms)
    simple = type(law) is Hertz or (type(law) is KelvinVoigt and (law.release == "gap" or law.damping == 0.0))
    if (
        record.friction is not None
        or not isinstance(law, ForceLaw)
        or not simple
        or factors not in ([-1.0], [1.0], [-1.0, 1.0])
    ):
        return False
    ends, offset = {1.0: build.ground_coordinate(), -1.0: build.ground_coordinate()}, record.offset
    bodies = {b.name: b for b in build.model.bodies}
    start = record.offset
    for term in record.terms:
        ends[term.factor], reference = build.coordinate(term.body, term.coordinate, record.name)
        offset += term.factor * reference
        body = bodies[term.body]
        start += term.factor * body.start_in(bodies)[0][body.coordinate_names.index(term.coordinate)]
    fields = contact_parameters(law, record.name)
    memory = build.add("NodeGenericData", numberOfDataCoordinates=1, initialCoordinates=[start])
    # exudyn's gap is marker 1 - marker 0 - offset
    build.add("ObjectContactCoordinate", markerNumbers=[ends[-1.0], ends[1.0]], nodeNumber=memory, offset=-offset,
              **fields)  # fmt: skip
    if build.sensors:
        build.coordinate_contacts.append(CoordinateColumns(record, normal_force(law)))
        build.notes.append(f"{record.name}: its force is the law's of the recorded gap; exudyn does not give it")
    return True


def coordinate_channels(
    columns: CoordinateColumns, channels: dict[str, np.ndarray], rates: dict[str, str]
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """(gap, gap rate, normal force) from the channels of the coordinates; `rates` names that of a coordinate's rate."""
    record = columns.record
    names = [(f"{term.body}.{term.coordinate}", term.factor) for term in record.terms]
    gap = record.offset + np.sum([factor * channels[name] for name, factor in names], axis=0)
    rate = np.sum([factor * channels[rates[name]] for name, factor in names], axis=0)
    inside = gap < 0.0
    force = np.zeros_like(gap)
    force[inside] = [columns.law(-g, -r, 1.0) for g, r in zip(gap[inside], rate[inside], strict=True)]
    return gap, rate, force
