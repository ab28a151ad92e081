"""Co-simulation: `Slave` (a step interface in Python) and `export_fmu` (the same slave as an FMU)."""

from .errors import CallOrderError, ExportError, FmuError, FmuValueError, SnapshotError
from .export import export_fmu
from .slave import Slave

__all__ = [
    "CallOrderError",
    "ExportError",
    "FmuError",
    "FmuValueError",
    "Slave",
    "SnapshotError",
    "export_fmu",
]
