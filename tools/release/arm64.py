"""Tries the wheel for Linux on ARM64 on another processor, with the emulator QEMU and packages of Debian.

``python -m tools arm64 [WHEEL]``: without a wheel, the one of the last commit is built. Nothing is installed on the
machine: Debian's Python for ARM64, the emulator and the wheels are unpacked into a temporary folder. It needs
``apt-get`` and ``dpkg``, and the archive and the index of packages that they and pip are set up for.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from tools.release import steps, wheels

TARGET = "linux-gnu-aarch64"
#: the version of Python of the release of Debian from which it is taken
SUITE, PYTHON = "bookworm", "3.11"
KEYS = "/usr/share/keyrings/debian-archive-keyring.gpg"
#: the newest glibc that this release has for wheels of others
_PLATFORMS = ("manylinux_2_28_aarch64", "manylinux_2_17_aarch64", "manylinux2014_aarch64")
_RUNNER = ("pytest", "pytest-timeout", "pytest-xdist", "hypothesis")
_SCENE = "src/morse/data/examples/repeatable/scene.py"
#: compiles with the compiler of this machine
_NOT_HERE = "--ignore=tests/kernel/test_sanitizers.py"


def main(wheel: Path | None) -> int:
    """Unpack, check, test and compare; the result is the status of the process."""
    missing = [name for name in ("apt-get", "dpkg") if shutil.which(name) is None]
    if missing or not Path(KEYS).is_file():
        print(f"skipped: needs {', '.join(missing) or KEYS}, as Debian and Ubuntu have them", file=sys.stderr)
        return 0
    with tempfile.TemporaryDirectory() as temporary:
        place = Path(temporary)
        if wheel is None:
            *_, wheel = wheels.build(place / "dist", [TARGET])
        emulated = _machine(place, wheel.resolve())
        if emulated is None:
            return 1
        program, settings = emulated
        tests = ["-m", "pytest", "-q", "-p", "no:cacheprovider", "--timeout", "1800", _NOT_HERE, "tests/kernel"]
        verify = ["-m", "morse", "verify", "--ticks", "60", _SCENE]
        for title, arguments in (("check", ["-m", "morse", "check"]), ("kernel", tests), ("verify", verify)):
            if steps.run(title, [program, *arguments], wheels.ROOT, settings) is None:
                return 1
        bits = str(Path(__file__).with_name("bits.py"))
        other = steps.run("bits", [program, bits], place, settings)
        own = steps.run("own bits", [sys.executable, bits], place)
    return 1 if own is None or other is None else compare(own, other)


def compare(own: str, other: str) -> int:
    """Print the lines that differ; the result is the status of the process."""
    lines, others = own.splitlines(), other.splitlines()
    errors = [line for line in lines if line not in others] if len(lines) == len(others) else ["their number"]
    for line in errors:
        print(f"error: other bits than on this processor: {line}", file=sys.stderr)
    print(f"{len(lines)} images, depths and scans compared, {len(errors)} errors")
    return 1 if errors else 0


def _machine(place: Path, wheel: Path) -> tuple[str, dict[str, str]] | None:
    """A Python for ARM64 with the wheel and what it needs: the program and its environment; None after an error."""
    debian = _debian(place)
    packages = ("python" + PYTHON, "libstdc++6", "libgcc-s1")
    site, root = place / "site", place / "root"
    platforms = [f"--platform={platform}" for platform in _PLATFORMS]
    pip = [sys.executable, "-m", "pip", "install", "-q", "--target", str(site), "--python-version", PYTHON, *platforms]
    for title, command in (
        ("index", [*debian, "update", "-q"]),
        ("python", [*debian, "install", "-y", "-q", "--download-only", "--no-install-recommends", *packages]),
        ("qemu", ["apt-get", "download", "-q", "qemu-user-static"]),
        ("wheels", [*pip, "--only-binary=:all:", str(wheel), *_RUNNER]),
    ):
        if steps.run(title, command, place) is None:
            return None
    for package in (place / "cache/archives").glob("*.deb"):
        subprocess.run(["dpkg", "-x", str(package), str(root)], check=True)
    (emulator,) = place.glob("qemu-user-static*.deb")
    subprocess.run(["dpkg", "-x", str(emulator), str(place / "qemu")], check=True)
    program = place / "python"
    program.write_text(
        f'#!/bin/sh\nexec {place}/qemu/usr/bin/qemu-aarch64-static -L {root} {root}/usr/bin/python{PYTHON} "$@"\n',
        encoding="utf-8",
    )
    program.chmod(0o755)
    # the system cannot start programs for ARM64: child processes of Python are started by the emulator, too
    (site / "sitecustomize.py").write_text(f"import sys\nsys.executable = {str(program)!r}\n", encoding="utf-8")
    return str(program), {**os.environ, "PYTHONPATH": str(site), "PYTHONDONTWRITEBYTECODE": "1"}


def _debian(place: Path) -> list[str]:
    """The command of a package manager for ARM64 that has its own lists and knows of no installed package."""
    for folder in ("state/lists/partial", "cache/archives/partial"):
        (place / folder).mkdir(parents=True)
    (place / "state/status").touch()
    mirror = "http://deb.debian.org/debian"
    (place / "sources.list").write_text(f"deb [signed-by={KEYS}] {mirror} {SUITE} main\n", encoding="utf-8")
    options = {
        "APT::Architecture": "arm64",
        "APT::Architectures::": "arm64",
        "APT::Sandbox::User": "root",  # the folder belongs to who has called this program
        "Acquire::Languages": "none",
        "Dir::State": place / "state",
        "Dir::State::status": place / "state/status",
        "Dir::Cache": place / "cache",
        "Dir::Etc::sourcelist": place / "sources.list",
        "Dir::Etc::sourceparts": "-",
    }
    return ["apt-get", *(part for name, value in options.items() for part in ("-o", f"{name}={value}"))]
