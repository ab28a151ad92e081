"""Cables in space: ObjectANCFCable, and their points as places in its elements."""

from ...core.elements import Cable3D, CableClamp3D, MaterialPoint3D
from ...core.model.base import in_space
from ..errors import NotTranslatable
from .bodies import node_columns
from .registry import BodyItems, Build, Column, no_equal, translates

no_equal("coordinate constraints on a node of the cable (ObjectConnectorCoordinate), where it is clamped to the ground",
         CableClamp3D)  # fmt: skip


@translates(Cable3D)
def cable(record: Cable3D, build: Build) -> None:
    """NodePointSlope1 and ObjectANCFCable; the reference is the shape at the start."""
    places, length = record.start_shape().reshape(-1, 6), record.length / record.elements
    _, v0 = record.initial_state()
    nodes = tuple(
        build.add(
            "NodePointSlope1", referenceCoordinates=place.tolist(), initialCoordinates=[0.0] * 6,
            initialVelocities=list(v0[6 * k : 6 * k + 6]),
        )
        for k, place in enumerate(places)
    )  # fmt: skip
    elements = []
    for k in range(record.elements):
        element = build.add(
            "ObjectANCFCable",
            length=length,
            massPerLength=record.mass_per_length,
            bendingStiffness=record.bending_stiffness,
            axialStiffness=record.axial_stiffness,
            axialDamping=record.axial_damping,
            referenceAxialStrain=record.reference_strain,
            useReducedOrderIntegration=int(record.integration == "reduced"),
            nodeNumbers=list(nodes[k : k + 2]),
        )
        if any(build.model.gravity):
            marker = build.add("MarkerBodyMass", bodyNumber=element)
            build.add("LoadMassProportional", markerNumber=marker, loadVector=[*in_space(build.model.gravity)])
        elements.append(element)
    reference = tuple(float(x) for x in places.ravel())
    build.bodies[record.name] = BodyItems(
        nodes[0], elements[0], False, nodes, tuple(elements), coordinates_each=6, reference=reference
    )
    build.flexible = True
    node_columns(record, build, nodes, reference)


@translates(MaterialPoint3D)
def material_point(record: MaterialPoint3D, build: Build) -> None:
    """A place in a cable element, for markers and sensors: exudyn needs no body there."""
    carrier = next(b for b in build.model.bodies if b.name == record.body)
    if not isinstance(carrier, Cable3D):
        raise NotTranslatable(f"'{record.body}' is a {type(carrier).__name__}, no Cable3D")
    e, xi = carrier.find(record.s)
    items = build.bodies[record.body]
    local = (xi * carrier.length / carrier.elements, 0.0)
    element = items.elements[e]
    build.bodies[record.name] = BodyItems(items.nodes[e], element, False, items.nodes[e : e + 2], (element,), 6, local)
    if not build.sensors:
        return
    for output, names in (("Position", "xyz"), ("Velocity", ("vx", "vy", "vz")), ("Acceleration", ("ax", "ay", "az"))):
        sensor = build.body_sensor(element, local, output)
        build.columns += [Column(f"{record.name}.{name}", sensor, k) for k, name in enumerate(names)]
