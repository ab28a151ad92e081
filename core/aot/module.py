"""One LLVM module of all recorded texts, optimised as a whole, and its machine code for a target."""

import json
from collections.abc import Iterable, Mapping
from typing import Any

import llvmlite.binding as llvm

from ..compiled.library import packed
from .libm import BESIDE, FUNCTIONS, PREFIX
from .targets import Target

DIGEST, MANIFEST, QUICK = "tlismni_digest", "tlismni_manifest", "tlismni_quick"


# What compiled code takes from numba's runtime. The few arrays that it allocates come from a stack of the thread
# (`native/pieces.c`) and are counted as numba does it; those of views have no owner. They never leave the call that
# makes them, so counting needs no lock. What is raised is read by Python (`compiled/crossing.py`), and not made into
# objects by functions of the library.
_RUNTIME = """
declare ptr @tlismni_take(i64)
declare void @tlismni_give(ptr)
declare double @nextafter(double, double)

%owner = type { i64, ptr, ptr, ptr, i64, ptr }

define weak_odr ptr @NRT_MemInfo_alloc_aligned(i64 %size, i32 %alignment) {
  %wide = zext i32 %alignment to i64
  %head = add i64 %wide, 48
  %room = add i64 %head, %size
  %new = call ptr @tlismni_take(i64 %room)
  %missing = icmp eq ptr %new, null
  br i1 %missing, label %none, label %there
none:
  ret ptr null
there:
  %begin = ptrtoint ptr %new to i64
  %after = add i64 %begin, %head
  %down = sub i64 0, %wide
  %place = and i64 %after, %down
  %data = inttoptr i64 %place to ptr
  store %owner { i64 1, ptr null, ptr null, ptr null, i64 0, ptr null }, ptr %new
  %at = getelementptr %owner, ptr %new, i32 0, i32 3
  store ptr %data, ptr %at
  ret ptr %new
}

define weak_odr ptr @NRT_MemInfo_alloc(i64 %size) {
  %new = call ptr @NRT_MemInfo_alloc_aligned(i64 %size, i32 16)
  ret ptr %new
}

define weak_odr ptr @NRT_MemInfo_data_fast(ptr %x) alwaysinline {
  %at = getelementptr %owner, ptr %x, i32 0, i32 3
  %data = load ptr, ptr %at
  ret ptr %data
}

define weak_odr void @NRT_incref(ptr %x) alwaysinline {
  %nobody = icmp eq ptr %x, null
  br i1 %nobody, label %done, label %count
count:
  %old = load i64, ptr %x
  %more = add i64 %old, 1
  store i64 %more, ptr %x
  br label %done
done:
  ret void
}

define weak_odr void @NRT_decref(ptr %x) alwaysinline {
  %nobody = icmp eq ptr %x, null
  br i1 %nobody, label %done, label %count
count:
  %old = load i64, ptr %x
  %less = sub i64 %old, 1
  store i64 %less, ptr %x
  %last = icmp eq i64 %less, 0
  br i1 %last, label %free, label %done
free:
  call void @tlismni_give(ptr %x)
  br label %done
done:
  ret void
}

define weak_odr ptr @NRT_Allocate(i64 %size) {
  %new = call ptr @tlismni_take(i64 %size)
  ret ptr %new
}

define weak_odr void @NRT_Free(ptr %x) {
  call void @tlismni_give(ptr %x)
  ret void
}

define weak_odr double @numba_nextafter(double %x, double %y) alwaysinline {
  %z = call double @nextafter(double %x, double %y)
  ret double %z
}

define weak_odr void @PyErr_SetString(ptr %kind, ptr %text) {
  ret void
}
@PyExc_RuntimeError = weak_odr constant ptr null
"""


_OF_LIBM = frozenset((*FUNCTIONS, *BESIDE))


def link(parts: Iterable[str | bytes]) -> Any:
    """One module of them all, texts or LLVM's bitcode. The same helper in several of them is one.

    LLVM walks through the whole module that it links into. So modules of about one size are linked with each other:
    each is walked through a dozen times, not thousands of times.
    """
    row: list[tuple[Any, int]] = []  # with the numbers of parts, decreasing
    for given in (*parts, _RUNTIME):
        module, number = _parsed(given), 1
        while row and row[-1][1] == number:
            larger, number = row[-1][0], 2 * number
            larger.link_in(module)
            module = larger
            row.pop()
        row.append((module, number))
    while len(row) > 1:
        module, _ = row.pop()
        row[-1][0].link_in(module)
    return row[0][0]


def _parsed(given: str | bytes) -> Any:
    module = llvm.parse_assembly(given) if isinstance(given, str) else llvm.parse_bitcode(given)
    for function in module.functions:
        if not function.is_declaration and function.linkage == llvm.Linkage.external:
            function.linkage = "weak_odr"
    return module


def _text_constant(name: str, content: str) -> str:
    data = content.encode() + b"\0"
    codes = "".join(f"\\{byte:02x}" for byte in data)
    return f'@{name} = constant [{len(data)} x i8] c"{codes}"\n'


