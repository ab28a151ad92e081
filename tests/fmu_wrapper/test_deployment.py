"""FMUs on other machines: which Python a host without Python starts, and FMUs that carry the package along."""

import io
import json
import os
import runpy
import shutil
import subprocess
import sys
import sysconfig
import types
import venv
import zipfile
from importlib.metadata import version
from pathlib import Path

import fmpy
import pytest
from fmu_helpers import ball_model
from test_fmu_real import STEPS, Fmu, host, run_host  # noqa: F401
from tlismni.core.compiled.library import LIBM, LIBRARY, LIBRARY_VARIABLE, SUFFIX, USUAL_PLACE
from tlismni.fmu_wrapper import export_fmu
from tlismni.fmu_wrapper.bundle import package_archive
from tlismni.fmu_wrapper.libpython import requirements
from tlismni.fmu_wrapper.python_library import library_record, shared_library

needs_library = pytest.mark.skipif(shared_library() is None, reason="needs a Python with a shared library")
BOOT = Path(__file__).parents[2] / "fmu_wrapper" / "boot.py"
NEEDED = USUAL_PLACE.with_name("needed.py").read_bytes()
EMPTY = b"PK\x05\x06" + bytes(18)
"""A zip archive of nothing."""


@pytest.fixture(scope="module")
def ball(tmp_path_factory):
    return Fmu(ball_model(), tmp_path_factory.mktemp("installed"), t_end=2.0)


@pytest.fixture(scope="module")
def bundled(tmp_path_factory):
    return Fmu(ball_model(), tmp_path_factory.mktemp("bundled"), t_end=2.0, bundle=True)


def elsewhere(fmu, folder, **changes):
    """The FMU as if unzipped on a machine that has not the Python of the export; `changes` go into python.json."""
    moved = object.__new__(Fmu)
    moved.__dict__ |= fmu.__dict__
    moved.unzipped = str(folder / "moved")
    shutil.copytree(fmu.unzipped, moved.unzipped)
    resources = Path(moved.unzipped, "resources")
    (resources / "libpython.txt").write_text("/nowhere/libpython3.99.so\n/nowhere\n/nowhere/os.py\n")
    record = json.loads((resources / "python.json").read_text())
    (resources / "python.json").write_text(json.dumps({**record, "folders": ["/nowhere"], **changes}))
    return moved


def logged(done):
    return [line for line in done.stdout.splitlines() if line.startswith("log ")]


# finding Python


@needs_library
def test_the_python_that_is_named(host, ball, tmp_path):  # noqa: F811
    """TLISMNI_PYTHON, the executable of a venv, gives library, home and packages; values as with the recorded one."""
    expected = run_host(host, ball, tmp_path)
    done = run_host(host, elsewhere(ball, tmp_path), tmp_path, TLISMNI_PYTHON=sys.executable)
    assert done.returncode == 0, done.stdout + done.stderr
    assert done.stdout == expected.stdout and logged(done) == []


@needs_library
def test_the_library_that_is_named(host, ball, tmp_path):  # noqa: F811
    """TLISMNI_LIBPYTHON names the library alone; the packages are those recorded."""
    moved = elsewhere(
        ball, tmp_path, folders=json.loads(Path(ball.unzipped, "resources/python.json").read_text())["folders"]
    )
    done = run_host(host, moved, tmp_path, TLISMNI_LIBPYTHON=str(shared_library()))
    assert done.returncode == 0, done.stdout + done.stderr


@needs_library
@pytest.mark.parametrize("variables", [{}, {"TLISMNI_LIBPYTHON": str(shared_library())}])
def test_one_line_says_what_to_set(host, ball, tmp_path, variables):  # noqa: F811
    done = run_host(host, elsewhere(ball, tmp_path), tmp_path, **variables)
    assert done.returncode == 4
    (line,) = logged(done)
    assert "set the environment variable TLISMNI_PYTHON to the python executable of an environment that has" in line


@pytest.mark.parametrize(
    ("program", "message"),
    [
        ("/nowhere/python", "TLISMNI_PYTHON names '/nowhere/python', which does not run as a Python: set it to"),
        ("/bin/false", "TLISMNI_PYTHON names '/bin/false', which does not run as a Python"),
        ("/bin/true", "TLISMNI_PYTHON names '/bin/true', a Python without a shared library"),
    ],
)
def test_a_wrong_name_gives_one_line(host, ball, tmp_path, program, message):  # noqa: F811
    done = run_host(host, elsewhere(ball, tmp_path), tmp_path, TLISMNI_PYTHON=program)
    assert done.returncode == 4
    (line,) = logged(done)
    assert message in line


