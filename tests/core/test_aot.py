"""The library of machine code: made, called, refused, and the same bits as what numba makes in the process."""

import json
import os
import platform
import shutil
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest
from tlismni.core.aot.__main__ import FRESH
from tlismni.core.aot.make import MEMORY
from tlismni.core.aot.module import QUICK, undefined
from tlismni.core.aot.packed import put, take
from tlismni.core.aot.targets import TARGETS
from tlismni.core.compiled.library import LIBRARY, LIBRARY_VARIABLE, packed, unpacked
from tlismni.core.compiled.lock import ProcessLock
from tlismni.core.compiled.signatures import signature_text, split_signature, split_types
from tlismni.core.source_digests import c_digest, core_digest

PART = ("tsuji_formula", "position_level", "eliminate", "directions", "violates_redundant")
"""Functions that take seconds to make a library of: numbers, a record, arrays; of both parts that are recorded."""
CALLER, CALLED = ("linalg.analyze.analyze", "stage.joints.factor_joints"), "linalg5solve6factor"
"""Two functions, each of another part, and what both call, as it is in LLVM's names."""


def run(code: str, library: str | Path, *arguments: str, **environment: str) -> subprocess.CompletedProcess[str]:
    """A new process of Python with this library."""
    return subprocess.run(
        [sys.executable, "-c", code, *arguments],
        env={**os.environ, LIBRARY_VARIABLE: str(library), **environment},
        capture_output=True,
        text=True,
        check=False,
    )


def answer(done: subprocess.CompletedProcess[str]) -> Any:
    """What it has printed, as JSON."""
    assert done.returncode == 0, done.stderr[-3000:]
    return json.loads(done.stdout)


def make(folder: Path, *arguments: str) -> Path:
    """A library of this machine."""
    command = [sys.executable, "-m", "tlismni.core.aot", "--output", str(folder), *arguments]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr[-3000:]
    (made,) = folder.rglob("tlismni_core.*")
    return made


RECORDED_ONCE = """
import json, sys
from contextlib import contextmanager
import llvmlite.binding as llvm
from tlismni.core.aot import __main__ as command, make

if __name__ == "__main__":
    whole, recorded = make.whole_module, make.recorded
    parts, modules = [], []

    @contextmanager
    def watched(only):
        with recorded(only) as made:
            parts.extend(made)
            yield parts

    def once(only):
        modules[:] = modules or [whole(only)]
        return modules[0]

    make.recorded, make.whole_module = watched, once
    for words in json.loads(sys.argv[1]):
        sys.argv = ["ahead", *words]
        assert command.main() == 0
    defined = [[x.name for x in llvm.parse_bitcode(part.bitcode).functions if not x.is_declaration] for part in parts]
    print(json.dumps(defined))
"""
"""The command with each of some arguments, on one recording; prints the names of what each of its parts has defined."""


def recorded_once(commands: list[list[str]]) -> list[list[str]]:
    """Run the command with each of these words on one recording: LLVM's names of the functions of each part."""
    environment = {name: value for name, value in FRESH.items() if name != LIBRARY_VARIABLE}
    names: list[list[str]] = answer(run(RECORDED_ONCE, "none", json.dumps(commands), **environment))
    return names


@dataclass(frozen=True)
class Made:
    """Libraries of a few functions, from one recording."""

    library: Path
    quick: Path
    """Made in less time."""


@pytest.fixture(scope="session")
def made(tmp_path_factory: pytest.TempPathFactory, worker_id: str) -> Made:
    """Made once for all workers of a session."""
    own = tmp_path_factory.getbasetemp()
    place = (own if worker_id == "master" else own.parent) / "libraries"
    lock = ProcessLock(place / "made.lock")
    lock.acquire()
    try:
        if not (place / "names.json").exists():
            only = [word for name in PART for word in ("--only", name)]
            words = [["--output", str(place / "part"), *only], ["--output", str(place / "quick"), *only]]
            words[1] += ["--patience", "0"]
            (place / "names.json").write_text(json.dumps(recorded_once(words)))
    finally:
        lock.release()
    (library,), (quick,) = (list((place / name).rglob("tlismni_core.*")) for name in ("part", "quick"))
    return Made(library, quick)


