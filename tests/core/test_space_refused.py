"""What is refused in space: attitudes, inertias, joints and forces that cannot be."""

import pytest
from tlismni.core import (
    AngleDriver3D,
    AngleStop3D,
    AppliedTorque3D,
    Axes,
    AxisAngles,
    Box3D,
    Bushing3D,
    ConsistencyError,
    Constant,
    ConstantVelocity3D,
    CoulombFriction,
    Cylindrical3D,
    Distance3D,
    Ellipsoid3D,
    EulerParameters,
    Fixed3D,
    ForceElement,
    Gear3D,
    HalfSpace3D,
    JointElement,
    Marker2D,
    Marker3D,
    MarkerOutput3D,
    Model,
    ModelError,
    NewtonImpact,
    PIDController3D,
    Planar3D,
    PointMass3D,
    Prismatic3D,
    RelativeLoad3D,
    Revolute2D,
    Revolute3D,
    RevoluteFriction3D,
    RigidBody2D,
    RigidBody3D,
    RollingSphere3D,
    Screw3D,
    Servo3D,
    Sphere3D,
    SphereOnHalfSpace3D,
    Spherical3D,
    SphericalFriction3D,
    SpringDamper3D,
    Step,
    TorsionSpring3D,
    TurningFriction,
    Universal3D,
    contacts_between,
    simulate,
)
from tlismni.core.contacts import ContactElement


@pytest.mark.parametrize(
    "make, words",
    [
        (lambda: EulerParameters(values=(0.0, 0.0, 0.0, 0.0)), "norm 0"),
        (lambda: AxisAngles(sequence="xxy", angles=(0, 0, 0)), "twice running"),
        (lambda: AxisAngles(sequence="xyw", angles=(0, 0, 0)), "three small letters out of x, y and z.*'zxz'"),
        (lambda: AxisAngles(sequence="ZXZ", angles=(0, 0, 0)), "three small letters"),
        (lambda: AxisAngles(sequence="xyz\n", angles=(0, 0, 0)), "three small letters"),
        (
            lambda: MarkerOutput3D(name="o", marker=Marker3D(), attitude="ZXZ"),
            "must be one of none, matrix, xyz, .*zxz",
        ),
        (lambda: RigidBody3D(name="a b", mass=1.0, inertia=(1.0, 1.0, 1.0)), "letters, digits and underscores"),
        (lambda: Axes(z=(0, 0, 1), x=(0, 0, 2)), "parallel"),
        (lambda: RigidBody3D(name="b", mass=1.0, inertia=(1.0, 1.0, 2.1)), "triangle inequality"),
        (lambda: RigidBody3D(name="b", mass=1.0, inertia=(1, 1, 1), inertia_products=(0.9, 0.9, 0.9)), "triangle"),
        (lambda: RigidBody3D(name="b", mass=1.0, inertia=(1.0, 1.0, 0.0)), "must be positive"),
        (lambda: Distance3D(name="d", a=Marker3D(), b=Marker3D(body="b"), length=0.0), "Spherical3D"),
        (lambda: AngleDriver3D(name="d", a=Marker3D(), b=Marker3D(body="b"), angle=Step(time=1.0)), "no motion"),
        (lambda: Bushing3D(name="f", a=Marker3D(), b=Marker3D(body="b"), stiffness=(1, 1, 1, 1, 1, -1)), "negative"),
    ],
)
def test_records_that_cannot_be(make, words):
    with pytest.raises(ModelError, match=words):
        make()


OTHER = RigidBody3D(name="other", mass=1.0, inertia=(1.0, 1.0, 1.0))
MASS = PointMass3D(name="mass", mass=1.0, position=(1.0, 0.0, 0.0))
FLAT = RigidBody2D(name="flat", mass=1.0, inertia=1.0)
UPSIDE_DOWN = Axes(z=(0.0, 0.0, -1.0))
X_ALONG_Y = Axes(z=(0.0, 0.0, 1.0), x=(0.0, 1.0, 0.0))
ON_MASS = {"a": Marker3D(), "b": Marker3D(body="mass")}
FROM_MASS = {"a": Marker3D(body="mass"), "b": Marker3D(body="other")}
HARD = NewtonImpact(restitution=0.5)
ZERO = Constant(value=0.0)
TURNS_POINTS = [
    *(kind(name="e", **ON_MASS) for kind in (Revolute3D, Universal3D, ConstantVelocity3D, Fixed3D, Cylindrical3D)),
    *(kind(name="e", **ends) for kind in (Prismatic3D, Planar3D, Revolute3D) for ends in (ON_MASS, FROM_MASS)),
    AngleDriver3D(name="e", **ON_MASS, angle=ZERO),
    RollingSphere3D(name="e", **ON_MASS, radius=0.1),
    Screw3D(name="e", **ON_MASS, lead=0.1),
    Gear3D(
        name="e", frame_a=Marker3D(), wheel_a=Marker3D(body="mass"), frame_b=Marker3D(), wheel_b=Marker3D(body="other"),
        radius_a=1.0, radius_b=1.0,
    ),
    TorsionSpring3D(name="e", **ON_MASS, stiffness=1.0),
    TorsionSpring3D(name="e", **FROM_MASS, stiffness=1.0),
    Bushing3D(name="e", **ON_MASS, stiffness=(1.0,) * 6),
    RevoluteFriction3D(name="e", **ON_MASS, torque=1.0, transition_rate=1.0),
    SphericalFriction3D(name="e", **ON_MASS, torque=1.0),
    RelativeLoad3D(name="e", **ON_MASS, load=ZERO),
    Servo3D(name="e", **ON_MASS, target=ZERO, gain=1.0),
    PIDController3D(name="e", **ON_MASS, target=ZERO, gain=1.0),
    AngleStop3D(name="e", **ON_MASS, limit=1.0, law=HARD),
    SphereOnHalfSpace3D(
        name="e", plane=HalfSpace3D(), sphere=Sphere3D(marker=Marker3D(body="mass"), radius=0.1), law=HARD,
        friction=CoulombFriction(coefficient=0.3), turning=TurningFriction(rolling=1e-3),
    ),
]  # fmt: skip


