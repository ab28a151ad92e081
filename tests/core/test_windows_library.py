"""Libraries for Windows show what C programs and masters look for. Needs ziglang, which links for it."""

import re
from importlib.util import find_spec
from pathlib import Path

import pytest
from tlismni.core.native.c_sources import c_sources

NATIVE = Path(__file__).parents[2] / "core" / "native"
FMI = Path(__file__).parents[2] / "fmu_wrapper" / "native"


@pytest.mark.skipif(find_spec("ziglang") is None, reason="needs ziglang, which links for other systems")
@pytest.mark.parametrize("name", ["windows-x86_64"])
def test_all_functions_for_others_are_shown(name: str, tmp_path: Path) -> None:
    import lief
    import llvmlite.binding as llvm
    from tlismni.core.ahead.shared import link_shared
    from tlismni.core.ahead.targets import TARGETS

    llvm.initialize_all_targets()
    llvm.initialize_all_asmprinters()
    target = TARGETS[name]
    machine = llvm.Target.from_triple(target.triple).create_target_machine()
    module = llvm.parse_assembly(
        f'target triple = "{target.triple}"\ndefine void @tlismni_compiled_1() {{ ret void }}\n'
        "define hidden void @inner() { ret void }\n"
        '@tlismni_digest = constant [2 x i8] c"x\\00"'
    )
    path = tmp_path / "tlismni_core.dll"
    link_shared(machine.emit_object(module), target, path, False, ["tlismni_compiled_1"], c_sources())

    header = (NATIVE / "tlismni.h").read_text()
    wanted = set(re.findall(r"TLISMNI_API[^;]*?\b(tlismni_\w+)\(", header))
    wanted |= {f for file in FMI.glob("*.c") for f in re.findall(r"^EXPORT[^(]*?\b(fmi\w+)\(", file.read_text(), re.M)}
    assert {"tlismni_open", "tlismni_restore", "fmi2DoStep", "fmi3DoStep"} < wanted and len(wanted) > 100
    library = lief.PE.parse(str(path))
    assert library is not None
    shown = {str(entry.name) for entry in library.get_export().entries}
    assert wanted - shown == set()
    assert "tlismni_compiled_1" in shown and "inner" not in shown
