"""`tlismni`, `list`, `methods`: help, figures, and the command as a process."""

from collections.abc import Callable
from typing import Any

import pytest
import tlismni.cli as cli
from tlismni.cli.screen import compile_notice, number, plain, shortened
from tlismni.core.methods.automatic import METHOD_NAMES, described
from tlismni.models import catalogue, names

COMMANDS = ("list", "methods", "run", "export", "warm", "cosim", "crosscheck")

Command = Callable[..., Any]


def test_help_names_every_command(tlismni: Command) -> None:
    done = tlismni("--help")
    assert done.code == 0
    assert all(command in done.out for command in COMMANDS)


@pytest.mark.parametrize("command", COMMANDS)
def test_help_of_every_command_has_examples(tlismni: Command, command: str) -> None:
    done = tlismni(command, "--help")
    assert done.code == 0
    assert "Examples:" in done.out and "--json" in done.out
    assert "SETS" not in done.out


def test_list_shows_all_scenarios(tlismni: Command) -> None:
    done = tlismni("list")
    assert done.code == 0
    assert all(name in done.out for name in names())
    # one screen, not the parameters of all
    assert len(done.out.splitlines()) < 2 * len(names())


def test_list_of_one_shows_its_parameters(tlismni: Command) -> None:
    done = tlismni("list", "pendulum_stop")
    assert all(word in done.out for word in ("restitution", "length", "kg"))


def test_list_json_is_the_catalogue(tlismni: Command) -> None:
    scenarios = {s["name"]: s for s in tlismni("list", "--json").json["scenarios"]}
    assert set(scenarios) == set(names())
    for entry in catalogue():
        shown = scenarios[entry.name]["parameters"]
        assert [p["name"] for p in shown] == [p.name for p in entry.parameters]
        assert [p["default"] for p in shown] == [p.default for p in entry.parameters]
        assert all(p["unit"] for p in shown)


def test_list_of_one_scenario(tlismni: Command) -> None:
    assert [s["name"] for s in tlismni("list", "chain", "--json").json["scenarios"]] == ["chain"]
    assert tlismni("list", "train").code == 1


def test_methods(tlismni: Command) -> None:
    done = tlismni("methods")
    assert all(name in done.out for name in METHOD_NAMES)
    shown = {
        m["name"]: {o["name"]: o["default"] for o in m["options"]} for m in tlismni("methods", "--json").json["methods"]
    }
    assert shown == {name: {o: v.default for o, v in described(name).options.items()} for name in METHOD_NAMES}


def test_without_typer_one_line_says_what_to_install(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(cli, "find_spec", lambda name: None)
    with pytest.raises(SystemExit) as stop:
        cli.main()
    assert stop.value.code == 1
    assert capsys.readouterr().err == 'tlismni: the command needs typer and rich: pip install "tlismni[cli]"\n'


def test_the_process(process: Command) -> None:
    done = process("run", "no_such_scenario")
    assert (done.code, done.out) == (1, "")
    assert done.cause.startswith("tlismni: there is no scenario")
    done = process("run", "no_such_scenario", "--debug")
    assert done.code == 1 and "Traceback" in done.err and "ScenarioError" in done.err
    assert process("--version").out.strip().count(".") == 2


def test_help_does_not_load_the_solver() -> None:
    import subprocess
    import sys

    code = (
        "import sys, tlismni.cli.app; heavy = {'numba', 'numpy', 'scipy', 'pydantic', 'matplotlib'} & set(sys.modules);"
        "sys.exit(str(heavy) if heavy else 0)"
    )
    subprocess.run([sys.executable, "-c", code], check=True, timeout=1200)


def test_compile_notice_is_given_once_and_only_if_something_is_compiled(capsys: pytest.CaptureFixture[str]) -> None:
    from tlismni.core.compiled import notices

    with compile_notice(), notices.compile_notices("the ball"):
        pass
    assert capsys.readouterr().err == ""
    with compile_notice(), notices.compile_notices("the ball"):
        for name in ("first", "second"):
            notices.begin(name)
            notices.end(name, 0.5)
    begun, done = capsys.readouterr().err.splitlines()
    assert begun == "compiling for this machine what the ball needs, once: it can take a minute"
    assert done.startswith("compiled 2 functions in 1.0 s for the ball")


def test_numbers_and_plain_data() -> None:
    import numpy as np

    assert number(0.123456789) == "0.123457" and number(3) == "3" and number(True) == "True"
    assert plain({"a": np.float64("nan"), "b": np.arange(2), "c": (1.5, None, "x")}) == {
        "a": None, "b": [0, 1], "c": [1.5, None, "x"],
    }  # fmt: skip
    rows = shortened([(k, "x") for k in range(100)], most=10)
    assert len(rows) == 11 and rows[5] == ["… 90 more …", ""]
