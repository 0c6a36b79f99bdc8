"""Objects that overlap at the start are named once."""

import logging
from pathlib import Path

import pytest

import morse

pytestmark = pytest.mark.long

#: a chair of the kitchen stands so under its desk in MORSE 1.4
AS_IN_1_4 = "part slowly: 'Desk_Rest.001' and 'Chair1' by 0.069 m"
ENVIRONMENTS = Path(morse.__file__).parent / "data" / "environments"


def warnings_of(
    tmp_path: Path, caplog: pytest.LogCaptureFixture, text: str, *, level: int = logging.WARNING
) -> list[str]:
    script = tmp_path / "scene.py"
    script.write_text("from morse.builder import *\n" + text)
    with caplog.at_level(level):
        morse.load(script).close()
    return [record.getMessage() for record in caplog.records if "overlap at the start" in record.getMessage()]


def test_robots_that_start_inside_each_other_and_in_a_box_are_named(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    (text,) = warnings_of(
        tmp_path,
        caplog,
        """
first = ATRV()
first.translate(5, 5, 0)
second = ATRV()
second.translate(5.3, 5, 0)
third = Morsy()
third.translate(-7.5, 0.6, 0)
wheeled = SegwayRMP400()
wheeled.translate(0, 0, -0.2)
env = Environment("indoors-1/boxes")
""",
    )
    assert "'first' and 'second'" in text or "'second' and 'first'" in text
    assert "'RedBox'" in text
    assert "'third'" in text
    assert "'wheeled'" in text
    assert "'Ground'" in text


def test_robots_of_mjcf_files_part_as_in_mujoco_and_this_is_said(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    """Their contacts are those of the file; only others are soft until they have parted."""
    (tmp_path / "ball.xml").write_text(
        '<mujoco><worldbody><body name="ball" pos="0 0 0.05"><freejoint/><geom size="0.1"/></body></worldbody></mujoco>'
    )
    (text,) = warnings_of(tmp_path, caplog, f"robot = Robot({str(tmp_path / 'ball.xml')!r})\nEnvironment('empty')\n")
    assert "'Ground' and 'robot' by 0.05 m; those of MJCF files part as fast as in MuJoCo" in text


@pytest.mark.parametrize("robot", ["ATRV", "Morsy", "B21", "Pioneer3DX", "SegwayRMP400", "PatrolBot"])
def test_robots_at_their_own_place_overlap_with_nothing(
    tmp_path: Path, caplog: pytest.LogCaptureFixture, robot: str
) -> None:
    for world in ("empty", "sandbox", "indoors-1/boxes"):
        assert warnings_of(tmp_path, caplog, f"robot = {robot}()\nenv = Environment('{world}')") == []


@pytest.mark.parametrize("path", sorted(ENVIRONMENTS.rglob("*.blend")), ids=lambda path: path.stem)
def test_our_worlds_overlap_with_nothing(tmp_path: Path, caplog: pytest.LogCaptureFixture, path: Path) -> None:
    name = path.relative_to(ENVIRONMENTS).with_suffix("").as_posix()
    text = f"robot = FakeRobot()\nrobot.translate(z=99)\nenv = Environment('{name}')"
    # also objects that lie in what is fixed, such as crates in hills
    messages = [one for one in warnings_of(tmp_path, caplog, text, level=logging.INFO) if AS_IN_1_4 not in one]
    assert messages == []
