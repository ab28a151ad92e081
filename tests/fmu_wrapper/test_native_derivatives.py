"""Derivatives of FMUs without Python, of all outputs of all scenarios: those of the slave, in both versions of FMI."""

import fmpy
import numpy as np
import pytest
from added_inputs import settable, with_inputs
from native_pair import TAKE_PYTHON, Side
from tlismni.core.compiled.library import LIBRARY
from tlismni.fmu_wrapper import Slave, export_fmu
from tlismni.models import load, names

pytestmark = pytest.mark.skipif(LIBRARY is None, reason="needs the library of machine code (tlismni.core.aot)")

USUAL = {"rocking_block": "2.0", "spinning_sphere": "3.0"}
CASES = [
    *USUAL.items(),
    *(
        pytest.param(name, version, marks=pytest.mark.full)
        for name in names()
        for version in ("2.0", "3.0")
        if name not in TAKE_PYTHON and USUAL.get(name) != version
    ),
]


@pytest.mark.parametrize(("name", "version"), CASES)
def test_derivatives_are_those_of_the_slave(name, version, tmp_path):
    scenario = load(name)
    model, added = with_inputs(scenario.model)
    model, inputs = model.model_copy(update={"parameters": ()}), settable(scenario, added)
    solver = {"method": scenario.method, "rtol": scenario.rtol, "atol": scenario.atol, **scenario.options}
    path = export_fmu(model, tmp_path / "x.fmu", version, native=True, t_end=0.2 * scenario.t_end, **solver)
    unzipped = fmpy.extract(str(path), unzipdir=str(tmp_path / "x"))
    side, slave = Side(version, unzipped, fmpy.read_model_description(unzipped)), Slave(model, **solver)
    slave.enter_initialization()
    slave.exit_initialization()
    side.begin()
    outputs = [v.name for v in slave.variables.block("channel") if v.kind == "real"]
    unknown, known = ([side.by_name[n].valueReference for n in of] for of in (outputs, inputs))
    here_unknown, here_known = (
        np.array([slave.variables.by_name[n].reference for n in of], dtype=np.uint32) for of in (outputs, inputs)
    )
    random = np.random.default_rng(5)
    for _ in range(2):
        h = 0.1 * scenario.t_end
        slave.do_step(side.time, h)
        side.step(h)
        seed = random.uniform(-1.0, 1.0, len(inputs))
        along = slave.directional_derivative(here_unknown, here_known, seed)
        assert list(side.fmu.getDirectionalDerivative(unknown, known, seed.tolist())) == along.tolist()
        rates = slave._engine().rates(slave.variables.plan("real", here_unknown).variables)
        there = [k for k in range(len(outputs)) if np.isfinite(rates[k])]
        refs = [unknown[k] for k in there]
        read = side.fmu.getOutputDerivatives if side.three else side.fmu.getRealOutputDerivatives
        assert list(read(refs, [1] * len(refs))) == rates[there].tolist()
        if not side.three:
            continue
        weights = random.uniform(-1.0, 1.0, len(outputs))
        adjoint = np.array(side.fmu.getAdjointDerivative(unknown, known, weights.tolist(), nSensitivity=len(known)))
        columns = np.array([slave.directional_derivative(here_unknown, here_known[k : k + 1], np.ones(1))
                            for k in range(len(inputs))])  # fmt: skip
        most = np.abs(columns) @ np.abs(weights)
        assert np.all(np.abs(adjoint - columns @ weights) <= 1e-13 * most)
