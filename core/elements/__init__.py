"""Elements: one file each, with its record and its kernel. A new one is a file and its name in one tuple here.

A user's own needs neither: subclasses of BodyElement, JointElement and ForceElement can stand in a model as they are.
"""

from typing import Annotated

from ..model.open_union import OpenUnion
from .applied_load2d import AppliedForce2D, AppliedTorque2D
from .axial_rod import AxialRod
from .base import BodyElement, Element, ForceElement, JointElement
from .bushing2d import Bushing2D
from .cable2d import Cable2D
from .clamp2d import Clamp2D
from .coordinate_driver import CoordinateDriver
from .coordinate_load import CoordinateLoad
from .distance2d import Distance2D
from .flexible_body import FlexibleBody
from .floating_beam2d import Attachment, FloatingBeam2D
from .floating_body2d import FloatingBody2D
from .formula2d import Frame2D
from .gear2d import Gear2D
from .linear_system import LinearSystem
from .material_point2d import MaterialPoint2D
from .moving_frame2d import MovingFrame2D
from .planar_body import PlanarBody, PlanarFrame, PointMass2D, RigidBody2D
from .prismatic2d import Prismatic2D
from .reduced_body2d import ReducedBody2D, ReducedPoint
from .revolute2d import Revolute2D
from .scalar_force2d import ScalarForce2D, scalar_force
from .scalar_joint2d import ScalarJoint2D, scalar_constraint
from .spring_damper2d import SpringDamper2D

BODIES = (
    PointMass2D,
    RigidBody2D,
    LinearSystem,
    AxialRod,
    Cable2D,
    FloatingBeam2D,
    ReducedBody2D,
    MaterialPoint2D,
    MovingFrame2D,
)
JOINTS = (Revolute2D, Prismatic2D, Clamp2D, Distance2D, Gear2D, CoordinateDriver)
FORCES = (SpringDamper2D, Bushing2D, AppliedForce2D, AppliedTorque2D, CoordinateLoad)

Body = Annotated[BodyElement, OpenUnion(BODIES, BodyElement)]
Joint = Annotated[JointElement, OpenUnion(JOINTS, JointElement)]
Force = Annotated[ForceElement, OpenUnion(FORCES, ForceElement)]

__all__ = [
    "BODIES",
    "FORCES",
    "JOINTS",
    "AppliedForce2D",
    "AppliedTorque2D",
    "Attachment",
    "AxialRod",
    "Body",
    "BodyElement",
    "Bushing2D",
    "Cable2D",
    "Clamp2D",
    "CoordinateDriver",
    "CoordinateLoad",
    "Distance2D",
    "Element",
    "FlexibleBody",
    "FloatingBeam2D",
    "FloatingBody2D",
    "Force",
    "ForceElement",
    "Frame2D",
    "Gear2D",
    "Joint",
    "JointElement",
    "LinearSystem",
    "MaterialPoint2D",
    "MovingFrame2D",
    "PlanarBody",
    "PlanarFrame",
    "PointMass2D",
    "Prismatic2D",
    "ReducedBody2D",
    "ReducedPoint",
    "Revolute2D",
    "RigidBody2D",
    "ScalarForce2D",
    "ScalarJoint2D",
    "SpringDamper2D",
    "scalar_constraint",
    "scalar_force",
]
