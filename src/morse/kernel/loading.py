"""Finds the library that suits the processor, and loads it."""

from __future__ import annotations

import ctypes
import logging
import sysconfig
from functools import cache
from pathlib import Path

from morse.kernel import targets
from morse.system import OF_MACHINE, variables

logger = logging.getLogger(__name__)

#: the version of structures and signatures that Python expects; see ``c/processor.c``
INTERFACE = 33
VARIABLE = "MORSE_KERNEL"
_SOURCES = Path(__file__).parent / "c"


class KernelError(OSError):
    """The native kernel cannot be loaded."""


@cache
def library() -> ctypes.CDLL:
    """The kernel.

    The environment variable ``MORSE_KERNEL`` selects a level of the instruction set, ``v2`` or ``v3``; by default, it
    is the highest level that the processor supports.

    Raises:
        KernelError: it was not compiled for this platform, or belongs to another version of MORSE.
    """
    choice = variables.word(VARIABLE)
    target = targets.host()
    if target is None:
        names = ", ".join(map(str, targets.ALL))
        here = sysconfig.get_platform()
        raise KernelError(f"MORSE has no native kernel for this platform, {here}, but for {names}")
    file_names = {f"v{level}": level for level in target.levels if level}
    if is_stale(target):
        logger.warning(
            "The native kernel was compiled from other sources than those of this checkout: run python -m "
            "morse.kernel.build",
            extra=OF_MACHINE,
        )
    try:
        return load(target, file_names[choice]) if choice in file_names else _best(target)
    except OSError as error:
        raise KernelError(f"the native kernel cannot be loaded: {error}") from None


def is_stale(target: targets.Target) -> bool:
    """Whether a source of an editable installation was saved after the library was compiled, and has changed."""
    path = targets.FOLDER / target.file_name(target.levels[0])
    try:
        compiled = path.stat().st_mtime_ns
        if all(source.stat().st_mtime_ns <= compiled for source in _SOURCES.iterdir()):
            return False
        # imported only now, because it takes longer than the check
        from morse.kernel import build

        return build.stamp(target).is_file() and not build.is_current(target)
    except OSError:
        return False


def load(target: targets.Target, level: int) -> ctypes.CDLL:
    """Load the build of one level.

    Raises:
        OSError: the build does not exist, or belongs to another version of MORSE.
    """
    path = targets.FOLDER / target.file_name(level)
    if not path.is_file():
        raise FileNotFoundError(f"{path.name} was not built; run python -m morse.kernel.build")
    kernel_library = ctypes.CDLL(str(path))
    interface = kernel_library.morse_interface()
    if interface != INTERFACE:
        raise OSError(f"{path.name} belongs to another version of MORSE; run python -m morse.kernel.build")
    return kernel_library


def _best(target: targets.Target) -> ctypes.CDLL:
    lowest = load(target, target.levels[0])
    level = lowest.morse_processor_level()
    if level < target.levels[0]:
        raise OSError(f"the processor lacks instructions of {target.processor(target.levels[0])}")
    fitting = max(candidate for candidate in target.levels if candidate <= level)
    return lowest if fitting == target.levels[0] else load(target, fitting)
