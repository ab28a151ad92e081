"""Flexible bodies: rods as one GenericODE2 object, cables as ANCF elements, and their material points."""

import numpy as np
from scipy.sparse import diags_array

from ...core.elements import AxialRod, Cable2D, FloatingBeam2D, MaterialPoint2D, ReducedBody2D
from ...core.model.base import in_space
from ..errors import NotTranslatable
from .bodies import node_columns
from .registry import BodyItems, Build, Column, no_equal, translates

no_equal(
    "a Cable2D of the same section: exudyn has the ANCF element, and FFRF bodies only from three-dimensional "
    "meshes (`tlismni.validation.as_cables(model)` makes the exchange, `crosscheck` takes it as `exudyn_model`)",
    FloatingBeam2D,
)
no_equal(
    "the finite element model it was reduced from, as an ObjectFFRFreducedOrder of one's own; for a beam a Cable2D",
    ReducedBody2D,
)


@translates(AxialRod)
def axial_rod(record: AxialRod, build: Build) -> None:
    """NodeGenericODE2 with ObjectGenericODE2 of sparse matrices; the reference is the unstrained rod."""
    if record.massless_ends:
        raise NotTranslatable(
            f"'{record.name}' has massless ends {list(record.massless_ends)}, and exudyn needs mass at each coordinate:"
            " compare it with massless_ends = () and more elements, both tend to the same rod"
        )
    n, length = record.elements + 1, record.length / record.elements
    inertia = record.mass_per_length * length
    diagonal, beside = (1.0 / 3.0, 1.0 / 6.0) if record.mass_matrix == "consistent" else (0.5, 0.0)
    shared = np.full(n, 2.0)  # elements at a node
    shared[[0, -1]] = 1.0
    side = np.ones(n - 1)
    mass = inertia * diags_array([beside * side, diagonal * shared, beside * side], offsets=[-1, 0, 1])
    chain = diags_array([-side, shared, -side], offsets=[-1, 0, 1])
    stiffness = record.axial_stiffness / length * chain
    core = build.exudyn.core
    matrices = {}
    for name, matrix in (("mass", mass), ("stiffness", stiffness), ("damping", record.damping_time * stiffness)):
        container = core.MatrixContainer()
        container.SetWithSparseMatrix(matrix.tocsr(), n, n)
        if name != "damping" or record.damping_time:
            matrices[f"{name}Matrix"] = container
    q0, v0 = record.initial_state()
    node = build.add(
        "NodeGenericODE2", numberOfODE2Coordinates=n, referenceCoordinates=list(q0), initialCoordinates=[0.0] * n,
        initialCoordinates_t=list(v0),
    )  # fmt: skip
    weight = (0.5 * inertia * build.model.gravity[0] * shared).tolist()
    item = build.add("ObjectGenericODE2", nodeNumbers=[node], forceVector=weight, **matrices)
    build.bodies[record.name] = BodyItems(node, item, False, reference=tuple(q0))
    build.flexible = True
    node_columns(record, build, (node,), q0)


@translates(Cable2D)
def cable(record: Cable2D, build: Build) -> None:
    """NodePoint2DSlope1 and ObjectANCFCable2D; the reference is the shape at the start."""
    places, length = record.start_shape(), record.length / record.elements
    _, v0 = record.initial_state()
    nodes = tuple(
        build.add(
            "NodePoint2DSlope1", referenceCoordinates=place.tolist(), initialCoordinates=[0.0] * 4,
            initialVelocities=list(v0[4 * k : 4 * k + 4]),
        )
        for k, place in enumerate(places)
    )  # fmt: skip
    elements = []
    for k in range(record.elements):
        element = build.add(
            "ObjectANCFCable2D",
            length=length,
            massPerLength=record.mass_per_length,
            bendingStiffness=record.bending_stiffness,
            axialStiffness=record.axial_stiffness,
            bendingDamping=record.bending_damping,
            axialDamping=record.axial_damping,
            referenceAxialStrain=record.reference_strain,
            referenceCurvature=record.reference_curvature,
            strainIsRelativeToReference=float(record.relaxed == "start"),
            useReducedOrderIntegration=int(record.integration == "reduced"),
            nodeNumbers=list(nodes[k : k + 2]),
        )
        if any(build.model.gravity):
            marker = build.add("MarkerBodyMass", bodyNumber=element)
            build.add("LoadMassProportional", markerNumber=marker, loadVector=[*in_space(build.model.gravity)])
        elements.append(element)
    reference = tuple(float(x) for x in places.ravel())
    build.bodies[record.name] = BodyItems(
        nodes[0], elements[0], False, nodes, tuple(elements), coordinates_each=4, reference=reference
    )
    build.flexible = True
    node_columns(record, build, nodes, reference)


@translates(MaterialPoint2D)
def material_point(record: MaterialPoint2D, build: Build) -> None:
    """A place in a cable element, for markers and sensors: exudyn needs no body there."""
    carrier = next(b for b in build.model.bodies if b.name == record.body)
    if not isinstance(carrier, Cable2D):
        raise NotTranslatable(
            f"'{record.name}' is a point of '{record.body}', a {type(carrier).__name__}, whose points exudyn has no "
            "markers for: take a coordinate of one of its nodes (CoordinateContact, CoordinateDriver, CoordinateLoad)"
        )
    e, xi = carrier.find(record.point[0])
    items = build.bodies[record.body]
    local = (xi * carrier.length / carrier.elements, record.point[1])
    element = items.elements[e]
    build.bodies[record.name] = BodyItems(items.nodes[e], element, True, items.nodes[e : e + 2], (element,), 4, local)
    if not build.sensors:
        return
    for output, names in (
        ("Position", ("x", "y")),
        ("Velocity", ("vx", "vy")),
        ("Acceleration", ("ax", "ay")),
        ("Rotation", ("angle",)),
        ("AngularVelocity", ("", "", "angular_velocity")),
    ):
        sensor = build.body_sensor(element, local, output)
        for k, name in enumerate(names):
            if name:
                build.columns.append(Column(f"{record.name}.{name}", sensor, k))