@pytest.fixture(scope="session")
def part(made: Made) -> Path:
    """A library of a few functions."""
    return made.library


def test_types_as_texts() -> None:
    from numba import types

    vector = types.Array(types.float64, 1, "C")
    signature = types.UniTuple(types.float64, 2)(types.int64, vector, types.boolean)
    text = signature_text(signature.return_type, signature.args)
    assert text == "(dd)(qAd1?)"
    assert split_signature(text) == ("(dd)", ["q", "Ad1", "?"])
    assert split_types("R(d(qq))AI2v") == ["R", "(d(qq))", "AI2", "v"]
    with pytest.raises(TypeError, match="no place"):
        signature_text(types.complex128, ())


def test_plain_types_have_the_texts_of_numbas() -> None:
    import numba
    import numpy as np
    from tlismni.core.compiled import plain_types as plain
    from tlismni.core.compiled.signatures import type_text

    record = np.dtype([("n", np.int64), ("x", np.int64)])
    of_numba, of_ours = numba.types, plain
    for kinds, make_record in ((of_numba, numba.from_dtype), (of_ours, plain.from_dtype)):
        made = [kinds.float64, kinds.int64, kinds.uint32, kinds.boolean, kinds.void]
        made += [kinds.Array(kinds.float64, 2, "C"), kinds.UniTuple(kinds.float64, 3), make_record(record)]
        assert [type_text(kind) for kind in made] == ["d", "q", "I", "?", "v", "Ad2", "(ddd)", "R"]
    signature = plain.void(plain.int64, plain.Array(plain.float64, 1, "C"))
    assert signature.for_numba() == numba.types.void(numba.types.int64, numba.types.float64[::1])


CALLS = """
import json, sys
import numpy as np
from tlismni.core.contact_solvers.directions import farthest_directions
from tlismni.core.laws.viscoelastic import tsuji_formula
from tlismni.core.linalg.row_pivoting import pivot_rows

force = tsuji_formula(0.003, -0.7, 1.1, 2e5, 30.0, 1.5, 0.0)
start, col = np.array([0, 3, 5, 8]), np.array([0, 1, 3, 1, 2, 0, 2, 3])
pivots = pivot_rows(3, 4, start, col, np.array([0.7, -2.0, 0.3, 1.0, 5.0, 0.1, 1.7, -3.0]))
matrix = np.array([[4.0, 1.0, 0.5], [1.0, 3.0, 0.2], [0.5, 0.2, 1e-9]])
kept, work = np.zeros(3, np.int64), np.zeros(64)
found = farthest_directions(matrix, np.arange(3), kept, work)
print(json.dumps([[x.hex() for x in force], pivots.pivot_column.tolist(), pivots.rank, found, kept.tolist(),
                  "numba" in sys.modules]))
"""


def test_the_same_bits_as_compiled_in_the_process(part: Path) -> None:
    *ahead, loaded = answer(run(CALLS, part))
    *here, needed = answer(run(CALLS, "none"))
    assert ahead == here
    assert (loaded, needed) == (False, True)


def test_code_that_is_made_in_less_time_gives_the_same_bits(made: Made) -> None:
    assert QUICK.encode() in made.quick.read_bytes() and QUICK.encode() not in made.library.read_bytes()
    assert answer(run(CALLS, made.quick)) == answer(run(CALLS, made.library))


def test_the_command_begins_anew_in_its_own_environment(tmp_path: Path) -> None:
    """And says by its exit code that there is nothing to take."""
    command = [sys.executable, "-m", "tlismni.core.aot", "--take", str(tmp_path), "--no-make"]
    assert any(os.environ.get(name) != value for name, value in FRESH.items())
    assert subprocess.run(command, check=False).returncode == 1


