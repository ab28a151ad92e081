"""Tangents and constraint levels of every element in space against differences of its residuals.

Euler parameters are moved off their norm too: the equations hold as functions of all coordinates.
"""

import pytest
from random_seeds import at_seeds
from reduced_bodies import points_with_modes
from test_tangents import SINE, H, Point, check_levels, check_matrix, draw
from tlismni.core import (
    AngleDriver3D,
    AppliedForce3D,
    AppliedTorque3D,
    Axes,
    AxialSpring3D,
    AxisAngles,
    Bushing3D,
    Cable3D,
    CableClamp3D,
    Constant,
    ConstantVelocity3D,
    Cylindrical3D,
    Distance3D,
    EulerParameters,
    Fixed3D,
    Gear3D,
    InterfaceFrame3D,
    Marker3D,
    MaterialPoint3D,
    Model,
    PIDController3D,
    Planar3D,
    PointMass3D,
    PointOnLine3D,
    PointOnPlane3D,
    PositionDriver3D,
    Prismatic3D,
    RackAndPinion3D,
    ReducedBody3D,
    RelativeLoad3D,
    Revolute3D,
    RevoluteFriction3D,
    RevoluteSpherical3D,
    RigidBody3D,
    RollingDisk3D,
    RollingSphere3D,
    RotationVector,
    Screw3D,
    Servo3D,
    SlideFriction3D,
    Spherical3D,
    SphericalFriction3D,
    SpringDamper3D,
    TableSpring3D,
    TorsionSpring3D,
    Universal3D,
)

A = RigidBody3D(
    name="a", mass=1.3, inertia=(0.4, 0.5, 0.7), inertia_products=(0.05, -0.08, 0.1), position=(0.1, -0.2, 0.3),
    attitude=RotationVector(vector=(0.2, -0.1, 0.3)),
)  # fmt: skip
B = RigidBody3D(
    name="b",
    mass=0.7,
    inertia=(0.2, 0.25, 0.3),
    position=(1.1, 0.4, -0.3),
    attitude=AxisAngles(angles=(0.1, 0.3, -0.2)),
)
P = PointMass3D(name="p", mass=2.0, position=(0.5, 1.5, 0.2))
LEFT = Marker3D(body="a", point=(0.3, -0.2, 0.1), attitude=Axes(z=(0.2, 0.1, 1.0)))
RIGHT = Marker3D(body="b", point=(-0.4, 0.1, 0.25), attitude=EulerParameters(values=(1.0, 0.1, -0.2, 0.1)))
RIGHT_WHEEL = Marker3D(body="b", point=(-0.4, 0.1, 0.25), attitude=Axes(z=(1.0, 0.6, 0.1)))
GROUND = Marker3D(point=(0.2, 0.1, -0.3), attitude=RotationVector(vector=(0.1, 0.2, -0.1)))
MASS = Marker3D(body="p")
CABLE = Cable3D(
    name="c", elements=2, length=1.5, mass_per_length=1.3, axial_stiffness=5.0, bending_stiffness=0.7,
    axial_damping=0.4, reference_strain=0.02, attitude=RotationVector(vector=(0.4, 0.2, -0.3)),
)  # fmt: skip

CLOUD = points_with_modes(seed=3, points=9, modes=3)
REDUCED = ReducedBody3D(
    name="r", **CLOUD, position=(0.2, -0.1, 0.4), attitude=RotationVector(vector=(0.4, 0.2, -0.3)),
    amplitudes=(0.1, -0.2, 0.15), damping=((0.3, 0.1, 0.0), (-0.1, 0.4, 0.05), (0.0, 0.02, 0.2)),
)  # fmt: skip
TIP = InterfaceFrame3D(name="m", body="r", interface="turning")
CORNER = InterfaceFrame3D(name="n", body="r", interface="node")

