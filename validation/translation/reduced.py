"""Reduced bodies in space as exudyn's floating frame of reference with modes, on a cloud of points.

exudyn makes its matrices of a mesh: places of nodes, their mass, mode shapes. A ReducedBody3D has the integrals alone,
and these are all that counts: they are the Gram matrix over the mass of (1, u0, S_1 ... S_n), of 4 + 3 n functions. So
4 + 3 n points of equal mass, whose values are the rows of its square root, turned until the first function is 1 in each
of them, have the same integrals exactly. Points without mass carry the interfaces.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...core.elements import InterfaceFrame3D, ReducedBody3D
from ...core.elements.reduced_body3d import Interface3D
from ...core.model.base import in_space
from ...core.model.markers import Marker3D
from ..errors import NotTranslatable
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
    from exudyn.FEM import ObjectFFRFreducedOrderInterface

    n = len(record.stiffness)
    each, places, shapes = cloud_of(record)
    masses = np.full(len(places), each)
    for place in record.interfaces:
        more, moved = _around(place, n)
        places, shapes = np.concatenate([places, more]), np.concatenate([shapes, moved], axis=1)
        masses = np.concatenate([masses, np.zeros(len(more))])
    stiffness = np.array(record.stiffness)
    ffrf = ObjectFFRFreducedOrderInterface(_Mesh(places, shapes.reshape(n, -1).T, np.repeat(masses, 3)))
    q0, v0 = record.initial_state()
    frame = build.add("NodeRigidBodyEP", referenceCoordinates=list(q0[:7]), initialVelocities=list(v0[:7]))
    modes = build.add(
        "NodeGenericODE2", numberOfODE2Coordinates=n, referenceCoordinates=[0.0] * n,
        initialCoordinates=list(q0[7:]), initialCoordinates_t=list(v0[7:]),
    )  # fmt: skip
    matrices = {"massMatrixReduced": ffrf.massMatrixReduced, "stiffnessMatrixReduced": stiffness}
    if record.damping is not None:
        matrices["dampingMatrixReduced"] = np.array(record.damping)
    integrals = (
        "mPsiTildePsi",
        "mPsiTildePsiTilde",
        "mPhitTPsi",
        "mPhitTPsiTilde",
        "mXRefTildePsi",
        "mXRefTildePsiTilde",
    )
    item = build.add(
        "ObjectFFRFreducedOrder", nodeNumbers=[frame, modes], modeBasis=ffrf.modeBasis, referencePositions=ffrf.xRef,
        mass=ffrf.totalMass, inertia=ffrf.inertiaLocal, centerOfMass=ffrf.chiU, computeFFRFterms=True,
        **{name: _container(matrix, build) for name, matrix in matrices.items()},
        **{name: getattr(ffrf, name) for name in integrals},
    )  # fmt: skip
    reference = (*q0[:7], *(0.0 for _ in range(n)))
    build.bodies[record.name] = BodyItems(frame, item, False)
    build.flexible = True
    weight = each * np.array(in_space(build.model.gravity))
    for k in range(4 + 3 * n if weight.any() else 0):
        # not LoadMassProportional, whose torque is that of the undeformed body
        marker = build.add("MarkerSuperElementPosition", bodyNumber=item, meshNodeNumbers=[k], weightingFactors=[1.0])
        build.add("LoadForceVector", markerNumber=marker, loadVector=weight.tolist())
    if build.sensors:
        outputs = ("Coordinates", "Coordinates_t", "Coordinates_tt")
        sensors = [[build.sensor(node, output, of_node=True) for output in outputs] for node in (frame, modes)]
        for k, coordinate in enumerate(record.coordinate_records()):
            node, component = (0, k) if k < 7 else (1, k - 7)
            for level, name in enumerate((coordinate.name, coordinate.rate, coordinate.acceleration)):
                offset = reference[k] if level == 0 else 0.0
                build.columns.append(Column(f"{record.name}.{name}", sensors[node][level], component, 1.0, offset))


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
    """No item of its own: markers on it are superelement markers of the body's points there. Its place and velocity are
    read of one."""
    if record.body not in build.bodies:
        raise NotTranslatable(f"'{record.name}' stands before its body '{record.body}': list the body first")
    build.bodies[record.name] = BodyItems(build.bodies[record.body].node, build.bodies[record.body].item, True)
    if build.sensors:
        marker = on_interface(Marker3D(body=record.name), build, np.eye(3))
        for output, names in (("Position", ("x", "y", "z")), ("Velocity", ("vx", "vy", "vz"))):
            kind = getattr(build.exudyn.core.OutputVariableType, output)
            sensor = build.mbs.AddSensor(
                build.exudyn.items.SensorMarker(
                    markerNumber=marker, outputVariableType=kind, storeInternal=True, writeToFile=False
                )
            )
            for k, name in enumerate(names):
                build.columns.append(Column(f"{record.name}.{name}", sensor, k))


def on_interface(marker: Marker3D, build: Build, axes: Array) -> int:
    """A rigid marker on the frame of an interface."""
    bodies = {body.name: body for body in build.model.bodies}
    frame = bodies[marker.body]
    assert isinstance(frame, InterfaceFrame3D)
    body = bodies[frame.body]
    assert isinstance(body, ReducedBody3D)
    number = [place.name for place in body.interfaces].index(frame.interface)
    first = 4 + 3 * len(body.stiffness) + len(AROUND) * number
    transformation = np.eye(4)
    transformation[:3, :3], transformation[:3, 3] = axes, marker.point
    return int(
        build.add(
            "MarkerSuperElementRigid", bodyNumber=build.bodies[frame.body].item, localHT=transformation,
            meshNodeNumbers=list(range(first, first + len(AROUND))), weightingFactors=[1.0 / len(AROUND)] * len(AROUND),
        )
    )  # fmt: skip
