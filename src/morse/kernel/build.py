"""Compiles the kernel with the C compiler of Zig, which is in the package ``ziglang``.

The build of the package calls `build`. By hand: ``python -m morse.kernel.build``, with ``--all TARGET_FOLDER`` for
every platform.
"""

from __future__ import annotations

import argparse
import hashlib
import os
import shutil
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import TYPE_CHECKING

from morse.kernel import targets
from morse.kernel.layout import SOURCES, layout

if TYPE_CHECKING:
    from collections.abc import Sequence

_STAMP = ".sources"
WARNINGS = ("-Wall", "-Wextra", "-Wstrict-prototypes", "-Wmissing-prototypes", "-Wshadow", "-Werror")
#: for bit-identical results: no fused products and sums, no reordering, no flush to zero
EXACT = ("-std=c11", "-ffp-contract=off", "-fno-fast-math", "-fno-math-errno", "-fno-trapping-math")
_OPTIONS = ("-O3", "-shared", "-fvisibility=hidden", "-fno-sanitize=undefined", "-fno-stack-protector", "-s")


def sources() -> list[Path]:
    """The C files."""
    return sorted(SOURCES.glob("*.c"))


def build(target: targets.Target, folder: Path = targets.FOLDER) -> list[Path]:
    """Compile the libraries of a platform, unless the existing libraries were compiled from the same sources.

    Raises:
        RuntimeError: the compiler reported an error.
    """
    state = _state(target)
    libraries = [folder / target.file_name(level) for level in target.levels]
    if is_current(target, folder):
        return libraries
    folder.mkdir(parents=True, exist_ok=True)
    with ThreadPoolExecutor() as pool:
        for future in [pool.submit(_compile, target, level, folder) for level in target.levels]:
            future.result()
    stamp(target, folder).write_text(state, encoding="utf-8")
    return libraries


def stamp(target: targets.Target, folder: Path = targets.FOLDER) -> Path:
    """The file with the state of the sources from which the libraries of a platform were compiled."""
    return folder / f"{_STAMP}-{target}"


def is_current(target: targets.Target, folder: Path = targets.FOLDER) -> bool:
    """Whether the libraries of a platform were compiled from the present sources."""
    file = stamp(target, folder)
    libraries = [folder / target.file_name(level) for level in target.levels]
    return (
        file.is_file()
        and file.read_text(encoding="utf-8") == _state(target)
        and all(path.is_file() for path in libraries)
    )


def _state(target: targets.Target) -> str:
    """A digest of all sources and settings of the libraries."""
    here = Path(__file__)
    digest = hashlib.sha256(str(target).encode())
    for path in [*sorted(SOURCES.iterdir()), here, here.parent / "targets.py", here.parent / "layout.py"]:
        digest.update(path.name.encode() + b"\0" + path.read_bytes() + b"\0")
    return digest.hexdigest()


def _compile(target: targets.Target, level: int, folder: Path) -> None:
    library = folder / target.file_name(level)
    # elsewhere, because a process that is killed leaves the files behind, and everything in the folder is packaged
    with tempfile.TemporaryDirectory() as temporary:
        output = Path(temporary) / library.name
        position = () if target.system == "windows" else ("-fPIC",)
        # without a name of its own the library would contain the path of the temporary folder
        name = (f"-Wl,-install_name,@rpath/{library.name}",) if target.system == "macos" else ()
        platform = ("-target", target.zig, f"-mcpu={target.processor(level)}")
        command = [sys.executable, "-m", "ziglang", "cc", *platform, *EXACT, *_OPTIONS, *position, *name, *WARNINGS]
        command += [f"-DMORSE_LAYOUT={layout():#x}ull"]
        command += ["-o", str(output), *map(str, sources())]
        # who compiles for many platforms may share the caches of the compiler
        caches = {name: os.environ.get(name, temporary) for name in ("ZIG_GLOBAL_CACHE_DIR", "ZIG_LOCAL_CACHE_DIR")}
        process = subprocess.run(
            command, capture_output=True, encoding="utf-8", errors="replace", env={**os.environ, **caches}
        )
        if process.returncode:
            raise RuntimeError(f"The kernel could not be compiled for {target}:\n\n{process.stderr[-4000:]}")
        copy = folder / f".{library.name}.{os.getpid()}"
        shutil.copyfile(output, copy)
        # another process may have the old file open
        os.replace(copy, library)


def main(arguments: Sequence[str] | None = None) -> None:
    """The command line."""
    parser = argparse.ArgumentParser(prog="python -m morse.kernel.build", description="Compile the kernel of MORSE.")
    parser.add_argument("--all", metavar="FOLDER", type=Path, help="compile it for every platform, into a folder")
    options = parser.parse_args(arguments)
    host = targets.host()
    if options.all is None and host is None:
        parser.error("the kernel does not support this platform; numpy is used instead")
    for target in targets.ALL if options.all else [host]:
        assert target is not None
        for library in build(target, options.all or targets.FOLDER):
            print(library)


if __name__ == "__main__":
    main()