PAIRS = {"two bodies": (LEFT, RIGHT), "ground": (GROUND, RIGHT), "a point mass": (LEFT, MASS)}
JOINTS = {
    Spherical3D: {}, Revolute3D: {}, Universal3D: {}, ConstantVelocity3D: {}, Fixed3D: {}, Cylindrical3D: {},
    Prismatic3D: {}, Planar3D: {}, PointOnLine3D: {}, PointOnPlane3D: {}, Distance3D: {"length": SINE},
    RevoluteSpherical3D: {"length": 1.2}, AngleDriver3D: {"angle": SINE}, PositionDriver3D: {"position": SINE},
}  # fmt: skip
STIFF = (3.0, 2.0, 4.0, 1.1, 0.7, 0.9)
COUPLED = tuple(tuple(STIFF[i] if i == j else 0.02 * (i + j) for j in range(6)) for i in range(6))
LOAD = {"force_x": SINE, "force_y": Constant(value=1.4), "force_z": Constant(value=-0.6)}
TORQUE = {"torque_x": SINE, "torque_y": Constant(value=1.4), "torque_z": Constant(value=-0.6)}
MEASURES = ("angle", "slide", "distance")
TABLE = {"lengths_table": (-2.0, 0.2, 1.0, 3.0), "forces": (-1.0, 0.2, 1.5, 4.0), "damping": 0.3}
FORCES = {
    "spring": (SpringDamper3D, {"stiffness": 3.0, "damping": 0.7, "natural_length": 0.9}),
    "axial spring": (AxialSpring3D, {"stiffness": 3.0, "damping": 0.7, "natural_position": 0.2}),
    "torsion spring": (TorsionSpring3D, {"stiffness": 3.0, "damping": 0.7, "natural_angle": 0.2}),
    "bushing": (Bushing3D, {"stiffness": STIFF, "damping": (0.2, 0.3, 0.1, 0.2, 0.1, 0.3)}),
    "coupled bushing": (Bushing3D, {"stiffness": COUPLED, "damping": COUPLED}),
    "spring whose length moves": (SpringDamper3D, {"stiffness": 3.0, "damping": 0.7, "natural_length": SINE}),
    "friction about an axis": (RevoluteFriction3D, {"torque": 0.8, "transition_rate": 9.0}),
    "friction of a ball": (SphericalFriction3D, {"torque": 0.8, "transition_rate": 9.0}),
    "friction along an axis": (SlideFriction3D, {"force": 0.8, "transition_speed": 9.0}),
    "rate servo": (Servo3D, {"target": SINE, "rate_gain": 0.7, "of_rate": True}),
    **{f"{m} table": (TableSpring3D, {"measure": m, **TABLE}) for m in MEASURES},
    **{f"{m} load": (RelativeLoad3D, {"measure": m, "load": SINE}) for m in MEASURES},
    **{
        f"{m} servo, largest {largest}": (
            Servo3D, {"measure": m, "target": SINE, "gain": 2.0, "rate_gain": 0.7, "largest": largest}
        )
        for m, largest in (("angle", None), ("slide", 6.0), ("distance", 6.0))
    },
    **{
        f"controller of {driven} by {sensed}": (
            PIDController3D,
            {
                "target": SINE, "measure": driven, "sensor_a": LEFT, "sensor_b": sensor, "sensed": sensed, "gain": 2.0,
                "integral_gain": 0.9, "rate_gain": 0.7, "largest": largest,
            },
        )
        for driven, sensed, sensor, largest in (
            ("angle", "slide", MASS, None), ("slide", "angle", RIGHT, 6.0), ("distance", "distance", MASS, 6.0)
        )
    },
    "controller of what it drives": (
        PIDController3D, {"target": SINE, "measure": "slide", "gain": -2.0, "integral_gain": -0.9}
    ),
}  # fmt: skip
OF_ATTITUDES = (
    "torsion spring", "bushing", "coupled bushing", "friction about an axis", "friction of a ball", "rate servo",
    "angle table", "angle load",
    "angle servo, largest None", "controller of angle by slide",
)  # fmt: skip
GEAR = Gear3D(name="j", frame_a=GROUND, wheel_a=LEFT, frame_b=LEFT, wheel_b=RIGHT, radius_a=0.7, radius_b=-0.4)
RACK = RackAndPinion3D(name="j", frame=GROUND, wheel=LEFT, guide=GROUND, rack=RIGHT, radius=0.3)
WHEELS = {
    "ball": RollingSphere3D(name="j", a=LEFT, b=RIGHT, radius=0.6),
    "ball on the ground": RollingSphere3D(name="j", a=GROUND, b=RIGHT, radius=0.6),
    "disk": RollingDisk3D(name="j", a=LEFT, b=RIGHT_WHEEL, radius=0.6),
    "rounded disk on the ground": RollingDisk3D(name="j", a=GROUND, b=RIGHT_WHEEL, radius=0.6, rim_radius=0.1),
}
SCREWS = {where: Screw3D(name="j", a=a, b=b, lead=0.8) for where, (a, b) in PAIRS.items() if where != "a point mass"}
SPAN = {"rolling disk": 1.5e-3}
"""Of the differences, where they are steep: the disk may come to lie nearly flat."""
OF_POINTS = (Spherical3D, PointOnLine3D, PointOnPlane3D, Distance3D, PositionDriver3D)
CASES = {
    "bodies": {},
    "gear": {"joints": [GEAR]},
    "rack": {"joints": [RACK]},
    **{f"rolling {what}": {"joints": [joint]} for what, joint in WHEELS.items()},
    "cable": {"bodies": [CABLE]},
    "material point": {"bodies": [CABLE, MaterialPoint3D(name="m", body="c", s=0.7)]},
    "reduced body": {"bodies": [REDUCED]},
    "interface": {"bodies": [REDUCED, TIP]},
    "joint between interfaces": {
        "bodies": [REDUCED, TIP, CORNER],
        "joints": [Revolute3D(name="j", a=Marker3D(body="m", point=(0.1, 0.2, 0.0)), b=RIGHT)],
    },
    **{
        f"cable clamp {marker.body}": {
            "bodies": [CABLE],
            "joints": [CableClamp3D(name="j", cable="c", s=0.7, marker=marker)],
        }
        for marker in (GROUND, RIGHT)
    },
    **{f"screw {where}": {"joints": [joint]} for where, joint in SCREWS.items()},
    **{
        f"{kind.__name__} {where}": {"joints": [kind(name="j", a=a, b=b, **fields)]}
        for kind, fields in JOINTS.items()
        for where, (a, b) in PAIRS.items()
        if where != "a point mass" or kind in OF_POINTS
    },
    **{
        f"{what} {where}": {"forces": [kind(name="f", a=a, b=b, **fields)]}
        for what, (kind, fields) in FORCES.items()
        for where, (a, b) in PAIRS.items()
        if where != "a point mass" or what not in OF_ATTITUDES
    },
    **{
        f"force{' that follows' * follower} {marker.body}": {
            "forces": [AppliedForce3D(name="f", marker=marker, follower=follower, **LOAD)]
        }
        for follower in (False, True)
        for marker in (LEFT, RIGHT, MASS)
    },
    **{
        f"torque{' that follows' * follower}": {
            "forces": [AppliedTorque3D(name="f", marker=LEFT, follower=follower, **TORQUE)]
        }
        for follower in (False, True)
    },
}


def system(case):
    given = {**CASES[case]}
    return Point(Model(gravity=(0.3, -0.4, -9.0), bodies=[A, P, B, *given.pop("bodies", ())], **given))


@pytest.mark.parametrize("case", CASES)
def test_tangent_is_the_derivative_of_the_residual(case):
    point = system(case)

    @at_seeds
    def check(seed):
        check_matrix(point, draw(point, seed), h=SPAN.get(case, H))

    check()


@pytest.mark.parametrize("case", CASES)
def test_velocity_and_acceleration_level_are_the_derivatives_of_the_position_level(case):
    point = system(case)

    @at_seeds
    def check(seed):
        check_levels(point, draw(point, seed), 4e-3)

    check()