@needs_library
def test_a_library_without_its_standard_library_does_not_end_the_host(host, ball, tmp_path):  # noqa: F811
    """Python would end the process if it found no home: the shim looks first."""
    lone = tmp_path / "lone" / "lib" / Path(shared_library()).name
    lone.parent.mkdir(parents=True)
    shutil.copy(shared_library(), lone)
    done = run_host(host, elsewhere(ball, tmp_path), tmp_path, TLISMNI_LIBPYTHON=str(lone))
    assert done.returncode == 4, done.stderr
    (line,) = logged(done)
    assert "but not its standard library" in line and "TLISMNI_PYTHON" in line


def test_the_record_is_what_the_named_python_prints():
    script = BOOT.with_name("python_library.py")
    done = subprocess.run([sys.executable, "-I", str(script)], capture_output=True, text=True)
    assert done.stdout == library_record()
    assert done.stdout.splitlines()[1] == sys.base_prefix


# the package inside


def bare_python(folder):
    """A venv with the third-party packages of this one, but without tlismni."""
    venv.create(folder, with_pip=False)
    python = folder / ("Scripts" if os.name == "nt" else "bin") / "python"
    inside = subprocess.run(
        [str(python), "-c", "import sysconfig; print(sysconfig.get_path('purelib'))"], capture_output=True, text=True
    )
    # the folder itself, not its .pth files, among them that of an editable tlismni
    packages = Path(inside.stdout.strip(), "packages")
    packages.mkdir()
    for entry in Path(sysconfig.get_path("purelib")).iterdir():
        if "tlismni" not in entry.name and entry.suffix != ".pth":
            (packages / entry.name).symlink_to(entry)
    Path(inside.stdout.strip(), "third.pth").write_text(f"{packages}\n")
    return python


STEPPING = """
import sys, fmpy
from fmpy.fmi2 import FMU2Slave
try:
    import tlismni.core
    raise SystemExit("tlismni is there")
except ImportError:
    pass
description = fmpy.read_model_description(sys.argv[1])
fmu = FMU2Slave(guid=description.guid, unzipDirectory=sys.argv[1],
                modelIdentifier=description.coSimulation.modelIdentifier)
fmu.instantiate()
fmu.enterInitializationMode()
fmu.exitInitializationMode()
path = list(sys.path)
y = next(v.valueReference for v in description.modelVariables if v.name == "ball.y")
for k in range({steps}):
    fmu.doStep(k * 0.1, 0.1)
    print(fmu.getReal([y])[0].hex())
assert not [name for name in sys.modules if name == "tlismni" or name.startswith("tlismni.")]
print("numba" in sys.modules)
"""


@pytest.mark.slow  # without the library of machine code: compiles once for each state of the sources
def test_a_bundled_fmu_needs_no_tlismni(bundled, tmp_path):
    """In a venv with the third-party packages alone: the values are those of this process, and where this process has
    machine code ahead of time nothing is compiled."""
    moved = elsewhere(bundled, tmp_path)
    command = [str(bare_python(tmp_path / "venv")), "-c", STEPPING.replace("{steps}", str(STEPS)), moved.unzipped]
    done = subprocess.run(command, capture_output=True, text=True, timeout=1200)
    assert done.returncode == 0, done.stdout + done.stderr
    fmu, expected = bundled.instance(), []
    for k in range(STEPS):
        fmu.doStep(k * 0.1, 0.1)
        expected.append(fmu.getReal([bundled.vr["ball.y"]])[0].hex())
    *values, compiles = done.stdout.split()
    assert values == expected and compiles == str(LIBRARY is None)


WHICH = """
import sys
sys.path.insert(0, sys.argv[1])
from carried.core.compiled import library
print(library.LIBRARY is not None, "numba" in sys.modules, library.REFUSED)
"""


def library_of(folder, bundle=None, **files):
    """What the package of `bundle` says of its machine code, with other content of `files` in `core/compiled`."""
    with zipfile.ZipFile(io.BytesIO(bundle or package_archive()[0])) as content:
        content.extractall(folder / "carried")
    for name, data in files.items():
        (folder / "carried" / "core" / "compiled" / name).write_bytes(data)
    environment = {k: v for k, v in os.environ.items() if k not in (LIBRARY_VARIABLE, LIBM)}
    command = [sys.executable, "-c", WHICH, str(folder)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=1200, env=environment)
    assert done.returncode == 0, done.stderr
    there, numba, *why = done.stdout.split(maxsplit=2)
    return there == "True", numba == "True", "".join(why).strip()


