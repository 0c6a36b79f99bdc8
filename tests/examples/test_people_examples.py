"""What a robot does among people in the example."""

import runpy
from pathlib import Path

import pytest

pytestmark = pytest.mark.long
FOLDER = Path(__file__).parents[2] / "examples" / "people"


def test_a_robot_delivers_through_a_corridor_with_people():
    seconds, hard = runpy.run_path(str(FOLDER / "deliver.py"))["main"]()
    # 26 m at 0.9 m/s at most
    assert 26.0 / 0.9 < seconds < 100.0
    assert hard == 0
