"""The kind of processor, which decides how functions of the engine and of the C library round."""

from __future__ import annotations

import platform
from functools import cache

from morse.kernel import targets
from morse.kernel.loading import load

#: the level of the x86-64 psABI from which on processors fuse products and sums
_FUSES = 3


@cache
def kind() -> str:
    """Return architecture, fused products and C library, such as ``x86_64 with FMA, glibc 2.36``.

    Two machines of one kind give the same bits with the same versions of MORSE, MuJoCo, numpy and Python.
    """
    library = " ".join(part for part in platform.libc_ver() if part) or platform.system()
    return f"{platform.machine()}{_fused()}, {library}"


def _fused() -> str:
    target = targets.host()
    if target is None or len(target.levels) < 2:  # other architectures always fuse
        return ""
    try:
        level = load(target, target.levels[0]).morse_processor_level()
    except OSError:
        return ""
    return " with FMA" if level >= _FUSES else " without FMA"
