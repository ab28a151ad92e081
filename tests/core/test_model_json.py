"""Models as JSON: equal after the journey, and refused with the place when broken."""

import json

import numpy as np
import pytest
from helpers import rod_pendulum
from hypothesis import given, settings
from hypothesis import strategies as st
from tlismni.core import (
    AngleDriver3D,
    AngleStop2D,
    AngleStop3D,
    AppliedForce2D,
    AppliedForce3D,
    AppliedTorque2D,
    AppliedTorque3D,
    Axes,
    AxialRod,
    AxialSpring3D,
    AxisAngles,
    Belt2D,
    Box2D,
    Box3D,
    Bushing2D,
    Bushing3D,
    Cable2D,
    Cable3D,
    CableClamp3D,
    CableOnHalfSpace3D,
    Capsule3D,
    CapsuleOnCapsule3D,
    Clamp2D,
    Constant,
    ConstantVelocity3D,
    CoordinateContact,
    CoordinateDriver,
    CoordinateLoad,
    CoordinateRelation,
    CoordinateTerm,
    CoulombFriction,
    Cylinder3D,
    Cylindrical3D,
    Disk2D,
    DiskInRing2D,
    DiskOnBox2D,
    DiskOnCable2D,
    DiskOnDisk2D,
    DiskOnHalfPlane2D,
    DiskOnLine2D,
    DiskOnPolygon2D,
    DiskOnSegment2D,
    Distance2D,
    Distance3D,
    DistanceStop3D,
    EdgesOnEdges3D,
    Ellipsoid3D,
    EulerParameters,
    Fixed3D,
    FloatingBeam2D,
    Flores,
    Gear2D,
    Gear3D,
    Gonthier,
    HalfPlane2D,
    HalfSpace3D,
    Hertz,
    HuntCrossley,
    Input,
    InputSignal,
    KelvinVoigt,
    KnifeEdge2D,
    LankaraniNikravesh,
    Line2D,
    LinearSystem,
    Marker2D,
    Marker3D,
    MarkerOutput2D,
    MarkerOutput3D,
    MaterialPoint2D,
    MaterialPoint3D,
    Model,
    ModelError,
    MovingFrame2D,
    NewtonImpact,
    Parameter,
    PIDController2D,
    PIDController3D,
    Planar3D,
    PointMass2D,
    PointMass3D,
    PointOnLine3D,
    PointOnPlane3D,
    PoissonImpact,
    Polygon2D,
    Polynomial,
    PositionDriver3D,
    Prismatic2D,
    Prismatic3D,
    Rack2D,
    RackAndPinion3D,
    Ramp,
    ReducedBody2D,
    ReducedPoint,
    RelationTerm,
    RelativeLoad2D,
    RelativeLoad3D,
    RelativeMotor2D,
    Revolute2D,
    Revolute3D,
    RevoluteFriction2D,
    RevoluteFriction3D,
    RevoluteSpherical3D,
    RigidBody2D,
    RigidBody3D,
    Rim3D,
    Ring2D,
    RollingDisk3D,
    RollingSphere3D,
    Rope2D,
    Rope3D,
    RotationVector,
    Screw3D,
    Segment2D,
    Servo2D,
    Servo3D,
    Sine,
    SlideFriction2D,
    SlideFriction3D,
    SlideSpring2D,
    SlideStop3D,
    SmoothOnHalfSpace3D,
    Sphere3D,
    SphereInSphere3D,
    SphereOnCable3D,
    SphereOnCylinder3D,
    SphereOnHalfSpace3D,
    SphereOnMesh3D,
    SphereOnRing3D,
    SphereOnSmooth3D,
    SphereOnSphere3D,
    Spherical3D,
    SphericalFriction3D,
    SpringDamper2D,
    SpringDamper3D,
    Step,
    Table,
    TableSpring2D,
    TableSpring3D,
    TorsionSpring2D,
    TorsionSpring3D,
    Torus3D,
    TriangleMesh3D,
    Universal3D,
    simulate,
)

quick = settings(deadline=None, max_examples=12, derandomize=True)

