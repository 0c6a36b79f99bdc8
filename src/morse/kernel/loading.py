"""Finds the library that suits the processor, and loads it."""

from __future__ import annotations

import ctypes
import importlib.util
import logging
import os
import sysconfig
from functools import cache

from morse.kernel import targets
from morse.kernel.layout import SOURCES, layout
from morse.system import OF_MACHINE, variables

logger = logging.getLogger(__name__)

VARIABLE = "MORSE_KERNEL"


class KernelError(OSError):
    """The native kernel cannot be loaded."""


@cache
def library() -> ctypes.CDLL:
    """The kernel.

    The environment variable ``MORSE_KERNEL`` selects a level of the instruction set, ``v2`` or ``v3``; by default, it
    is the highest level that the processor supports.

    Raises:
        KernelError: it was not compiled for this platform, or from C files with other structures.
    """
    choice = variables.word(VARIABLE)
    target = targets.host()
    if target is None:
        names = ", ".join(map(str, targets.ALL))
        here = sysconfig.get_platform()
        raise KernelError(f"MORSE has no native kernel for this platform, {here}, but for {names}")
    file_names = {f"v{level}": level for level in target.levels if level}
    try:
        if is_stale(target):
            _renew(target)
        return load(target, file_names[choice]) if choice in file_names else _best(target)
    except OSError as error:
        raise KernelError(f"the native kernel cannot be loaded: {error}") from None


def is_stale(target: targets.Target) -> bool:
    """Whether a source of an editable installation was saved after the library was compiled, and has changed."""
    path = targets.FOLDER / target.file_name(target.levels[0])
    try:
        compiled = path.stat().st_mtime_ns
        if all(source.stat().st_mtime_ns <= compiled for source in SOURCES.iterdir()):
            return False
        # imported only now, because it takes longer than the check
        from morse.kernel import build

        return build.stamp(target).is_file() and not build.is_current(target)
    except OSError:
        return False


def _renew(target: targets.Target) -> None:
    """Compile the libraries again after the C files of an editable installation have changed.

    Raises:
        OSError: the compiler reported an error.
    """
    if importlib.util.find_spec("ziglang") is None or not os.access(targets.FOLDER, os.W_OK):
        logger.warning(
            "The native kernel was compiled from other sources than those of this checkout: run python -m "
            "morse.kernel.build, which needs the package ziglang",
            extra=OF_MACHINE,
        )
        return
    logger.info("The native kernel is compiled again, because its C files have changed: this takes some seconds")
    from morse.kernel import build

    try:
        build.build(target)
    except RuntimeError as error:
        raise OSError(str(error)) from None


def load(target: targets.Target, level: int) -> ctypes.CDLL:
    """Load the build of one level.

    Raises:
        OSError: the build does not exist, or was compiled from C files with other structures.
    """
    path = targets.FOLDER / target.file_name(level)
    if not path.is_file():
        raise FileNotFoundError(f"{path.name} was not built; run python -m morse.kernel.build")
    kernel_library = ctypes.CDLL(str(path))
    if _layout_of(kernel_library) != layout():
        raise OSError(
            f"{path.name} was compiled from other sources, with other structures; run python -m morse.kernel.build"
        )
    return kernel_library


def _layout_of(kernel_library: ctypes.CDLL) -> int | None:
    """The digest that was compiled in; None for libraries of earlier versions of MORSE."""
    function = getattr(kernel_library, "morse_layout", None)
    if function is None:
        return None
    function.restype = ctypes.c_uint64
    return int(function())


def _best(target: targets.Target) -> ctypes.CDLL:
    lowest = load(target, target.levels[0])
    level = lowest.morse_processor_level()
    if level < target.levels[0]:
        raise OSError(f"the processor lacks instructions of {target.processor(target.levels[0])}")
    fitting = max(candidate for candidate in target.levels if candidate <= level)
    return lowest if fitting == target.levels[0] else load(target, fitting)
