"""The platforms that the kernel is compiled for."""

from __future__ import annotations

import platform
import sys
import sysconfig
from dataclasses import dataclass
from pathlib import Path

#: directory of the libraries
FOLDER = Path(__file__).parent / "lib"

_SUFFIXES = {"linux-gnu": ".so", "linux-musl": ".so", "macos": ".dylib", "windows": ".dll"}
_MACHINES = {"x86_64": "x86_64", "amd64": "x86_64", "aarch64": "aarch64", "arm64": "aarch64"}
#: the oldest systems that the libraries support, in the notation of Zig
_ZIG_SYSTEMS = {
    "linux-gnu": "linux-gnu.2.17",
    "linux-musl": "linux-musl",
    "macos": "macos.11.0",
    "windows": "windows-gnu",
}
#: how wheels name these systems (PEP 600, PEP 656)
_WHEEL_SYSTEMS = {
    "linux-gnu": "manylinux_2_17_{}",
    "linux-musl": "musllinux_1_2_{}",
    "macos": "macosx_11_0_{}",
    "windows": "win_{}",
}
_WHEEL_MACHINES = {
    "macos": {"x86_64": "x86_64", "aarch64": "arm64"},
    "windows": {"x86_64": "amd64", "aarch64": "arm64"},
}
#: levels of the instruction set; 0 if there is only one
_LEVELS = {"x86_64": (2, 3), "aarch64": (0,)}


@dataclass(frozen=True)
class Target:
    """An operating system and a processor.

    Attributes:
        system: ``linux-gnu``, ``linux-musl``, ``macos`` or ``windows``.
        machine: ``x86_64`` or ``aarch64``.
    """

    system: str
    machine: str

    @property
    def levels(self) -> tuple[int, ...]:
        """The levels of the instruction set with libraries, the lowest first."""
        return _LEVELS[self.machine]

    @property
    def zig(self) -> str:
        """The target in the notation of Zig."""
        return f"{self.machine}-{_ZIG_SYSTEMS[self.system]}"

    @property
    def platform_tag(self) -> str:
        """The platform in the name of a wheel."""
        machine = _WHEEL_MACHINES.get(self.system, {}).get(self.machine, self.machine)
        return _WHEEL_SYSTEMS[self.system].format(machine)

    def processor(self, level: int) -> str:
        """The processor in the notation of Zig."""
        return f"{self.machine}_v{level}" if level else "generic"

    def file_name(self, level: int) -> str:
        """The name of a library."""
        suffix = f"_v{level}" if level else ""
        return f"{self.system}-{self.machine}{suffix}{_SUFFIXES[self.system]}"

    def __str__(self) -> str:
        return f"{self.system}-{self.machine}"


ALL = tuple(Target(system, machine) for system in _SUFFIXES for machine in _LEVELS)


def host() -> Target | None:
    """The platform of this Python; None if the kernel does not support it."""
    machine = _MACHINES.get(platform.machine().lower())
    if machine is None or sys.maxsize < 2**32:
        return None
    if sys.platform == "linux":
        musl = "musl" in (sysconfig.get_config_var("HOST_GNU_TYPE") or "") or "musl" in (
            sysconfig.get_config_var("SOABI") or ""
        )
        return Target("linux-musl" if musl else "linux-gnu", machine)
    system = {"darwin": "macos", "win32": "windows"}.get(sys.platform)
    return Target(system, machine) if system else None
