"""`tlismni study`."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from tlismni.core import METHODS
from tlismni.validation.study import order_cases

Command = Callable[..., Any]
PNG = b"\x89PNG"


@pytest.fixture
def once(monkeypatch: pytest.MonkeyPatch) -> Callable[[str], None]:
    """`once(name)`: this study is run at its first call; later ones, for other forms of its results, take them."""
    from tlismni.validation import study

    def keep(name: str) -> None:
        run, made = getattr(study, name), []

        def runs_once(*arguments: Any, **options: Any) -> Any:
            if not made:
                made.append(run(*arguments, **options))
            return made[0]

        monkeypatch.setattr(study, name, runs_once)

    return keep


def test_orders_as_a_table(tlismni: Command) -> None:
    done = tlismni("study", "orders", "--method", "hht", "--method", "park", "--quick")
    assert done.code == 0
    for case in order_cases(["hht", "park"]):
        (line,) = [line for line in done.out.splitlines() if line.startswith(f" {case.setting.label} ")]
        assert line.split()[-1] == "agree"


def test_orders_as_json_and_figure(tlismni: Command, tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    done = tlismni("study", "orders", "-m", "adams", "--quick", "--json", "--plot", tmp_path / "orders.png")
    assert done.code == 0
    figures = done.json
    assert [row["options"]["order"] for row in figures["rows"]] == [2, 3, 4, 5, 6, 7, 8]
    for row in figures["rows"]:
        assert row["observed"]["multiplier"] == pytest.approx(row["theory"]["multiplier"], abs=0.2)
        assert len(row["steps"]) == len(row["errors"]["velocity"]) >= 5
    assert figures["files"] == [str(tmp_path / "orders.png")]
    assert (tmp_path / "orders.png").read_bytes().startswith(PNG)


def test_an_order_off_its_theory_is_exit_code_1(tlismni: Command, monkeypatch: pytest.MonkeyPatch) -> None:
    """`park` put in the place of a method that is said to have order 3."""
    monkeypatch.setitem(METHODS, "adams", METHODS["park"])
    monkeypatch.setattr("tlismni.validation.study.cases.ORDER_CASES", _claiming_order_3())
    done = tlismni("study", "orders", "-m", "adams", "--quick")
    assert done.code == 1
    assert "differ" in done.out
    assert done.err.splitlines()[-1] == "tlismni: 1 of 1 orders are off their theory: adams"


def _claiming_order_3() -> Any:
    from tlismni.validation.study.cases import OrderCase, Setting

    return (OrderCase(Setting("adams"), 3),)


def test_iterations(tlismni: Command, tmp_path: Path, once: Callable[[str], None]) -> None:
    pytest.importorskip("matplotlib")
    once("iteration_study")
    arguments = ("study", "iterations", "--quick", "-s", "chain", "-m", "hht", "-m", "ebdf")
    done = tlismni(*arguments, "--json", "--plot", tmp_path / "iterations.png")
    assert done.code == 0
    figures = done.json
    assert [claim["name"] for claim in figures["claims"]] == ["C1", "C2", "C3"]
    assert {run["outer"] for run in figures["runs"]} == {"newton", "simple"}
    assert (tmp_path / "iterations.png").read_bytes().startswith(PNG)
    printed = tlismni(*arguments)
    assert printed.code == 0
    text = printed.out
    for run in figures["runs"]:
        if run["tolerance"] == 1e-7 and run["label"] == "hht":
            assert str(run["outer_iterations"]) in text and f"{run['error']:.1e}" in text
    for claim in figures["claims"]:
        assert f"{claim['name']}: {claim['claim']}" in " ".join(text.split())
        assert claim["verdict"].upper() in text


@pytest.mark.parametrize(
    "arguments, cause",
    [
        (("orders", "--method", "nope"), "unknown method ['nope']"),
        (("iterations", "--method", "nope", "--quick"), "unknown method ['nope']"),
        (("iterations", "--scenario", "nope", "--quick"), "unknown scenario 'nope'"),
    ],
)
def test_unknown_names_are_one_line(tlismni: Command, arguments: tuple[str, ...], cause: str) -> None:
    done = tlismni("study", *arguments)
    assert done.code == 1 and not done.out
    assert cause in done.cause


@pytest.mark.parametrize("command", ["orders", "iterations"])
def test_an_unknown_kind_of_figure_is_refused_before_any_work(tlismni: Command, command: str) -> None:
    done = tlismni("study", command, "--plot", "figure.gif")
    assert done.code == 2 and "must end in .png or .pdf or .svg" in " ".join(done.err.split())


def test_help_names_both_parts(tlismni: Command) -> None:
    done = tlismni("study", "--help")
    assert done.code == 0 and "orders" in done.out and "iterations" in done.out


def test_impacts(tlismni: Command, once: Callable[[str], None]) -> None:
    once("impact_orders")
    done = tlismni("study", "impacts", "--quick", "-m", "park")
    assert done.code == 0
    (line,) = [line for line in done.out.splitlines() if line.startswith(" park ")]
    assert line.split()[-1] == "kept"
    assert tlismni("study", "impacts", "--quick", "-m", "park", "--json").json["rows"][0]["verdict"] == "kept"


def test_contact(tlismni: Command, monkeypatch: pytest.MonkeyPatch, once: Callable[[str], None]) -> None:
    """With two settings and one problem, so that it is short."""
    from tlismni.validation.study.cases import Setting

    once("contact_study")

    monkeypatch.setattr("tlismni.validation.study.contact_failure.PROBLEMS", _first_problem())
    monkeypatch.setattr("tlismni.validation.study.contact_failure.SETTINGS", (Setting("ebdf"), Setting("baumgarte")))
    done = tlismni("study", "contact", "--quick")
    assert done.code == 0
    lines = [line.split() for line in done.out.splitlines() if line.startswith((" ebdf ", " baumgarte "))]
    assert [(line[1], line[-1]) for line in lines if line[1] == "yes"] == [("yes", "none")] * 2
    assert all(line[-1] != "none" for line in lines if line[1] == "no")
    figures = tlismni("study", "contact", "--quick", "--json").json
    assert figures["claims"][0]["name"] == "C4" and len(figures["rows"]) == 4


def test_stiffness(tlismni: Command, monkeypatch: pytest.MonkeyPatch) -> None:
    from tlismni.validation.study import STIFFNESS_CASES

    monkeypatch.setattr("tlismni.validation.study.stiffness.CASES", STIFFNESS_CASES[3:4])
    done = tlismni("study", "stiffness", "--quick", "--json")
    assert done.code == 0
    (row,) = done.json["rows"]
    assert row["observed"]["position"] == pytest.approx(row["theory"], abs=0.03)


def _first_problem() -> Any:
    from tlismni.validation.study.contact_failure import PROBLEMS

    return PROBLEMS[:1]


def test_damping(tlismni: Command, monkeypatch: pytest.MonkeyPatch, tmp_path: Any) -> None:
    from tlismni.validation.study import damping

    monkeypatch.setattr(damping, "problems", lambda: (damping._rod(1.0, 20),))
    done = tlismni("study", "damping", "--quick", "--json", "--plot", str(tmp_path / "d.png"))
    assert done.code == 0 and (tmp_path / "d.png").stat().st_size > 10_000
    assert {row["method"] for row in done.json["rows"]} == {"hht", "hht_ggl"}
    (claim,) = done.json["claims"]
    assert claim["name"] == "C5" and claim["verdict"] == "does not hold here"


def test_coupling_as_table_json_and_figure(tlismni: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """With two contenders and two steps, to be quick."""
    pytest.importorskip("fmpy")
    from tlismni.validation.study import coupling
    from tlismni.validation.study.coupling_problems import JACOBI, NEWTON

    monkeypatch.setattr(coupling, "CONTENDERS", (JACOBI, NEWTON))
    monkeypatch.setattr(coupling, "CONTROLLED", ((NEWTON, "iteration"),))
    monkeypatch.setattr(coupling, "QUICK_STEPS", (1e-3, 5e-4))
    monkeypatch.setattr(coupling, "SHORTEST", 4e-3)
    monkeypatch.setattr(coupling, "FEWEST", 30)
    monkeypatch.setattr(coupling, "LONG_END", 0.04)
    monkeypatch.setattr(coupling, "LONG_STEPS", (2e-3,))
    monkeypatch.setattr(coupling, "TOLERANCES", (1.0, 1e-1))
    study = coupling.coupling_study(quick=True)
    monkeypatch.setattr(coupling, "coupling_study", lambda **arguments: study)
    done = tlismni("study", "coupling", "--quick", "--json", "--plot", tmp_path / "c.png")
    assert done.code == 0
    jacobi, newton = ([r for r in done.json["rows"] if r["contender"] == c.label] for c in (JACOBI, NEWTON))
    assert [r["step"] for r in jacobi] == pytest.approx([1e-3, 5e-4])
    assert all(n["error"] < 0.05 * j["error"] for j, n in zip(jacobi, newton, strict=True))
    beyond = {row["contender"]: row["beyond"] for row in done.json["stability"]}
    assert beyond == {JACOBI.label: "below", NEWTON.label: "none up to"}
    assert (tmp_path / "c.png").read_bytes().startswith(PNG)
    shown = tlismni("study", "coupling", "--quick").out
    assert all(text in shown for text in ("A blow", "A contact that stays", JACOBI.label, "observed orders"))


def test_methods_as_json_and_report(tlismni: Command, tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    pytest.importorskip("jinja2")
    arguments = ("study", "methods", "--quick", "-s", "pendulum_stop", "-m", "hht", "-m", "irk", "--processes", "1")
    done = tlismni(*arguments, "--json", "--report", tmp_path)
    assert done.code == 0
    labels = {row["label"] for row in done.json["rows"]}
    assert labels == {"hht", *(f"irk tableau={name}" for name in ("sdirk4", "gauss2", "radau3", "gauss3"))}
    for row in done.json["rows"]:
        assert row["best run: error"] < 1e-3 and row["cpu_time at 1e-03"] > 0.0 and not row["failure"]
    names = {Path(path).name for path in done.json["files"]}
    assert {"methods.html", "methods.json", "methods.csv", "methods_cpu_time.png"} <= names
    page = (tmp_path / "methods.html").read_text()
    assert "pendulum_stop" in page and "data:image/png;base64," in page
    again = tlismni(*arguments, "--report", tmp_path)  # from the records: nothing is run but the reference
    assert again.code == 0 and "Error 1e-03 of the motion, 1 scenarios" in again.out


def test_methods_in_two_processes(tlismni: Command, tmp_path: Path) -> None:
    done = tlismni("study", "methods", "--quick", "-s", "pendulum_stop", "-m", "hht", "--json",
                   "--records", tmp_path / "r.jsonl", "--processes", "2")  # fmt: skip
    assert done.code == 0 and len(done.json["pairs"]) == 1
    assert len((tmp_path / "r.jsonl").read_text().splitlines()) == 3  # header, reference, pair


def test_claims(tlismni: Command) -> None:
    done = tlismni("study", "claims", "C1", "--quick", "--json")
    assert done.code == 0
    (row,) = done.json["claims"]
    assert (row["name"], row["verdict"], row["command"]) == ("C1", "reproduced", "tlismni study claims C1")
    assert row["figures"]["highest"] == pytest.approx(2.0, abs=0.2)
    assert tlismni("study", "claims", "C8").code == 1
