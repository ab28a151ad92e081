"""Reduced bodies of the plane as exudyn's floating frame of reference with modes, on a cloud of points.

exudyn's frame moves in space, so z and two of its three rotations are held: NodeRigidBodyRxyz, whose third angle is
then that of the plane and counts turns. Of a body in the plane only integrals that no turn of u changes count: with
vectors as complex numbers, u = u_x + i u_y, int conj(u) v dm = int u.v dm + i int u x v dm. They are the Gram matrix
of the 2 + n functions (1, u0, S_1 ... S_n), which is Hermitian. So 2 + n points of equal mass, whose values are the
rows of its square root, turned until the first function is 1 in each of them, have the same integrals exactly.

Where modal_mass is more than centrifugal_mass the rest goes into motions of the points across the plane: these have
inertia of their own, and no part in how the plane turns.
"""

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...core.elements import MaterialPoint2D, ReducedBody2D
from ...core.model.markers import Marker2D
from ..errors import NotTranslatable
from .bodies import node_columns
from .reduced import ARM, add_ffrf, add_weight, read_place
from .registry import BodyItems, Build, Column, translates

Array = NDArray[np.float64]
AROUND = ARM * np.concatenate([np.eye(3), -np.eye(3)])
"""m, points around a place, which show how it turns, (6, 3)."""
ROUNDING = 1e-10
"""Of an eigenvalue, in parts of the largest, that may be below zero; matrices are given to nine digits or more."""
ORDER = (0, 1, 5)
"""Where x, y and angle stand among the coordinates of NodeRigidBodyRxyz; the other three are held."""
HELD = (2, 3, 4)


def cloud_in_plane(record: ReducedBody2D) -> tuple[float, Array, Array]:
    """(mass of each point, places (N, 3), mode shapes (n, N, 3)), in kg and m, with the integrals of the body.

    Raises
    ------
    NotTranslatable : for terms of second order, which exudyn's frame does not have, and for integrals that no points
        have: with rotary inertia, say.
    """
    if any((record.geometric_first_moment, record.geometric_inertia, record.geometric_coupling)):
        raise NotTranslatable(
            f"'{record.name}' has integrals of second order (geometric_first_moment, geometric_inertia, "
            "geometric_coupling), and the displacements of exudyn's floating frame are of first order: leave these out "
            "on both sides; for a beam take a Cable2D"
        )
    n = len(record.modal_mass)
    size = n + 2
    zero = np.zeros(n)
    mass = np.array(record.modal_mass)
    moving = mass if record.centrifugal_mass is None else np.array(record.centrifugal_mass)
    gram = np.zeros((size, size), dtype=complex)
    gram[0, 0], gram[0, 1], gram[1, 1] = record.mass, complex(*record.first_moment), record.inertia
    first = np.zeros((2, n)) if record.modal_first_moment is None else np.array(record.modal_first_moment)
    gram[0, 2:] = first[0] + 1j * first[1]
    along = zero if record.modal_inertia is None else np.array(record.modal_inertia)
    across = zero if record.modal_coupling is None else np.array(record.modal_coupling)
    gram[1, 2:] = along + 1j * across
    gram[2:, 2:] = moving + 1j * (np.zeros((n, n)) if record.gyroscopic is None else np.array(record.gyroscopic))
    gram = np.triu(gram) + np.conj(np.triu(gram, 1)).T
    root = _root(gram, record, "no points of mass have its integrals (as with rotary inertia)")
    beside = _root(mass - moving, record, "centrifugal_mass is more than modal_mass").real
    each = record.mass / size
    # a reflection that brings the column of 1 to sqrt(each) in all points, times a phase: such a turn of all changes
    # nothing
    wanted = np.full(size, np.sqrt(each), dtype=complex)
    overlap = np.vdot(wanted, root[:, 0])
    root = root * (np.conj(overlap) / abs(overlap) if abs(overlap) > 0.0 else 1.0)
    reflected = root[:, 0] - wanted
    if (length := np.vdot(reflected, reflected).real) > 0.0:
        root = root - 2.0 * np.outer(reflected, np.conj(reflected) @ root) / length
    functions = root / np.sqrt(each)
    places, shapes = np.zeros((size, 3)), np.zeros((n, size, 3))
    places[:, 0], places[:, 1] = functions[:, 1].real, functions[:, 1].imag
    shapes[:, :, 0], shapes[:, :, 1] = functions[:, 2:].real.T, functions[:, 2:].imag.T
    shapes[:, :n, 2] = beside.T / np.sqrt(each)
    return each, places, shapes


def _root(matrix: NDArray[Any], record: ReducedBody2D, why_not: str) -> NDArray[Any]:
    """R with conj(R).T R = matrix, which is Hermitian. Raises NotTranslatable for a negative eigenvalue."""
    scale = np.sqrt(np.maximum(np.diag(matrix).real, 0.0))
    scale[scale == 0.0] = 1.0
    values, vectors = np.linalg.eigh(matrix / np.outer(scale, scale))
    if values[0] < -ROUNDING * max(values[-1], 1.0):
        raise NotTranslatable(
            f"'{record.name}' cannot be exudyn's floating frame, whose matrices are those of points: {why_not}; the "
            f"lowest eigenvalue of these, scaled to a diagonal of 1, is {values[0]:.3g}"
        )
    return np.sqrt(np.maximum(values, 0.0))[:, None] * np.conj(vectors.T) * scale


