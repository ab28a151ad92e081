"""Elements: one file each, with its record and its kernel. A new one is a file and its name in one tuple here.

A user's own needs neither: subclasses of BodyElement, JointElement and ForceElement can stand in a model as they are.
"""

from typing import TYPE_CHECKING, Annotated

from ..lazy_import import LateClasses, late_names
from ..model.open_union import OpenUnion
from .base import BodyElement, Element, ForceElement, JointElement

if TYPE_CHECKING:
    from .applied_load2d import AppliedForce2D, AppliedTorque2D
    from .applied_load3d import AppliedForce3D, AppliedTorque3D
    from .axial_rod import AxialRod
    from .belt2d import Belt2D
    from .bushing2d import Bushing2D
    from .bushing3d import Bushing3D
    from .cable2d import Cable2D
    from .cable3d import Cable3D
    from .cable_clamp3d import CableClamp3D
    from .clamp2d import Clamp2D
    from .coordinate_driver import CoordinateDriver
    from .coordinate_load import CoordinateLoad
    from .coordinate_relation import CoordinateRelation, RelationTerm
    from .distance2d import Distance2D
    from .flexible_body import FlexibleBody
    from .floating_beam2d import Attachment, FloatingBeam2D
    from .floating_body2d import FloatingBody2D
    from .formula2d import Frame2D
    from .gear2d import Gear2D
    from .interface_frame3d import InterfaceFrame3D
    from .joint3d import Joint3D
    from .joint_friction2d import RevoluteFriction2D, SlideFriction2D
    from .joint_friction3d import RevoluteFriction3D, SlideFriction3D
    from .joints3d import (
        AngleDriver3D,
        ConstantVelocity3D,
        Cylindrical3D,
        Distance3D,
        Fixed3D,
        Planar3D,
        PointOnLine3D,
        PointOnPlane3D,
        PositionDriver3D,
        Prismatic3D,
        Revolute3D,
        RevoluteSpherical3D,
        Spherical3D,
        Universal3D,
    )
    from .knife_edge2d import KnifeEdge2D
    from .linear_system import LinearSystem
    from .material_point2d import MaterialPoint2D
    from .material_point3d import MaterialPoint3D
    from .moving_frame2d import MovingFrame2D
    from .pid_controller2d import PIDController2D
    from .pid_controller3d import PIDController3D
    from .planar_body import PlanarBody, PlanarFrame, PointMass2D, RigidBody2D
    from .prismatic2d import Prismatic2D
    from .rack2d import Rack2D
    from .reduced_body2d import ReducedBody2D, ReducedPoint
    from .reduced_body3d import Interface3D, ReducedBody3D
    from .relation3d import Gear3D, RackAndPinion3D, Relation3D, Screw3D
    from .relative_load2d import RelativeLoad2D
    from .relative_load3d import RelativeLoad3D
    from .relative_motor2d import RelativeMotor2D
    from .revolute2d import Revolute2D
    from .rolling_joints3d import RollingDisk3D, RollingSphere3D
    from .scalar_force2d import ScalarForce2D, scalar_force
    from .scalar_joint2d import ScalarJoint2D, scalar_constraint
    from .servo2d import Servo2D
    from .servo3d import Servo3D
    from .slide_spring2d import SlideSpring2D
    from .spatial_body import PointMass3D, RigidBody3D, SpatialFrame
    from .spherical_friction3d import SphericalFriction3D
    from .spring_damper2d import SpringDamper2D
    from .spring_damper3d import AxialSpring3D, SpringDamper3D, TorsionSpring3D
    from .table_spring2d import TableSpring2D
    from .table_spring3d import TableSpring3D
    from .torsion_spring2d import TorsionSpring2D

