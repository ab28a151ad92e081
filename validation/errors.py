"""Errors of the cross-check. Each says what was given, what was needed and how to mend it."""

from ..core.errors import TlismniError


class ExudynUnavailable(TlismniError, ImportError):
    """exudyn cannot be imported, or is a version that the translation was not written for."""


class NotTranslatable(TlismniError):
    """Something in the model has no equal in exudyn."""


class ExudynFailed(TlismniError):
    """exudyn did not reach the end of the run."""
