"""LLVM's text of everything that numba compiles, before it optimises or links any of it.

numba makes machine code of each function together with all that it calls, and its code generator changes a module while
it does so: what can be taken later is neither whole nor as it was. Here no machine code is made at all. This leans on
numba's internals, of 0.68 (`tests/core/test_aot.py` looks whether they are still so).
"""

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from itertools import count
from typing import Any

from numba.core import cgutils
from numba.core.bytecode import FunctionIdentity
from numba.core.codegen import JITCodeLibrary
from numba.core.registry import cpu_target
from numba.core.runtime import rtsys

from ..compiled.kept import KeptCode
from ..errors import TlismniError
from .front import quick_front_end, replaced

PARTS = 1000
"""More than there are parts."""


class RecordError(TlismniError):
    """Something was not recorded."""


class RecordedLibrary(JITCodeLibrary):
    """The functions of one compilation, as text."""

    def __init__(self, codegen: Any, name: str) -> None:
        super().__init__(codegen, name)
        self.texts: list[str] = []

    def add_ir_module(self, ir_module: Any) -> None:
        self.texts.append(cgutils.normalize_ir_text(str(ir_module)))

    def add_linking_library(self, library: Any) -> None:
        self._linking_libraries.append(library)

    def finalize(self) -> None:
        self._finalized = True

    def get_pointer_to_function(self, name: str) -> int:
        """None: nothing is run."""
        return 0


@contextmanager
def recording(part: int = 0) -> Iterator[None]:
    """numba makes text instead of machine code meanwhile. What it has compiled before stays as it is.

    `part`: a number of this process, so that what several record can be put together.
    """
    context = cpu_target.target_context
    rtsys.initialize(context)  # its own helpers are machine code
    codegen = context.codegen()
    kept = KeptCode.load_overload, KeptCode.save_overload
    codegen._library_class = RecordedLibrary
    codegen.set_env = lambda name, environment: None  # would write into the code
    KeptCode.load_overload = lambda self, sig, target_context: None  # type: ignore[method-assign]
    KeptCode.save_overload = lambda self, sig, data: None  # type: ignore[method-assign]
    try:
        with quick_front_end(), same_names(part):
            yield
    finally:
        KeptCode.load_overload, KeptCode.save_overload = kept  # type: ignore[method-assign]
        del codegen._library_class, codegen.set_env


@contextmanager
def same_names(part: int) -> Iterator[None]:
    """A function of a module has the same name in LLVM whenever it is compiled; others (made by functions, they may
    differ although their names do not) have one that is of this part alone.

    numba counts what it compiles, and the number is in the name.
    """
    numbers = count(1 + part, PARTS)
    from_function = FunctionIdentity.from_function

    def identity(function: Any) -> FunctionIdentity:
        made = from_function(function)
        found = getattr(made.module, made.func_qualname, None)
        of_module = getattr(found, "py_func", found) is made.func
        made.unique_id = 0 if of_module else next(numbers)
        made.unique_name = f"{made.func_qualname}${made.unique_id}"
        return made

    with replaced(FunctionIdentity, "from_function", staticmethod(identity)):
        yield


def compile_for(function: Any, signature: Any) -> Any:
    """The compilation of a numba function, without what Python would need to call it."""
    for options in (function.targetoptions, function._compiler.targetoptions):
        options.update(no_cpython_wrapper=True, no_cfunc_wrapper=True)
    arguments = tuple(getattr(signature, "args", signature))
    function.compile(arguments)
    (made,) = [found for taken, found in function.overloads.items() if taken == arguments]
    return made


def texts_of(compilations: Iterable[Any]) -> list[str]:
    """The texts of all that these compilations call. Raises RecordError if one of them is machine code already."""
    found: list[str] = []
    seen: set[Any] = set()

    def visit(library: Any) -> None:
        if library in seen or library is rtsys.library:  # in whose place `module.py` has its own
            return
        if not isinstance(library, RecordedLibrary):
            raise RecordError(f"{library!r} was compiled before recording began: record in a new process")
        seen.add(library)
        for other in library._linking_libraries:
            visit(other)
        found.extend(library.texts)

    for compilation in compilations:
        visit(compilation.library)
    return found