@pytest.mark.skipif(LIBRARY is None, reason="needs the library of machine code")
def test_a_bundle_has_the_machine_code(tmp_path):
    """And leaves it alone beside other sources."""
    archive = package_archive()[0]
    assert library_of(tmp_path / "same", archive) == (True, False, "")
    there, numba, why = library_of(tmp_path / "edited", archive, **{"needed.py": NEEDED + b"# edited"})
    assert not there and numba and "is of other sources" in why and "a minute or two" in why


def test_machine_code_of_another_platform_is_said_to_be_left_alone(tmp_path):
    """A file that does not load, and one of another system, are no errors."""
    foreign = {f"tlismni_core{SUFFIX}": b"\x7fELF of another processor"}
    there, numba, why = library_of(tmp_path / "processor", **foreign)
    assert not there and numba and "cannot be loaded here" in why
    other = ".dll" if SUFFIX != ".dll" else ".so"
    with zipfile.ZipFile(io.BytesIO(package_archive()[0])) as content:
        names = [name for name in content.namelist() if not name.endswith(SUFFIX)]
        content.extractall(tmp_path / "system" / "carried", names)
    there, numba, why = library_of(tmp_path / "system", EMPTY, **{f"tlismni_core{other}": b"MZ"})
    assert not there and numba and "is for another system" in why


def test_bundled_and_installed_live_side_by_side(ball, bundled):
    """Both in one process: each has its own modules, and they agree."""
    rows = [fmu.step(fmu.instance(), 0, STEPS) for fmu in (ball, bundled)]
    assert rows[0] == rows[1]
    packages = {name.split(".")[0] for name in sys.modules if name.startswith("tlismni")}
    assert {"tlismni", f"tlismni_{package_archive()[1]}"} <= packages


@needs_library
def test_a_bundled_fmu_in_a_host_without_python(host, ball, bundled, tmp_path):  # noqa: F811
    python = bare_python(tmp_path / "venv")
    done = run_host(host, elsewhere(bundled, tmp_path), tmp_path, TLISMNI_PYTHON=str(python))
    assert done.returncode == 0, done.stdout + done.stderr
    assert done.stdout == run_host(host, ball, tmp_path).stdout


@needs_library
def test_missing_packages_are_named(host, bundled, tmp_path):  # noqa: F811
    """Those that are not there, and those that are too old."""
    python = bare_python(tmp_path / "venv")
    for entry in tmp_path.glob("venv/lib/*/site-packages/packages/numba"):
        entry.unlink()
    requires = [*requirements(), ("packaging", "9999.1"), ("tlismni_none", "1.0")]
    moved = elsewhere(bundled, tmp_path, requires=requires)
    done = run_host(host, moved, tmp_path, TLISMNI_PYTHON=str(python))
    assert done.returncode == 4
    (line,) = logged(done)
    least = dict(requirements())["numba"]
    assert "fmi2Instantiate: ImportError: this FMU needs packages that Python" in line
    assert f"numba>={least} (missing)" in line and "tlismni_none>=1.0 (missing)" in line
    assert "packaging>=9999.1 (" in line and " is installed)" in line and "numpy" not in line.split("lacks")[1]


@pytest.mark.parametrize(
    "error", [TypeError("__init__() takes 2 arguments"), SystemError("pydantic-core ... incompatible")]
)
def test_too_old_a_package_is_named_however_it_fails(boot, tmp_path, monkeypatch, error):
    """pydantic 2.0 to 2.8 are found and imported, and fail later with words of their own."""

    def fail(*arguments, **flags):
        raise error

    record = {"version": "3.11", "prefix": "/nowhere", "folders": [], "tlismni": "1", "bundle": None}
    monkeypatch.setitem(sys.modules, "tlismni.fmu_wrapper.embedded", types.SimpleNamespace(create=fail))
    for requires, expected in (([("pydantic", "99.1")], ImportError), ([("pydantic", "2.0")], type(error))):
        (tmp_path / "python.json").write_text(json.dumps({**record, "requires": requires}))
        with pytest.raises(expected) as caught:
            boot["create"](2, "name", "token", str(tmp_path), False, None, False, False, False, None, None)
        if expected is ImportError:
            text = str(caught.value)
            assert f"pydantic>=99.1 ({version('pydantic')} is installed)" in text and str(error) in text
        else:
            assert caught.value is error


def test_what_is_needed_is_what_the_project_says():
    assert {name for name, _ in requirements()} == {"numpy", "scipy", "numba", "pydantic"}
    assert all(least[0].isdigit() for _, least in requirements())


# unpacking


@pytest.fixture
def boot():
    return runpy.run_path(str(BOOT))