number = st.floats(-1e6, 1e6)
positive = st.floats(1e-6, 1e6)
vector = st.tuples(number, number)
marker = st.builds(Marker2D, body=st.just("b"), point=vector, angle=number)
vector3 = st.tuples(number, number, number)
attitude = st.one_of(
    st.builds(EulerParameters, values=st.tuples(number, number, number, positive)),
    st.builds(RotationVector, vector=vector3),
    st.builds(AxisAngles, sequence=st.sampled_from(["xyz", "zxz"]), angles=vector3),
    st.builds(Axes, z=st.tuples(number, number, positive)),
    st.just(Axes(z=(0.0, 1.0, 0.0), x=(1.0, 0.0, 1.0))),
)
TETRAHEDRON = TriangleMesh3D(
    marker=Marker3D(), vertices=((0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)),
    faces=((0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)),
)  # fmt: skip
marker3d = st.builds(Marker3D, body=st.just("s"), point=vector3, attitude=attitude)
signal = st.one_of(
    st.builds(Constant, value=number),
    st.builds(Step, time=number, before=number, after=number),
    st.builds(Ramp, start=number, duration=positive, before=number, after=number),
    st.builds(Sine, amplitude=number, angular_frequency=number, phase=number, offset=number),
    st.builds(Polynomial, coefficients=st.lists(number, min_size=1, max_size=5).map(tuple)),
    st.builds(Table, times=st.just((0.0, 0.1, 0.5, 2.0)), values=st.tuples(number, number, number, number)),
    st.just(InputSignal(channel="u")),
)
motion = signal.filter(lambda s: not isinstance(s, Step)) | st.just(InputSignal(channel="u", rate="u"))
e = st.floats(0.01, 1.0)
law = st.one_of(
    st.builds(NewtonImpact, restitution=e, rest_ratio=st.floats(0.0, 0.5)),
    st.builds(Hertz, stiffness=positive, exponent=st.floats(1.0, 3.0)),
    st.builds(KelvinVoigt, stiffness=positive, damping=positive),
    *(
        st.builds(kind, stiffness=positive, restitution=e, exponent=st.floats(1.0, 3.0))
        for kind in (HuntCrossley, LankaraniNikravesh, Flores, Gonthier)
    ),
)
terms = st.lists(
    st.builds(
        CoordinateTerm, body=st.just("b"), coordinate=st.sampled_from(["x", "y", "angle"]), factor=st.floats(0.1, 10.0)
    ),
    min_size=1, max_size=3,
).map(tuple)  # fmt: skip
disk = st.builds(Disk2D, marker=marker, radius=positive)
ELEMENTS = {
    "bodies": [
        st.builds(PointMass2D, name=st.just("x"), mass=positive, position=vector, velocity=vector),
        st.builds(
            RigidBody2D, name=st.just("x"), mass=positive, inertia=positive, position=vector, velocity=vector,
            angle=number, angular_velocity=number,
        ),
        st.builds(
            LinearSystem, name=st.just("x"), coordinates=st.just(("u", "angle")),
            mass=st.tuples(positive, positive).map(lambda d: ((d[0], 0.0), (0.0, d[1]))),
            damping=st.none() | st.tuples(vector, vector), stiffness=st.none() | number.map(lambda k: ((k, k), (k, k))),
            force=st.none() | vector, position=st.none() | vector, velocity=st.none() | vector,
            units=st.none() | st.just(("m", "rad")), scales=st.none() | st.tuples(positive, positive),
        ),
        st.builds(
            Cable2D, name=st.just("x"), elements=st.just(1), length=positive, mass_per_length=positive,
            axial_stiffness=positive, bending_stiffness=positive, axial_damping=positive, bending_damping=positive,
            reference_strain=number, reference_curvature=number, relaxed=st.sampled_from(["straight", "start"]),
            integration=st.sampled_from(["full", "reduced"]), position=vector, angle=number, velocity=vector,
            shape=st.none() | st.tuples(st.tuples(number, number, positive, number)).map(lambda node: 2 * node),
            angular_velocity=number,
        ),
        st.builds(
            MaterialPoint2D, name=st.just("x"), body=st.just("rope"),
            point=st.tuples(st.floats(0.0, 1.0), st.just(0.0)),
        ),
        st.builds(MovingFrame2D, name=st.just("x"), x=motion, y=motion, angle=motion),
        st.builds(
            AxialRod, name=st.just("x"), elements=st.integers(3, 5), length=positive, axial_stiffness=positive,
            mass_per_length=positive, mass_matrix=st.sampled_from(["consistent", "lumped"]), damping_time=positive,
            position=number, velocity=number, massless_ends=st.sampled_from([(), ("left",), ("left", "right")]),
        ),
        st.builds(
            ReducedBody2D, name=st.just("x"), mass=positive, inertia=positive,
            stiffness=positive.map(lambda k: ((k,),)),
            modal_mass=positive.map(lambda m: ((m,),)), damping=st.none() | positive.map(lambda c: ((c,),)),
            points=st.just((ReducedPoint(point=(1.0, 0.0), shape=((0.0,), (1.0,))),)),
            position=vector, angle=number, velocity=vector, angular_velocity=number,
        ),
        st.builds(
            FloatingBeam2D, name=st.just("x"), mass=st.floats(0.1, 10.0), length=st.floats(0.1, 10.0),
            bending_stiffness=positive, axial_stiffness=positive, modes=st.integers(1, 3),
            axial_modes=st.integers(0, 2),
            boundary_conditions=st.sampled_from(["cantilever", "simply_supported", "free"]),
            damping_ratio=st.floats(0.0, 0.1), geometric_stiffening=st.booleans(), position=vector, angle=number,
            velocity=vector, angular_velocity=number,
        ),
    ],
    "joints": [
        st.builds(Revolute2D, name=st.just("x"), a=marker, b=marker),
        st.builds(Prismatic2D, name=st.just("x"), a=marker, b=marker, relative_angle=st.none() | number),
        st.builds(Clamp2D, name=st.just("x"), a=marker, b=marker, relative_angle=st.none() | number),
        st.builds(Distance2D, name=st.just("x"), a=marker, b=marker, length=positive),
        st.builds(
            Gear2D, name=st.just("x"), a=st.builds(Marker2D, point=vector), b=st.builds(Marker2D, body=st.just("b")),
            radius_a=positive, radius_b=positive,
        ),
        st.builds(
            CoordinateDriver, name=st.just("x"), body=st.just("b"),
            coordinate=st.sampled_from(["x", "y", "angle"]), motion=motion,
        ),
    ],
    "forces": [
        st.builds(
            SpringDamper2D, name=st.just("x"), a=marker, b=marker, stiffness=positive, damping=positive,
            natural_length=positive,
        ),
        st.builds(
            Bushing2D, name=st.just("x"), a=marker, b=marker, stiffness=positive, damping=positive,
            rotational_stiffness=positive, rotational_damping=positive,
        ),
        st.builds(
            AppliedForce2D, name=st.just("x"), marker=marker, force_x=signal, force_y=signal, follower=st.booleans()
        ),
        st.builds(AppliedTorque2D, name=st.just("x"), body=st.just("b"), torque=signal),
        st.builds(
            CoordinateLoad, name=st.just("x"), body=st.just("b"), coordinate=st.sampled_from(["x", "y", "angle"]),
            load=signal,
        ),
    ],
    "contacts": [
        st.builds(
            DiskOnHalfPlane2D, name=st.just("x"), plane=st.builds(HalfPlane2D, marker=marker), disk=disk, law=law
        ),
        st.builds(DiskOnDisk2D, name=st.just("x"), a=disk, b=disk, law=law),
        st.builds(
            DiskOnSegment2D, name=st.just("x"), disk=disk, law=law,
            segment=st.builds(Segment2D, marker=marker, length=positive, radius=positive),
        ),
        st.builds(
            DiskOnLine2D, name=st.just("x"), disk=disk, law=law,
            line=st.builds(
                Line2D, nodes=st.lists(st.builds(Marker2D, point=vector), min_size=2, max_size=4).map(tuple),
                radius=positive, rounding=st.floats(0.1, 1.0),
            ),
        ),
        st.builds(
            DiskOnCable2D, name=st.just("x"), disk=disk, law=law, cable=st.just("rope"), thickness=positive
        ),
        st.builds(
            CoordinateContact, name=st.just("x"), law=law, offset=number,
            terms=st.tuples(st.builds(CoordinateTerm, body=st.just("b"), coordinate=st.just("y"), factor=positive)),
            slide=st.tuples(st.builds(CoordinateTerm, body=st.just("b"), coordinate=st.just("x"), factor=positive)),
        ),
        st.builds(
            DiskOnHalfPlane2D, name=st.just("x"), plane=st.builds(HalfPlane2D, marker=marker), disk=disk,
            law=st.builds(PoissonImpact, restitution=st.floats(0.0, 1.0)),
            friction=st.builds(CoulombFriction, coefficient=st.floats(0.0, 2.0)),
        ),
    ],
    "outputs": [
        st.builds(MarkerOutput2D, name=st.just("x"), marker=marker),
        st.builds(
            MarkerOutput3D, name=st.just("x"), marker=marker3d, attitude=st.sampled_from(["none", "matrix", "zxz"])
        ),
    ],
}  # fmt: skip
sphere = st.builds(Sphere3D, marker=marker3d, radius=positive)
ELEMENTS["bodies"] += [
    st.builds(PointMass3D, name=st.just("x"), mass=positive, position=vector3, velocity=vector3),
    st.builds(
        RigidBody3D, name=st.just("x"), mass=positive,
        inertia=st.tuples(positive, positive, positive).map(lambda m: (m[0] + m[1], m[1] + m[2], m[2] + m[0])),
        position=vector3, attitude=attitude, velocity=vector3, angular_velocity=vector3,
        angular_velocity_in=st.sampled_from(["body", "space"]),
    ),
]  # fmt: skip
ELEMENTS["joints"] += [
    *(
        st.builds(kind, name=st.just("x"), a=st.builds(Marker3D), b=st.builds(Marker3D, body=st.just("s")))
        for kind in (
            Spherical3D, Revolute3D, Universal3D, ConstantVelocity3D, Fixed3D, Cylindrical3D, Prismatic3D, Planar3D
        )
    ),
    *(
        st.builds(kind, name=st.just("x"), a=st.builds(Marker3D, point=vector3, attitude=attitude), b=marker3d)
        for kind in (PointOnLine3D, PointOnPlane3D)
    ),
    st.builds(Distance3D, name=st.just("x"), a=st.builds(Marker3D), b=marker3d, length=positive | motion),
    st.builds(RevoluteSpherical3D, name=st.just("x"), a=st.builds(Marker3D), b=marker3d, length=positive),
    st.builds(Screw3D, name=st.just("x"), a=st.builds(Marker3D), b=marker3d, lead=number),
    st.builds(
        RackAndPinion3D, name=st.just("x"), frame=st.builds(Marker3D), wheel=marker3d, guide=st.builds(Marker3D),
        rack=marker3d, radius=number,
    ),
    st.builds(
        Gear3D, name=st.just("x"), frame_a=st.builds(Marker3D), wheel_a=marker3d, frame_b=st.builds(Marker3D),
        wheel_b=marker3d, radius_a=positive, radius_b=positive,
    ),
    st.builds(AngleDriver3D, name=st.just("x"), a=st.builds(Marker3D), b=marker3d, angle=motion),
    st.builds(PositionDriver3D, name=st.just("x"), a=st.builds(Marker3D), b=marker3d, position=motion),
]  # fmt: skip
ELEMENTS["forces"] += [
    st.builds(
        AppliedForce3D, name=st.just("x"), marker=marker3d, force_x=signal, force_z=signal, follower=st.booleans()
    ),
    st.builds(AppliedTorque3D, name=st.just("x"), marker=marker3d, torque_y=signal, follower=st.booleans()),
    st.builds(
        SpringDamper3D, name=st.just("x"), a=st.builds(Marker3D), b=marker3d, stiffness=positive, damping=positive,
        natural_length=positive,
    ),
    st.builds(
        AxialSpring3D, name=st.just("x"), a=st.builds(Marker3D), b=marker3d, stiffness=positive, damping=positive,
        natural_position=number,
    ),
    st.builds(
        TorsionSpring3D, name=st.just("x"), a=st.builds(Marker3D), b=marker3d, stiffness=positive, damping=positive,
        natural_angle=number,
    ),
    st.builds(
        Bushing3D, name=st.just("x"), a=st.builds(Marker3D), b=marker3d,
        stiffness=st.tuples(*(positive,) * 6) | positive.map(lambda k: tuple(map(tuple, (k * np.eye(6)).tolist()))),
        damping=st.tuples(*(positive,) * 6),
    ),
]  # fmt: skip
ENDS = {"name": st.just("x"), "a": st.builds(Marker2D, point=vector), "b": marker}
SIDES = st.sampled_from(["upper", "lower"])
MEASURES = st.sampled_from(["angle", "slide", "distance"])
ELEMENTS["joints"] += [
    st.builds(Rack2D, **ENDS, radius=positive),
    st.builds(Belt2D, **ENDS, radius_a=positive, radius_b=positive, crossed=st.booleans()),
    st.builds(RelativeMotor2D, **ENDS, motion=motion, measure=MEASURES),
    st.builds(
        CoordinateRelation, name=st.just("x"), offset=number,
        terms=st.builds(RelationTerm, body=st.just("b"), coordinate=st.just("x"), factor=positive).map(lambda t: (t,)),
    ),
]  # fmt: skip
ELEMENTS["forces"] += [
    st.builds(TorsionSpring2D, **ENDS, stiffness=positive, damping=positive, natural_angle=number),
    st.builds(SlideSpring2D, **ENDS, stiffness=positive, damping=positive, natural_position=number),
    st.builds(
        TableSpring2D, **ENDS, lengths_table=st.just((0.5, 1.0, 2.0, 3.0)),
        forces=st.tuples(number, number, number, number),
        damping=positive,
    ),
    st.builds(RelativeLoad2D, **ENDS, load=signal, measure=MEASURES),
    st.builds(RevoluteFriction2D, **ENDS, torque=positive, transition_rate=positive),
    st.builds(SlideFriction2D, **ENDS, force=positive, transition_speed=positive),
    st.builds(RevoluteFriction2D, **ENDS, torque=positive, static_ratio=st.floats(1.0, 3.0)),
    st.builds(
        Servo2D, **ENDS, target=signal, measure=MEASURES, gain=positive, rate_gain=positive, of_rate=st.just(False)
    ),
    st.builds(
        PIDController2D, **ENDS, target=signal, measure=MEASURES, gain=positive, integral_gain=positive,
        rate_gain=number, sensor_a=marker, sensor_b=marker, sensed=MEASURES, largest=positive,
    ),
]  # fmt: skip
ENDS3D = {"name": st.just("x"), "a": st.builds(Marker3D), "b": st.just(Marker3D(body="s", point=(1.0, 0.0, 0.0)))}
TURNS = st.none() | st.integers(-3, 3).map(lambda n: 2.0 * np.pi * n)
ELEMENTS["joints"] += [st.builds(kind, **ENDS3D, start_angle=TURNS) for kind in (Revolute3D, Cylindrical3D, Planar3D)]
ELEMENTS["forces"] += [
    st.builds(SpringDamper3D, **ENDS3D, stiffness=positive, natural_length=signal),
    st.builds(
        TableSpring3D, **ENDS3D, lengths_table=st.just((0.5, 1.0, 2.0, 3.0)), damping=positive,
        forces=st.tuples(number, number, number, number), measure=MEASURES,
    ),
    st.builds(RelativeLoad3D, **ENDS3D, load=signal, measure=MEASURES),
    st.builds(RevoluteFriction3D, **ENDS3D, torque=positive, transition_rate=positive),
    st.builds(SlideFriction3D, **ENDS3D, force=positive, transition_speed=positive),
    st.builds(SphericalFriction3D, **ENDS3D, torque=positive, transition_rate=positive),
    st.builds(SphericalFriction3D, **ENDS3D, torque=positive, static_ratio=st.floats(1.0, 3.0)),
    st.builds(SlideFriction3D, **ENDS3D, force=positive, static_ratio=st.floats(1.0, 3.0)),
    st.builds(
        Servo3D, **ENDS3D, target=signal, measure=MEASURES, gain=positive, rate_gain=positive, of_rate=st.just(False)
    ),
    st.builds(
        PIDController3D, **ENDS3D, target=signal, measure=MEASURES, gain=positive, integral_gain=positive,
        rate_gain=number, sensor_a=marker3d, sensor_b=marker3d, sensed=MEASURES, largest=positive,
    ),
]  # fmt: skip
ELEMENTS["contacts"].append(
    st.builds(DistanceStop3D, **ENDS3D, law=law, limit=st.floats(0.5, 2.0), side=st.sampled_from(["upper", "lower"]))
)
ELEMENTS["contacts"] += [
    st.builds(Rope2D, **ENDS, law=law, length=positive),
    st.builds(AngleStop2D, **ENDS, law=law, limit=number, side=SIDES),
    st.builds(
        DiskOnPolygon2D, name=st.just("x"), law=law, disk=disk,
        shape=st.builds(Polygon2D, marker=marker, vertices=st.just(((0.0, 0.0), (2.0, 0.0), (0.0, 1.0)))),
    ),
    st.builds(
        DiskInRing2D, name=st.just("x"), law=law, disk=st.builds(Disk2D, marker=marker, radius=st.just(0.01)),
        shape=st.builds(Ring2D, marker=marker, radius=st.just(2.0)),
    ),
    st.builds(
        DiskOnBox2D, name=st.just("x"), law=law, disk=disk,
        shape=st.builds(Box2D, marker=marker, width=positive, height=positive),
    ),
    st.builds(
        SphereOnHalfSpace3D, name=st.just("x"), law=law, sphere=sphere,
        plane=st.builds(HalfSpace3D, marker=st.builds(Marker3D, point=vector3, attitude=attitude)),
    ),
    st.builds(
        SphereOnSphere3D, name=st.just("x"), law=law, a=st.builds(Sphere3D, marker=st.builds(Marker3D, point=vector3)),
        b=sphere,
    ),
    st.builds(
        SmoothOnHalfSpace3D, name=st.just("x"), law=law, plane=st.builds(HalfSpace3D, marker=st.builds(Marker3D)),
        shape=st.builds(Ellipsoid3D, marker=marker3d, half_axes=st.tuples(positive, positive, positive))
        | st.builds(Torus3D, marker=marker3d, radius=positive, rim_radius=positive, rim_points=st.integers(3, 20))
        | st.builds(Rim3D, marker=marker3d, radius=positive, rim_radius=positive),
    ),
    st.builds(
        SphereInSphere3D, name=st.just("x"), law=law,
        hollow=st.builds(Sphere3D, marker=st.builds(Marker3D, point=vector3), radius=st.just(2e3)),
        sphere=st.builds(Sphere3D, marker=marker3d, radius=st.floats(0.0, 1e3)),
    ),
    st.builds(
        SphereOnMesh3D, name=st.just("x"), law=law, sphere=st.builds(Sphere3D, marker=marker3d, radius=positive),
        mesh=st.just(TETRAHEDRON),
    ),
    st.builds(
        EdgesOnEdges3D, name=st.just("x"), law=law, sort_b=st.integers(0, 3),
        a=st.builds(Capsule3D, marker=st.builds(Marker3D, point=vector3), length=positive, radius=positive),
        b=st.builds(Box3D, marker=marker3d, size=st.tuples(*[st.floats(0.01, 100.0)] * 3)),
    ),
    st.builds(
        SphereOnSmooth3D, name=st.just("x"), law=law, sphere=st.builds(Sphere3D, marker=marker3d, radius=positive),
        shape=st.builds(
            Ellipsoid3D, marker=st.builds(Marker3D, point=vector3), half_axes=st.tuples(positive, positive, positive)
        ),
    ),
    st.builds(
        SphereOnCylinder3D, name=st.just("x"), law=law, sphere=st.builds(Sphere3D, marker=marker3d, radius=positive),
        shape=st.builds(Cylinder3D, marker=st.builds(Marker3D, point=vector3), radius=positive, length=positive),
    ),
    st.builds(
        SphereOnRing3D, name=st.just("x"), law=law, sphere=st.builds(Sphere3D, marker=marker3d, radius=st.just(1e-3)),
        ring=st.builds(
            Torus3D, marker=st.builds(Marker3D, point=vector3), radius=st.just(2.0), rim_radius=st.just(0.5)
        ),
    ),
    st.builds(
        SphereOnCable3D, name=st.just("x"), law=law, cable=st.just("line"), thickness=positive, sphere=sphere,
    ),
    st.builds(
        CableOnHalfSpace3D, name=st.just("x"), law=law, cable=st.just("line"), thickness=positive,
        place=st.floats(0.0, 1.0), plane=st.builds(HalfSpace3D, marker=st.builds(Marker3D, point=vector3)),
    ),
    st.builds(
        CapsuleOnCapsule3D, name=st.just("x"), law=law, b=sphere,
        a=st.builds(Capsule3D, marker=st.builds(Marker3D, point=vector3), length=positive, radius=positive),
    ),
]  # fmt: skip
ELEMENTS["bodies"] += [
    st.builds(
        Cable3D, name=st.just("x"), elements=st.just(1), length=positive, mass_per_length=positive,
        axial_stiffness=positive, bending_stiffness=positive, axial_damping=positive, reference_strain=number,
        integration=st.sampled_from(["full", "reduced"]), position=vector3, attitude=attitude, velocity=vector3,
        shape=st.none() | st.tuples(st.tuples(*5 * [number], positive)).map(lambda node: 2 * node),
        angular_velocity=vector3,
    ),
    st.builds(MaterialPoint3D, name=st.just("x"), body=st.just("line"), s=st.floats(0.0, 1.0)),
]  # fmt: skip
ELEMENTS["joints"].append(
    st.builds(
        CableClamp3D, name=st.just("x"), cable=st.just("line"), s=st.floats(0.0, 1.0),
        marker=st.builds(Marker3D, point=vector3, attitude=attitude),
    )
)  # fmt: skip
ELEMENTS["joints"].append(st.builds(KnifeEdge2D, name=st.just("x"), marker=marker))
ELEMENTS["joints"] += [
    st.builds(
        RollingDisk3D, name=st.just("x"), a=st.builds(Marker3D), radius=st.floats(1.0, 2.0),
        rim_radius=st.floats(0.0, 0.5),
        b=st.just(Marker3D(body="s", attitude=Axes(z=(1.0, 0.0, 0.0)))),
    ),
    st.builds(RollingSphere3D, name=st.just("x"), a=st.builds(Marker3D), b=marker3d, radius=positive),
]  # fmt: skip
ELEMENTS["contacts"] += [
    st.builds(kind, name=st.just("x"), a=st.builds(Marker3D), b=marker3d, law=law, limit=number, side=SIDES)
    for kind in (AngleStop3D, SlideStop3D)
]
ELEMENTS["contacts"].append(
    st.builds(
        Rope3D, name=st.just("x"), b=st.just(Marker3D(body="s", point=(1.0, 0.0, 0.0))), law=law,
        length=st.floats(0.5, 2.0),
    )
)  # fmt: skip
SPATIAL = {
    "PointMass3D", "RigidBody3D", "Spherical3D", "Revolute3D", "Universal3D", "ConstantVelocity3D", "Fixed3D",
    "Cylindrical3D", "Prismatic3D", "Planar3D", "PointOnLine3D", "PointOnPlane3D", "Distance3D", "RevoluteSpherical3D",
    "AngleDriver3D", "PositionDriver3D", "MarkerOutput3D", "AppliedForce3D", "AppliedTorque3D", "SpringDamper3D",
    "AxialSpring3D", "TorsionSpring3D", "Bushing3D", "Gear3D", "RackAndPinion3D", "Screw3D", "SphereOnHalfSpace3D",
    "SphereOnSphere3D", "SmoothOnHalfSpace3D", "SphereInSphere3D", "CapsuleOnCapsule3D", "SphereOnCable3D",
    "EdgesOnEdges3D",
    "SphereOnMesh3D", "SphereOnSmooth3D", "SphereOnCylinder3D", "SphereOnRing3D", "CableOnHalfSpace3D", "Cable3D",
    "MaterialPoint3D", "CableClamp3D",
    "AngleStop3D", "SlideStop3D", "Rope3D", "DistanceStop3D", "RollingDisk3D", "RollingSphere3D",
    "TableSpring3D", "RelativeLoad3D", "RevoluteFriction3D", "SlideFriction3D", "SphericalFriction3D", "Servo3D",
    "PIDController3D",
}  # fmt: skip
BODY = RigidBody2D(name="b", mass=1.0, inertia=1.0)
SOLID = RigidBody3D(name="s", mass=1.0, inertia=(1.0, 1.0, 1.0))
ROPE = Cable2D(name="rope", elements=1, length=1.0, mass_per_length=1.0, axial_stiffness=1.0, bending_stiffness=0.0)

