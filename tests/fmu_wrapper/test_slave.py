"""The slave's phases, checks and state, on the fake simulation."""

import math
from itertools import pairwise
from types import SimpleNamespace

import numpy as np
import pytest
import tlismni.fmu_wrapper.snapshot as snapshot_module
from fake_simulation import FakeSimulation
from fmu_helpers import ball_model
from tlismni.core import EquationSystem
from tlismni.core.errors import ModelError, SimulationError, TlismniError
from tlismni.fmu_wrapper import CallOrderError, FmuError, FmuValueError, Slave, SnapshotError, export_fmu
from tlismni.fmu_wrapper.errors import SourceError


def started(slave, start=0.0, **values):
    slave.setup(start)
    slave.set_by_name(values)
    slave.enter_initialization()
    slave.exit_initialization()
    return slave


def refs(slave, *names):
    return np.array([slave.variables.by_name[n].reference for n in names], dtype=np.uint32)


def run(slave, times, inputs=None):
    rows = []
    for t0, t1 in pairwise(times):
        if inputs:
            slave.set_by_name({"push": inputs(t0)})
        slave.do_step(t0, t1 - t0)
        rows.append([slave[n] for n in ("time", "ball.y", "ball.vy", "solver.events")])
    return rows


GRID = np.linspace(0.0, 2.0, 41).tolist()
IRREGULAR = np.cumsum([0.0, *np.random.default_rng(3).uniform(1e-4, 0.1, 40)]).tolist()


@pytest.mark.parametrize("times", [GRID, IRREGULAR], ids=["fixed", "irregular"])
def test_steps_give_the_simulation_bit_for_bit(fake_slave, model, times):
    rows = run(started(fake_slave()), times)
    simulation = FakeSimulation(model)
    for row, t0, t1 in zip(rows, times, times[1:], strict=False):
        simulation.advance(t0 + (t1 - t0))
        assert row == [simulation.t, *simulation.values()[:2], len(simulation.events)]
    assert rows[-1][3] >= 2


def test_parameters_inputs_and_options_reach_the_simulation(fake_slave):
    slave = started(fake_slave(order=4, variant="b", light=False), restitution=0.25, mass=4.0)
    simulation = slave._run._simulation
    assert (simulation.restitution, simulation.mass) == (0.25, 4.0)
    assert (simulation.order, simulation.variant) == (4, "b")
    assert slave["ball.ay"] == 1.0 / 4.0 - 9.81  # the input's start value
    slave.set_by_name({"push": 3.0})
    assert slave["ball.ay"] == 3.0 / 4.0 - 9.81  # held from now on, seen at once
    slave.do_step(0.0, 0.125)
    assert slave["ball.vy"] == (3.0 / 4.0 - 9.81) * 0.125


def test_solver_settings_are_parameters(fake_slave):
    slave = fake_slave(rtol=1e-4, step=1e-3, order=4)
    slave.set_by_name({"solver.method": "bdf", "solver.rtol": 1e-8, "solver.step": 0.0})
    simulation = started(slave)._run._simulation
    assert (simulation.rtol, simulation.step) == (1e-8, None)
    assert simulation.order == 3  # the exported options belong to the exported method


def test_tolerance_of_the_experiment_gives_way_to_the_parameter(fake_slave):
    slave = fake_slave()
    slave.setup(tolerance=1e-3)
    slave.enter_initialization()
    assert slave["solver.rtol"] == 1e-3
    slave.exit_initialization()
    assert slave._run._simulation.rtol == 1e-3
    slave.reset()
    slave.set_by_name({"solver.rtol": 1e-8})
    slave.setup(tolerance=1e-3)
    slave.enter_initialization()
    assert slave["solver.rtol"] == 1e-8


def test_outputs_can_be_read_in_initialization_mode(fake_slave):
    slave = fake_slave()
    slave.enter_initialization()
    assert slave["ball.ay"] == 0.5 - 9.81
    slave.set_by_name({"mass": 1.0, "push": 3.0})
    assert slave["ball.ay"] == 3.0 - 9.81
    assert slave["floor.in_contact"] is False and slave["floor.mode"] == 0
    assert slave["solver.method"] == "auto"


