"""`solver.method` of an FMU may be "auto": chosen for the model when the run is built."""

from tlismni.core.methods.automatic import METHOD_NAMES
from tlismni.fmu_wrapper import Slave
from tlismni.models import load


def test_auto_is_a_value_of_solver_method_and_solves_as_the_method_that_it_takes() -> None:
    scenario, ends = load("chain"), []
    for settings in ({"method": "auto"}, {"method": "adams", "order": 6}):
        slave = Slave(scenario, **settings)
        variable = {v.name: v for v in slave.variables.block("solver")}["solver.method"]
        assert variable.items == METHOD_NAMES and variable.start == METHOD_NAMES.index(settings["method"])
        slave.setup()
        slave.enter_initialization()
        slave.exit_initialization()
        slave.do_step(0.0, 0.2)
        ends.append([slave[f"link{k}.{name}"] for k in (1, 5, 10) for name in ("x", "y", "vx", "vy")])
    assert ends[0] == ends[1]
