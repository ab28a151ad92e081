"""What machine code is made for."""

import platform
import sys
from dataclasses import dataclass

from ..errors import TlismniError


@dataclass(frozen=True)
class Target:
    """What machine code is for."""

    name: str
    triple: str
    cpu: str
    features: str
    suffix: str
    """Of a shared library there."""
    linker: str
    """Name of the target as zig writes it."""


TARGETS = {
    target.name: target
    for target in (
        Target("linux-x86_64", "x86_64-unknown-linux-gnu", "x86-64-v2", "", ".so", "x86_64-linux-gnu.2.17"),
        Target("linux-aarch64", "aarch64-unknown-linux-gnu", "generic", "", ".so", "aarch64-linux-gnu.2.17"),
        Target("musl-x86_64", "x86_64-unknown-linux-musl", "x86-64-v2", "", ".so", "x86_64-linux-musl"),
        Target("musl-aarch64", "aarch64-unknown-linux-musl", "generic", "", ".so", "aarch64-linux-musl"),
        Target("windows-x86_64", "x86_64-pc-windows-gnu", "x86-64-v2", "", ".dll", "x86_64-windows-gnu"),
        Target("windows-aarch64", "aarch64-pc-windows-gnu", "generic", "", ".dll", "aarch64-windows-gnu"),
        Target("macos-x86_64", "x86_64-apple-macosx11.0.0", "x86-64-v2", "", ".dylib", "x86_64-macos.11.0"),
        Target("macos-aarch64", "arm64-apple-macosx11.0.0", "apple-m1", "", ".dylib", "aarch64-macos.11.0"),
    )
}


def own_name() -> str:
    """Name of the target that this machine is, known or not."""
    machine = {"amd64": "x86_64", "arm64": "aarch64"}.get(platform.machine().lower(), platform.machine().lower())
    system = {"win32": "windows", "darwin": "macos"}.get(sys.platform, "linux")
    return f"{system}-{machine}"


def own_target() -> Target:
    """That of this machine. Raises TlismniError for one that is unknown."""
    name = own_name()
    if name not in TARGETS:
        raise TlismniError(f"there is no target '{name}': known are {sorted(TARGETS)}")
    return TARGETS[name]
