"""No file imports one that imports it, on whatever way round, also where an import waits inside a function."""

import ast
from collections.abc import Iterator
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PACKAGES = ("core", "models", "viewer", "fmu_wrapper", "validation", "cli")


def modules(package):
    """Every module of the package with its file."""
    for path in sorted((ROOT / package).rglob("*.py")):
        parts = path.relative_to(ROOT).with_suffix("").parts
        yield ".".join(parts[:-1] if parts[-1] == "__init__" else parts), path


def statements(body: list[ast.stmt]) -> Iterator[ast.stmt]:
    """All statements, those for the type checker alone left out."""
    for node in body:
        if isinstance(node, ast.If) and "TYPE_CHECKING" in ast.unparse(node.test):
            yield from statements(node.orelse)
            continue
        yield node
        for _, inner in ast.iter_fields(node):
            if isinstance(inner, list):
                yield from statements([x for x in inner if isinstance(x, ast.stmt)])
                for handler in (x for x in inner if isinstance(x, ast.ExceptHandler | ast.match_case)):
                    yield from statements(handler.body)


def imports(name, path, known):
    """The modules among `known` that a module imports."""
    package = name if path.name == "__init__.py" else name.rpartition(".")[0]
    for node in statements(ast.parse(path.read_text(encoding="utf-8")).body):
        if isinstance(node, ast.ImportFrom):
            above = package.split(".")[: len(package.split(".")) - node.level + 1] if node.level else []
            base = ".".join([*above, *(node.module.split(".") if node.module else [])]).removeprefix("tlismni.")
            names = [f"{base}.{alias.name}" for alias in node.names]
        elif isinstance(node, ast.Import):
            base, names = "", [alias.name.removeprefix("tlismni.") for alias in node.names]
        else:
            continue
        yield from (found if found in known else base for found in names if found in known or base in known)


@pytest.fixture(scope="module")
def graph():
    known = {name: path for package in PACKAGES for name, path in modules(package)}
    return {name: set(imports(name, path, known)) - {name} for name, path in known.items()}


def folder(name, path):
    """Where a module stands; files of core itself stand alone."""
    parts = name.split(".")
    if parts[0] != "core" or len(parts) == 1:
        return parts[0]
    return parts[1] if len(parts) > 2 or path.name == "__init__.py" else name


@pytest.fixture(scope="module")
def folders(graph):
    where = {name: folder(name, path) for package in PACKAGES for name, path in modules(package)}
    found = {place: set() for place in where.values()}
    for name, targets in graph.items():
        found[where[name]] |= {where[target] for target in targets} - {where[name]}
    return found


def circle(graph):
    try:
        TopologicalSorter(graph).prepare()
    except CycleError as error:
        return error.args[1]
    return None


def test_no_circle_of_imports(graph):
    assert circle(graph) is None


def test_it_would_be_found(graph):
    """Imports inside functions count, and those of the real files are seen."""
    assert "core.assembly.assembly" in graph["core.multibody_model"]
    assert "core.simulation.simulation" in graph["core.simulate_one"]
    assert circle({**graph, "core.errors": {"core.simulate_one"}}) is not None


def test_arrows_between_folders_point_one_way(folders):
    assert circle(folders) is None
    assert "assembly" in folders["stage"] and "simulation" in folders["native"]
    assert circle({**folders, "linalg": folders["linalg"] | {"simulation"}}) is not None


def test_the_core_knows_none_of_the_packages_beside_it(graph):
    for name, targets in graph.items():
        if name.startswith("core"):
            assert all(target.startswith("core") for target in targets), name


BELOW_SIMULATION = (
    "compiled model elements laws linalg contacts state assembly stage methods contact_solvers event_detection events "
    "time_loop equations"
)


@pytest.mark.sampled(5)
@pytest.mark.parametrize("place", BELOW_SIMULATION.split())
def test_nothing_below_simulation_takes_a_whole_simulation(place):
    files = sorted((ROOT / "core" / place).rglob("*.py"))
    assert files
    for path in files:
        names = {
            node.id for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))) if isinstance(node, ast.Name)
        }
        texts = {
            word
            for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
            if isinstance(node, ast.arg) and isinstance(node.annotation, ast.Constant)
            for word in str(node.annotation.value).split()
        }
        assert not {"Simulation", "Engine", "ContactSide"} & (names | texts), path
