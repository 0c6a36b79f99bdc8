"""Programs of `examples` with software that others wrote, in closed loop."""

import re
from importlib.util import find_spec
from pathlib import Path

import pytest

from tests.kit.programs import python

EXAMPLES = Path(__file__).parents[2] / "examples"
LIMIT = 1200.0

pytestmark = pytest.mark.slow


def numbers(program: str, pattern: str, tmp_path: Path) -> list[float]:
    """What the program has said, by the groups of a pattern."""
    said = python(EXAMPLES / program, folder=tmp_path, limit=LIMIT)
    assert said.returncode == 0, said.stderr[-2000:]
    found = re.search(pattern, said.stdout)
    assert found is not None, said.stdout
    return [float(group) for group in found.groups()]


@pytest.mark.skipif(find_spec("kiss_icp") is None, reason="there is no kiss_icp: pip install kiss-icp")
@pytest.mark.peer("kiss-icp")
def test_kiss_icp_drives_by_its_own_estimate(tmp_path: Path) -> None:
    way, _, drift = numbers(
        "kiss_icp/drive_by_lidar.py", r"driven ([\d.]+) m, final error ([\d.]+) m, drift ([\d.]+) %", tmp_path
    )
    assert way > 12.0, "two squares of 1.6 m"
    assert drift < 1.0


@pytest.mark.skipif(
    find_spec("python_motion_planning") is None,
    reason="there is no python_motion_planning: pip install python_motion_planning",
)
@pytest.mark.peer("python_motion_planning")
def test_a_planner_finds_the_way_round_a_wall(tmp_path: Path) -> None:
    left, way, nearest = numbers(
        "planner/drive_a_plan.py", r"within ([\d.]+) m, after ([\d.]+) m, never closer than ([\d.]+) m", tmp_path
    )
    assert left <= 0.15
    # 7 m as the crow flies, across a wall of 4 m in the middle
    assert 7.5 < way < 14.0
    assert nearest > 0.3


@pytest.mark.skipif(find_spec("cv2") is None, reason="there is no OpenCV: pip install opencv-python-headless")
@pytest.mark.peer("opencv-python-headless")
def test_opencv_docks_at_a_marker(tmp_path: Path) -> None:
    distance, off = numbers(
        "docking/dock_at_marker.py", r"docked ([\d.]+) m in front of the marker, (-?[\d.]+) degrees off", tmp_path
    )
    # it stops at the first picture from within 0.6 m, after at most 0.1 m/s * 0.2 s
    assert distance == pytest.approx(0.6, abs=0.05)
    assert abs(off) < 2.0


@pytest.mark.skipif(find_spec("cv2") is None, reason="there is no OpenCV: pip install opencv-python-headless")
@pytest.mark.peer("opencv-python-headless")
def test_a_robot_that_has_not_docked_does_not_say_so(tmp_path: Path) -> None:
    """From 6 m, the detector does not see a marker of 8 cm."""
    program = (
        f"import sys; sys.path.insert(0, {str(EXAMPLES / 'docking')!r})\n"
        "from functools import partial\nimport morse, dock_at_marker as program\nprogram.MOST_PICTURES = 5\n"
        "with morse.load(partial(program.scene, 6.0)) as sim:\n    print(program.dock(sim)['docked'])\n"
    )
    (tmp_path / "far.py").write_text(program)
    said = python(tmp_path / "far.py", folder=tmp_path, limit=LIMIT)
    assert said.stdout.strip() == "0", said.stderr[-2000:]


@pytest.mark.skipif(find_spec("filterpy") is None, reason="there is no filterpy: pip install 'filterpy>=2,<3'")
@pytest.mark.peer("filterpy")
def test_a_kalman_filter_of_filterpy_knows_more_than_its_sensors(tmp_path: Path) -> None:
    corners, by_filter, by_gps, by_wheels = numbers(
        "localisation/drive_by_filter.py",
        r"(\d) corners, errors: filter ([\d.]+) m, GPS ([\d.]+) m, wheels ([\d.]+) m",
        tmp_path,
    )
    assert corners == 8
    # 0.5 m in each of two directions
    assert by_gps == pytest.approx(0.5 * 2.0**0.5, rel=0.1)
    assert by_filter < 0.4 * by_gps
    assert by_filter < by_wheels


@pytest.mark.skipif(find_spec("casadi") is None, reason="there is no CasADi: pip install casadi")
@pytest.mark.peer("casadi")
def test_a_quadrotor_flies_the_way_that_casadi_plans(tmp_path: Path) -> None:
    """The way takes 8.7 s; the program waits another 2 s at its end. Wind of 3 m/s is corrected."""
    found = numbers(
        "race/fly_gates.py",
        r"wind 0 m/s: (\d) gates in ([\d.]+) s, at most ([\d.]+) m.*\n"
        r"wind 3 m/s: (\d) gates in [\d.]+ s, at most ([\d.]+) m",
        tmp_path,
    )
    assert (found[0], found[3]) == (4, 4)
    assert found[1] == pytest.approx(10.7, abs=0.2)
    assert found[2] < 0.1
    assert found[4] < 0.3
