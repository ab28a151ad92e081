"""Analyses: of a place of rest (equilibrium, modes, linear models), of a mechanism's mobility, of runs as a whole."""

from .eigenmodes import Eigenmodes, eigenmodes
from .equilibrium import Equilibrium, static_equilibrium
from .fit import Fit, Measurement, fit
from .floquet import FloquetResult, floquet_multipliers
from .lyapunov import LyapunovResult, lyapunov_exponents
from .mobility import Mobility, mobility
from .parameter_sensitivity import ParameterSensitivities, parameter_sensitivities
from .state_space import StateSpace, state_space

__all__ = [
    "Eigenmodes",
    "Equilibrium",
    "Fit",
    "FloquetResult",
    "LyapunovResult",
    "Measurement",
    "Mobility",
    "ParameterSensitivities",
    "StateSpace",
    "eigenmodes",
    "fit",
    "floquet_multipliers",
    "lyapunov_exponents",
    "mobility",
    "parameter_sensitivities",
    "state_space",
    "static_equilibrium",
]
