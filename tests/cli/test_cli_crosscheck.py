"""`tlismni crosscheck`."""

import sys
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from tlismni.validation import crosscheck, exudyn_available

needs_exudyn = pytest.mark.skipif(not exudyn_available(), reason="exudyn cannot be imported")

Command = Callable[..., Any]


@needs_exudyn
def test_agreement_is_exit_code_0(tlismni: Command, tmp_path: Path) -> None:
    done = tlismni(
        "crosscheck", "pendulum", "--set", "angle=0.1", "--t-end", 0.6, "--report", tmp_path / "report", "--json"
    )
    assert done.code == 0
    figures = done.json
    assert figures["ok"] is True and figures["parameters"]["angle"] == 0.1
    assert {row["verdict"] for row in figures["rows"]} == {"agree"}
    assert Path(figures["report"]).is_file()


def _found(ok: bool) -> Any:
    row = SimpleNamespace(quantity="ball.y", required=True, verdict="agree" if ok else "differ")
    numbers = {"unit": "m", "ours": 1.0, "exudyn": 1.5, "difference": 0.5, "relative": 0.33, "tolerance": 0.1}
    data = {
        "scenario": "bouncing_ball", "kind": "made up", "exudyn": {"version": "1.13"}, "ok": ok, "notes": ["a note"],
        "rows": [{"quantity": row.quantity, "verdict": row.verdict, "tolerance_kind": "absolute", **numbers}],
    }  # fmt: skip
    return SimpleNamespace(ok=ok, rows=(row,), report=None, figures=(), to_dict=lambda: data)


@pytest.mark.parametrize("ok", [True, False])
def test_the_verdict_decides_the_exit_code(tlismni: Command, monkeypatch: pytest.MonkeyPatch, ok: bool) -> None:
    monkeypatch.setattr("tlismni.validation.crosscheck", lambda *args, **kwargs: _found(ok))
    done = tlismni("crosscheck", "bouncing_ball")
    assert done.code == (0 if ok else 1)
    assert "ball.y" in done.out and "a note" in done.out
    assert ok or done.err.splitlines()[-1] == "tlismni: 1 of 1 quantities differ: ball.y"


def test_a_report_that_cannot_be_written_is_refused_before_the_work(
    tlismni: Command, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    def never(*args: object, **kwargs: object) -> None:
        raise AssertionError("the work was begun")

    monkeypatch.setattr("tlismni.validation.crosscheck", never)
    file = tmp_path / "file"
    file.write_text("")
    for target in (file, file / "report"):
        done = tlismni("crosscheck", "bouncing_ball", "--report", target)
        assert done.code == 1 and f"'{target}' cannot be written" in done.cause


@needs_exudyn
def test_a_report_folder_that_cannot_be_made_is_refused_before_the_work(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    def never(*args: object, **kwargs: object) -> None:
        raise AssertionError("the work was begun")

    module = sys.modules["tlismni.validation.crosscheck"]
    monkeypatch.setattr(module, "compare_constraints", never)
    (tmp_path / "file").write_text("")
    with pytest.raises(OSError, match="file"):
        crosscheck("bouncing_ball", tmp_path / "file" / "report")
