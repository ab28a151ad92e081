"""Slaves and FMUs on the fake simulation."""

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import lark
import pytest
import tlismni.core
from fake_simulation import FakeSimulation
from fmu_helpers import Messages, ball_model
from tlismni.core.multibody_model import Model
from tlismni.fmu_wrapper import Slave, export_fmu


@pytest.fixture(scope="session", autouse=True)
def names_parsed_once() -> Iterator[None]:
    """fmpy parses the name of each variable of each FMU that it reads, by a grammar, in milliseconds; what the grammar
    has accepted is not parsed again. Of the trees fmpy makes no use."""
    accepted: set[tuple[str, str]] = set()
    parse = lark.Lark.parse

    def once(parser: lark.Lark, text: str) -> None:
        if (parser.source_grammar, text) not in accepted:
            parse(parser, text)
            accepted.add((parser.source_grammar, text))

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(lark.Lark, "parse", once)
        yield


@pytest.fixture
def model() -> Model:
    return ball_model()


@pytest.fixture
def messages() -> Messages:
    return Messages()


@pytest.fixture
def fake_slave(model: Model, messages: Messages) -> Callable[..., Slave]:
    """Makes slaves on the fake simulation."""

    def make(**arguments: Any) -> Slave:
        return Slave(model, simulation_factory=FakeSimulation, on_log=messages, **arguments)

    return make


@pytest.fixture
def fake_core(monkeypatch: pytest.MonkeyPatch) -> None:
    """Everything in this process, FMUs too, runs on the fake simulation."""
    monkeypatch.setattr(tlismni.core, "Simulation", FakeSimulation, raising=False)


@pytest.fixture
def fake_fmu(fake_core: None, model: Model, tmp_path: Path) -> Callable[..., Path]:
    """Exports FMUs that run on the fake simulation in this process."""

    def make(name: str = "ball.fmu", source: Any = model, **arguments: Any) -> Path:
        return export_fmu(source, tmp_path / name, **{"t_end": 2.0, **arguments})

    return make