def test_a_packed_library_is_taken_if_it_is_of_these_sources(tmp_path: Path) -> None:
    library, place = tmp_path / "library", tmp_path / "there.so"
    library.write_bytes(b"\x7fELF" + b"0" * 64)
    put(library, tmp_path)
    assert not take(tmp_path / "nothing", place)
    assert not take(tmp_path, place) and not place.exists()
    for digest in (core_digest(), c_digest()):
        library.write_bytes(b"\x7fELF" + digest.encode())
        put(library, tmp_path)
        assert not take(tmp_path, place) and not place.exists()
    library.write_bytes(b"\x7fELF" + core_digest().encode() + c_digest().encode())
    put(library, tmp_path)
    assert take(tmp_path, place) == (sys.platform != "linux" or platform.libc_ver()[0] == "glibc")
    assert not place.exists() or place.read_bytes() == library.read_bytes()


@pytest.mark.full
def test_what_both_recording_processes_need_has_one_name(tmp_path: Path) -> None:
    """So it is in the module once: two functions, each of another part, call it. Were it there twice, the library would
    be larger than a test of the one that is here allows."""
    only = [word for name in CALLER for word in ("--only", name)]
    first, second = (
        [name for name in names if CALLED in name] for names in recorded_once([["--output", str(tmp_path), *only]])
    )
    assert first == second and len(first) == 1


def test_other_arguments_are_compiled_in_the_process(part: Path) -> None:
    code = """
import json, sys
import numpy as np
from tlismni.core.contact_solvers.directions import farthest_directions
matrix = np.array([[4.0, 1.0], [1.0, 3.0]])
kept, work = np.zeros(2, np.int64), np.zeros(64)
print(json.dumps([farthest_directions(np.asfortranarray(matrix), np.arange(2), kept, work), "numba" in sys.modules]))
"""
    found, loaded = answer(run(code, part))
    assert found == 2 and loaded


def test_own_code_next_to_the_library(part: Path) -> None:
    """A user's kernel calls our helpers, which numba then compiles with it from their sources."""
    code = """
import json
import numpy as np, numba
from tlismni.core.compiled.jit import address_of, compiled, internal
from tlismni.core.compiled.kernels import KERNEL_SIGNATURE, kernel_address
from tlismni.core.compiled.views import vec
from tlismni.core.methods.history import restart

@internal
def own_kernel(job, t, b):
    vec(b.r, b.n_extended)[0] += t

@numba.njit
def twice(address):
    return 2.0 * vec(address, 1)[0]

x = np.array([1.5])
print(json.dumps([kernel_address(own_kernel) != 0, twice(x.ctypes.data)]))
"""
    assert answer(run(code, part)) == [True, 3.0]


def test_without_numba_the_error_names_the_extra(part: Path) -> None:
    code = """
import sys
sys.modules["numba"] = None
import tlismni.core
from tlismni.core.compiled.jit import internal
from tlismni.core.compiled.kernels import kernel_address
from tlismni.core import ModelError

@internal
def own_kernel(job, t, b):
    pass

try:
    kernel_address(own_kernel)
except ModelError as error:
    print(repr(str(error)))
"""
    done = run(code, part)
    assert done.returncode == 0, done.stderr[-2000:]
    assert "tlismni[own]" in done.stdout
    nothing = run("import sys; sys.modules['numba'] = None; from tlismni.core import Model", "none")
    assert nothing.returncode != 0 and "tlismni[own]" in nothing.stderr


def test_what_compiled_code_raises_reaches_python(part: Path) -> None:
    code = """
import pickle, ctypes, json
from tlismni.core.compiled import crossing
text = pickle.dumps((ValueError, ("no such row",), None))
raised = crossing._Raised(ctypes.cast(ctypes.c_char_p(text), ctypes.c_void_p).value, len(text), None, None, 0)
place = ctypes.c_void_p(ctypes.addressof(raised))
try:
    crossing.raise_from(1, place)
except ValueError as error:
    print(json.dumps(str(error)))
"""
    assert answer(run(code, part)) == "no such row"


def test_a_library_of_other_sources_is_left_alone(part: Path, tmp_path: Path) -> None:
    content = part.read_bytes()
    digest = answer(
        run("import json; from tlismni.core.source_digests import core_digest as d; print(json.dumps(d()))", "none")
    )
    assert content.count(digest.encode()) == 1
    stale = tmp_path / part.name
    stale.write_bytes(content.replace(digest.encode(), digest[::-1].encode()))
    code = "import logging; logging.basicConfig(); from tlismni.core.compiled.library import LIBRARY; print(LIBRARY)"
    done = run(code, stale)
    assert done.stdout.strip() == "None" and "of other sources" in done.stderr and digest in done.stderr


