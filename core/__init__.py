"""The solver: models, TLISMNI methods, contact. Knows nothing of FMI, exudyn, files, screens."""

from .contact.contact2d import Disk2D, DiskOnDisk2D, DiskOnHalfPlane2D, HalfPlane2D
from .contact.laws import Flores, Gonthier, Hertz, HuntCrossley, KelvinVoigt, LankaraniNikravesh, NewtonImpact
from .description import Model
from .elements import (
    AppliedForce2D,
    AppliedTorque2D,
    Bushing2D,
    CoordinateDriver,
    CoordinateLoad,
    Distance2D,
    LinearSystem,
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
    "AppliedForce2D",
    "AppliedTorque2D",
    "Bushing2D",
    "Channel",
    "ConsistencyError",
    "Constant",
    "CoordinateDriver",
    "CoordinateLoad",
    "Disk2D",
    "DiskOnDisk2D",
    "DiskOnHalfPlane2D",
    "Distance2D",
    "EquationError",
    "EquationSystem",
    "Event",
    "Flores",
    "GapContact",
    "Gonthier",
    "HalfPlane2D",
    "Hertz",
    "HuntCrossley",
    "Input",
    "InputSignal",
    "KelvinVoigt",
    "LankaraniNikravesh",
    "LinearSystem",
    "Marker2D",
    "Model",
    "ModelError",
    "NewtonImpact",
    "Parameter",
    "PointMass2D",
    "Polynomial",
    "Prismatic2D",
    "Ramp",
    "RedundantRow",
    "Result",
    "Revolute2D",
    "RigidBody2D",
    "Simulation",
    "SimulationError",
    "Sine",
    "SpringDamper2D",
    "State",
    "Step",
    "Table",
    "TlismniError",
    "simulate",
]
