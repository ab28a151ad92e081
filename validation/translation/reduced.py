"""Reduced bodies in space as exudyn's floating frame of reference with modes, on a cloud of points.

exudyn makes its matrices of a mesh: places of nodes, their mass, mode shapes. A ReducedBody3D has the integrals alone,
and these are all that counts: they are the Gram matrix over the mass of (1, u0, S_1 ... S_n), of 4 + 3 n functions. So
4 + 3 n points of equal mass, whose values are the rows of its square root, turned until the first function is 1 in each
of them, have the same integrals exactly. Points without mass carry the interfaces.
"""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...core.elements import InterfaceFrame3D, ReducedBody3D
from ...core.elements.reduced_body3d import Interface3D
from ...core.model.base import in_space
from ..errors import NotTranslatable
from .bodies import node_columns
from .registry import BodyItems, Build, Column, translates

Array = NDArray[np.float64]
ARM = 0.1
"""m, of the points around that of an interface, which show how it turns: small turns do not depend on it."""
AROUND = ARM * np.concatenate([np.eye(3), -np.eye(3)])


def cloud_of(record: ReducedBody3D) -> tuple[float, Array, Array]:
    """(mass of each point, places (N, 3), mode shapes (n, N, 3)) with the integrals of the body."""
    n = len(record.stiffness)
    size = 4 + 3 * n
    gram = np.empty((size, size))
    gram[0, 0], gram[0, 1:4], gram[1:4, 1:4] = record.mass, record.first_moment, record.second_moment
    gram[0, 4:] = np.array(record.modal_first_moment).ravel()
    gram[1:4, 4:] = np.array(record.modal_moment).transpose(1, 0, 2).reshape(3, 3 * n)
    gram[4:, 4:] = np.array(record.modal_second_moment).transpose(0, 2, 1, 3).reshape(3 * n, 3 * n)
    gram = np.triu(gram) + np.triu(gram, 1).T
    values, vectors = np.linalg.eigh(gram)
    root = np.sqrt(np.maximum(values, 0.0))[:, None] * vectors.T  # root.T root = gram
    each = record.mass / size
    # a reflection that brings the column of 1 to sqrt(each) in all points
    wanted = np.full(size, np.sqrt(each))
    across = root[:, 0] - wanted
    if across @ across > 0.0:
        root -= 2.0 * np.outer(across, across @ root) / (across @ across)
    functions = root / np.sqrt(each)
    return each, functions[:, 1:4], functions[:, 4:].reshape(size, n, 3).transpose(1, 0, 2)


def _around(place: Interface3D, n: int) -> tuple[Array, Array]:
    """Places (6, 3) and mode shapes (n, 6, 3) of the points of an interface."""
    turns = np.zeros((n, 3)) if place.rotation is None else np.array(place.rotation)
    shapes = np.array(place.shape)[:, None, :] + np.cross(turns[:, None, :], AROUND[None])
    return np.array(place.point) + AROUND, shapes


@translates(ReducedBody3D)
def reduced_body(record: ReducedBody3D, build: Build) -> None:
    """NodeRigidBodyEP and NodeGenericODE2 with ObjectFFRFreducedOrder."""
    n = len(record.stiffness)
    each, places, shapes = cloud_of(record)
    masses = np.full(len(places), each)
    for place in record.interfaces:
        more, moved = _around(place, n)
        places, shapes = np.concatenate([places, more]), np.concatenate([shapes, moved], axis=1)
        masses = np.concatenate([masses, np.zeros(len(more))])
    q0, v0 = record.initial_state()
    frame = build.add("NodeRigidBodyEP", referenceCoordinates=list(q0[:7]), initialVelocities=list(v0[:7]))
    modes = build.add(
        "NodeGenericODE2", numberOfODE2Coordinates=n, referenceCoordinates=[0.0] * n,
        initialCoordinates=list(q0[7:]), initialCoordinates_t=list(v0[7:]),
    )  # fmt: skip
    item = add_ffrf(build, (frame, modes), (places, shapes, masses), record.stiffness, record.damping)
    reference = (*q0[:7], *(0.0 for _ in range(n)))
    build.bodies[record.name] = BodyItems(frame, item, False)
    build.flexible = True
    add_weight(build, item, masses)
    if build.sensors:
        outputs = ("Coordinates", "Coordinates_t", "Coordinates_tt")
        sensors = [[build.sensor(node, output, of_node=True) for output in outputs] for node in (frame, modes)]
        for k, coordinate in enumerate(record.coordinate_records()):
            node, component = (0, k) if k < 7 else (1, k - 7)
            for level, name in enumerate((coordinate.name, coordinate.rate, coordinate.acceleration)):
                offset = reference[k] if level == 0 else 0.0
                build.columns.append(Column(f"{record.name}.{name}", sensors[node][level], component, 1.0, offset))