@pytest.mark.parametrize(
    "joint, words",
    [
        (Spherical3D(name="j", a=Marker3D(body="other"), b=Marker3D(body="other")), "two bodies"),
        (Spherical3D(name="j", a=Marker3D(body="flat"), b=Marker3D(body="other")), "carries Marker2Ds"),
        (Spherical3D(name="j", a=Marker3D(), b=Marker3D(body="mass", point=(0.0, 0.0, 1.0))), "no extension"),
        (Revolute3D(name="j", a=Marker3D(), b=Marker3D(body="other", attitude=UPSIDE_DOWN)), "mirrored"),
        (Spherical3D(name="j", a=Marker3D(), b=Marker3D(body="nobody")), "does not exist"),
        (
            Universal3D(name="j", a=Marker3D(), b=Marker3D(body="other", attitude=X_ALONG_Y)),
            "the y axis of marker b 180 degrees from the x axis of marker a: they must be perpendicular, and are 90",
        ),
    ],
)
def test_joints_that_do_not_fit(joint, words):
    with pytest.raises(ModelError, match=words):
        Model(bodies=[OTHER, MASS, FLAT], joints=[joint])


def test_planar_markers_are_refused_on_bodies_in_space():
    joint = Revolute2D(name="j", a=Marker2D(), b=Marker2D(body="other"))
    with pytest.raises(ModelError, match="carries Marker3Ds"):
        Model(bodies=[OTHER], joints=[joint])


def test_torque_on_a_point_mass_is_refused():
    load = AppliedTorque3D(name="f", marker=Marker3D(body="mass"), torque_x=Constant(value=1.0))
    with pytest.raises(ModelError, match="does not turn"):
        Model(bodies=[MASS], forces=[load])


@pytest.mark.parametrize("element", TURNS_POINTS, ids=lambda e: f"{e.type} from {e.markers()[0].body}")
def test_what_turns_a_point_mass_is_refused(element):
    kind = {JointElement: "joints", ForceElement: "forces", ContactElement: "contacts"}
    (place,) = [name for base, name in kind.items() if isinstance(element, base)]
    with pytest.raises(ModelError, match=r"'e' turns 'mass', .*a PointMass3D is a point, which does not turn"):
        Model(bodies=[OTHER, MASS], **{place: [element]})


def test_names_that_begin_with_a_vowel_have_their_article():
    ellipsoid = Ellipsoid3D(marker=Marker3D(body="other"), half_axes=(0.1, 0.2, 0.3))
    box = Box3D(marker=Marker3D(), size=(0.1, 0.1, 0.1))
    with pytest.raises(ModelError, match="an Ellipsoid3D on 'other'"):
        contacts_between("c", [box], [ellipsoid], law=HARD)


def test_contradictory_joints_are_refused():
    """Two welds that want the body in two places."""
    joints = [
        Fixed3D(name="one", a=Marker3D(), b=Marker3D(body="other")),
        Fixed3D(name="two", a=Marker3D(point=(1e-3, 0.0, 0.0)), b=Marker3D(body="other")),
    ]
    with pytest.raises(ConsistencyError, match="two"):
        simulate(Model(bodies=[OTHER], joints=joints), 0.1)


def test_joint_that_does_not_close_is_refused():
    joint = Spherical3D(name="ball", a=Marker3D(point=(0.5, 0.0, 0.0)), b=Marker3D(body="other"))
    with pytest.raises(ConsistencyError, match="ball"):
        simulate(Model(bodies=[OTHER], joints=[joint]), 0.1)


def test_spring_of_no_length_is_refused():
    spring = SpringDamper3D(name="s", a=Marker3D(), b=Marker3D(body="other"), stiffness=1.0, natural_length=1.0)
    with pytest.raises(ConsistencyError, match="no direction"):
        simulate(Model(bodies=[OTHER], forces=[spring]), 0.1)
