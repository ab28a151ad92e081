"""Libraries for all systems show what C programs and masters look for, and take nothing but memory, files and texts
from elsewhere. Needs ziglang, which links for them."""

import re
from importlib.util import find_spec
from pathlib import Path

import pytest
from elsewhere import LIBRARIES, is_of_these_sources, library_for
from tlismni.core.aot.targets import TARGETS
from tlismni.core.source_digests import c_sources

lief = pytest.importorskip("lief")
NATIVE = Path(__file__).parents[2] / "core" / "native"
FMI = Path(__file__).parents[2] / "fmu_wrapper" / "fmi"
OF_C = frozenset(
    "calloc fclose fopen fread free fseek ftell malloc memchr memcpy memmove memset strcmp strcspn strlen strncmp "
    "snprintf vsnprintf rint fmin fmax".split()
)
"""What a C library has on each system; the last three are exact."""
OF_SYSTEM = {
    ".so": "__tls_get_addr",
    ".dylib": "_tlv_bootstrap bzero __bzero memset_pattern16 dyld_stub_binder",
    ".dll": "_wfopen fwrite abort _exit __acrt_iob_func __stdio_common_vfprintf __stdio_common_vsprintf _initterm "
    "_initterm_e _execute_onexit_table _initialize_onexit_table _register_onexit_function",
}
"""What linkers and compilers add there."""
FROM = {".so": r"(libc|libm|ld-linux-x86-64)\.so(\.\d)?", ".dylib": r"/usr/lib/libSystem\.B\.dylib",
        ".dll": r"(api-ms-win-crt-[\w-]+|KERNEL32)\.dll"}  # fmt: skip
"""Libraries that are on each system."""
MACHINES = {"x86_64": {"X86_64", "AMD64"}, "aarch64": {"AARCH64", "ARM64"}}


def wanted():
    """Functions for others, of `tlismni.h` and of FMI."""
    found = set(re.findall(r"TLISMNI_API[^;]*?\b(tlismni_\w+)\(", (NATIVE / "tlismni.h").read_text()))
    found |= {f for file in FMI.glob("*.c") for f in re.findall(r"^EXPORT[^(]*?\b(fmi\w+)\(", file.read_text(), re.M)}
    assert {"tlismni_open", "tlismni_restore", "fmi2DoStep", "fmi3DoStep"} < found and len(found) > 100
    return found


def read(path):
    """(machine, shown functions, needed libraries, what is taken from those of C) of a library."""
    found = lief.parse(str(path))
    if path.suffix == ".dll":
        shown = {str(entry.name) for entry in found.get_export().entries}
        of_c = {e.name for part in found.imports if part.name.startswith("api-") for e in part.entries}
        return found.header.machine.name, shown, {part.name for part in found.imports}, of_c
    shown, taken = ({str(s.name) for s in symbols} for symbols in (found.exported_symbols, found.imported_symbols))
    if path.suffix == ".so":
        return found.header.machine_type.name, shown, set(found.libraries), taken
    own, *others = (part.name for part in found.libraries)
    assert own == "@rpath/tlismni_core.dylib"
    assert found.has_code_signature or found.header.cpu_type.name != "ARM64"  # which loads nothing else
    shown, taken = ({name.removeprefix("_") for name in names} for names in (shown, taken))
    return found.header.cpu_type.name, shown, set(others), taken


def check(path, target, besides=()):
    """What holds of each, which may take `besides`; the functions that it shows."""
    machine, shown, libraries, taken = read(path)
    assert machine in MACHINES[target.partition("-")[2]]
    assert wanted() - shown == set()
    assert [name for name in libraries if not re.fullmatch(FROM[path.suffix], name)] == []
    assert taken - OF_C - {*OF_SYSTEM[path.suffix].split(), *besides} == set()
    return shown


@pytest.mark.skipif(find_spec("ziglang") is None, reason="needs ziglang, which links for other systems")
@pytest.mark.parametrize("name", ["windows-x86_64", "macos-aarch64"])
def test_all_functions_for_others_are_shown(name, tmp_path):
    import llvmlite.binding as llvm
    from tlismni.core.aot.shared import link_shared

    llvm.initialize_all_targets()
    llvm.initialize_all_asmprinters()
    target = TARGETS[name]
    machine = llvm.Target.from_triple(target.triple).create_target_machine()
    module = llvm.parse_assembly(
        f'target triple = "{target.triple}"\ndefine void @tlismni_compiled_1() {{ ret void }}\n'
        "define hidden void @inner() { ret void }\n"
        '@tlismni_digest = constant [2 x i8] c"x\\00"'
    )
    path = tmp_path / f"tlismni_core{target.suffix}"
    link_shared(machine.emit_object(module), target, path, False, ["tlismni_compiled_1"], c_sources())
    shown = check(path, name, besides=["nextafter"])  # which the machine code has
    assert "tlismni_compiled_1" in shown and "inner" not in shown


@pytest.mark.parametrize("name", TARGETS)
def test_whole_libraries(name):
    path = library_for(name)
    if path is None or not is_of_these_sources(path):
        pytest.skip(f"needs the library of these sources for {name} in {LIBRARIES}")
    check(path, name)
