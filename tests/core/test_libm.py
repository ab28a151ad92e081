"""The libm that libraries of machine code carry (`core/aot/libm.py`): how exact it is, the same for all targets."""

import ctypes
import math
import os
import subprocess
import sys
from importlib.util import find_spec

import numpy as np
import pytest
from tlismni.core.compiled.library import LIBRARY

needs_own = pytest.mark.skipif(
    not (LIBRARY and LIBRARY.libm), reason="needs a library of machine code with its own libm"
)
ONE = {
    "sin": (-40.0, 40.0), "cos": (-40.0, 40.0), "tan": (-40.0, 40.0), "asin": (-1.0, 1.0), "acos": (-1.0, 1.0),
    "atan": (-20.0, 20.0), "exp": (-40.0, 40.0), "expm1": (-2.0, 2.0), "log": (1e-9, 50.0), "log10": (1e-9, 50.0),
    "log2": (1e-9, 50.0), "log1p": (-0.9, 5.0), "sinh": (-5.0, 5.0), "cosh": (-5.0, 5.0), "tanh": (-3.0, 3.0),
}  # fmt: skip
TWO = {"atan2": (-5.0, 5.0), "hypot": (-5.0, 5.0), "pow": (0.01, 6.0), "fmod": (-9.0, 9.0)}


def own(name, arguments):
    function = ctypes.CFUNCTYPE(ctypes.c_double, *[ctypes.c_double] * arguments)(LIBRARY.libm_addresses()[name])
    return function


@needs_own
@pytest.mark.parametrize("name", [*ONE, *TWO])
def test_right_to_three_units_in_the_last_place(name):
    """Beside the system's, which is right to one."""
    low, high = (ONE | TWO)[name]
    count = 2 if name in TWO else 1
    function, reference = own(name, count), getattr(math, name)
    for x in np.random.default_rng(2).uniform(low, high, (3000, count)).tolist():
        wanted = reference(*x)
        assert abs(function(*x) - wanted) <= 3.0 * math.ulp(wanted), x


@needs_own
def test_its_special_values():
    pi, inf, nan = math.pi, math.inf, math.nan
    for name, arguments, wanted in (
        ("sin", (0.0,), 0.0), ("cos", (0.0,), 1.0), ("exp", (-inf,), 0.0), ("exp", (710.0,), inf),
        ("log", (0.0,), -inf),
        ("log", (1.0,), 0.0), ("pow", (2.0, 0.5), math.sqrt(2.0)), ("pow", (-2.0, 3.0), -8.0),
        ("atan2", (0.0, -1.0), pi),
        ("atan2", (-0.0, -1.0), -pi), ("hypot", (3.0, 4.0), 5.0), ("hypot", (inf, nan), inf), ("tanh", (inf,), 1.0),
    ):  # fmt: skip
        assert own(name, len(arguments))(*arguments) == wanted, name
    for name in ("sin", "cos", "log"):
        assert math.isnan(own(name, 1)(-inf))


@needs_own
def test_code_compiled_in_this_process_calls_it():
    """numba's `sin` has the bits of the library's, not of the system's."""
    code = (
        "import math, sys; import numpy as np; from tlismni.core.compiled.library import LIBRARY\n"
        "from tlismni.core.compiled.needed import numba_module; numba = numba_module(); import ctypes\n"
        "f = numba.njit(lambda x: math.tanh(x)); g = numba.njit(lambda x, y: math.atan2(x, y))\n"
        "at = LIBRARY.libm_addresses(); real = ctypes.c_double\n"
        "t = ctypes.CFUNCTYPE(real, real)(at['tanh']); a = ctypes.CFUNCTYPE(real, real, real)(at['atan2'])\n"
        "xs = np.random.default_rng(0).uniform(-3, 3, 2000).tolist()\n"
        "assert all(f(x) == t(x) and g(x, 0.7) == a(x, 0.7) for x in xs)\n"
        "assert any(f(x) != math.tanh(x) for x in xs)\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, env=dict(os.environ))
    assert done.returncode == 0, done.stderr


ASKING = """
declare double @llvm.pow.f64(double, double)
declare double @llvm.sin.f64(double)
declare double @llvm.cos.f64(double)

define double @tlismni_asking(double %x) {
  %power = call double @llvm.pow.f64(double 10.0, double %x)
  %sine = call double @llvm.sin.f64(double %power)
  %cosine = call double @llvm.cos.f64(double %power)
  %sum = fadd double %sine, %cosine
  ret double %sum
}
"""
"""Which LLVM makes other functions of, by other names on each system."""


def taken_from_elsewhere(machine_code):
    """Names that an object file asks for."""
    lief = pytest.importorskip("lief")
    found = lief.parse(machine_code)
    if isinstance(found, lief.MachO.Binary):
        return {s.name for s in found.imported_symbols}
    if isinstance(found, lief.ELF.Binary):
        return {s.name for s in found.symbols if s.name and s.shndx == 0}
    return {s.name for s in found.symbols if s.section_idx == 0 and s.storage_class.name == "EXTERNAL"}


@pytest.mark.slow
@pytest.mark.skipif(find_spec("ziglang") is None, reason="needs ziglang")
def test_its_sources_need_nothing_and_are_of_no_machine():
    from tlismni.core.aot.libm import FUNCTIONS, PREFIX, libm_texts
    from tlismni.core.aot.module import link, optimised, undefined
    from tlismni.core.aot.targets import TARGETS

    texts = libm_texts()
    assert not any(word in text for text in texts for word in ("target-cpu", "target-features", "target triple", "x86"))
    whole = link([*texts, ASKING])
    for target in TARGETS.values():
        module, machine = optimised(whole, {"tlismni_asking": "tlismni_asking"}, {}, target)
        assert set(undefined(module)) <= {"tlismni_take", "tlismni_give"}
        seen = {f.name for f in module.functions if not f.is_declaration}
        assert {PREFIX + x for x in FUNCTIONS} <= seen
        assert "fmadd" not in machine.emit_assembly(module)  # each operation rounds once
        assert taken_from_elsewhere(machine.emit_object(module)) == set()
