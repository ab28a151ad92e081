"""`tlismni warm`: what is compiled once is loaded after; what is no FMU of ours is said."""

from collections.abc import Callable
from typing import Any

import pytest

Command = Callable[..., Any]


def test_a_second_time_nothing_is_compiled(tlismni: Command) -> None:
    tlismni("warm", "pendulum_stop")
    done = tlismni("warm", "pendulum_stop", "--json")
    assert done.code == 0, done.err
    (target,) = done.json["targets"]
    assert target["name"] == "pendulum_stop" and target["functions"] == done.json["functions"] == 0
    assert target["folder"]


@pytest.mark.parametrize("bundle", [(), ("--bundle",)])
def test_an_fmu_is_warmed_with_its_own_package(
    tlismni: Command, tmp_path: Any, monkeypatch: pytest.MonkeyPatch, bundle: tuple[str, ...]
) -> None:
    if bundle:
        # a package of its own compiles everything anew: who it is, is enough here
        monkeypatch.setattr("tlismni.cli.warming.boot.create", lambda *arguments: _Calls())
    path = tmp_path / "x.fmu"
    assert tlismni("export", "pendulum_stop", "-o", path, *bundle).code == 0
    done = tlismni("warm", path, "--json")
    assert done.code == 0, done.err
    assert [target["functions"] for target in done.json["targets"]] == [0]


class _Calls:
    """What `boot.create` gives, as far as it matters."""

    class slave:
        @staticmethod
        def enter_initialization() -> None: ...

        @staticmethod
        def exit_initialization() -> None: ...


def test_what_cannot_be_warmed(tlismni: Command, tmp_path: Any) -> None:
    path = tmp_path / "x.fmu"
    path.write_text("no archive")
    done = tlismni("warm", path)
    assert done.code == 1 and "is no FMU made by tlismni" in done.err
    assert tlismni("warm", path, "--method", "irk").code == 2
    assert tlismni("warm", "--set", "mass=2").code == 2
    assert tlismni("warm", "no_such_scenario").code == 1
