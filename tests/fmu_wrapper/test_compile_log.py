"""A master hears that functions are compiled, when it instantiates: what it is told, in which category, and when."""

import logging
from collections.abc import Callable
from typing import Any

import pytest
from fake_simulation import FakeSimulation
from fmu_helpers import ball_model
from tlismni.core.compiled import notices
from tlismni.core.errors import ModelError
from tlismni.fmu_wrapper import Slave
from tlismni.fmu_wrapper import log as logs
from tlismni.fmu_wrapper.embedded import read_slave
from tlismni.fmu_wrapper.errors import Status
from tlismni.fmu_wrapper.fmi2_calls import Fmi2Calls
from tlismni.fmu_wrapper.fmi3_calls import Fmi3Calls
from tlismni.fmu_wrapper.snapshot import Snapshot

BUILT: list[float] = []


class Compiling(FakeSimulation):
    """Compiles, as far as others hear; and notes from where it starts."""

    def __init__(self, *arguments: Any, t0: float = 0.0, **options: Any) -> None:
        BUILT.append(t0)
        notices.begin("a function")
        notices.tell(logging.WARNING, "no place")
        notices.end("a function", 12.3)
        super().__init__(*arguments, t0=t0, **options)


def prepared(heard: list[Any], logging_on: bool = False, factory: Callable[..., Any] = Compiling) -> Slave:
    described = Slave(ball_model(), simulation_factory=FakeSimulation).variables
    BUILT.clear()
    slave = Slave(
        ball_model(), simulation_factory=factory, variables=described, logging_on=logging_on,
        on_log=lambda *message: heard.append(message),
    )  # fmt: skip
    slave.prepare()
    return slave


def test_beginning_and_end_are_logged_at_instantiation(caplog):
    caplog.set_level(logging.INFO)
    heard: list[Any] = []
    prepared(heard, logging_on=True)
    assert [(status, category) for status, category, _ in heard] == [
        (Status.OK, logs.COMPILATION), (Status.WARNING, logs.COMPILATION), (Status.OK, logs.COMPILATION),
    ]  # fmt: skip
    texts = [text for *_, text in heard]
    assert texts[0].startswith("compiling") and "compiled 1 function in 12.3 s" in texts[2]
    assert [record.getMessage() for record in caplog.records] == texts  # and from Python, once
    caplog.clear()
    prepared(heard := [])
    assert heard == [] and len(caplog.records) == 3  # a master that wants no log gets none


@pytest.mark.parametrize("calls", [Fmi2Calls, Fmi3Calls])
def test_the_category_can_be_switched_off_by_its_name(calls):
    heard: list[Any] = []
    slave = prepared(heard, logging_on=True)
    heard.clear()
    set_logging = f"{'fmi2' if calls is Fmi2Calls else 'fmi3'}SetDebugLogging"
    assert getattr(calls(slave), set_logging)(0, [logs.COMPILATION.encode()]) == Status.OK
    slave.enter_initialization()
    slave.set_by_name({"solver.rtol": 1e-8})
    slave.exit_initialization()
    assert heard == [] and BUILT == [0.0, 0.0]


def test_what_was_built_at_instantiation_is_used():
    slave = prepared([])
    slave.enter_initialization()
    slave.exit_initialization()
    slave.do_step(0.0, 0.5)
    assert BUILT == [0.0]
    slave.reset()
    slave.setup(start_time=2.0)
    slave.enter_initialization()
    slave.exit_initialization()
    assert BUILT == [0.0, 2.0]
    other = prepared([])
    other.setup(start_time=3.0)
    other.enter_initialization()
    other.exit_initialization()
    assert BUILT == [0.0, 3.0]
    assert other.time == 3.0


def test_a_prepared_slave_is_as_a_new_one():
    one, other = prepared([]), prepared([], factory=FakeSimulation)
    for slave in (one, other):
        slave.enter_initialization()
        slave.exit_initialization()
        slave.do_step(0.0, 1.0)
    first, second = one.snapshot(), other.snapshot()
    assert isinstance(first, Snapshot) and first.data == second.data


def test_a_model_that_cannot_be_built_is_told_when_initialization_ends():
    """Parameters may come that make it sound."""

    def refusing(*arguments: Any, **options: Any) -> Any:
        raise ModelError("not like this")

    slave = prepared([], factory=refusing)
    slave.enter_initialization()
    with pytest.raises(ModelError, match="not like this"):
        slave.exit_initialization()


def test_an_fmu_is_prepared_when_it_is_read(fake_fmu, tmp_path, monkeypatch):
    import zipfile

    import tlismni.core

    path = fake_fmu()
    with zipfile.ZipFile(path) as archive:
        archive.extractall(tmp_path / "fmu")
    monkeypatch.setattr(tlismni.core, "Simulation", Compiling)
    heard: list[Any] = []
    read_slave(tmp_path / "fmu" / "resources", logging_on=True, on_log=lambda *m: heard.append(m))
    assert [category for _, category, _ in heard] == [logs.COMPILATION] * 3