LINE = Cable3D(name="line", elements=1, length=1.0, mass_per_length=1.0, axial_stiffness=1.0, bending_stiffness=0.0)


def model_with(kind, element):
    parts = {"bodies": [BODY, ROPE, SOLID, LINE], "joints": [], "forces": [], "contacts": [], "outputs": []}
    parts["inputs"] = [Input(name="u", unit="N")]
    parts[kind] = [*parts[kind], element]
    return Model(name="journey", **parts)


CASES = [(kind, k) for kind, strategies in ELEMENTS.items() for k in range(len(strategies))]


@pytest.mark.parametrize("kind, k", CASES)
def test_every_element_is_equal_after_json(kind, k):
    @quick
    @given(ELEMENTS[kind][k])
    def check(element):
        model = model_with(kind, element)
        again = Model.from_json(model.to_json())
        assert again == model
        assert again.to_json() == model.to_json()
        assert getattr(again, kind)[-1] == element and type(getattr(again, kind)[-1]) is type(element)

    check()


def test_the_list_of_elements_above_is_complete():
    """A new element needs its line in ELEMENTS: the schema knows all of them."""
    definitions = json.dumps(Model.model_json_schema())
    found = {
        name
        for name, schema in Model.model_json_schema()["$defs"].items()
        if {"name", "type"} <= set(schema.get("properties", {}))
    }
    here = {
        "PointMass2D", "RigidBody2D", "Revolute2D", "Prismatic2D", "Distance2D", "CoordinateDriver", "SpringDamper2D",
        "Bushing2D", "AppliedForce2D", "AppliedTorque2D", "CoordinateLoad", "LinearSystem", "DiskOnHalfPlane2D",
        "DiskOnDisk2D", "DiskOnSegment2D", "DiskOnLine2D", "CoordinateContact", "Cable2D", "MaterialPoint2D",
        "Clamp2D", "Gear2D", "AxialRod", "MovingFrame2D", "MarkerOutput2D", "ReducedBody2D", "FloatingBeam2D",
        "DiskOnCable2D", "Rack2D", "Belt2D", "RelativeMotor2D", "CoordinateRelation", "TorsionSpring2D",
        "SlideSpring2D", "TableSpring2D", "RevoluteFriction2D", "SlideFriction2D", "Servo2D", "PIDController2D",
        "RelativeLoad2D", "Rope2D", "AngleStop2D", "DiskInRing2D", "DiskOnPolygon2D",
        "DiskOnBox2D", "KnifeEdge2D", *SPATIAL,
        # (`test_contact_groups.py`, `test_cornered_shapes.py`, `test_reduced_body3d.py`)
        "ReducedBody3D", "InterfaceFrame3D", "ContactGroup2D", "ContactGroup3D",
    }  # fmt: skip
    assert found == here and "HalfPlane2D" in definitions


