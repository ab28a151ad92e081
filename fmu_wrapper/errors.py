"""The errors of the FMU wrapper, and the status that each one becomes at the FMI boundary."""

from enum import IntEnum

from ..core.errors import TlismniError


class Status(IntEnum):
    """Status of an FMI call. FMI 2.0 and 3.0 use the same numbers."""

    OK = 0
    WARNING = 1
    DISCARD = 2
    ERROR = 3
    FATAL = 4


class FmuError(TlismniError):
    """Base of the FMU wrapper's own errors. It becomes `status` at the FMI boundary; the instance lives on."""

    status = Status.ERROR


class CallOrderError(FmuError):
    """A call that is not allowed in the present phase of the slave."""


class FmuValueError(FmuError, ValueError):
    """A value, a name or a value reference that the slave refuses."""


class SourceError(FmuError, TypeError):
    """What shall be a slave or an FMU is neither a model nor a scenario."""


class SnapshotError(FmuError):
    """A stored state that is unknown, damaged, or belongs to another model or version."""


class ExportError(FmuError):
    """An FMU cannot be written."""


class UnavailableError(FmuError):
    """Something was asked that this slave does not do, and has said so in its capability flags."""


class DiscardError(FmuError):
    """A status figure was asked that this slave cannot give (FMI 2.0 wants Discard for it)."""

    status = Status.DISCARD