@pytest.mark.parametrize(
    ("calls", "match"),
    [
        (["do_step"], "cannot do step in phase 'instantiated': enter and exit initialization mode first"),
        (["exit"], "cannot exit initialization mode in phase 'instantiated'"),
        (["get"], "cannot get values in phase 'instantiated'"),
        (["terminate"], "cannot terminate in phase 'instantiated'"),
        (["enter", "enter"], "cannot enter initialization mode in phase 'initialization'"),
        (["enter", "setup"], "cannot setup in phase 'initialization'"),
        (["enter", "do_step"], "cannot do step in phase 'initialization': exit"),
        (["enter", "exit", "setup"], "phase 'step': reset first"),
        (["enter", "exit", "set parameter"], "parameter 'mass' is fixed after initialization: reset"),
        (["enter", "exit", "terminate", "do_step"], "phase 'terminated': the run is terminated: reset"),
        (["enter", "exit", "terminate", "set parameter"], "cannot set values in phase 'terminated'"),
    ],
)
def test_calls_out_of_order_are_refused(fake_slave, calls, match):
    slave = fake_slave()
    known = {
        "do_step": lambda: slave.do_step(0.0, 0.1), "get": lambda: slave["ball.y"], "setup": slave.setup,
        "enter": slave.enter_initialization, "exit": slave.exit_initialization, "terminate": slave.terminate,
        "set parameter": lambda: slave.set_by_name({"mass": 1.0}),
    }  # fmt: skip
    *allowed, last = calls
    for call in allowed:
        known[call]()
    phase = slave.phase
    with pytest.raises(CallOrderError, match=match):
        known[last]()
    assert slave.phase == phase


@pytest.mark.parametrize(
    ("values", "match"),
    [
        ({"push": math.nan}, r"'push' \(value reference 10\) was set to nan, which is not finite"),
        ({"push": math.inf}, "not finite"),
        ({"push": "much"}, "needs a number, not 'much'"),
        ({"restitution": 1.5}, r"'restitution' .* was set to 1.5, which is outside its range \[0.0, 1.0\]"),
        ({"mass": -1.0}, r"outside its range \[0.0, inf\]"),
        ({"solver.rtol": 0.0}, "'rtol' = 0.0 must be greater than 0"),
        ({"solver.step": -1.0}, "outside its range"),
        ({"solver.method": 99}, "was set to 99, which is none of its values: 0 newmark, 1 hht"),
        ({"solver.method": "euler"}, r"'solver.method' \(value reference 2\) has no item 'euler'; it has"),
        ({"solver.method": True}, "needs a number, not True"),
        ({"floor.law": "Hertz"}, "'floor.law' is of role constant and cannot be set"),
        ({"ball.y": 1.0}, "'ball.y' is of role output and cannot be set"),
        ({"time": 1.0}, "'time' is of role independent"),
        ({"nonsense": 1.0}, "no variable 'nonsense'; there are"),
    ],
)
def test_bad_values_are_refused_and_change_nothing(fake_slave, values, match):
    slave = fake_slave()
    slave.enter_initialization()
    before = slave.snapshot().data
    with pytest.raises(FmuValueError, match=match):
        slave.set_by_name(values)
    assert slave.snapshot().data == before


def test_setting_is_all_or_nothing(fake_slave):
    slave = fake_slave()
    with pytest.raises(FmuValueError):
        slave.set("real", refs(slave, "mass", "push"), [3.0, math.nan])
    with pytest.raises(FmuValueError, match="1 values were given for 2 value references"):
        slave.set("real", refs(slave, "mass", "push"), [3.0])
    slave.enter_initialization()
    assert slave["mass"] == 2.0


def test_unknown_and_wrong_references_are_refused(fake_slave):
    slave = started(fake_slave())
    with pytest.raises(FmuValueError, match=r"value reference 77 is unknown: this FMU has 10 real variables"):
        slave.get("real", np.array([77], dtype=np.uint32))
    with pytest.raises(FmuValueError, match=r"is 'floor.mode', which is of kind integer, not real: use the get"):
        slave.get("real", refs(slave, "floor.mode"))