def test_model_file_journey(tmp_path):
    model = rod_pendulum(0.3, parameters=[Parameter(name="mass", unit="kg", targets=["rod.mass"])])
    path = tmp_path / "rod.json"
    model.save(path)
    assert Model.load(path) == model
    assert Model.load(str(path)) == model


def test_model_from_a_file_moves_as_the_one_from_python(tmp_path):
    model = rod_pendulum(0.3)
    model.save(tmp_path / "rod.json")
    ends = [simulate(m, 0.5).q[-1].tobytes() for m in (model, Model.load(tmp_path / "rod.json"))]
    assert ends[0] == ends[1]


@pytest.mark.parametrize("keep", [0.0, 0.3, 0.9, 0.999])
def test_file_cut_short_is_refused_with_its_path(tmp_path, keep):
    text = rod_pendulum().to_json()
    path = tmp_path / "cut.json"
    path.write_text(text[: int(keep * len(text))])
    with pytest.raises(ModelError, match=r"cut\.json.*not JSON"):
        Model.load(path)


@pytest.mark.parametrize("content", [b"\xff\xfe\x00", b"[1, 2]", b"3", b"null", b'{"bodies": 3}', b'{"mass": NaN}'])
def test_file_that_is_no_model_is_refused(tmp_path, content):
    path = tmp_path / "bad.json"
    path.write_bytes(content)
    with pytest.raises(ModelError, match=r"bad\.json"):
        Model.load(path)


