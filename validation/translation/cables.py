"""Cables as ANCF elements, in the plane and in space, and their points as places in these elements."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...core.elements import Cable2D, Cable3D, CableClamp3D, MaterialPoint2D, MaterialPoint3D, ReducedBody2D
from ...core.model.base import in_space
from ..errors import NotTranslatable
from .bodies import node_columns
from .reduced2d import point_of_reduced
from .registry import BodyItems, Build, Column, no_equal, translates

no_equal("coordinate constraints on a node of the cable (ObjectConnectorCoordinate), where it is clamped to the ground",
         CableClamp3D)  # fmt: skip


@translates(Cable2D)
def cable_in_plane(record: Cable2D, build: Build) -> None:
    """NodePoint2DSlope1 and ObjectANCFCable2D; the reference is the shape at the start."""
    _cable(
        record, build, ("NodePoint2DSlope1", "ObjectANCFCable2D"), record.start_shape(),
        bendingDamping=record.bending_damping,
        referenceCurvature=record.reference_curvature,
        strainIsRelativeToReference=float(record.relaxed == "start"),
    )  # fmt: skip


@translates(Cable3D)
def cable_in_space(record: Cable3D, build: Build) -> None:
    """NodePointSlope1 and ObjectANCFCable; the reference is the shape at the start."""
    _cable(record, build, ("NodePointSlope1", "ObjectANCFCable"), record.start_shape().reshape(-1, 6))


def _cable(
    record: Cable2D | Cable3D, build: Build, kinds: tuple[str, str], places: NDArray[np.float64], **own: Any
) -> None:
    """Nodes and elements of these `kinds`; `places` (nodes, coordinates each); `own`: what only these elements have."""
    each = places.shape[1]
    _, v0 = record.initial_state()
    nodes = tuple(
        build.add(
            kinds[0], referenceCoordinates=place.tolist(), initialCoordinates=[0.0] * each,
            initialVelocities=list(v0[each * k : each * (k + 1)]),
        )
        for k, place in enumerate(places)
    )  # fmt: skip
    elements = []
    for k in range(record.elements):
        element = build.add(
            kinds[1],
            length=record.length / record.elements,
            massPerLength=record.mass_per_length,
            bendingStiffness=record.bending_stiffness,
            axialStiffness=record.axial_stiffness,
            axialDamping=record.axial_damping,
            referenceAxialStrain=record.reference_strain,
            useReducedOrderIntegration=int(record.integration == "reduced"),
            nodeNumbers=list(nodes[k : k + 2]),
            **own,
        )
        if any(build.model.gravity):
            marker = build.add("MarkerBodyMass", bodyNumber=element)
            build.add("LoadMassProportional", markerNumber=marker, loadVector=[*in_space(build.model.gravity)])
        elements.append(element)
    reference = tuple(float(x) for x in places.ravel())
    build.bodies[record.name] = BodyItems(
        nodes[0], elements[0], False, nodes, tuple(elements), coordinates_each=each, reference=reference
    )
    build.flexible = True
    node_columns(record, build, nodes, reference)


@translates(MaterialPoint2D)
def point_in_plane(record: MaterialPoint2D, build: Build) -> None:
    """A place in a cable element, for markers and sensors: exudyn needs no body there."""
    if any(isinstance(b, ReducedBody2D) and b.name == record.body for b in build.model.bodies):
        return point_of_reduced(record, build)
    outputs = {
        "Position": ("x", "y"),
        "Velocity": ("vx", "vy"),
        "Acceleration": ("ax", "ay"),
        "Rotation": ("angle",),
        "AngularVelocity": ("", "", "angular_velocity"),
    }
    _point(record, build, record.point, outputs, oriented=True)


@translates(MaterialPoint3D)
def point_in_space(record: MaterialPoint3D, build: Build) -> None:
    """The same; it has no frame."""
    outputs = {"Position": ("x", "y", "z"), "Velocity": ("vx", "vy", "vz"), "Acceleration": ("ax", "ay", "az")}
    _point(record, build, (record.s, 0.0), outputs, oriented=False)


def _point(
    record: MaterialPoint2D | MaterialPoint3D,
    build: Build,
    place: tuple[float, float],
    outputs: Mapping[str, tuple[str, ...]],
    oriented: bool,
) -> None:
    """The point at `place` (m, along the cable and beside it), and its sensors: names of channels by exudyn's outputs,
    "" for a component that is none."""
    carrier = next(b for b in build.model.bodies if b.name == record.body)
    if not isinstance(carrier, Cable2D | Cable3D):
        raise NotTranslatable(
            f"'{record.name}' is a point of '{record.body}', a {type(carrier).__name__}, whose points exudyn has no "
            "markers for: take a coordinate of one of its nodes (CoordinateContact, CoordinateDriver, CoordinateLoad)"
        )
    e, xi = carrier.find(place[0])
    items = build.bodies[record.body]
    local = (xi * carrier.length / carrier.elements, place[1])
    element = items.elements[e]
    build.bodies[record.name] = BodyItems(
        items.nodes[e], element, oriented, items.nodes[e : e + 2], (element,), items.coordinates_each, local
    )
    if not build.sensors:
        return
    for output, names in outputs.items():
        sensor = build.body_sensor(element, local, output)
        build.columns += [Column(f"{record.name}.{name}", sensor, k) for k, name in enumerate(names) if name]