def _mangled(module: str) -> str:
    """How numba writes a module of the core in the names of its functions."""
    return "".join(f"{len(part)}{part}" for part in f"tlismni.core.{module}".split("."))


_SELDOM = tuple(
    _mangled(module)
    for module in (
        "analysis", "assembly.building", "assembly.condition_probe", "assembly.entries", "assembly.matrix_state",
        "assembly.partition_building", "assembly.projection", "assembly.structure_tables", "contact_solvers",
        "contacts.bristle2d", "contacts.bristle3d", "contacts.patch3d", "contacts.scalar_contact2d",
        "contacts.spherical_friction3d", "contacts.stop3d", "contacts.turning3d", "elements.cable_clamp3d",
        "elements.interface_load3d", "elements.joint_coordinates3d", "elements.measure3d", "elements.pid_law",
        "elements.relative_spin3d", "elements.rolling3d",
        "elements.spherical_friction3d", "event_detection.contact_evaluation", "event_detection.event_search",
        "event_detection.joint_loads", "event_detection.repivoting", "event_detection.roots", "events",
        "linalg.analyze", "linalg.ordering", "linalg.row_pivoting", "methods.frame_choice",
        "methods.frame_partition", "methods.frames",
        "recovery", "simulation", "stage.corotating", "stage.frame_motion", "stage.jfnk", "stage.simple",
        "time_loop.time_stepping",
    )
)  # fmt: skip
"""Where few bytes are worth more than speed: nothing is repeated there to save a jump."""
_BUSY, _ALONE = _mangled("contact_solvers.contact_blocks"), _mangled("contact_solvers.contact_blocks.sweep_contacts")
"""Of these, where time goes all the same, and what of it stays no part of its caller, which is one of the others."""


def optimised(
    whole: Any, symbols: Mapping[str, str], texts: Mapping[str, str], target: Target, quick: bool = False
) -> tuple[Any, Any]:
    """The module for a target, of which only `symbols` (new names by LLVM's) and `texts` (constants) are seen from
    outside; and LLVM's machine of that target. `quick`: with little done for its speed, and nothing inlined that need
    not be."""
    llvm.initialize_all_targets()
    llvm.initialize_all_asmprinters()
    machine = llvm.Target.from_triple(target.triple).create_target_machine(
        cpu=target.cpu, features=target.features, opt=1 if quick else 3, reloc="pic", codemodel="default"
    )
    module = whole.clone()
    module.triple, module.data_layout = target.triple, str(machine.target_data)
    for function in module.functions:
        if not function.is_declaration and _BUSY in function.name:
            if _ALONE in function.name:
                function.add_function_attribute("noinline")
        elif not function.is_declaration and any(part in function.name for part in _SELDOM):
            function.add_function_attribute("optsize")
        if function.name in symbols:
            function.linkage = "external"
            function.name = symbols[function.name]
        elif function.name in _OF_LIBM and not function.is_declaration:
            # the code generator asks for them by name, when it is too late to bring them back
            function.linkage, function.visibility = "external", "hidden"
        elif not function.is_declaration and not function.name.startswith(PREFIX):
            function.linkage = "internal"
        if not function.is_declaration and target.suffix != ".dll":
            # nothing is thrown through it, and tables that say how to would be a fortieth of the library; Windows wants
            # them to walk any stack
            function.add_function_attribute("nounwind")
    for variable in module.global_variables:
        if not variable.is_declaration:
            variable.linkage = "internal"
    module.link_in(llvm.parse_assembly("".join(_text_constant(*pair) for pair in texts.items())))
    options = llvm.create_pipeline_tuning_options(speed_level=3)
    options.loop_vectorization = options.slp_vectorization = options.loop_interleaving = True
    builder = llvm.create_pass_builder(machine, options)
    # what nobody calls goes first: half of it makes Python objects
    first = llvm.create_new_module_pass_manager()
    first.add_global_dead_code_eliminate_pass()
    if quick:
        first.add_always_inliner_pass()
        first.add_sroa_pass()
        first.add_simplify_cfg_pass()
        first.add_instruction_combine_pass()
        first.add_global_dead_code_eliminate_pass()
    first.run(module, builder)
    if not quick:
        builder.getModulePassManager().run(module, builder)
    module.verify()
    return module, machine


def undefined(module: Any) -> list[str]:
    """What a module takes from elsewhere, LLVM's own intrinsics left out."""
    return sorted(f.name for f in module.functions if f.is_declaration and not f.name.startswith("llvm."))


def manifest_text(entries: Mapping[str, str], forms: Mapping[str, Any], functions: Mapping[str, str]) -> str:
    """What `compiled/library.py` reads; `functions`: symbols of the functions of its own libm, by name."""
    content = {"entries": dict(entries), "forms": dict(forms), "libm": dict(functions)}
    return packed(json.dumps(content, separators=(",", ":")))
