import ctypes
import os

import pytest

from morse.kernel import loading, targets

#: a library to test instead; see test_sanitizers.py
_CHECKED = os.environ.get("MORSE_TEST_KERNEL")


def builds() -> list[int]:
    """The levels for which this machine has libraries and can run them."""
    if _CHECKED:
        return [0]
    host = targets.host()
    if host is None:
        return []
    try:
        lowest = loading.load(host, host.levels[0])
    except OSError:
        return []
    return [level for level in host.levels if level <= max(lowest.morse_processor_level(), host.levels[0])]


@pytest.fixture(params=builds() or [None], ids=lambda level: f"v{level}")
def build(request: pytest.FixtureRequest) -> ctypes.CDLL:
    """Each build of the kernel that this machine can run."""
    if request.param is None:
        if os.environ.get("CI"):
            pytest.fail("the kernel was not built")
        pytest.skip("the kernel was not built: python -m morse.kernel.build")
    if _CHECKED:
        return ctypes.CDLL(_CHECKED)
    host = targets.host()
    assert host is not None
    return loading.load(host, request.param)