BODIES = LateClasses(
    __name__,
    "PointMass2D RigidBody2D LinearSystem AxialRod Cable2D FloatingBeam2D ReducedBody2D MaterialPoint2D "
    "MovingFrame2D PointMass3D RigidBody3D Cable3D MaterialPoint3D ReducedBody3D InterfaceFrame3D",
)
JOINTS = LateClasses(
    __name__,
    "Revolute2D Prismatic2D Clamp2D Distance2D Gear2D Rack2D Belt2D KnifeEdge2D CoordinateDriver "
    "RelativeMotor2D CoordinateRelation AngleDriver3D ConstantVelocity3D Cylindrical3D Distance3D Fixed3D "
    "Planar3D PointOnLine3D PointOnPlane3D PositionDriver3D Prismatic3D Revolute3D RevoluteSpherical3D "
    "Spherical3D Universal3D Gear3D RackAndPinion3D Screw3D RollingDisk3D RollingSphere3D CableClamp3D",
)
FORCES = LateClasses(
    __name__,
    "SpringDamper2D TableSpring2D TorsionSpring2D SlideSpring2D RevoluteFriction2D SlideFriction2D Bushing2D "
    "Servo2D RelativeLoad2D PIDController2D AppliedForce2D AppliedTorque2D CoordinateLoad AppliedForce3D "
    "AppliedTorque3D AxialSpring3D SpringDamper3D TorsionSpring3D Bushing3D TableSpring3D RevoluteFriction3D "
    "SlideFriction3D SphericalFriction3D Servo3D RelativeLoad3D PIDController3D",
)

Body = Annotated[BodyElement, OpenUnion(BODIES, BodyElement)]
Joint = Annotated[JointElement, OpenUnion(JOINTS, JointElement)]
Force = Annotated[ForceElement, OpenUnion(FORCES, ForceElement)]

__all__ = [
    "BODIES",
    "FORCES",
    "JOINTS",
    "AngleDriver3D",
    "AppliedForce2D",
    "AppliedForce3D",
    "AppliedTorque2D",
    "AppliedTorque3D",
    "Attachment",
    "AxialRod",
    "AxialSpring3D",
    "Belt2D",
    "Body",
    "BodyElement",
    "Bushing2D",
    "Bushing3D",
    "Cable2D",
    "Cable3D",
    "CableClamp3D",
    "Clamp2D",
    "ConstantVelocity3D",
    "CoordinateDriver",
    "CoordinateLoad",
    "CoordinateRelation",
    "Cylindrical3D",
    "Distance2D",
    "Distance3D",
    "Element",
    "Fixed3D",
    "FlexibleBody",
    "FloatingBeam2D",
    "FloatingBody2D",
    "Force",
    "ForceElement",
    "Frame2D",
    "Gear2D",
    "Gear3D",
    "Interface3D",
    "InterfaceFrame3D",
    "Joint",
    "Joint3D",
    "JointElement",
    "KnifeEdge2D",
    "LinearSystem",
    "MaterialPoint2D",
    "MaterialPoint3D",
    "MovingFrame2D",
    "PIDController2D",
    "PIDController3D",
    "Planar3D",
    "PlanarBody",
    "PlanarFrame",
    "PointMass2D",
    "PointMass3D",
    "PointOnLine3D",
    "PointOnPlane3D",
    "PositionDriver3D",
    "Prismatic2D",
    "Prismatic3D",
    "Rack2D",
    "RackAndPinion3D",
    "ReducedBody2D",
    "ReducedBody3D",
    "ReducedPoint",
    "Relation3D",
    "RelationTerm",
    "RelativeLoad2D",
    "RelativeLoad3D",
    "RelativeMotor2D",
    "Revolute2D",
    "Revolute3D",
    "RevoluteFriction2D",
    "RevoluteFriction3D",
    "RevoluteSpherical3D",
    "RigidBody2D",
    "RigidBody3D",
    "RollingDisk3D",
    "RollingSphere3D",
    "ScalarForce2D",
    "ScalarJoint2D",
    "Screw3D",
    "Servo2D",
    "Servo3D",
    "SlideFriction2D",
    "SlideFriction3D",
    "SlideSpring2D",
    "SpatialFrame",
    "Spherical3D",
    "SphericalFriction3D",
    "SpringDamper2D",
    "SpringDamper3D",
    "TableSpring2D",
    "TableSpring3D",
    "TorsionSpring2D",
    "TorsionSpring3D",
    "Universal3D",
    "scalar_constraint",
    "scalar_force",
]

