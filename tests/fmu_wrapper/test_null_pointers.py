"""A host that gives NULL for one argument of a call, or a length beyond all memory: Error with a line, in each function
of both standards and both kinds of FMU, and the instance lives on. In a process of its own, which a crash would end."""

import ctypes
import json
import subprocess
import sys
from pathlib import Path

import fmpy
import pytest
from fmpy.fmi2 import FMU2Slave, fmi2CallbackFunctions, fmi2CallbackLoggerTYPE
from fmpy.fmi3 import FMU3Slave
from fmu_helpers import ball_model
from tlismni.core.compiled.library import LIBRARY
from tlismni.fmu_wrapper import export_fmu

ERROR, DISCARD = 3, 2
LIFE = ("Instantiate", "FreeInstance", "GetVersion", "GetTypesPlatform")
ABSURD = (2**64 - 1, 2**63 - 1, 2**61 + 1)


def opened(path):
    """The FMU's instance and the lines of its log."""
    unzipped = fmpy.extract(str(path), unzipdir=str(path.with_suffix("")))
    description, lines = fmpy.read_model_description(unzipped), []
    kind = FMU2Slave if description.fmiVersion == "2.0" else FMU3Slave
    identifier = description.coSimulation.modelIdentifier
    fmu = kind(guid=description.guid, unzipDirectory=unzipped, modelIdentifier=identifier)
    if kind is FMU2Slave:
        callbacks = fmi2CallbackFunctions()
        callbacks.logger = fmi2CallbackLoggerTYPE(lambda e, n, s, c, message: lines.append(message.decode()))
        fmu.instantiate(callbacks=callbacks)
    else:
        fmu.instantiate(logMessage=lambda e, s, c, message: lines.append(message.decode()))
    fmu.enterInitializationMode()
    fmu.exitInitializationMode()
    return fmu, description, lines


def is_pointer(kind):
    return kind in (ctypes.c_char_p, ctypes.c_void_p) or hasattr(kind, "contents")


def probes(path):
    """(function, argument, status, last line) of every call with one NULL, and of those with an absurd length."""
    fmu, description, lines = opened(path)
    found = []
    prefix = "fmi2" if isinstance(fmu, FMU2Slave) else "fmi3"
    real = next(v for v in description.modelVariables if v.name == "push").valueReference
    for name in sorted(n for n in dir(fmu) if n.startswith(prefix) and n[len(prefix) :][:1].isupper()):
        if any(part in name for part in LIFE):
            continue
        # bare: fmpy's own wrapper would refuse some of this
        function, kinds = getattr(ctypes.CDLL(fmu.dll._name), name), list(fmu._functions[name].argtypes)
        pointers = [i for i, kind in enumerate(kinds) if i and is_pointer(kind)]
        sizes = [i for i, kind in enumerate(kinds) if kind is ctypes.c_size_t]
        trials = [(i, None) for i in pointers] + [(sizes[0], size) for size in ABSURD if sizes and len(pointers) > 1]
        for at, value in trials:
            arguments = [ctypes.c_void_p(fmu.component)]
            for kind in kinds[1:]:
                if kind is ctypes.c_size_t:
                    arguments.append(ctypes.c_size_t(2))
                elif getattr(kind, "_type_", None) is ctypes.c_char_p:
                    arguments.append((ctypes.c_char_p * 64)(*[b"x"] * 64))
                elif is_pointer(kind):
                    arguments.append((ctypes.c_uint32 * 64)(real, real))
                else:
                    arguments.append(kind())
            arguments[at] = ctypes.c_void_p(None) if value is None else ctypes.c_size_t(value)
            before = len(lines)
            status = function(*arguments)
            print(name, at, status, file=sys.stderr)
            found.append([name, at, status, lines[-1] if len(lines) > before else ""])
    fmu.reset()
    fmu.enterInitializationMode()
    fmu.exitInitializationMode()
    fmu.doStep(0.0, 0.125)
    return found


@pytest.mark.sampled(2)
@pytest.mark.parametrize("version", ["2.0", "3.0"])
@pytest.mark.parametrize("native", [False, True])
def test_null_is_an_error_with_a_line(tmp_path, version, native):
    if native and LIBRARY is None:
        pytest.skip("FMUs without Python are made of the library of machine code")
    path = export_fmu(ball_model(), tmp_path / "ball.fmu", version, native=native, t_end=1.0)
    done = subprocess.run([sys.executable, __file__, str(path)], capture_output=True, text=True, timeout=1200)
    assert done.returncode == 0, f"ended with {done.returncode}: {done.stderr[-2000:]}"
    found = json.loads(done.stdout)
    assert len({name for name, *_ in found}) > (20 if version == "2.0" else 40)
    for name, at, status, line in found:
        if name.endswith(("FreeFMUstate", "FreeFMUState")) and at == 1:
            assert (status, line) == (0, "")  # the standard allows it
        else:
            # Discard is no error, and its line is not asked for
            assert status == DISCARD or (status == ERROR and line.startswith(name)), (name, at, status, line)
    arrays = [line for name, _, _, line in found if name.endswith(("GetReal", "SetReal", "GetFloat64", "SetString"))]
    assert sum("NULL was given for" in line for line in arrays) > len(arrays) // 2


if __name__ == "__main__":
    print(json.dumps(probes(Path(sys.argv[1]))))
