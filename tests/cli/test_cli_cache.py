"""`tlismni cache`, what absent extras say, and the citation."""

import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from tlismni.core.compiled.reach import whole_digest

Command = Callable[..., Any]


@pytest.fixture
def kept(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A cache folder with code of these sources and of others, a package, and something that is not ours."""
    from tlismni.cli import cached

    place = tmp_path / "tlismni"
    for name in (whole_digest(), "0123456789abcdef", "packages", "notes"):
        (place / name).mkdir(parents=True)
        (place / name / "file").write_bytes(b"x" * 1000)
    monkeypatch.setattr(cached, "user_cache", lambda: tmp_path)
    monkeypatch.setattr(cached, "cache_folder", lambda: place)
    return place


def test_it_is_shown(tlismni: Command, kept: Path) -> None:
    found = {Path(entry["path"]).name: entry for entry in tlismni("cache", "--json").json["entries"]}
    assert set(found) == {whole_digest(), "0123456789abcdef", "packages"}
    assert found["0123456789abcdef"]["old"] and not found[whole_digest()]["old"]
    assert found["packages"]["bytes"] == 1000
    assert "in use" in tlismni("cache").out


def test_old_code_goes_and_the_rest_stays(tlismni: Command, kept: Path) -> None:
    done = tlismni("cache", "--clear", "old")
    assert done.code == 0 and "removed 1 folders" in done.err
    assert sorted(path.name for path in kept.iterdir()) == sorted([whole_digest(), "packages", "notes"])


def test_all_goes_but_what_is_not_ours(tlismni: Command, kept: Path) -> None:
    assert len(tlismni("cache", "--clear", "all", "--json").json["removed"]) == 3
    assert [path.name for path in kept.iterdir()] == ["notes"]
    assert tlismni("cache", "--clear", "some").code == 2


WITHOUT = """
import importlib.machinery, sys
absent = set(sys.argv[1].split(","))
real = importlib.machinery.PathFinder.find_spec

def find_spec(name, *arguments):
    return None if name.partition(".")[0] in absent else real(name, *arguments)

importlib.machinery.PathFinder.find_spec = staticmethod(find_spec)
from tlismni.models import load
ball = load("bouncing_ball")
try:
    exec(sys.argv[2])
except ImportError as error:
    print(error)
except Exception as error:
    print(type(error).__name__, error)
else:
    print("went through")
"""
RUN = "from tlismni.core import simulate; result = simulate(ball.model, 0.1); "


@pytest.mark.sampled(2)
@pytest.mark.parametrize(
    "absent, code, extra",
    [
        ("matplotlib", RUN + "result.plot('ball.y')", "plot"),
        ("pandas", RUN + "result.to_pandas()", "data"),
        ("xarray", RUN + "result.to_xarray()", "data"),
        ("pyarrow", RUN + "result.export('x.parquet')", "data"),
        ("PIL", RUN + "result.animate().save('x.gif')", "film"),
        ("imageio_ffmpeg", RUN + "result.animate().save('x.mp4')", "film"),
        ("pyarrow", "from tlismni.core.sweeps import sweep; sweep(ball.model, {'restitution': [0.5]}, 0.1)", "sweep"),
        (
            "dask,distributed",
            "from tlismni.core.sweeps import sweep; sweep(ball.model, {'restitution': [0.5]}, 0.1, cluster='tcp://x:1')",
            "sweep",
        ),
        ("lxml", "from tlismni.fmu_wrapper import export_fmu; export_fmu(ball, 'x.fmu')", "fmu"),
        ("fmpy", "from tlismni.fmu_wrapper.in_process import fmi2_in_process", "fmu"),
        ("exudyn", "from tlismni.validation import crosscheck; crosscheck('bouncing_ball')", "validation"),
        ("jinja2", "from tlismni.validation.report import environment; environment()", "validation"),
    ],
)
def test_an_absent_extra_says_what_to_install(absent: str, code: str, extra: str, tmp_path: Path) -> None:
    done = subprocess.run(
        [sys.executable, "-c", WITHOUT, absent, code], capture_output=True, text=True, timeout=1200, check=False,
        cwd=tmp_path,
    )  # fmt: skip
    said = done.stdout.strip().splitlines()[-1] if done.stdout.strip() else done.stderr
    assert f"tlismni[{extra}]" in said and "pip install" in said, said


def test_the_citation_has_the_version_of_the_package() -> None:
    root = Path(__file__).parents[2]
    text = (root / "CITATION.cff").read_text()
    version = next(line for line in (root / "pyproject.toml").read_text().splitlines() if line.startswith("version = "))
    number = version.split('"')[1]
    assert f"version: {number}" in text
