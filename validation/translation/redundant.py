"""Redundant equations: what exudyn's joints hold less of.

exudyn keeps every row of a joint, and with one that others imply its matrix is singular. So a joint that owns one
becomes one of exudyn's that leaves that axis free. Which rows these are says the Jacobian at the start of the model, as
in our solver; that the freed axis stays held all the same is seen in the comparison of the motions.
"""

import logging
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ...core.assembly.evaluate import evaluate_residuals, evaluate_tangent
from ...core.elements import Joint3D, Spherical3D
from ...core.elements.dot1_3d import Dot1
from ...core.elements.dot2_3d import AT_POINT, Dot2
from ...core.elements.point3d import Point
from ...core.elements.primitive3d import AXIS
from ...core.elements.spatial_body import start_of_marker
from ...core.errors import TlismniError
from ...core.model.words import an
from ...core.multibody_model import Model
from ...core.simulation.simulation import Simulation
from ..errors import NotTranslatable
from .registry import Build, can_free

log = logging.getLogger(__name__)

DEPENDENT = 1e-6
"""What is left, at the start, of a row of length one that others imply."""
ONE = 1.0 - 1e-9
"""Cosine of directions that are the same."""


@dataclass(frozen=True)
class Place:
    """A row: x_b - x_a along an axis of space."""

    axis: int


@dataclass(frozen=True)
class Along:
    """A row: the way of b along an axis of marker a."""

    axis: int


@dataclass(frozen=True)
class Turn:
    """A row: an axis of marker a is across one of marker b."""

    of_a: int
    of_b: int


HeldRow = Place | Along | Turn


@dataclass(frozen=True)
class Redundancy:
    """Joints of a model that repeat each other.

    Attributes
    ----------
    rows : which equations of which joints, counted from 0 in each, exudyn must not get because others imply them.
    sharing : names of the joints that share their loads.
    """

    rows: Mapping[str, frozenset[int]]
    sharing: frozenset[str]


def drop_shared_loads(build: Build) -> None:
    """Do not read the loads of joints that repeat each other from exudyn, which has less of them: there the rest of
    them carries all, while equally compliant ones share."""
    if not build.sharing:
        return

    def is_shared(channel: str) -> bool:
        joint, _, quantity = channel.rpartition(".")
        return joint in build.sharing and quantity.startswith(("force", "torque", "tension"))

    build.columns = [column for column in build.columns if not is_shared(column.channel)]
    build.derived = [derived for derived in build.derived if not is_shared(derived.channel)]
    build.notes.append(f"{', '.join(sorted(build.sharing))}: these share loads; theirs are not read back from exudyn")


def redundant_rows(model: Model) -> Mapping[str, frozenset[int]]:
    """The `rows` of `redundancy`."""
    return redundancy(model).rows


def redundancy(model: Model) -> Redundancy:
    """What exudyn must not get, and whose loads differ from ours because of it.

    The rows are those that our solver leaves out, as far as exudyn can: it keeps the norms of Euler parameters, and
    joints of some kinds whole. Others that say the same are left out in their place.
    """
    none = Redundancy({}, frozenset())
    if not model.joints:
        return none
    # contacts say nothing of joints, and some have laws that exudyn alone knows
    alone = model.model_copy(update={"contacts": (), "groups": ()})
    try:
        sim = Simulation(alone)
    except TlismniError as error:
        # our own run says what is wrong with the model; exudyn may be run without it
        log.debug("redundant equations of '%s' are not known: %s", model.name, error)
        return none
    if not sim.redundant:
        return none
    said = {found.constraint for found in sim.redundant}.union(*(found.repeats for found in sim.redundant))
    names, records = sim.assembly.row_names, {joint.name: joint for joint in model.joints}
    ours = sim.workspace.dropped
    sim.workspace.drop(frozenset())
    evaluate_residuals(sim.workspace.record)
    evaluate_tangent(sim.workspace.record, 0.0, 0.0)
    at, cols, values = sim.workspace.jacobian()
    active = sim.workspace.structure.active
    matrix = np.zeros((len(active), sim.assembly.n))
    matrix[at, cols] = values * sim.assembly.coordinate_scale[cols]
    joints = [k for k, row in enumerate(active) if row < sim.assembly.m_joints]

    def preference(row: int) -> int:
        record = records.get(names[row])
        if record is None or not leaves_out(record, row - names.index(names[row]), model):
            return 0
        return 2 if row in ours else 1

    preferences = np.array([preference(int(active[k])) for k in joints])
    found: dict[str, frozenset[int]] = {}
    for k in _dependent(matrix[joints], preferences):
        row = int(active[joints[k]])
        found[names[row]] = found.get(names[row], frozenset()) | {row - names.index(names[row])}
    # bodies are among them, by the norms of their Euler parameters
    return Redundancy(found, frozenset(said & records.keys()))


