"""Springs and applied loads."""

from typing import Any

from ...core.elements import AppliedForce2D, AppliedTorque2D, Bushing2D, CoordinateLoad, SpringDamper2D
from ...core.model.markers import GROUND, Marker2D
from .registry import Build, translates
from .signals import TimeFunction, time_function, turned


@translates(SpringDamper2D)
def spring_damper(record: SpringDamper2D, build: Build) -> None:
    """ObjectConnectorSpringDamper; a natural length that moves is a function of the user."""
    more = {}
    if signals := record.signals():
        more["springForceUserFunction"] = _pulled(time_function(signals[0], build.model))
    build.add(
        "ObjectConnectorSpringDamper",
        markerNumbers=[build.point(record.a), build.point(record.b)],
        referenceLength=record.reference(),
        stiffness=record.stiffness,
        damping=record.damping,
        **more,
    )


def _pulled(length: TimeFunction) -> Any:
    """Force of a spring whose natural length, beyond the reference of 0, is this function."""

    def force(mbs: Any, t: float, item: int, stretch: float, rate: float, k: float, d: float, f: float) -> float:
        return k * (stretch - length.value(t)) + d * rate

    return force


@translates(Bushing2D)
def bushing(record: Bushing2D, build: Build) -> None:
    """ObjectConnectorCartesianSpringDamper, and ObjectConnectorTorsionalSpringDamper for the rotational part."""
    build.add(
        "ObjectConnectorCartesianSpringDamper",
        markerNumbers=[build.point(record.a), build.point(record.b)],
        stiffness=[record.stiffness, record.stiffness, 0.0],
        damping=[record.damping, record.damping, 0.0],
    )
    if not (record.rotational_stiffness or record.rotational_damping):
        return
    # exudyn measures the angle within one turn only; the data node carries it on beyond
    start = build.start_angle(record.b.body) - build.start_angle(record.a.body)
    turns = build.add("NodeGenericData", numberOfDataCoordinates=1, initialCoordinates=[start])
    build.add(
        "ObjectConnectorTorsionalSpringDamper",
        markerNumbers=[build.frame(record.a, record.name), build.frame(record.b, record.name)],
        nodeNumber=turns,
        stiffness=record.rotational_stiffness,
        damping=record.rotational_damping,
        offset=record.a.angle - record.b.angle,
    )


@translates(AppliedForce2D)
def applied_force(record: AppliedForce2D, build: Build) -> None:
    """LoadForceVector, over time as a user function."""
    fx, fy = (time_function(s, build.model) for s in (record.force_x, record.force_y))
    if record.marker.body == GROUND:
        return  # a force on the ground moves nothing
    if record.follower:
        fx, fy = turned(fx, fy, record.marker.angle)
    _load(build, "LoadForceVector", build.point(record.marker), (fx, fy, None), bodyFixed=record.follower)


@translates(AppliedTorque2D)
def applied_torque(record: AppliedTorque2D, build: Build) -> None:
    """LoadTorqueVector about z, over time as a user function."""
    if record.body == GROUND:
        return
    marker = build.frame(Marker2D(body=record.body), record.name)
    _load(build, "LoadTorqueVector", marker, (None, None, time_function(record.torque, build.model)))


@translates(CoordinateLoad)
def coordinate_load(record: CoordinateLoad, build: Build) -> None:
    """LoadCoordinate, over time as a user function."""
    marker, _ = build.coordinate(record.body, record.coordinate, record.name)
    load = time_function(record.load, build.model)
    if load.constant is not None:
        build.add("LoadCoordinate", markerNumber=marker, load=load.constant)
    else:
        build.add("LoadCoordinate", markerNumber=marker, load=1.0, loadUserFunction=lambda mbs, t, item: load.value(t))


def _load(build: Build, item: str, marker: Any, components: tuple[TimeFunction | None, ...], **fields: Any) -> None:
    """A load vector of three components, None for zero."""
    if all(c is None or c.constant is not None for c in components):
        vector = [0.0 if c is None else c.value(0.0) for c in components]
        if any(vector):
            build.add(item, markerNumber=marker, loadVector=vector, **fields)
        return

    def vector_at(mbs: Any, t: float, load: Any) -> list[float]:
        return [0.0 if c is None else c.value(t) for c in components]

    # the vector given with a user function is only a stand-in, but must not be zero
    build.add(item, markerNumber=marker, loadVector=[1.0, 1.0, 1.0], loadVectorUserFunction=vector_at, **fields)
