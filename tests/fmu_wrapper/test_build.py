"""Binaries for other platforms: built with one command, with all functions of both standards, free of Python."""

import re
import subprocess
import sys
import zipfile
from pathlib import Path

import fmpy
import pytest
from fmpy.validation import validate_fmu
from tlismni.fmu_wrapper import ExportError
from tlismni.fmu_wrapper import build as build_module
from tlismni.fmu_wrapper.build import binary, build, compile_shim, main
from tlismni.fmu_wrapper.export import fmi2_platform, fmi3_platform
from tlismni.fmu_wrapper.platforms import PLATFORMS, Platform, choose

HEADERS = Path(fmpy.__file__).parent / "c-code"
FMI2 = set(re.findall(r"define (fmi2\w+)\s+fmi2FullName", (HEADERS / "fmi2Functions.h").read_text()))
FMI3 = set(re.findall(r"^FMI3_Export fmi3\w+TYPE\s+(fmi3\w+);", (HEADERS / "fmi3Functions.h").read_text(), re.M))
MODEL_EXCHANGE_2 = {
    "fmi2EnterEventMode", "fmi2NewDiscreteStates", "fmi2EnterContinuousTimeMode", "fmi2CompletedIntegratorStep",
    "fmi2SetTime", "fmi2SetContinuousStates", "fmi2GetDerivatives", "fmi2GetEventIndicators", "fmi2GetContinuousStates",
    "fmi2GetNominalsOfContinuousStates",
}  # fmt: skip
WANTED = {
    "x86_64-linux": ("ELF", "X86_64"),
    "aarch64-linux": ("ELF", "AARCH64"),
    "x86_64-darwin": ("MACHO", "X86_64"),
    "aarch64-darwin": ("MACHO", "ARM64"),
    "x86_64-windows": ("PE", "AMD64"),
}


def read(path):
    """(format, machine, exported names, needed libraries) of a binary."""
    lief = pytest.importorskip("lief")
    found = lief.parse(str(path))
    if isinstance(found, lief.PE.Binary):
        exported = {e.name for e in found.get_export().entries}
        return "PE", found.header.machine.name, exported, {i.name for i in found.imports}
    if isinstance(found, lief.ELF.Binary):
        exported = {s.name for s in found.exported_symbols}
        return "ELF", found.header.machine_type.name, exported, set(found.libraries)
    exported = {s.name.removeprefix("_") for s in found.exported_symbols}
    return "MACHO", found.header.cpu_type.name, exported, {library.name for library in found.libraries}


@pytest.mark.slow  # the first time on a machine, Zig compiles the C libraries of each platform
@pytest.mark.parametrize("name", PLATFORMS)
def test_each_binary_has_all_functions_and_no_others(name):
    pytest.importorskip("ziglang")
    pytest.importorskip("lief")
    kind, machine, exported, libraries = read(binary(name))
    assert (kind, machine) == WANTED[name]
    assert exported >= (FMI2 - MODEL_EXCHANGE_2) | FMI3
    own = {"_init", "_fini", "DllMain", "__dso_handle", "_mh_dylib_header"}  # the linker's
    assert {n for n in exported if not n.startswith("fmi")} <= own
    assert not [n for n in libraries if "python" in n.lower()]
    assert not [n for n in libraries if n.startswith("/") and not n.startswith("/usr/lib/")]  # where it was made
    assert binary(name) == binary(name)  # the second time it is there


@pytest.mark.slow
def test_they_load_where_they_are_said_to():
    """glibc 2.17 has all that the ones for Linux ask for; macOS on ARM loads nothing that is not signed."""
    pytest.importorskip("ziglang")
    lief = pytest.importorskip("lief")
    for name in ("x86_64-linux", "aarch64-linux"):
        found = lief.parse(str(binary(name)))
        libraries = list(found.symbols_version_requirement)
        asked = [version.name for library in libraries for version in library.get_auxiliary_symbols()]
        assert asked and max(tuple(map(int, re.findall(r"\d+", version))) for version in asked) <= (2, 17)
    assert lief.parse(str(binary("aarch64-darwin"))).has_code_signature


@pytest.mark.slow
def test_the_linux_binary_runs(fake_fmu, tmp_path):
    """An FMU with all binaries is valid, has each in its folder, and runs with the one built for this machine."""
    pytest.importorskip("ziglang")
    for version, folder in (("2.0", fmi2_platform()), ("3.0", fmi3_platform())):
        path = fake_fmu(f"all{version}.fmu", fmi_version=version, platforms=["all"])
        assert validate_fmu(str(path)) == []
        with zipfile.ZipFile(path) as archive:
            held = {n.split("/")[1] for n in archive.namelist() if n.startswith("binaries/")}
        assert held == {p.folder(version) for p in PLATFORMS.values()} | {folder}
        result = fmpy.simulate_fmu(str(path), stop_time=1.0, output=["ball.y"], fmi_type="CoSimulation")
        assert result["ball.y"][-1] < 1.0


def test_the_functions_of_the_standards_are_known():
    assert len(FMI2) == 44 and MODEL_EXCHANGE_2 < FMI2 and len(FMI3) == 75


def test_platforms_are_chosen_by_name():
    assert choose(["all"]) == list(PLATFORMS) == choose(["x86_64-linux", "all"])
    assert choose([]) == [] and choose(["x86_64-windows", "x86_64-windows"]) == ["x86_64-windows"]
    with pytest.raises(ExportError, match=r"platform 'riscv64-linux' is unknown: choose from \['all', 'x86_64-linux'"):
        choose(["riscv64-linux"])


def test_without_zig_it_says_so(monkeypatch, tmp_path, capsys):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    monkeypatch.setattr(build_module.importlib.util, "find_spec", lambda name: None)
    with pytest.raises(ExportError, match="needs Zig's C compiler: python -m pip install ziglang"):
        list(build(["x86_64-windows"]))
    assert main(["x86_64-windows"]) == 1 and "pip install ziglang" in capsys.readouterr().err


def test_a_compiler_that_fails_is_heard(tmp_path):
    pytest.importorskip("ziglang")
    with pytest.raises(ExportError, match=r"the binary for none cannot be built: .*unknown architecture: 'none'"):
        compile_shim(Platform("none", "none", ".so", "none-none"), tmp_path / "x.so")
    assert list(tmp_path.iterdir()) == []


def test_the_command(tmp_path, monkeypatch):
    """With a binary that is there already, it copies it; from a shell, it knows its platforms."""
    monkeypatch.setattr(build_module, "binary", lambda name: Path(__file__))
    ((name, path),) = build(["aarch64-darwin"], tmp_path / "out")
    assert (
        name == "aarch64-darwin"
        and path == tmp_path / "out" / "aarch64-darwin" / Path(__file__).name
        and path.is_file()
    )
    command = [sys.executable, "-m", "tlismni.fmu_wrapper.build", "riscv64-linux"]
    done = subprocess.run(command, capture_output=True, text=True, cwd=tmp_path)
    assert done.returncode == 1 and done.stderr.startswith("error: platform 'riscv64-linux' is unknown")