def test_missing_file_and_folder_are_refused(tmp_path):
    with pytest.raises(ModelError, match=r"nowhere\.json.*cannot be read"):
        Model.load(tmp_path / "nowhere.json")
    with pytest.raises(ModelError, match="cannot be read"):
        Model.load(tmp_path)


@pytest.mark.parametrize("where", [("mass",), ("position", 0), ("inertia",)])
def test_nan_in_a_file_is_refused_with_its_place(where):
    data = json.loads(rod_pendulum().to_json())
    target = data["bodies"][0]
    for key in where[:-1]:
        target = target[key]
    target[where[-1]] = float("nan")
    with pytest.raises(ModelError, match=str(where[0])):
        Model.from_json(json.dumps(data))


def test_parameters_reach_their_fields():
    model = rod_pendulum(
        parameters=[Parameter(name="m", minimum=0.1, maximum=5.0, targets=["rod.mass", "rod.inertia"])]
    )
    changed = model.with_parameters({"m": 2.0})
    assert (changed.bodies[0].mass, changed.bodies[0].inertia) == (2.0, 2.0)
    assert changed.parameter_value("m") == 2.0 and model.parameter_value("m") == 1.0
    for bad, word in (({"m": 9.0}, "range"), ({"k": 1.0}, "no parameter"), ({"m": float("nan")}, "m")):
        with pytest.raises(ModelError, match=word):
            model.with_parameters(bad)


def test_models_do_not_change():
    with pytest.raises(ValueError, match="frozen"):
        rod_pendulum().bodies[0].mass = 3.0
