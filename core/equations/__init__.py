"""Own equations: residuals and tangents of user functions, differentiated by jets."""

from .errors import EquationError, NotDifferentiableError
from .functions import EquationFunctions
from .jet import Jet, LineJet

__all__ = ["EquationError", "EquationFunctions", "Jet", "LineJet", "NotDifferentiableError"]
