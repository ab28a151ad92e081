"""docs/architecture.md and docs/notes name files and folders that exist; the map names every folder of the core."""

import re
from functools import cache
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
PAGES = [DOCS / "architecture.md", *sorted((DOCS / "notes").glob("*.md"))]
FILE = re.compile(r"`((?:[\w.-]+/)*[\w.-]+\.(?:py|c|h|sh|json))`")
FOLDER = re.compile(r"`((?:core|models|viewer|fmu_wrapper|validation|cli|tests|benchmarks)(?:/\w+)*)/?`")
MOST_LINES = 250


@cache
def sources() -> list[str]:
    """Paths of all files of the packages, the tests and the benchmarks."""
    folders = ("core", "models", "viewer", "fmu_wrapper", "validation", "cli", "tests", "benchmarks")
    return [path.relative_to(ROOT).as_posix() for folder in folders for path in (ROOT / folder).rglob("*.*")]


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_files_and_folders_exist(page: Path) -> None:
    text = page.read_text(encoding="utf-8")
    names = FILE.findall(text)
    for name in names:
        assert any(f"/{path}".endswith(f"/{name}") for path in sources()), f"{page.name} names {name}"
    for name in FOLDER.findall(text):
        assert (ROOT / name).is_dir(), f"{page.name} names {name}"
    assert page.name != "architecture.md" or len(names) > 100


def test_the_map_has_every_folder_of_the_core_and_stays_a_map() -> None:
    text = (DOCS / "architecture.md").read_text(encoding="utf-8")
    table = "\n".join(line for line in text.splitlines() if line.startswith("| `"))
    packages = {path.parent.name for path in (ROOT / "core").glob("*/__init__.py")}
    assert packages <= set(re.findall(r"`(\w+)`", table))
    assert len(text.splitlines()) <= MOST_LINES
