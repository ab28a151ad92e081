"""The C shim: compiles without a warning, refuses bad instantiations, holds in threads and over many loads."""

import ctypes
import gc
import json
import re
import shutil
import subprocess
import sys
import threading
from pathlib import Path

import fmpy
import pytest
from fmpy.fmi2 import FMU2Slave, fmi2CallbackFunctions, fmi2CallbackLoggerTYPE
from tlismni.fmu_wrapper.build import shim_sources
from tlismni.fmu_wrapper.export import shim_path

FMI = Path(__file__).parents[2] / "fmu_wrapper" / "fmi"
CC = shutil.which("cc")


@pytest.fixture
def unzipped(fake_fmu):
    path = fake_fmu()
    return fmpy.extract(str(path), unzipdir=str(path.with_suffix("")))


def instance(unzipped, messages, guid=None, fmi_type=1, name=b"it", logger=True):
    """A bare handle on the binary: (library, component, callbacks to keep)."""
    description = fmpy.read_model_description(unzipped)
    fmu = FMU2Slave(
        guid=description.guid, unzipDirectory=unzipped, modelIdentifier=description.coSimulation.modelIdentifier
    )
    callbacks = fmi2CallbackFunctions()
    if logger:
        callbacks.logger = fmi2CallbackLoggerTYPE(lambda e, n, s, c, m: messages(s, c.decode(), m.decode()))
    fmu.callbacks = callbacks
    fmu.component = fmu.fmi2Instantiate(
        name,
        fmi_type,
        (guid or description.guid).encode(),
        (Path(unzipped) / "resources").as_uri().encode(),
        ctypes.byref(callbacks),
        0,
        0,
    )
    return fmu


@pytest.mark.sampled(1)
@pytest.mark.skipif(CC is None, reason="needs a C compiler")
@pytest.mark.parametrize("standard", ["c11", "c17"])
def test_compiles_without_warnings(tmp_path, standard):
    sources = list(map(str, shim_sources()))
    flags = ["-Wall", "-Wextra", "-Wpedantic", "-Wshadow", "-Wstrict-prototypes", "-Werror", "-O2", "-shared", "-fPIC"]
    command = [CC, f"-std={standard}", *flags, "-o", str(tmp_path / "shim.so"), *sources, "-ldl", "-lpthread"]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr


@pytest.mark.skipif(CC is None, reason="needs a C compiler")
def test_functions_have_the_types_of_the_standard(tmp_path):
    """fmpy carries the standard's own headers: each of its function types must fit our function."""
    headers = Path(fmpy.__file__).parent / "c-code"
    names = re.findall(r"EXPORT \S+ \*?(fmi2\w+)\(", (FMI / "fmi2.c").read_text().replace("const char", "char"))
    assert len(names) == 34
    # our own typedefs would clash with the standard's: rename ours, then compare sizes and calling shapes
    declarations = "\n".join(f"{name}TYPE *p_{name} = {name};" for name in names)
    source = tmp_path / "types.c"
    source.write_text(f'#include "fmi2Functions.h"\n{declarations}\nint main(void) {{ return 0; }}\n')
    command = [CC, "-Wall", "-Werror", f"-I{headers}", "-o", str(tmp_path / "types"), str(source), str(shim_path())]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr


