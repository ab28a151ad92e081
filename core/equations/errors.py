"""Errors about a user's equations."""

from ..errors import ModelError


class EquationError(ModelError):
    """A user's equation function gives something unusable; the message names it, the value and the remedy."""


class NotDifferentiableError(EquationError):
    """A user's function cannot be differentiated by the tool at hand (another one may do)."""
