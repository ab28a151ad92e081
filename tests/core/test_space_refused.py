"""What is refused in space: attitudes, inertias, joints and forces that cannot be."""

import pytest
from tlismni.core import (
    AngleDriver3D,
    AppliedTorque3D,
    Axes,
    AxisAngles,
    Bushing3D,
    ConsistencyError,
    Constant,
    Distance3D,
    EulerParameters,
    Fixed3D,
    Marker2D,
    Marker3D,
    Model,
    ModelError,
    PointMass3D,
    Revolute2D,
    Revolute3D,
    RigidBody2D,
    RigidBody3D,
    Spherical3D,
    SpringDamper3D,
    Step,
    simulate,
)


@pytest.mark.parametrize(
    "make, words",
    [
        (lambda: EulerParameters(values=(0.0, 0.0, 0.0, 0.0)), "norm 0"),
        (lambda: AxisAngles(sequence="xxy", angles=(0, 0, 0)), "twice running"),
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


@pytest.mark.parametrize(
    "joint, words",
    [
        (Spherical3D(name="j", a=Marker3D(body="other"), b=Marker3D(body="other")), "two bodies"),
        (Spherical3D(name="j", a=Marker3D(body="flat"), b=Marker3D(body="other")), "carries Marker2Ds"),
        (Spherical3D(name="j", a=Marker3D(), b=Marker3D(body="mass", point=(0.0, 0.0, 1.0))), "no extension"),
        (Revolute3D(name="j", a=Marker3D(), b=Marker3D(body="other", attitude=UPSIDE_DOWN)), "mirrored"),
        (Spherical3D(name="j", a=Marker3D(), b=Marker3D(body="nobody")), "does not exist"),
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
