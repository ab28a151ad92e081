"""The platforms that an FMU can have binaries for."""

import platform
from collections.abc import Sequence
from dataclasses import dataclass

from .errors import ExportError


@dataclass(frozen=True)
class Platform:
    """One platform: its folder in an FMU of each version, the suffix of its binaries, and how Zig names it. The oldest
    systems that its binaries run on are glibc 2.17, macOS 11 and Windows 10."""

    fmi2: str
    fmi3: str
    suffix: str
    target: str
    flags: tuple[str, ...] = ()

    def folder(self, fmi_version: str) -> str:
        """Name of its folder under `binaries` in an FMU."""
        return self.fmi2 if fmi_version.startswith("2") else self.fmi3


# its own name in the binary would else be that of the folder where it was made
_DARWIN = ("-fPIC", "-Wl,-install_name,@rpath/tlismni_shim.dylib")

PLATFORMS = {
    found.fmi3: found
    for found in (
        Platform("linux64", "x86_64-linux", ".so", "x86_64-linux-gnu.2.17", ("-fPIC", "-ldl", "-lpthread")),
        Platform("aarch64-linux", "aarch64-linux", ".so", "aarch64-linux-gnu.2.17", ("-fPIC", "-ldl", "-lpthread")),
        Platform("darwin64", "x86_64-darwin", ".dylib", "x86_64-macos.11.0", _DARWIN),
        Platform("aarch64-darwin", "aarch64-darwin", ".dylib", "aarch64-macos.11.0", _DARWIN),
        Platform("win64", "x86_64-windows", ".dll", "x86_64-windows-gnu"),
    )
}
"""What can be built, by the names that FMI 3.0 gives."""
_SYSTEMS = {"Linux": "linux", "Windows": "win", "Darwin": "darwin"}


def this_platform() -> str:
    """FMI 3.0's name for this machine, such as "x86_64-linux"; not all that have one are in PLATFORMS."""
    machine = platform.machine().lower()
    system = {"Linux": "linux", "Windows": "windows", "Darwin": "darwin"}.get(platform.system(), "unknown")
    return f"{ {'amd64': 'x86_64', 'arm64': 'aarch64'}.get(machine, machine) }-{system}"


def fmi2_platform() -> str:
    """Folder name of this machine's binaries in an FMI 2.0 FMU."""
    machine = platform.machine().lower()
    system = _SYSTEMS.get(platform.system(), platform.system().lower())
    if machine in ("x86_64", "amd64"):
        return f"{system}64"
    return f"{'aarch64' if machine == 'arm64' else machine}-{system}"


def choose(names: Sequence[str]) -> list[str]:
    """Names of platforms; "all" means all that can be built. Raises ExportError for an unknown one."""
    chosen: list[str] = []
    for name in names:
        if name != "all" and name not in PLATFORMS:
            raise ExportError(f"platform '{name}' is unknown: choose from {['all', *PLATFORMS]}")
        chosen += PLATFORMS if name == "all" else [name]
    return list(dict.fromkeys(chosen))
