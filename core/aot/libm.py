"""One libm for all platforms: musl's, whose sources ziglang's package carries, as LLVM's text.

Compiled once, for no machine in particular, it goes into the module of everything, and from there into the machine code
of each target like all else: the same source, the same operations, each rounded once, so the same bits everywhere. What
the machine does by itself (square roots, rounding to whole numbers) is exact anyway.
"""

import re
import subprocess
import sys
import tempfile
from importlib.util import find_spec
from pathlib import Path

from ..errors import TlismniError

FUNCTIONS = (
    "sin", "cos", "tan", "asin", "acos", "atan", "atan2", "exp", "exp2", "exp10", "expm1", "log", "log2", "log10",
    "log1p", "pow", "hypot", "fmod", "nextafter", "sinh", "cosh", "tanh", "ldexp",
)  # fmt: skip
"""What compiled code may call; those of two arguments are TWO, `ldexp` has a number and a whole one."""
TWO = ("atan2", "pow", "hypot", "fmod", "nextafter")
BESIDE = ("sincos", "modf", "scalbn", "sqrt", "__sincos_stret", "__exp10")
"""What else a code generator makes of them."""
SEEN = (*FUNCTIONS, "sincos")
"""Those that code compiled elsewhere can call."""
_HELPERS = (
    "__sin", "__cos", "__tan", "__rem_pio2", "__rem_pio2_large", "__expo2", "exp_data", "log_data", "log2_data",
    "pow_data", "__math_oflow", "__math_uflow", "__math_xflow", "__math_divzero", "__math_invalid",
)  # fmt: skip
PREFIX = "tlismni_libm_"
"""Before the names by which these functions are seen from outside the library."""
_TARGET = "x86_64-linux-musl"
"""Whose headers are used, of the plainest processor: without fused operations."""
_FLAGS = ("-std=c99", "-O2", "-g0", "-ffreestanding", "-fno-builtin", "-ffp-contract=off", "-w", "-S", "-emit-llvm")
_OF_MACHINE = {"fabs": "llvm.fabs.f64", "sqrt": "llvm.sqrt.f64", "floor": "llvm.floor.f64"}
_KEPT_ATTRIBUTES = re.compile(r'\s"(?!no-builtins)[\w-]+"(="[^"]*")?|\suwtable')

# macOS asks for sine and cosine at once, and for powers of ten, in this way; square roots are an instruction
_OF_OURS = """
declare double @llvm.sqrt.f64(double)

define double @sqrt(double %x) {
  %y = call double @llvm.sqrt.f64(double %x)
  ret double %y
}

declare double @sin(double)
declare double @cos(double)

define { double, double } @__sincos_stret(double %x) {
  %s = call double @sin(double %x)
  %c = call double @cos(double %x)
  %half = insertvalue { double, double } undef, double %s, 0
  %both = insertvalue { double, double } %half, double %c, 1
  ret { double, double } %both
}

declare double @exp10(double)

define double @__exp10(double %x) {
  %y = call double @exp10(double %x)
  ret double %y
}
"""


class LibmError(TlismniError):
    """The sources of the libm are not there, or do not compile."""


def _musl() -> Path | None:
    found = find_spec("ziglang")
    folders = [] if found is None else found.submodule_search_locations or []
    return next((Path(folder, "lib", "libc", "musl") for folder in folders), None)


def libm_texts() -> list[str]:
    """LLVM's texts of FUNCTIONS and what they need; none without ziglang: then the library takes the system's libm.

    Raises
    ------
    LibmError : for a version of ziglang that has not all of them.
    """
    musl = _musl()
    if musl is None:
        return []
    sources = [musl / "src" / "math" / f"{name}.c" for name in (*FUNCTIONS, *BESIDE[:3], *_HELPERS)]
    missing = [source.name for source in sources if not source.is_file()]
    if missing:
        raise LibmError(
            f"the ziglang that is installed has no {', '.join(missing)} of musl's libm: take the version that the "
            "extra 'cross' names (pip install 'tlismni[cross]')"
        )
    include = [f"-I{musl / part}" for part in ("src/include", "src/internal", "arch/generic")]
    texts = []
    with tempfile.TemporaryDirectory() as folder:
        for source in sources:
            out = Path(folder, "out.ll")
            command = [sys.executable, "-m", "ziglang", "cc", "-target", _TARGET, *_FLAGS, *include]
            done = subprocess.run([*command, "-o", str(out), str(source)], capture_output=True, text=True, check=False)
            if done.returncode != 0:
                raise LibmError(f"'{source}' does not compile: {done.stderr.strip()}")
            texts.append(plain(out.read_text()))
    return [*texts, _OF_OURS, _seen()]


def plain(text: str) -> str:
    """A text without what is of one machine."""
    lines = [x for x in text.splitlines() if not x.startswith(("target ", "source_filename", "@pow10"))]
    text = "\n".join(_KEPT_ATTRIBUTES.sub("", x) if x.startswith("attributes ") else x for x in lines)
    for name, machine in _OF_MACHINE.items():
        text = re.sub(rf"^declare .*@{name}\(.*\n", "", text, flags=re.MULTILINE).replace(f"@{name}(", f"@{machine}(")
        if f"@{machine}(" in text and not re.search(rf"^declare .*@{machine}\(", text, flags=re.MULTILINE):
            text += f"\ndeclare double @{machine}(double)"
    return text


def _seen() -> str:
    """The same functions under names that nobody else has."""
    lines = []
    for name in FUNCTIONS:
        rest = ", double %y" if name in TWO else ", i32 %y" if name == "ldexp" else ""
        lines += [
            f"declare double @{name}(double{rest.removesuffix(' %y')})",
            f"define double @{PREFIX}{name}(double %x{rest}) {{",
            f"  %z = call double @{name}(double %x{rest})",
            "  ret double %z",
            "}",
        ]
    lines += [
        "declare void @sincos(double, ptr, ptr)",
        f"define void @{PREFIX}sincos(double %x, ptr %s, ptr %c) {{",
        "  call void @sincos(double %x, ptr %s, ptr %c)",
        "  ret void",
        "}",
    ]
    return "\n".join(lines)
