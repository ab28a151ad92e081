"""The solver: models, TLISMNI methods, contact. Knows nothing of FMI, exudyn, files, screens."""

from .compiled_model import CompiledModel, compile_model
from .contact.contact2d import Disk2D, DiskOnDisk2D, DiskOnHalfPlane2D, HalfPlane2D
from .contact.coordinate_contact import CoordinateContact, CoordinateTerm
from .contact.disk_on_cable import DiskOnCable2D
from .contact.disk_on_line import DiskOnLine2D, Line2D
from .contact.friction import (
    AmbrosioFriction,
    BrownMcPheeFriction,
    CoulombFriction,
    FrictionLaw,
    LuGreFriction,
    StepFriction,
    TanhFriction,
    ThrelfallFriction,
)
from .contact.laws import (
    CarvalhoMartins,
    Flores,
    ForceLaw,
    Gonthier,
    HerbertMcWhannell,
    Hertz,
    HuGuo,
    HuntCrossley,
    KelvinVoigt,
    KuwabaraKono,
    LankaraniNikravesh,
    LeeWang,
    NewtonImpact,
    PoissonImpact,
    Tsuji,
    ZhiyingQishao,
    force_formula,
)
from .contact.segment2d import DiskOnSegment2D, Segment2D
from .contact.stiffness import Material, sphere_on_plane, sphere_on_sphere
from .description import Model
from .elements import (
    AppliedForce2D,
    AppliedTorque2D,
    Attachment,
    AxialRod,
    Bushing2D,
    Cable2D,
    Clamp2D,
    CoordinateDriver,
    CoordinateLoad,
    Distance2D,
    FloatingBeam2D,
    LinearSystem,
    MaterialPoint2D,
    MovingFrame2D,
    PointMass2D,
    Prismatic2D,
    ReducedBody2D,
    ReducedPoint,
    Revolute2D,
    RigidBody2D,
    SpringDamper2D,
)
from .equations.errors import EquationError
from .equations.system import EquationSystem, GapContact
from .errors import ConsistencyError, ModelError, SimulationError, TlismniError
from .events import Event
from .flexible.section_loads import (
    axial_force,
    axial_strain,
    bending_moment,
    bending_stress,
    curvature,
    deformed_shape,
    section,
    stress,
)
from .integrate.simulation import Simulation
from .methods.registry import METHODS
from .model.channels import Channel, Input, Parameter
from .model.markers import Marker2D
from .model.outputs import MarkerOutput2D
from .model.signals import Constant, InputSignal, Polynomial, Ramp, Sine, Step, Table
from .result import Result
from .runs import Runs
from .simulate import simulate
from .simulate_many import simulate_many
from .state import State
from .system.redundancy import RedundantRow
from .tolerances import OfScales

__all__ = [
    "METHODS",
    "AmbrosioFriction",
    "AppliedForce2D",
    "AppliedTorque2D",
    "Attachment",
    "AxialRod",
    "BrownMcPheeFriction",
    "Bushing2D",
    "Cable2D",
    "CarvalhoMartins",
    "Channel",
    "Clamp2D",
    "CompiledModel",
    "ConsistencyError",
    "Constant",
    "CoordinateContact",
    "CoordinateDriver",
    "CoordinateLoad",
    "CoordinateTerm",
    "CoulombFriction",
    "Disk2D",
    "DiskOnCable2D",
    "DiskOnDisk2D",
    "DiskOnHalfPlane2D",
    "DiskOnLine2D",
    "DiskOnSegment2D",
    "Distance2D",
    "EquationError",
    "EquationSystem",
    "Event",
    "FloatingBeam2D",
    "Flores",
    "ForceLaw",
    "FrictionLaw",
    "GapContact",
    "Gonthier",
    "HalfPlane2D",
    "HerbertMcWhannell",
    "Hertz",
    "HuGuo",
    "HuntCrossley",
    "Input",
    "InputSignal",
    "KelvinVoigt",
    "KuwabaraKono",
    "LankaraniNikravesh",
    "LeeWang",
    "Line2D",
    "LinearSystem",
    "LuGreFriction",
    "Marker2D",
    "MarkerOutput2D",
    "Material",
    "MaterialPoint2D",
    "Model",
    "ModelError",
    "MovingFrame2D",
    "NewtonImpact",
    "OfScales",
    "Parameter",
    "PointMass2D",
    "PoissonImpact",
    "Polynomial",
    "Prismatic2D",
    "Ramp",
    "ReducedBody2D",
    "ReducedPoint",
    "RedundantRow",
    "Result",
    "Revolute2D",
    "RigidBody2D",
    "Runs",
    "Segment2D",
    "Simulation",
    "SimulationError",
    "Sine",
    "SpringDamper2D",
    "State",
    "Step",
    "StepFriction",
    "Table",
    "TanhFriction",
    "ThrelfallFriction",
    "TlismniError",
    "Tsuji",
    "ZhiyingQishao",
    "axial_force",
    "axial_strain",
    "bending_moment",
    "bending_stress",
    "compile_model",
    "curvature",
    "deformed_shape",
    "force_formula",
    "section",
    "simulate",
    "simulate_many",
    "sphere_on_plane",
    "sphere_on_sphere",
    "stress",
]