def _dependent(matrix: np.ndarray, preferences: np.ndarray) -> list[int]:
    """Rows of a matrix that others imply; of those with the least preference as few as can be."""
    size = np.linalg.norm(matrix, axis=1)
    left = matrix / np.where(size > 0.0, size, 1.0)[:, None]
    open_rows = np.ones(len(left), dtype=bool)
    for preference in range(3):
        while True:
            candidates = np.flatnonzero(open_rows & (preferences == preference))
            lengths = np.linalg.norm(left[candidates], axis=1)
            if not len(candidates) or lengths.max() < DEPENDENT:
                break
            best = candidates[int(np.argmax(lengths))]
            direction = left[best] / np.linalg.norm(left[best])
            left = left - np.outer(left @ direction, direction)
            open_rows[best] = False
    return [int(k) for k in np.flatnonzero(open_rows)]


def leaves_out(record: object, row: int, model: Model) -> bool:
    """Whether exudyn's equal of a joint can do without this one of its equations."""
    if not can_free(record):
        return False
    if isinstance(record, Spherical3D) or not isinstance(record, Joint3D):
        return True  # along the axes of space, or of the plane, as ours
    held = rows_of(record)[row]
    return not isinstance(held, Place) or _axis_of_a(record, held, model) is not None


def rows_of(record: Joint3D) -> Sequence[HeldRow]:
    """The equations of a joint in their order. Raises NotTranslatable for primitives that exudyn does not hold."""
    rows: list[HeldRow] = []
    what = "" if type(record).parts is Joint3D.parts else "equations of its own"
    for primitive in record.primitives():
        if isinstance(primitive, Point):
            rows += [Place(k) for k in range(3)]
        elif isinstance(primitive, Dot2) and primitive.distance == AT_POINT:
            rows.append(Along(AXIS[primitive.axis]))
        elif isinstance(primitive, Dot1) and primitive.value == 0.0 and primitive.axis_a != primitive.axis_b:
            rows.append(Turn(AXIS[primitive.axis_a], AXIS[primitive.axis_b]))
        else:
            what = an(type(primitive).__name__)
    turns = [row for row in rows if isinstance(row, Turn)]
    if len({frozenset((turn.of_a, turn.of_b)) for turn in turns}) < len(turns):
        what = "two turns about one axis"
    elif len(turns) == 2 and turns[0].of_a != turns[1].of_a:
        what = "axes across each other in two pairs"
    if what:
        raise NotTranslatable(
            f"'{record.name}' is {an(type(record).__name__)} and holds {what}, of which exudyn's generic joint has no "
            "axis; where another joint repeats it, let a hinge (Revolute3D) own the redundant equation, last in the "
            "loop"
        )
    return rows


def held_axes(record: Joint3D, left_out: frozenset[int], model: Model) -> tuple[list[int], np.ndarray]:
    """Axes that exudyn's generic joint holds, three ways and three turns, and the axes (3, 3) of its frames in those of
    the markers, as columns, for a joint without the equations `left_out`.

    Raises
    ------
    NotTranslatable : if an equation left out is along no axis of exudyn's joint.
    """
    rows = rows_of(record)
    turns = [row for row in rows if isinstance(row, Turn)]
    kept = [row for k, row in enumerate(rows) if k not in left_out]
    ways = [0, 0, 0]
    for row in kept:
        if isinstance(row, Along):
            ways[row.axis] = 1
    if any(isinstance(row, Place) for row in rows):
        ways = [1, 1, 1]
        for k, row in enumerate(rows):
            if k in left_out and isinstance(row, Place):
                axis = _axis_of_a(record, row, model)
                if axis is None:
                    raise NotTranslatable(
                        f"'{record.name}' has a redundant equation along {'xyz'[row.axis]} of space, along which no "
                        "axis of its marker a is: exudyn's joint frees axes of that marker. Turn the `attitude` of the "
                        "markers, or of the mechanism, along the axes of space"
                    )
                ways[axis] = 0
    held = [row for row in kept if isinstance(row, Turn)]
    if len(held) == 1 and len(turns) < 3:
        # its other turns are free, so that it has to be this very equation: exudyn's holds y of a across z of b
        order = _frame(held[0])
        return [*(ways[int(np.argmax(np.abs(column)))] for column in order.T), 1, 0, 0], order
    # small turns about the axis across both
    about = [0, 0, 0]
    for turn in held:
        about[3 - turn.of_a - turn.of_b] = 1
    return [*ways, *about], np.eye(3)


def _axis_of_a(record: Joint3D, row: Place, model: Model) -> int | None:
    """The axis of marker a along this axis of space at the start; None if there is none."""
    _, axes = start_of_marker(record.a, {body.name: body for body in model.bodies})
    along = np.flatnonzero(np.abs(axes[row.axis]) > ONE)
    return int(along[0]) if len(along) else None


def _frame(turn: Turn) -> np.ndarray:
    """Right-handed axes of which y is the turn's axis of a and z that of b."""
    y, z = np.eye(3)[turn.of_a], np.eye(3)[turn.of_b]
    return np.stack([np.cross(y, z), y, z], axis=1)
