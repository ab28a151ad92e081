"""Nominal values of an FMU's variables: about how large each quantity becomes.

Two sources. What the model's dimensions, masses, speeds and stiffnesses make likely is known before anything runs:
m, kg and s from `Scales`, and for contacts with a force law what a blow at a likely speed brings. What the model as
exported really reaches is known after a rehearsal: its default experiment, run once at the export. That wins where a
quantity moves at all; what only inputs set in motion, or what the rehearsal did not come to, keeps the estimate.
"""

import logging
import math
import sys
from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from ..core.analysis.time_scales import contact_blows
from ..core.elements.floating_body2d import FloatingBody2D
from ..core.elements.linear_system import LinearSystem
from ..core.errors import SimulationError, TlismniError
from ..core.multibody_model import Model
from ..core.simulate_one import simulate
from ..core.simulation.simulation import Simulation
from .scales import Scales, round_number
from .settings import Settings
from .variables import Variable, VariableTable

MOST_STEPS = 5_000
"""Steps of the solver in the rehearsal."""
MOST_NUMBERS = 20_000_000
"""Numbers that the rehearsal keeps: large models are rehearsed for fewer steps."""
ROUNDING = 1e-9
"""What stays below this part of its estimate is rounding, of a quantity that is zero."""
CLOSE = 10.0
"""Up to this factor the estimate stays: it holds for other parameters and inputs too."""
FAINT = 1e-15
"""Constraint violations and the energy balance are rounding, and so large a part of what has their unit."""

Nominals = Mapping[str, float | None]


def with_nominals(table: VariableTable, model: Model, settings: Settings, simulation: Any) -> VariableTable:
    """`table` with the nominal values of its real outputs; `simulation` is one of the model at its start."""
    likely = estimates(table, model, settings, simulation)
    reached = rehearsal(model, settings) if isinstance(simulation, Simulation) else {}
    return VariableTable(_with_nominal(v, likely, reached) for v in table.variables)


def estimates(table: VariableTable, model: Model, settings: Settings, simulation: Any) -> dict[str, float]:
    """What is likely of each real output, in its unit, before anything has run; none for those without dimension."""
    scales = Scales.of(model, settings.t_end)
    found = {}
    for variable in _outputs(table):
        value = scales.magnitude(variable.unit)
        if value is not None:
            found[variable.name] = value * (FAINT if _is_rounding(variable) else 1.0)
    found |= {name: value for name, value in _amplitudes(model, scales).items() if name in found}
    # only this package's solver knows effective masses
    blows = contact_blows(simulation, scales.length / scales.time) if isinstance(simulation, Simulation) else {}
    for name, blow in blows.items():
        brought = {
            # friction: coefficients are near one, as far as powers of ten go
            "normal_force": blow.force, "friction_force": blow.force, "gap_rate": blow.speed,
            "impulse": 2.0 * blow.energy / blow.speed, "dissipation": blow.energy,
        }  # fmt: skip
        found |= {f"{name}.{what}": value for what, value in brought.items() if f"{name}.{what}" in found}
    return {name: value for name, value in found.items() if 0.0 < value < math.inf}


def _amplitudes(model: Model, scales: Scales) -> dict[str, float]:
    """Of coordinates that vibrate by themselves: the amplitude v / omega to which a speed v of the model's size brings
    each, and its rates; motions slower than the model's are left out."""
    speed = scales.length / scales.time
    found: dict[str, float] = {}
    for body in model.bodies:
        if isinstance(body, FloatingBody2D):
            own = body.invariants()
            stiffness, mass = np.diag(own.stiffness), np.diag(own.mass)
        elif isinstance(body, LinearSystem):
            mass = np.diag(body.mass)
            stiffness = np.zeros(len(mass)) if body.stiffness is None else np.diag(body.stiffness)
        else:
            continue
        # the modes of a body in a floating frame come after the coordinates of the frame
        for c, k, m in zip(body.coordinate_records()[-len(mass) :], stiffness, mass, strict=True):
            omega = math.sqrt(k / m) if k > 0.0 and m > 0.0 else 0.0
            if c.unit == "m" and omega * scales.time > 1.0:
                rates = (c.name, speed / omega), (c.rate, speed), (c.acceleration, speed * omega)
                found |= {f"{body.name}.{name}": float(value) for name, value in rates}
    return found


def rehearsal(model: Model, settings: Settings) -> dict[str, float]:
    """The largest magnitude of each channel in the default experiment, with inputs at their start values.

    Empty without a stop time, or if the model cannot be run as it is exported. A run that fails or is too long counts
    as far as it comes.
    """
    if settings.t_end is None:
        return {}
    width = 3 * sum(len(body.coordinate_names) for body in model.bodies) + 10 * len(model.contacts) + 10
    options = {**settings.options, "record": True, "max_steps": max(100, min(MOST_STEPS, MOST_NUMBERS // width))}
    try:
        result = simulate(
            model,
            settings.t_end,
            settings.method,
            settings.rtol,
            settings.tolerance,
            step=settings.step or None,
            **options,
        )
    except SimulationError as error:
        logging.getLogger(__name__).debug("the rehearsal ends early: %s", error)
        if error.partial is None:
            return {}
        result = error.partial
    except TlismniError as error:
        logging.getLogger(__name__).debug("no rehearsal: %s", error)
        return {}
    tops = {name: float(np.max(np.abs(result[name]), initial=0.0)) for name in result.channels}
    return {name: top for name, top in tops.items() if sys.float_info.min < top < math.inf}


def _with_nominal(variable: Variable, likely: Nominals, reached: Nominals) -> Variable:
    if variable.kind != "real" or variable.block != "channel":
        return variable
    guess, top = likely.get(variable.name), reached.get(variable.name)
    moves = top is not None and top > ROUNDING * (guess or 1.0)
    near = moves and guess is not None and top is not None and guess / CLOSE <= top <= guess * CLOSE
    value = top if moves and not near else guess
    return variable if value is None else replace(variable, nominal=round_number(value))


def _outputs(table: VariableTable) -> Iterable[Variable]:
    return (v for v in table.block("channel") if v.kind == "real")


def _is_rounding(variable: Variable) -> bool:
    """Whether a quantity is zero but for rounding: a constraint violation, the energy balance."""
    return variable.name.startswith("residual.") or variable.name == "energy.balance"
