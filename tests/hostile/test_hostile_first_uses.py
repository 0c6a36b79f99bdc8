"""Nothing is imported, opened or compiled for the first time within a tick, when no descriptor may be left."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from morse.verification.contract.subjects import library

pytestmark = pytest.mark.skipif(not hasattr(os, "fork"), reason="each component needs a process of its own")

_PROGRAM = Path(__file__).with_name("first_uses.py")
#: components with rays, images, tables and kernels of their own
_SOME = ("Hokuyo", "VideoCamera", "SegmentationCamera", "IMU", "MotionVW")


def _first_uses(names: tuple[str, ...]) -> dict[str, list[str]]:
    done = subprocess.run([sys.executable, str(_PROGRAM), *names], capture_output=True, text=True, check=True)
    return dict(json.loads(line) for line in done.stdout.splitlines())


def test_components_use_nothing_for_the_first_time_in_a_tick() -> None:
    assert _first_uses(_SOME) == {name: [] for name in _SOME}


@pytest.mark.slow
@pytest.mark.parametrize("part", range(4))
def test_no_component_uses_anything_for_the_first_time_in_a_tick(part: int) -> None:
    names = tuple(library()[part::4])
    assert _first_uses(names) == {name: [] for name in names}
