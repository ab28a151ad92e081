"""Parameters of FMUs without Python, set at run time, of all scenarios: the run is that of a model with that value.

A value that is exact to rounding begins a run that another choice of steps may follow, as any change by one rounding
does; so runs are compared at a tolerance at which the steps do not matter.
"""

import fmpy
import numpy as np
import pytest
from native_pair import TAKE_PYTHON, Side
from tlismni.core import Simulation
from tlismni.core.compiled.library import LIBRARY
from tlismni.fmu_wrapper import Slave, export_fmu
from tlismni.models import load, names

pytestmark = pytest.mark.skipif(LIBRARY is None, reason="needs the library of machine code (tlismni.core.aot)")

USUAL = ("rocking_block",)
CASES = [
    *USUAL,
    *(pytest.param(name, marks=pytest.mark.full) for name in names() if name not in (*TAKE_PYTHON, *USUAL)),
]
ALIKE = 1e-9
"""Of the largest number of a unit: runs at a relative tolerance of 1e-11 that begin alike to rounding."""
CABLES = {"cable_ground", "cable_pendulum", "cantilever"}
BEAMS = {"flexible_slider_crank_stop", "hub_beam_stop", "sphere_beam"}
RINGING = 1e-7
"""The same where bodies ring: accelerations of their modes magnify what the steps leave."""
FACTORS = (1.05, 0.9)
PART, STEPS = 0.3, 4
"""How much of the run is compared, in so many communication steps."""


def values_of(variable):
    """Two other values of a parameter, within its limits."""
    x, least, largest = (float(y) for y in (variable.start, variable.min or "-inf", variable.max or "inf"))
    wanted = [x * factor for factor in FACTORS] if x else [0.02, -0.05]
    if np.isfinite(least) and np.isfinite(largest):
        wanted += [least + part * (largest - least) for part in (0.3, 0.7)]
    return [y for y in wanted if least <= y <= largest and y != x][:2]


def scales(rows, units):
    """The largest number of each unit, (columns,). What is zero cancels: moments are forces times lengths, others at
    least 1e-6 of the largest number of all."""
    of = {unit: np.nanmax(np.abs(rows[:, units == unit])) for unit in set(units)}
    if "N.m" in of:
        of["N.m"] = max(of["N.m"], of.get("N", 0.0) * of.get("m", 0.0))
    least = 1e-6 * max(of.values())
    return np.array([max(of[unit], least) for unit in units])


@pytest.mark.parametrize("name", CASES)
def test_a_parameter_gives_the_run_of_the_model_built_with_it(name, tmp_path):
    scenario = load(name)
    solver = {"rtol": 1e-11, "atol": 1e-14}
    end, h = PART * scenario.t_end, PART * scenario.t_end / STEPS
    path = export_fmu(scenario, tmp_path / "x.fmu", "3.0", native=True, t_end=end, **solver)
    unzipped = fmpy.extract(str(path), unzipdir=str(tmp_path / "x"))
    description = fmpy.read_model_description(unzipped)
    parameters = [v for v in description.modelVariables if v.causality == "parameter" and v.type == "Float64"]
    if name == "rocking_block":
        assert len(parameters) == 7
    for variable in parameters:
        for value in values_of(variable):
            given = {variable.name: value}
            side, slave = Side("3.0", unzipped, description), Slave(scenario, **solver)
            slave.set_by_name(given)
            slave.enter_initialization()
            slave.exit_initialization()
            side.begin(**given)
            built = load(name, **given)
            sim = Simulation(built.model, built.method, **{**built.options, **solver})
            # residuals are rounding
            columns = {
                c.name: k for k, c in enumerate(sim.channels) if c.kind == "real" and not c.name.startswith("residual.")
            }
            units = np.array([sim.channels[k].unit for k in columns.values()])
            references = [side.by_name[n].valueReference for n in columns]
            rows = []
            for k in range(STEPS + 1):
                if k:
                    slave.do_step(side.time, h)
                    side.step(h)
                    sim.advance(side.time)
                built_with = np.array(sim.values())[list(columns.values())]
                rows.append((side.fmu.getFloat64(references), [slave[n] for n in columns], built_with))
            native, python, wanted = (np.array(of) for of in zip(*rows, strict=True))
            size = scales(wanted, units)
            for found in (native, python):
                worst = np.max(np.abs(found - wanted) / size)
                k = int(np.argmax(np.max(np.abs(found - wanted), axis=0) / size))
                most = RINGING if name in CABLES | BEAMS else ALIKE
                assert worst < most, (variable.name, value, worst, list(columns)[k])