def test_every_target_is_known_to_llvm() -> None:
    import llvmlite.binding as llvm

    llvm.initialize_all_targets()
    for target in TARGETS.values():
        assert llvm.Target.from_triple(target.triple).name
    module = llvm.parse_assembly("declare double @sin(double)\ndeclare double @llvm.fabs.f64(double)")
    assert undefined(module) == ["sin"]


SCENARIOS = """
import hashlib, json, sys
import numpy as np
from tlismni.core import simulate
from tlismni.core.methods.registry import METHODS
from tlismni.models import load, names

found, many = {}, ("pendulum_stop", "slider_crank_stop", "chain")
for name in sys.argv[1:] or names():
    scenario = load(name)
    for method in METHODS if name in many and not sys.argv[1:] else (scenario.method,):
        options = scenario.options if method == scenario.method else {}
        end = min(scenario.t_end, 0.5)
        try:
            result = simulate(scenario.model, end, method, scenario.rtol, scenario.atol, **options)
        except Exception as error:
            found[f"{name} {method}"] = f"{type(error).__name__}: {error}"
            continue
        digest = hashlib.sha256()
        for numbers in (result.t, result.q, result.v, result.a, result.multipliers):
            digest.update(np.ascontiguousarray(numbers).tobytes())
        digest.update(repr([(e.t.hex(), e.kind, e.contact, e.impulse) for e in result.events]).encode())
        found[f"{name} {method}"] = digest.hexdigest()
print(json.dumps([found, "numba" in sys.modules]))
"""


@pytest.fixture(scope="session")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The whole library."""
    return make(tmp_path_factory.mktemp("whole"))


@pytest.mark.full
def test_scenarios_give_the_same_bits_and_need_no_numba(whole: Path) -> None:
    ahead, loaded = answer(run(SCENARIOS, whole))
    here, _ = answer(run(SCENARIOS, "none", TLISMNI_LIBM=str(whole)))
    assert {name for name in ahead if ahead[name] != here[name]} == set()
    assert len(ahead) > 40
    assert not loaded


SAMPLE = """
import json, sys
import numpy as np
from tlismni.core.contact_solvers.directions import farthest_directions
from tlismni.core.laws.friction.ambrosio import ambrosio_formula
from tlismni.core.laws.friction.brown_mcphee import brown_mcphee_formula
from tlismni.core.laws.friction.step import step_formula
from tlismni.core.laws.friction.tanh import tanh_formula
from tlismni.core.laws.friction.threlfall import threlfall_formula
from tlismni.core.laws.hertz import hertz_formula
from tlismni.core.laws.hunt_crossley import hunt_crossley_formula
from tlismni.core.laws.kelvin_voigt import kelvin_voigt_formula
from tlismni.core.laws.viscoelastic import kuwabara_kono_formula, tsuji_formula
from tlismni.core.linalg import Factorization
from tlismni.core.linalg.row_pivoting import pivot_rows

rng = np.random.default_rng(int(sys.argv[1], 16))
found = []
for formula in (hertz_formula, hunt_crossley_formula, kelvin_voigt_formula, kuwabara_kono_formula, tsuji_formula):
    for _ in range(200):
        numbers = (1e-3, 2.0, 1.0, 1e6, 1.5, 100.0, 1.0) * rng.uniform(0.0, 1.0, 7)
        found += [x.hex() for x in formula(*map(float, numbers))]
for formula in (ambrosio_formula, brown_mcphee_formula, step_formula, tanh_formula, threlfall_formula):
    for _ in range(200):
        numbers = (1.0, 50.0, 0.3, 0.4, 0.1, 0.5, 1.0) * rng.uniform((-1.0, *[0.1] * 6), 1.0)
        found += [x.hex() for x in formula(*map(float, numbers))]
