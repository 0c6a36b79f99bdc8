"""`tools reach` judges small files whose answers are known."""

import importlib.util
import json
import sys
from pathlib import Path

import pytest

BOX = '<geometry><box size="{}"/></geometry>'
INERTIAL = '<inertial><mass value="{}"/><inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial>'
#: the base is a ball, about which the arm swings
ARM = f"""<robot name="arm"><link name="base"><collision><geometry><sphere radius="0.1"/></geometry></collision>
{INERTIAL.format(1)}</link>
<link name="boom">{INERTIAL.format(2).replace("<mass", '<origin xyz="0.5 0 0"/><mass')}</link>
<joint name="turn" type="revolute"><parent link="base"/><child link="boom"/><origin xyz="0 0 0.3"/><axis xyz="0 0 1"/>
<limit lower="-1" upper="1" effort="100" velocity="1"/></joint></robot>"""
GHOST = f"""<robot name="ghost"><link name="body"><visual>{BOX.format("1 1 1")}</visual>{INERTIAL.format(1)}
</link></robot>"""
MODEL = """<model name="{}"><static>1</static><pose>0 0 {} 0 0 0</pose><link name="l"><collision name="c"><geometry>
<box><size>{}</size></box></geometry></collision></link></model>"""
WORLD = '<sdf version="1.7"><world name="w">{}</world></sdf>'
#: a room whose floor is at 2.5 m, below a roof; a plate without room above it; and nothing at all
ROOM = WORLD.format(MODEL.format("floor", 2.45, "20 20 0.1") + MODEL.format("roof", 6, "20 20 0.2"))
CRAWL = WORLD.format(MODEL.format("floor", 0, "20 20 0.1") + MODEL.format("lid", 0.5, "20 20 0.2"))
EMPTY = WORLD.format('<light type="directional" name="sun"/>')


@pytest.fixture(scope="module")
def reach():
    spec = importlib.util.spec_from_file_location("reach", Path(__file__).parents[2] / "tools" / "reach.py")
    module = importlib.util.module_from_spec(spec)
    sys.modules["reach"] = module
    spec.loader.exec_module(module)
    return module


def test_the_command_writes_a_table_and_the_answers(reach, tmp_path, capsys) -> None:
    folder = tmp_path / "makers"
    folder.mkdir()
    (folder / "arm.urdf").write_text(ARM)
    (folder / "room.world").write_text(ROOM)
    (folder / "notes.xml").write_text("<notes/>")
    assert reach.main([str(tmp_path), "--json", str(tmp_path / "rows.json"), "--md", str(tmp_path / "table.md")]) == 0
    arm, room = json.loads((tmp_path / "rows.json").read_text())
    assert (arm["joints"], arm["joints_here"], arm["mass"], arm["mass_here"]) == (1, 1, 2.0, 2.0)
    assert arm["places"] == pytest.approx(0.0, abs=1e-9)
    assert (arm["rests"], arm["rests_fixed"]) == (False, True)
    assert room["drives"] == [pytest.approx(2.0, abs=0.05)]
    table = (tmp_path / "table.md").read_text()
    assert "| makers | urdf | 1 | 1 of 1 | 1 of 1 | 1 of 1 |  |" in table
    assert "| makers | world | 1 | 1 of 1 |  |  | 1 of 1 |" in table
    assert "| all | | 2 | 2 of 2 | 1 of 1 | 1 of 1 | 1 of 1 |" in table
    assert table in capsys.readouterr().out


def test_what_cannot_stand_or_drive_is_not_judged_and_a_failure_is_one(reach, tmp_path) -> None:
    (tmp_path / "ghost.urdf").write_text(GHOST)
    (tmp_path / "empty.world").write_text(EMPTY)
    (tmp_path / "lid.world").write_text(CRAWL)
    ghost = reach.judged(reach.measured("urdf", tmp_path / "ghost.urdf"))
    assert (ghost["loads"], ghost["stands"]) == (True, None)
    empty = reach.judged(reach.measured("world", tmp_path / "empty.world"))
    assert (empty["loads"], empty["drives"]) == (True, None)
    # the robot drives on the lid
    assert reach.judged(reach.measured("world", tmp_path / "lid.world"))["drives"]
    (tmp_path / "two.urdf").write_text("<robot name='r'><link name='a'/><link name='b'/></robot>")
    two = reach.measured("urdf", tmp_path / "two.urdf")
    assert "it has 2 links without a parent: a, b" in two["error"]
    # MuJoCo reads it
    assert reach.judged(two) == {"sound": True, "loads": False, "same": None, "stands": None, "drives": None}


def test_a_robot_that_moves_in_all_directions_drives(reach, tmp_path) -> None:
    (tmp_path / "plate.sdf").write_text(
        '<sdf version="1.7"><model name="plate"><link name="l"><pose>0 0 0.1 0 0 0</pose><inertial><mass>10</mass>'
        '</inertial><collision name="c"><geometry><box><size>0.4 0.4 0.2</size></box></geometry></collision></link>'
        '<plugin name="move" filename="libgazebo_ros_planar_move.so"/></model></sdf>'
    )
    assert reach.measured("sdf", tmp_path / "plate.sdf")["drives"] == pytest.approx([1.2, 1.0], abs=0.03)


def test_without_folders_the_command_says_how_it_is_used(reach, capsys) -> None:
    assert reach.main([]) == 2
    assert "python -m tools reach FOLDER" in capsys.readouterr().err


def test_the_other_engine_has_a_floor_as_well(reach, tmp_path) -> None:
    """A file without a floor stands on that of the environment here: it would fall for ever in MuJoCo alone."""
    path = tmp_path / "box.xml"
    path.write_text(
        '<mujoco><worldbody><body pos="0 0 0.1"><freejoint/><geom type="box" size="0.1 0.1 0.1"/></body>'
        "</worldbody></mujoco>"
    )
    row = reach.measured("mjcf", path)
    assert (row["rests"], row["rests_there"], reach.judged(row)["stands"]) == (True, True, True)


def test_masses_are_not_compared_where_the_file_has_none(reach) -> None:
    row = {"kind": "urdf", "loads": True, "joints": 6, "joints_here": 6, "places": 0.0, "collides": False}
    assert reach.judged(row | {"mass": 6e-6, "mass_here": 0.8})["same"]
    assert not reach.judged(row | {"mass": 0.5, "mass_here": 0.8})["same"]