@pytest.mark.parametrize(
    ("t", "h", "match"),
    [
        (0.5, 0.1, "the communication point is 0.5 s, but this slave is at 0.0 s"),
        (-1e-6, 0.1, "but this slave is at 0.0 s"),
        (0.0, 0.0, "step is 0.0 s: a step greater than 0 is needed"),
        (0.0, -0.1, "a step greater than 0"),
        (math.nan, 0.1, "must be finite"),
        (0.0, math.inf, "must be finite"),
        (0.0, 2.5, "ends after the stop time 2.0 s"),
    ],
)
def test_bad_steps_are_refused_and_change_nothing(fake_slave, t, h, match):
    slave = fake_slave()
    slave.setup(0.0, 2.0)
    slave.enter_initialization()
    slave.exit_initialization()
    with pytest.raises(FmuValueError, match=match):
        slave.do_step(t, h)
    slave.do_step(0.0, 2.0)
    assert slave.time == 2.0


def test_a_master_may_round_but_not_repeat(fake_slave):
    slave = started(fake_slave(), start=1e4)
    slave.do_step(1e4, 1e-3)
    with pytest.raises(FmuValueError, match="but this slave is at"):
        slave.do_step(1e4, 1e-3)
    slave.do_step(math.nextafter(1e4 + 1e-3, 0.0), 1e-3)
    assert slave.time == math.nextafter(1e4 + 1e-3, 0.0) + 1e-3


def test_times_do_not_drift_from_a_master_that_counts_its_steps(fake_slave):
    slave = started(fake_slave())
    for k in range(10_000):
        slave.do_step(k * 0.1, 0.1)
    assert abs(slave.time - 1000.0) <= math.ulp(1000.0)  # the plain sum of 0.1 is 1e-10 off here


@pytest.mark.parametrize("carry", [lambda s, _: s, lambda s, slave: slave.snapshot_from_bytes(s.data)])
@pytest.mark.parametrize("into", ["same", "another", "reset"])
def test_rollback_is_bit_equal(fake_slave, carry, into):
    def push(t):
        return 1.0 + t

    slave = fake_slave()
    run(started(slave, restitution=0.9), GRID[:11], push)
    snapshot = carry(slave.snapshot(), slave)
    first = run(slave, GRID[10:], push)
    target = fake_slave() if into == "another" else slave
    if into == "reset":
        slave.reset()
    target.restore(snapshot)
    assert run(target, GRID[10:], push) == first
    assert target.snapshot().data == slave.snapshot().data


def test_a_state_remembers_inputs_that_no_step_has_used(fake_slave):
    slave = started(fake_slave())
    slave.set_by_name({"push": 7.0})
    snapshot = slave.snapshot()
    slave.set_by_name({"push": -7.0})
    slave.do_step(0.0, 0.25)
    slave.restore(slave.snapshot_from_bytes(snapshot.data))
    slave.do_step(0.0, 0.25)
    assert slave["ball.vy"] == (7.0 / 2.0 - 9.81) * 0.25


def test_a_state_before_initialization_can_be_kept_too(fake_slave):
    slave = fake_slave()
    slave.set_by_name({"mass": 5.0})
    snapshot = slave.snapshot_from_bytes(slave.snapshot().data)
    started(slave, mass=3.0)
    slave.restore(snapshot)
    assert slave.phase == "instantiated"
    slave.enter_initialization()
    assert slave["mass"] == 5.0


def test_reset_equals_a_new_slave(fake_slave):
    used, new = fake_slave(), fake_slave()
    run(started(used, restitution=0.2), GRID[:20])
    used.reset()
    assert used.snapshot().data == new.snapshot().data
    assert run(started(used), GRID) == run(started(new), GRID)