for n in (3, 20, 40):
    place = {(i, int(j)): rng.uniform(3.0, 5.0) for i, j in enumerate(rng.permutation(n))}
    for _ in range(3 * n):
        place.setdefault((int(rng.integers(n)), int(rng.integers(n))), rng.uniform(-1.0, 1.0))
    rows, columns = np.array(list(place)).T
    values = np.array(list(place.values()))
    lu = Factorization(n, rows, columns, np.arange(len(values)), dense=False)
    lu.analyze(values)
    found += [x.hex() for x in lu.solve(rng.normal(size=n)).tolist()]
    matrix = rng.normal(size=(n, n))
    kept, work = np.zeros(n, np.int64), np.zeros(8 * n * n)
    found += [farthest_directions(matrix @ matrix.T, np.arange(n), kept, work), *kept.tolist()]
    order = np.lexsort((columns, rows))
    starts = np.searchsorted(rows[order], np.arange(n + 1))
    found += pivot_rows(n, n, starts, columns[order], values[order]).pivot_column.tolist()
print(json.dumps([found, "numba" in sys.modules]))
"""


@pytest.mark.skipif(LIBRARY is None, reason="needs the library of machine code (tlismni.core.aot)")
def test_the_library_that_is_here_gives_the_bits_of_the_process() -> None:
    """Of laws, a sparse solver, pivots, at arguments that change with the sources; of whole runs with `-m full`, since
    to compile what one takes is minutes."""
    assert LIBRARY is not None
    path = str(LIBRARY.path)
    ahead, loaded = answer(run(SAMPLE, path, core_digest()))
    here, compiled = answer(run(SAMPLE, "none", core_digest(), TLISMNI_LIBM=path))
    assert ahead == here and (loaded, compiled) == (False, True)


FEW = ("bouncing_ball", "pendulum_stop", "slider_crank_stop", "stick_slip", "cable_ground", "heavy_top", "dropped_box")


@pytest.mark.full
@pytest.mark.skipif(LIBRARY is None, reason="needs the library of machine code (tlismni.core.aot)")
def test_runs_with_the_library_that_is_here_have_the_bits_of_the_process() -> None:
    """Of some scenarios: of all of them above."""
    assert LIBRARY is not None
    path = str(LIBRARY.path)
    ahead, loaded = answer(run(SCENARIOS, path, *FEW))
    here, compiled = answer(run(SCENARIOS, "none", *FEW, TLISMNI_LIBM=path))
    assert ahead == here and len(ahead) == len(FEW) and (loaded, compiled) == (False, True)
    assert not [text for text in ahead.values() if "Error" in text]


@pytest.mark.skipif(LIBRARY is None or not shutil.which("nm"), reason="needs a library of machine code, and nm")
@pytest.mark.skipif(sys.platform != "linux", reason="reads symbols as binutils write them")
def test_the_library_takes_nothing_but_memory_and_texts_from_elsewhere() -> None:
    """Of a library with its own libm; what C takes beside: rounding, which has no other bits anywhere."""
    if not LIBRARY.libm:
        pytest.skip("a library that was linked without ziglang takes the system's libm")
    command = ["nm", "-D", "--undefined-only", str(LIBRARY.path)]
    listed = subprocess.run(command, capture_output=True, text=True, check=True)
    strong = {line.split()[1].split("@")[0] for line in listed.stdout.splitlines() if line.split()[0] == "U"}
    of_c = "calloc fclose fopen fread free fseek ftell malloc memchr memcmp strcmp strcspn strlen strncmp"
    printed = "snprintf vsnprintf __tls_get_addr rint fmin fmax"
    assert strong <= (MEMORY - {"tlismni_take", "tlismni_give"}) | set(of_c.split()) | set(printed.split())
    if QUICK.encode() not in LIBRARY.path.read_bytes():
        assert LIBRARY.path.stat().st_size < 2_000_000


def test_texts_of_a_library_are_packed():
    """And those of earlier ones, whose libm may be asked for, are read as they are."""
    text = json.dumps({"entries": {f"f{k}": f"tlismni_f{k}" for k in range(200)}, "u": "ü"})
    assert unpacked(packed(text)) == text == unpacked(text)
    assert packed(text).isascii() and len(packed(text)) < 0.5 * len(text)