def add_ffrf(
    build: Build,
    nodes: tuple[int, int],
    cloud: tuple[Array, Array, Array],
    stiffness: Sequence[Sequence[float]],
    damping: Sequence[Sequence[float]] | None,
) -> int:
    """ObjectFFRFreducedOrder on the nodes (of the frame, of the n amplitudes); returns its index.

    `cloud`: places (N, 3) in m, mode shapes (n, N, 3) and masses (N,) in kg of its points. `stiffness`, `damping`: of
    the amplitudes, (n, n).
    """
    from exudyn.FEM import ObjectFFRFreducedOrderInterface

    places, shapes, masses = cloud
    ffrf = ObjectFFRFreducedOrderInterface(_Mesh(places, shapes.reshape(len(shapes), -1).T, np.repeat(masses, 3)))
    matrices = {"massMatrixReduced": ffrf.massMatrixReduced, "stiffnessMatrixReduced": np.array(stiffness)}
    if damping is not None:
        matrices["dampingMatrixReduced"] = np.array(damping)
    integrals = (
        "mPsiTildePsi",
        "mPsiTildePsiTilde",
        "mPhitTPsi",
        "mPhitTPsiTilde",
        "mXRefTildePsi",
        "mXRefTildePsiTilde",
    )
    return int(
        build.add(
            "ObjectFFRFreducedOrder", nodeNumbers=list(nodes), modeBasis=ffrf.modeBasis, referencePositions=ffrf.xRef,
            mass=ffrf.totalMass, inertia=ffrf.inertiaLocal, centerOfMass=ffrf.chiU, computeFFRFterms=True,
            **{name: _container(matrix, build) for name, matrix in matrices.items()},
            **{name: getattr(ffrf, name) for name in integrals},
        )
    )  # fmt: skip


def add_weight(build: Build, item: int, masses: Array) -> None:
    """The weight of each point of the cloud that has mass (N,), kg."""
    gravity = np.array(in_space(build.model.gravity))
    for k in np.flatnonzero(masses).tolist() if gravity.any() else ():
        # not LoadMassProportional, whose torque is that of the undeformed body
        marker = build.add("MarkerSuperElementPosition", bodyNumber=item, meshNodeNumbers=[k], weightingFactors=[1.0])
        build.add("LoadForceVector", markerNumber=marker, loadVector=(masses[k] * gravity).tolist())


class _Mesh:
    """What exudyn asks of a finite element model."""

    def __init__(self, places: Array, modes: Array, masses: Array) -> None:
        self.places, self.masses = places, masses
        self.modeBasis: dict[str, Any] = {"matrix": modes}
        self.postProcessingModes: dict[str, Any] = {}

    def GetNodePositionsAsArray(self) -> Array:
        return self.places

    def GetSurfaceTriangles(self) -> list[Any]:
        return []

    def GetSurfaceTriangles6(self) -> list[Any]:
        return []

    def GetMassMatrix(self, sparse: bool = True) -> Any:
        from scipy.sparse import diags_array

        return diags_array(self.masses).tocsr()

    def GetStiffnessMatrix(self, sparse: bool = True) -> Any:
        """That of the modes is given beside it."""
        from scipy.sparse import csr_array

        return csr_array((len(self.masses), len(self.masses)))


def _container(matrix: Array, build: Build) -> Any:
    found = build.exudyn.core.MatrixContainer()
    found.SetWithDenseMatrix(matrix, useDenseMatrix=False)
    return found


@translates(InterfaceFrame3D)
def interface_frame(record: InterfaceFrame3D, build: Build) -> None:
    """NodeRigidBodyEP with an ObjectRigidBody without mass, welded to the body's points there. A marker of these points
    alone would not do: an offset of it does not turn with the modes in exudyn."""
    if record.body not in build.bodies:
        raise NotTranslatable(f"'{record.name}' stands before its body '{record.body}': list the body first")
    records = {body.name: body for body in build.model.bodies}
    body = records[record.body]
    assert isinstance(body, ReducedBody3D)
    number = [place.name for place in body.interfaces].index(record.interface)
    first = 4 + 3 * len(body.stiffness) + len(AROUND) * number
    points = replace(build.bodies[record.body], mesh_points=tuple(range(first, first + len(AROUND))))
    q0, v0 = record.start_in(records)
    node = build.add(
        "NodeRigidBodyEP", referenceCoordinates=list(q0), initialCoordinates=[0.0] * 7, initialVelocities=list(v0)
    )
    item = build.add("ObjectRigidBody", nodeNumber=node, mass=0.0, inertia=[0.0] * 6)
    build.bodies[record.name] = BodyItems(node, item, True, reference=tuple(q0))
    carried = build.mesh_frame(points, (0.0, 0.0, 0.0), np.eye(3))
    own = build.add("MarkerBodyRigid", bodyNumber=item, localPosition=[0.0] * 3)
    build.add("ObjectJointGeneric", markerNumbers=[carried, own], constrainedAxes=[1] * 6)
    node_columns(record, build, (node,), q0)
    read_place(build, carried, record.name, "xyz")


def read_place(build: Build, marker: int, name: str, axes: str) -> None:
    """Channels of place and velocity of `name` along `axes`, of the marker on the body's points in place of the node's:
    the velocity of what has no mass is as good as Newton's last iteration only."""
    if not build.sensors:
        return
    for output, prefix in (("Position", ""), ("Velocity", "v")):
        kind = getattr(build.exudyn.core.OutputVariableType, output)
        sensor = build.mbs.AddSensor(
            build.exudyn.items.SensorMarker(
                markerNumber=marker, outputVariableType=kind, storeInternal=True, writeToFile=False
            )
        )
        names = {f"{name}.{prefix}{axis}" for axis in axes}
        build.columns = [column for column in build.columns if column.channel not in names]
        build.columns += [Column(f"{name}.{prefix}{axis}", sensor, k) for k, axis in enumerate(axes)]