def _around(point: Array, shape: Array, rotation: Array) -> tuple[Array, Array]:
    """Places (6, 3) and mode shapes (n, 6, 3) of the points that carry a frame at `point` (2,), which the modes move by
    `shape` (2, n) and turn by `rotation` (n,)."""
    n = len(rotation)
    moves, turns = np.zeros((n, 1, 3)), np.zeros((n, 1, 3))
    moves[:, 0, :2], turns[:, 0, 2] = shape.T, rotation
    return np.array([*point, 0.0]) + AROUND, moves + np.cross(turns, AROUND[None])


@translates(ReducedBody2D)
def reduced_body_in_plane(record: ReducedBody2D, build: Build) -> None:
    """NodeRigidBodyRxyz, of which three coordinates are held, and NodeGenericODE2 with ObjectFFRFreducedOrder."""
    n = len(record.modal_mass)
    each, places, shapes = cloud_in_plane(record)
    frames = [(np.zeros(2), np.zeros((2, n)), np.zeros(n))]  # the frame itself, then its points
    for given in record.points:
        rotation = np.zeros(n) if given.rotation is None else np.array(given.rotation)
        frames.append((np.array(given.point), np.array(given.shape), rotation))
    carried = [_around(*frame) for frame in frames]
    masses = np.concatenate([np.full(len(places), each), np.zeros(len(AROUND) * len(frames))])
    places = np.concatenate([places, *(more for more, _ in carried)])
    shapes = np.concatenate([shapes, *(moved for _, moved in carried)], axis=1)
    q0, v0 = record.initial_state()
    reference, rates = np.zeros(6), np.zeros(6)
    reference[list(ORDER)], rates[list(ORDER)] = q0[:3], v0[:3]
    frame = build.add("NodeRigidBodyRxyz", referenceCoordinates=reference.tolist(), initialVelocities=rates.tolist())
    for k in HELD:
        markers = [build.ground_coordinate(), build.add("MarkerNodeCoordinate", nodeNumber=frame, coordinate=k)]
        build.add("ObjectConnectorCoordinate", markerNumbers=markers)
    modes = build.add(
        "NodeGenericODE2", numberOfODE2Coordinates=n, referenceCoordinates=[0.0] * n,
        initialCoordinates=list(q0[3:]), initialCoordinates_t=list(v0[3:]),
    )  # fmt: skip
    item = add_ffrf(build, (frame, modes), (places, shapes, masses), record.stiffness, record.damping)
    add_weight(build, item, masses)
    build.flexible = True
    build.bodies[record.name] = items = BodyItems(
        frame, item, True, (frame, modes), reference=(*reference.tolist(), *(0.0 for _ in range(n))), sizes=(6, n),
        order=(*ORDER, *range(6, 6 + n)), mesh_points=_points(n, 0),
    )  # fmt: skip
    if build.sensors:
        outputs = ("Coordinates", "Coordinates_t", "Coordinates_tt")
        sensors = {node: [build.sensor(node, output, of_node=True) for output in outputs] for node in (frame, modes)}
        for k, coordinate in enumerate(record.coordinate_records()):
            node, component, offset = items.place(k)
            for level, name in enumerate((coordinate.name, coordinate.rate, coordinate.acceleration)):
                add = offset if level == 0 else 0.0
                build.columns.append(Column(f"{record.name}.{name}", sensors[node][level], component, 1.0, add))


def _points(n: int, number: int) -> tuple[int, ...]:
    """Numbers of the points that carry the frame `number`; the cloud of n + 2 points is before them."""
    first = n + 2 + len(AROUND) * number
    return tuple(range(first, first + len(AROUND)))


def point_of_reduced(record: MaterialPoint2D, build: Build) -> None:
    """NodeRigidBody2D with an ObjectRigidBody2D without mass, welded to the points that carry its frame: an offset of a
    superelement's marker does not turn with the modes in exudyn."""
    if record.body not in build.bodies:
        raise NotTranslatable(f"'{record.name}' stands before its body '{record.body}': list the body first")
    carrier = next(b for b in build.model.bodies if b.name == record.body)
    assert isinstance(carrier, ReducedBody2D)
    number = [given.point for given in carrier.points].index(carrier.material_point(record.point).offset)
    tied = replace(build.bodies[record.body], mesh_points=_points(len(carrier.modal_mass), 1 + number))
    q0, v0 = build.start(record.name)
    node = build.add(
        "NodeRigidBody2D", referenceCoordinates=list(q0), initialCoordinates=[0.0] * 3, initialVelocities=list(v0)
    )
    item = build.add("ObjectRigidBody2D", nodeNumber=node, mass=0.0, inertia=0.0)
    build.bodies[record.name] = BodyItems(node, item, True, reference=q0)
    carried = build.mesh_frame(tied, (0.0, 0.0, 0.0), np.eye(3))
    markers = [carried, build.point(Marker2D(body=record.name))]
    build.add("ObjectJointGeneric", markerNumbers=markers, constrainedAxes=[1, 1, 0, 0, 0, 1])
    node_columns(record, build, (node,), q0)
    read_place(build, carried, record.name, "xy")