@pytest.fixture
def archive(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    monkeypatch.setenv("LOCALAPPDATA", str(tmp_path / "cache"))
    monkeypatch.setenv("HOME", str(tmp_path / "home"))
    data, digest = package_archive()
    path = tmp_path / "fmu" / "tlismni.zip"
    path.parent.mkdir()
    path.write_bytes(data)
    return str(path), digest


def test_unpacked_once_for_each_content(boot, archive):
    folder = Path(boot["_unpack"](*archive))
    assert archive[1] in folder.name
    found = {p.relative_to(folder).as_posix(): p.stat().st_mtime_ns for p in folder.rglob("*") if p.is_file()}
    with zipfile.ZipFile(archive[0]) as content:
        assert set(found) == set(content.namelist())
    assert {"core/__init__.py", "fmu_wrapper/embedded.py", "LICENSE"} <= set(found) and len(set(found.values())) == 1
    identity = folder.stat().st_ino
    assert boot["_unpack"](*archive) == str(folder) and folder.stat().st_ino == identity
    assert [p.name for p in folder.parent.iterdir()] == [folder.name]


def test_a_damaged_folder_is_mended(boot, archive):
    folder = Path(boot["_unpack"](*archive))
    before = {p.relative_to(folder) for p in folder.rglob("*")}
    (folder / "core" / "__init__.py").unlink()
    assert boot["_unpack"](*archive) == str(folder)
    assert {p.relative_to(folder) for p in folder.rglob("*")} == before
    assert [p.name for p in folder.parent.iterdir()] == [folder.name]


def test_processes_that_unpack_at_once(archive):
    script = "import runpy, sys; print(runpy.run_path(sys.argv[1])['_unpack'](*sys.argv[2:]))"
    command = [sys.executable, "-I", "-c", script, str(BOOT), *archive]
    running = [subprocess.Popen(command, stdout=subprocess.PIPE, text=True) for _ in range(6)]
    folders = {process.communicate()[0].strip() for process in running}
    assert {process.returncode for process in running} == {0} and len(folders) == 1
    (folder,) = map(Path, folders)
    assert [p.name for p in folder.parent.iterdir()] == [folder.name]


def test_a_user_folder_that_cannot_be_written(boot, archive, tmp_path, monkeypatch):
    (tmp_path / "cache").write_text("a file, no folder")
    if sys.platform == "darwin":
        pytest.skip("another folder there")
    assert Path(boot["_unpack"](*archive)).parent == tmp_path / "fmu"
    shutil.rmtree(boot["_unpack"](*archive))
    monkeypatch.setattr(boot["tempfile"], "mkdtemp", lambda **where: (_ for _ in ()).throw(OSError(30, "Read-only")))
    with pytest.raises(ImportError, match=r"cannot be unpacked .*Read-only.*set the environment variable"):
        boot["_unpack"](*archive)


def test_a_damaged_archive_is_refused(boot, archive):
    Path(archive[0]).write_bytes(Path(archive[0]).read_bytes()[:-10])
    with pytest.raises(ImportError, match="is damaged: its content is not what the export wrote"):
        boot["_unpack"](*archive)


def test_the_same_sources_give_the_same_file(tmp_path, monkeypatch):
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "1763800000")
    paths = [export_fmu(ball_model(), tmp_path / f"{k}.fmu", bundle=True) for k in range(2)]
    assert paths[0].read_bytes() == paths[1].read_bytes()
    with zipfile.ZipFile(paths[0]) as content:
        assert fmpy.read_model_description(paths[0]) and "resources/tlismni.zip" in content.namelist()


def test_an_editable_install_behind_an_entry_of_the_path(tmp_path):
    """PYTHONPATH with the packages' folder makes an entry without its .pth files: tlismni is found all the same."""
    path = export_fmu(ball_model(), tmp_path / "x.fmu")
    with zipfile.ZipFile(path) as archive:
        archive.extractall(tmp_path / "unzipped")
    token = json.loads((tmp_path / "unzipped" / "resources" / "settings.json").read_text())["token"]
    script = """
import runpy, sys
sys.path.append(sys.argv[1])
boot = runpy.run_path(sys.argv[2] + "/boot.py")
calls = boot["create"](2, "it", sys.argv[3], sys.argv[2], 0, print, 0, 0, 1, None, b"")
print(type(calls).__name__)
"""
    packages, resources = sysconfig.get_path("purelib"), str(tmp_path / "unzipped" / "resources")
    command = [sys.executable, "-S", "-c", script, packages, resources, token]
    done = subprocess.run(command, capture_output=True, text=True, timeout=1200)
    assert done.stdout.strip() == "Fmi2Calls", done.stderr[-1500:]