def test_foreign_and_damaged_states_are_refused(fake_slave, monkeypatch):
    slave = started(fake_slave())
    data = slave.snapshot().data
    other = started(Slave(ball_model(height=1.5), simulation_factory=FakeSimulation))
    with pytest.raises(SnapshotError, match="belongs to another model or other settings"):
        other.snapshot_from_bytes(data)
    with pytest.raises(SnapshotError, match="belongs to another model"):
        other.restore(slave.snapshot())
    with pytest.raises(SnapshotError, match=r"damaged or cut off"):
        slave.snapshot_from_bytes(data[:-1])
    with pytest.raises(SnapshotError, match="damaged"):
        slave.snapshot_from_bytes(data[:-1] + bytes([data[-1] ^ 1]))
    monkeypatch.setattr(snapshot_module, "package_version", lambda: "9.9")
    with pytest.raises(SnapshotError, match=r"stored by tlismni \S+ \(format 2\), this is 9.9 \(format 2\)"):
        slave.snapshot_from_bytes(data)
    monkeypatch.undo()
    with pytest.raises(SnapshotError, match="these 7 bytes are no stored state"):
        slave.snapshot_from_bytes(b"garbage")
    with pytest.raises(SnapshotError, match="2 bytes follow the stored state"):
        slave.snapshot_from_bytes(data + b"\0\0")


def test_a_failed_step_leaves_a_slave_that_can_be_restored_or_reset(fake_slave):
    slave = started(fake_slave(fail_at=0.5))
    slave.do_step(0.0, 0.25)
    snapshot = slave.snapshot()
    with pytest.raises(SimulationError):
        slave.do_step(0.25, 0.25)
    with pytest.raises(CallOrderError, match="the last step failed: set a stored state, or reset"):
        slave.do_step(0.25, 0.25)
    with pytest.raises(CallOrderError, match="cannot get the state"):
        slave.snapshot()
    assert slave["time"] == 0.25  # for finding out why
    slave.restore(snapshot)
    slave.do_step(0.25, 0.125)
    slave.reset()
    run(started(slave), [0.0, 0.25])


class HalfSet(FakeSimulation):
    """Takes the input 7.0 and fails before it has restarted; the same value again is no change and no restart."""

    def set_inputs(self, values):
        changed = values["push"] != self._state.push
        super().set_inputs(values)
        if changed and values["push"] == 7.0:
            raise SimulationError("the state cannot be projected onto the constraints", t=self.t, loop="inner")


def test_a_clock_that_cannot_be_moved_hands_out_no_old_values(fake_slave):
    slave = started(fake_slave(fail_at=0.5))
    slave.do_step(0.0, 0.1)
    before = slave["ball.y"]
    with pytest.raises(SimulationError):
        slave.catch_up(0.6)
    assert slave.phase == "failed"
    with pytest.raises(CallOrderError, match="stored state, or reset"):
        slave["ball.y"]
    slave.reset()
    started(slave).do_step(0.0, 0.1)
    assert slave["ball.y"] == before


def ask_output(slave):
    return slave["ball.ay"]


def ask_derivative(slave):
    return slave.directional_derivative(refs(slave, "ball.ay"), refs(slave, "push"), np.ones(1))


@pytest.mark.parametrize("ask", [ask_output, ask_derivative])
@pytest.mark.parametrize("phase", ["step", "event", "event due"])
def test_an_input_that_fails_when_outputs_are_asked_is_no_silent_half_change(model, ask, phase):
    slave = started(Slave(model, simulation_factory=HalfSet, event_mode=phase != "step", early_return=True))
    if phase == "event due":
        slave.enter_step_mode()
        slave.do_step(0.0, 1.5)
    assert slave.phase == phase
    snapshot = slave.snapshot()
    slave.set_by_name({"push": 7.0})
    with pytest.raises(SimulationError, match="cannot be projected"):
        ask(slave)
    assert slave.phase == "failed"
    for go_on in (lambda: slave.do_step(0.0, 0.1), slave.snapshot, slave.update_discrete_states):
        with pytest.raises(CallOrderError, match="the last step failed: set a stored state, or reset"):
            go_on()
    slave.restore(snapshot)
    assert slave.phase == phase and slave["ball.ay"] == 1.0 / 2.0 - 9.81
    slave.set_by_name({"push": 3.0})
    assert slave["ball.ay"] == 3.0 / 2.0 - 9.81


