"""What the code of a module depends on, read from the text of its imports, against Python's own parser."""

import ast
from pathlib import Path

from tlismni.core.compiled import reach
from tlismni.core.compiled.cache import folder_name

CORE = Path(reach.__file__).resolve().parents[1]


def parsed(path: Path) -> set[Path]:
    """The files of the core that a source imports, wherever in it."""
    found = set()
    for node in ast.walk(ast.parse(path.read_bytes())):
        if isinstance(node, ast.ImportFrom) and node.level:
            base = path.parents[node.level - 1].joinpath(*(node.module or "").split("."))
            names = [base.with_suffix(".py")]
            for alias in node.names:
                if alias.name == "*":  # for type checkers: what is taken from there is followed where it is taken
                    assert path.name == "__init__.py" and path.parents[1] == CORE
                    continue
                names += [base / f"{alias.name}.py", base / alias.name / "__init__.py"]
                if not any(name.is_file() for name in names):
                    names.append(base / "__init__.py")
            found |= {name for name in names if name.is_file() and name.is_relative_to(CORE)}
        elif isinstance(node, ast.ImportFrom | ast.Import):
            name = getattr(node, "module", None) or node.names[0].name
            assert not name.startswith("tlismni"), f"{path} imports the core by its name, which is not followed"
    return found


def test_every_import_is_followed() -> None:
    assert len(reach.sources()) > 300
    for path in reach.sources():
        missing = parsed(path) - set(reach.imported(path))
        assert not missing, (path, missing)


def test_a_name_of_a_folder_is_followed_to_its_module() -> None:
    assert CORE / "elements" / "cable3d.py" in reach.imported(CORE / "results" / "restart.py")


def test_code_depends_on_what_it_reaches_alone() -> None:
    kernel, solver, shape = (
        CORE / name for name in ("elements/planar_body.py", "stage/solver.py", "contacts/line2d.py")
    )
    jit = CORE / "compiled" / "jit.py"
    assert all(jit in reach.reached(path) for path in (kernel, solver, shape))
    assert shape not in reach.reached(solver) and kernel not in reach.reached(solver)
    assert len({folder_name(path) for path in (kernel, solver, shape)}) == 3
    assert {str(folder_name(path)) for path in (kernel, solver, shape)} <= reach.present_digests()


def test_own_sources_depend_on_all() -> None:
    assert folder_name(Path(__file__)).parts[0] == reach.whole_digest()
