"""Checks wheels file by file and their libraries symbol by symbol, without running them."""

from __future__ import annotations

import re
import zipfile
from typing import TYPE_CHECKING, Any

from morse.kernel import targets

if TYPE_CHECKING:
    from collections.abc import Iterable
    from pathlib import Path

LIBRARIES = "morse/kernel/lib/"
#: bytes of a wheel
LARGEST = 30 << 20
#: the versions of systems that the tags of the wheels promise
GLIBC, MACOS = (2, 17), (11, 0)
#: what libraries may need of a system
SYSTEM_LIBRARIES = {
    "linux-gnu": re.compile(r"lib(c|m|pthread)\.so\.\d+|ld-linux.*"),
    "linux-musl": re.compile(r"libc\.so"),
    "macos": re.compile(r"/usr/lib/libSystem\.B\.dylib"),
    "windows": re.compile(r"KERNEL32\.dll|api-ms-win-crt-[a-z0-9-]+\.dll", re.IGNORECASE),
}
#: what a build adds to the files of the repository; the names of scripts and styles of the page contain a digest
_BUILT = re.compile(
    r"morse/viewer/static/(index\.html|assets/(icon-[\w-]+\.svg|(index|worker|codeeditor)-[\w-]+\.(css|js)|licences\.txt))"
    r"|morse/core/classes/definitions/classes\.index|morse/kernel/lib/[\w.-]+"
    r"|morse_simulator-[\w.+-]+\.dist-info/(METADATA|WHEEL|RECORD|entry_points\.txt|licenses/LICENSE)"
)
_MACHINES = {
    "x86_64": {"X86_64", "AMD64"},
    "aarch64": {"AARCH64", "ARM64"},
}


def strays(names: Iterable[str], sources: Iterable[str]) -> list[str]:
    """The files of a wheel that should not be in it, and those that it lacks.

    Args:
        names: the paths in the wheel.
        sources: the paths of the repository below ``src``.
    """
    there, expected = set(names), set(sources)
    errors = [f"{name} is neither in the repository nor made by the build" for name in there - expected]
    errors = [error for error in errors if not _BUILT.fullmatch(error.partition(" ")[0])]
    return sorted(errors) + [f"{name} is missing" for name in sorted(expected - there)]


def verify(wheels: list[Path], sources: Iterable[str] | None = None) -> list[str]:
    """What is wrong with the wheels of a release; an empty list if nothing is.

    Args:
        wheels: the wheels of all platforms, of one version.
        sources: the paths of the repository below ``src``; None if they are not compared.
    """
    errors: list[str] = []
    common: dict[str, dict[str, int]] = {}
    functions: dict[str, frozenset[str]] = {}
    for path in wheels:
        target = next((one for one in targets.ALL if path.stem.endswith(f"py3-none-{one.platform_tag}")), None)
        if target is None:
            errors.append(f"{path.name}: the tag names no platform of the kernel")
            continue
        if path.stat().st_size > LARGEST:
            errors.append(f"{path.name}: {path.stat().st_size} bytes, at most {LARGEST}")
        with zipfile.ZipFile(path) as archive:
            sums = {one.filename: one.CRC for one in archive.infolist()}
            if sources is not None:
                errors += [f"{path.name}: {error}" for error in strays(sums, sources)]
            names = {name.removeprefix(LIBRARIES) for name in sums if name.startswith(LIBRARIES)}
            expected = {target.file_name(level) for level in target.levels}
            if names != expected:
                errors.append(f"{path.name}: libraries {sorted(names)}, expected {sorted(expected)}")
            for name in sorted(names & expected):
                problems, exported = inspect(archive.read(LIBRARIES + name), target)
                errors += [f"{path.name}: {name}: {problem}" for problem in problems]
                functions[f"{path.name}: {name}"] = exported
            for needed in ("morse/viewer/static/index.html", "morse/core/classes/definitions/classes.index"):
                if needed not in sums:
                    errors.append(f"{path.name}: {needed} is missing")
        common[path.name] = {
            name: value
            for name, value in sums.items()
            if not name.startswith(LIBRARIES) and not name.endswith((".dist-info/WHEEL", ".dist-info/RECORD"))
        }
    errors += _differences(common)
    every = frozenset().union(*functions.values())
    errors += [f"{name} does not export {sorted(every - own)}" for name, own in functions.items() if own != every]
    return errors


def _differences(common: dict[str, dict[str, int]]) -> list[str]:
    """Files that are not the same in all wheels."""
    if not common:
        return ["there are no wheels"]
    first, *others = common
    errors = []
    for other in others:
        different = {name for name, _ in common[first].items() ^ common[other].items()}
        if different:
            errors.append(f"{other} differs from {first} in {sorted(different)[:5]}")
    return errors


def inspect(data: bytes, target: targets.Target) -> tuple[list[str], frozenset[str]]:
    """What is wrong with a library, and the functions of the kernel that it exports."""
    import lief

    system = {"linux-gnu": "linux", "linux-musl": "linux"}.get(target.system, target.system)
    kinds: dict[str, Any] = {"linux": lief.ELF.Binary, "macos": lief.MachO.Binary, "windows": lief.PE.Binary}
    binary: Any = lief.parse(list(data))
    if not isinstance(binary, kinds[system]):
        return [f"not a library of {target.system}"], frozenset()
    errors = []
    if system == "linux":
        machine, needed = binary.header.machine_type.name, [str(name) for name in binary.libraries]
        exported = [str(symbol.name) for symbol in binary.exported_symbols]
        auxiliaries = [one for need in binary.symbols_version_requirement for one in need.get_auxiliary_symbols()]
        versions = [tuple(map(int, re.findall(r"\d+", str(one.name)))) for one in auxiliaries]
        if any(version[:2] > GLIBC for version in versions):
            errors.append(f"needs glibc {max(versions)}, at most {GLIBC}")
    elif system == "macos":
        machine = binary.header.cpu_type.name
        own, *needed = [str(library.name) for library in binary.libraries]
        exported = [str(symbol.name).removeprefix("_") for symbol in binary.exported_symbols]
        if not own.startswith("@rpath/"):
            errors.append(f"its own name is {own}")
        if tuple(binary.build_version.minos[:2]) > MACOS:
            errors.append(f"needs macOS {binary.build_version.minos}, at most {MACOS}")
    else:
        machine, needed = binary.header.machine.name, [str(library.name) for library in binary.imports]
        exported = [str(entry.name) for entry in binary.get_export().entries]
    if machine not in _MACHINES[target.machine]:
        errors.append(f"for {machine}, not for {target.machine}")
    errors += [f"needs {name}" for name in needed if not SYSTEM_LIBRARIES[target.system].fullmatch(name)]
    return errors, frozenset(name for name in exported if name.startswith("morse_"))