@pytest.mark.skipif(CC is None, reason="needs a C compiler")
def test_functions_of_fmi3_are_all_there_with_the_types_of_the_standard(tmp_path):
    """Each function of the standard's header is defined, and its definition fits the header's type."""
    headers = Path(fmpy.__file__).parent / "c-code"
    names = re.findall(r"^FMI3_Export fmi3\w+TYPE\s+(fmi3\w+);", (headers / "fmi3Functions.h").read_text(), re.M)
    assert len(names) == 75
    pointers = "\n".join(f"{name}TYPE *p_{name} = {name};" for name in names)
    (tmp_path / "there.c").write_text(f'#include "fmi3Functions.h"\n{pointers}\nint main(void) {{ return 0; }}\n')
    flags = ["-Wall", "-Werror", f"-I{headers}"]
    there = [CC, *flags, "-o", str(tmp_path / "there"), str(tmp_path / "there.c"), str(shim_path())]
    done = subprocess.run(there, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    # our definitions and the header's declarations in one file: the compiler compares them
    text = "".join((FMI / name).read_text() for name in ("fmi3.c", "fmi3_refused.c"))
    text = re.sub(r"typedef (?!void \(\*)[^;(]*fmi3\w+;|typedef void[^;]*;", "", text)
    source = tmp_path / "fits.c"
    source.write_text(f'#include "fmi3Functions.h"\n{text}')
    fits = [CC, "-std=c11", *flags, "-Wno-unused", f"-I{FMI}", "-fsyntax-only", str(source)]
    done = subprocess.run(fits, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr


def test_links_to_no_python():
    library = shim_path().read_bytes()
    assert b"libpython3.%d.so" in library  # looked for at run time
    if shutil.which("readelf"):
        needed = subprocess.run(["readelf", "-d", str(shim_path())], capture_output=True, text=True).stdout
        assert "python" not in " ".join(re.findall(r"NEEDED.*\[(.*)\]", needed))


def test_wrong_guid_gives_null_and_a_line(unzipped, messages):
    fmu = instance(unzipped, messages, guid="{wrong}")
    assert not fmu.component
    assert len(messages) == 1
    assert messages.errors[0].startswith("fmi2Instantiate: FmuValueError: the guid given is '{wrong}', this FMU has '{")
    fmu.fmi2FreeInstance(None)  # allowed


def test_missing_resources_give_null_and_a_line(unzipped, messages):
    shutil.rmtree(Path(unzipped) / "resources")
    assert not instance(unzipped, messages).component
    assert "fmi2Instantiate: cannot read '" in messages.errors[0] and "resources are missing" in messages.errors[0]


@pytest.mark.parametrize(
    ("file", "message"),
    [
        ("model.json", "fmi2Instantiate: ModelError: model file"),
        ("settings.json", "fmi2Instantiate: ExportError: 'settings.json' in the FMU's resources cannot be read"),
        ("python.json", "fmi2Instantiate: FileNotFoundError"),
    ],
)
def test_each_missing_resource_gives_null_and_a_line(unzipped, messages, file, message):
    (Path(unzipped) / "resources" / file).unlink()
    assert not instance(unzipped, messages).component
    assert len(messages) == 1 and messages.errors[0].startswith(message)


@pytest.mark.parametrize(
    ("file", "change", "message"),
    [
        ("settings.json", lambda data: [data], "ExportError: 'settings.json' in the FMU's resources is no JSON object"),
        ("settings.json", lambda data: {**data, "solver": 3}, "ExportError: 'solver' in 'settings.json' of the FMU's"),
        ("settings.json", lambda data: {k: v for k, v in data.items() if k != "variables"},
         "ExportError: 'variables' in 'settings.json' of the FMU's resources is missing, where a list is needed"),
        ("settings.json", lambda data: {**data, "variables": [{"name": 3}]}, "ExportError: 'settings.json'"),
        ("settings.json", lambda data: {**data, "variables": []}, "ExportError: 'settings.json'"),
        ("settings.json", lambda data: {**data, "solver": {**data["solver"], "rtol": "x"}}, "ExportError: 'settings"),
        ("settings.json", lambda data: {**data, "solver": {**data["solver"], "rtol": -1.0}}, "FmuValueError: 'rtol'"),
        ("settings.json", lambda data: {**data, "solver": {"on_log": "x"}}, "ExportError: 'solver' in 'settings.json'"),
        ("python.json", lambda data: [], "ImportError: 'version' in "),
        ("python.json", lambda data: {**data, "requires": [3]}, "ImportError: 'requires' in "),
    ],
)  # fmt: skip
def test_each_broken_resource_gives_null_and_a_line(unzipped, messages, file, change, message):
    path = Path(unzipped) / "resources" / file
    path.write_text(json.dumps(change(json.loads(path.read_text()))))
    assert not instance(unzipped, messages).component
    assert len(messages) == 1 and messages.errors[0].startswith(f"fmi2Instantiate: {message}")


def test_model_exchange_is_refused(unzipped, messages):
    assert not instance(unzipped, messages, fmi_type=0).component
    assert messages.errors == ["fmi2Instantiate: this FMU does co-simulation only, type 0 was asked"]


def test_a_host_without_a_logger_or_a_component(unzipped, messages):
    fmu = instance(unzipped, messages, name=b"", logger=False)
    assert fmu.component
    with pytest.raises(Exception, match="fmi2DoStep failed with status 3"):
        fmu.doStep(0.0, 0.1)
    fmu.fmi2FreeInstance(fmu.component)
    with pytest.raises(Exception, match="fmi2Reset failed with status 3"):
        fmu.fmi2Reset(None)
    assert fmu.getVersion() == "2.0" and fmu.getTypesPlatform() == "default"


def test_many_loads_leave_nothing_behind(unzipped, messages):
    def cycle():
        fmu = instance(unzipped, messages)
        fmu.enterInitializationMode()
        fmu.exitInitializationMode()
        fmu.getFMUState()
        fmu.doStep(0.0, 0.1)
        fmu.freeInstance()

    cycle()
    gc.collect()
    path, modules, objects = list(sys.path), set(sys.modules), len(gc.get_objects())
    for _ in range(20):
        cycle()
    gc.collect()
    assert (sys.path, set(sys.modules)) == (path, modules)
    assert len(gc.get_objects()) - objects < 200
    assert messages == []


def test_steps_from_other_threads(unzipped, messages):
    def work(k):
        fmu = instance(unzipped, messages)
        fmu.enterInitializationMode()
        fmu.exitInitializationMode()
        for i in range(200):
            fmu.doStep(i * 0.01, (i + 1) * 0.01 - i * 0.01)
        rows[k] = fmu.getReal([vr[name] for name in ("time", "ball.y", "ball.vy")])
        fmu.freeInstance()

    vr = {v.name: v.valueReference for v in fmpy.read_model_description(unzipped).modelVariables}
    rows = [None] * 4
    threads = [threading.Thread(target=work, args=(k,)) for k in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert rows[0] is not None and rows == [rows[0]] * 4


def test_folders_with_odd_names(fake_fmu, tmp_path, messages):
    folder = tmp_path / "a b%20ü#;"
    unzipped = fmpy.extract(str(fake_fmu()), unzipdir=str(folder))
    fmu = instance(unzipped, messages)
    assert fmu.component, messages.errors
    fmu.freeInstance()
