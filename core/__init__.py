"""The solver: models, TLISMNI methods, contact. Knows nothing of FMI, exudyn, files, screens."""

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
    Bushing2D,
    Cable2D,
    Clamp2D,
    CoordinateDriver,
    CoordinateLoad,
    Distance2D,
    LinearSystem,
    MaterialPoint2D,
    PointMass2D,
    Prismatic2D,
    Revolute2D,
    RigidBody2D,
    SpringDamper2D,
)
from .equations.errors import EquationError
from .equations.system import EquationSystem, GapContact
from .errors import ConsistencyError, ModelError, SimulationError, TlismniError
from .events import Event
from .integrate.simulation import Simulation
from .methods.registry import METHODS
from .model.channels import Channel, Input, Parameter
from .model.markers import Marker2D
from .model.signals import Constant, InputSignal, Polynomial, Ramp, Sine, Step, Table
from .result import Result
from .simulate import simulate
from .state import State
from .system.redundancy import RedundantRow

__all__ = [
    "METHODS",
    "AmbrosioFriction",
    "AppliedForce2D",
    "AppliedTorque2D",
    "BrownMcPheeFriction",
    "Bushing2D",
    "Cable2D",
    "CarvalhoMartins",
    "Channel",
    "Clamp2D",
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
    "Material",
    "MaterialPoint2D",
    "Model",
    "ModelError",
    "NewtonImpact",
    "Parameter",
    "PointMass2D",
    "PoissonImpact",
    "Polynomial",
    "Prismatic2D",
    "Ramp",
    "RedundantRow",
    "Result",
    "Revolute2D",
    "RigidBody2D",
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
    "force_formula",
    "simulate",
    "sphere_on_plane",
    "sphere_on_sphere",
]
