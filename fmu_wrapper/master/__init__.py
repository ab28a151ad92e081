"""A small master for co-simulation studies: couples FMUs and slaves in this process."""

from .description import Connection, InstanceRecord, MasterSettings, StepControl, SystemDescription, read_system
from .errors import CouplingError, MasterError
from .result import SystemResult
from .run import run, simulate_system
from .sources import of_fmu, of_source
from .ssp import write_ssp

__all__ = [
    "Connection",
    "CouplingError",
    "InstanceRecord",
    "MasterError",
    "MasterSettings",
    "StepControl",
    "SystemDescription",
    "SystemResult",
    "of_fmu",
    "of_source",
    "read_system",
    "run",
    "simulate_system",
    "write_ssp",
]