def test_an_input_that_fails_in_initialization_fails_again_until_it_is_mended(model):
    slave = Slave(model, simulation_factory=HalfSet)
    slave.enter_initialization()
    slave.set_by_name({"push": 7.0})
    for ask in (ask_output, ask_derivative, Slave.exit_initialization, ask_output):
        with pytest.raises(SimulationError, match="cannot be projected"):
            ask(slave)
        assert slave.phase == "initialization"
    slave.set_by_name({"push": 3.0})
    slave.exit_initialization()
    assert slave["ball.ay"] == 3.0 / 2.0 - 9.81


def test_values_that_are_not_finite_are_an_error(fake_slave):
    slave = started(fake_slave(nan_at=0.5))
    slave.do_step(0.0, 0.25)
    slave.do_step(0.25, 0.25)
    with pytest.raises(FmuError, match=r"at t = 0.5 s these values are not finite: ball.y = nan; the model runs away"):
        slave["ball.vy"]
    with pytest.raises(CallOrderError, match="outputs that were not asked for before in phase 'failed'"):
        slave["ball.y"]
    assert slave.time == 0.5


def test_a_failed_initialization_can_be_repaired(fake_slave):
    slave = fake_slave()
    slave.set_by_name({"solver.method": "adams"})  # a method, but not of this simulation
    slave.enter_initialization()
    with pytest.raises(ModelError, match="unknown method 'adams'"):
        slave.exit_initialization()
    assert slave.phase == "initialization"
    slave.set_by_name({"solver.method": "bdf"})
    slave.exit_initialization()


def test_two_slaves_interleaved_equal_two_alone(fake_slave):
    alone = [run(started(fake_slave(), restitution=e), GRID) for e in (0.5, 0.9)]
    slaves = [started(fake_slave(), restitution=e) for e in (0.5, 0.9)]
    rows = [[], []]
    for t0, t1 in pairwise(GRID):
        for slave, out in zip(slaves, rows, strict=True):
            out += run(slave, [t0, t1])
    assert rows == alone


def test_events_are_logged_when_asked(fake_slave, messages):
    slave = started(fake_slave(logging_on=True))
    slave.do_step(0.0, 0.5)
    assert [(s, c) for s, c, _ in messages] == [(0, "logEvents")]
    assert messages[0][2].startswith("impact of contact 'floor' at t = 0.46")
    slave.log.choose(False)
    slave.do_step(0.5, 1.0)
    assert len(messages) == 1 and slave["solver.events"] > 1


def test_names_must_be_unique(model):
    clash = model.model_copy(update={"parameters": (model.parameters[0].model_copy(update={"name": "push"}),)})
    with pytest.raises(FmuValueError, match=r"the variables \['push'\] would exist twice"):
        Slave(clash, simulation_factory=FakeSimulation)


def test_sources_that_are_no_models_are_refused():
    with pytest.raises(TypeError, match=r"a Model or a Scenario is needed, not str"):
        Slave("ball")


def test_own_equations_are_refused_with_the_reason(tmp_path):
    system = EquationSystem(mass=np.eye(1), force=np.zeros(1), q0=[0.0], v0=[1.0])
    for source in (system, SimpleNamespace(model=system)):
        with pytest.raises(SourceError, match=r"embeds its model as data.*user functions are code.*Simulation"):
            Slave(source)
        with pytest.raises(TlismniError, match="EquationSystem cannot become"):
            export_fmu(source, tmp_path / "x.fmu")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("given", ["x", b"x", None, 3])
def test_what_is_no_snapshot_is_refused(fake_slave, given):
    slave = started(fake_slave())
    before = slave.snapshot().data
    with pytest.raises(SnapshotError, match=f"not {type(given).__name__}; bytes go through snapshot_from_bytes"):
        slave.restore(given)
    assert slave.snapshot().data == before


@pytest.mark.parametrize("given", ["x", None, 3])
def test_what_are_no_bytes_is_refused(fake_slave, given):
    with pytest.raises(SnapshotError, match="the bytes of a stored state are needed"):
        fake_slave().snapshot_from_bytes(given)