__getattr__, __dir__ = late_names(
    __name__,
    {
        ".applied_load2d": "AppliedForce2D AppliedTorque2D",
        ".applied_load3d": "AppliedForce3D AppliedTorque3D",
        ".axial_rod": "AxialRod",
        ".belt2d": "Belt2D",
        ".bushing2d": "Bushing2D",
        ".bushing3d": "Bushing3D",
        ".cable2d": "Cable2D",
        ".cable3d": "Cable3D",
        ".cable_clamp3d": "CableClamp3D",
        ".clamp2d": "Clamp2D",
        ".coordinate_driver": "CoordinateDriver",
        ".coordinate_load": "CoordinateLoad",
        ".coordinate_relation": "CoordinateRelation RelationTerm",
        ".distance2d": "Distance2D",
        ".flexible_body": "FlexibleBody",
        ".floating_beam2d": "Attachment FloatingBeam2D",
        ".floating_body2d": "FloatingBody2D",
        ".formula2d": "Frame2D",
        ".gear2d": "Gear2D",
        ".interface_frame3d": "InterfaceFrame3D",
        ".joint3d": "Joint3D",
        ".joint_friction2d": "RevoluteFriction2D SlideFriction2D",
        ".joint_friction3d": "RevoluteFriction3D SlideFriction3D",
        ".spherical_friction3d": "SphericalFriction3D",
        ".joints3d": (
            "AngleDriver3D ConstantVelocity3D Cylindrical3D Distance3D Fixed3D Planar3D PointOnLine3D "
            "PointOnPlane3D PositionDriver3D Prismatic3D Revolute3D RevoluteSpherical3D Spherical3D Universal3D"
        ),
        ".knife_edge2d": "KnifeEdge2D",
        ".linear_system": "LinearSystem",
        ".material_point2d": "MaterialPoint2D",
        ".material_point3d": "MaterialPoint3D",
        ".moving_frame2d": "MovingFrame2D",
        ".pid_controller2d": "PIDController2D",
        ".pid_controller3d": "PIDController3D",
        ".planar_body": "PlanarBody PlanarFrame PointMass2D RigidBody2D",
        ".prismatic2d": "Prismatic2D",
        ".rack2d": "Rack2D",
        ".reduced_body2d": "ReducedBody2D ReducedPoint",
        ".reduced_body3d": "Interface3D ReducedBody3D",
        ".relation3d": "Gear3D RackAndPinion3D Relation3D Screw3D",
        ".relative_load2d": "RelativeLoad2D",
        ".relative_load3d": "RelativeLoad3D",
        ".relative_motor2d": "RelativeMotor2D",
        ".revolute2d": "Revolute2D",
        ".rolling_joints3d": "RollingDisk3D RollingSphere3D",
        ".scalar_force2d": "ScalarForce2D scalar_force",
        ".scalar_joint2d": "ScalarJoint2D scalar_constraint",
        ".servo2d": "Servo2D",
        ".servo3d": "Servo3D",
        ".slide_spring2d": "SlideSpring2D",
        ".spatial_body": "PointMass3D RigidBody3D SpatialFrame",
        ".spring_damper2d": "SpringDamper2D",
        ".spring_damper3d": "AxialSpring3D SpringDamper3D TorsionSpring3D",
        ".table_spring2d": "TableSpring2D",
        ".table_spring3d": "TableSpring3D",
        ".torsion_spring2d": "TorsionSpring2D",
    },
)
