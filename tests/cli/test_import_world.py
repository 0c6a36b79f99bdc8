"""``morse import-world`` writes a scene script, and ``morse check`` reads model files."""

import numpy as np
import pytest
from PIL import Image

import morse as simulator

WORLD = """<sdf version="1.9"><world name="yard"><gravity>0 0 -1.62</gravity>
<spherical_coordinates><latitude_deg>47.5</latitude_deg><longitude_deg>8.5</longitude_deg><elevation>400</elevation>
</spherical_coordinates><include><uri>model://ground_plane</uri></include>
<include><uri>model://crate</uri><name>first crate</name><pose>3 1 0.25 0 0 0.5</pose></include>
<model name="box"><pose>-2 0 0.5 0 0 0</pose><link name="l"><collision name="c"><geometry><box><size>1 1 1</size></box>
</geometry></collision><visual name="v"><geometry><box><size>1 1 1</size></box></geometry></visual></link></model>
<model name="box 2"><static>1</static><pose>-4 0 0.5 0 0 1</pose><link name="l"><collision name="c"><geometry><box>
<size>1 1 1</size></box></geometry></collision></link></model>
<model name="class"><pose>0 0 0.2 0 0 0.3</pose><link name="base"><collision name="c"><geometry><box>
<size>1 1 0.4</size></box></geometry></collision><sensor name="imu" type="imu"/></link></model></world></sdf>"""
CRATE = """<sdf version="1.6"><model name="crate">
<link name="l"><collision name="c"><geometry><box>
<size>0.5 0.5 0.5</size></box></geometry></collision></link></model></sdf>"""


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "world.sdf").write_text(WORLD)
    (tmp_path / "crate").mkdir()
    (tmp_path / "crate" / "model.sdf").write_text(CRATE)
    return tmp_path


def test_a_world_becomes_a_scene_script(morse, folder) -> None:
    script = folder / "scene.py"
    answer = morse("import-world", str(folder / "world.sdf"), "-o", str(script))
    assert answer.status == 0, answer.err
    text = script.read_text()
    assert 'first_crate = PassiveObject("crate/model.sdf")' in text
    assert 'box = PassiveObject("world.sdf", object_name="box")' in text
    assert 'model_class = Robot("world.sdf", blender_object_name="class")' in text
    with simulator.load(script) as simulation:
        simulation.step(60)
        # at rest, it measures the gravity of the moon
        assert simulation.model_class.imu.get()["linear_acceleration"][2] == pytest.approx(1.62, rel=1e-2)


def test_an_existing_script_is_not_replaced(morse, folder) -> None:
    (folder / "scene.py").write_text("mine")
    answer = morse("import-world", str(folder / "world.sdf"), "-o", str(folder / "scene.py"))
    assert answer.status == 1
    assert "exists" in answer.err
    assert (folder / "scene.py").read_text() == "mine"


def test_a_model_is_no_world(morse, folder) -> None:
    answer = morse("import-world", str(folder / "crate" / "model.sdf"), "-o", str(folder / "scene.py"))
    assert answer.status == 1
    assert "contains no <world>" in answer.err


def test_check_lists_the_content_of_a_model_and_draws_it(morse, folder) -> None:
    picture = folder / "yard.png"
    answer = morse("check", str(folder / "world.sdf"), "--picture", str(picture))
    assert answer.status == 0
    for part in ("first crate (free)", "box 2 (fixed)", "imu (IMU)", "gravity 1.62, latitude 47.5", "can be loaded"):
        assert part in " ".join(answer.out.split()), part
    with Image.open(picture) as image:
        shades = np.asarray(image.convert("L"))
    assert np.ptp(shades) > 20, "something is in front of the sky"


CRANE = """<robot name="crane"><link name="base"/><link name="arm"/><link name="rope"/>
<joint name="turn" type="continuous"><parent link="base"/><child link="arm"/></joint>
<joint name="lift" type="revolute"><parent link="arm"/><child link="rope"/>
<limit lower="0" upper="1" effort="1" velocity="1"/></joint><transmission name="t"/></robot>"""


def test_check_tells_joints_with_limits_from_those_without(morse, folder, monkeypatch) -> None:
    monkeypatch.chdir(folder)
    (folder / "crane.urdf").write_text(CRANE)
    answer = morse("check", "crane.urdf")
    assert "2: 1 continuous, 1 revolute" in answer.out
    assert (folder / "crane_check.png").is_file()


def test_check_names_what_is_wrong(morse, folder) -> None:
    (folder / "broken.sdf").write_text("<sdf><model></sdf>")
    answer = morse("check", str(folder / "broken.sdf"))
    assert answer.status == 1
    assert "it is not XML" in answer.err


def test_check_names_a_file_that_is_missing(morse, folder) -> None:
    answer = morse("check", str(folder / "gone.urdf"), "--picture", "gone.png")
    assert answer.status == 1
    assert f"There is no file {folder / 'gone.urdf'}" in answer.err.replace("\n", "")


def test_check_says_what_a_robot_without_masses_weighs(morse, folder) -> None:
    shape = '<collision><geometry><box size="1 1 1"/></geometry></collision>'
    (folder / "cubes.urdf").write_text(
        f'<robot name="cubes"><link name="a">{shape}</link><link name="b">{shape}</link><joint name="j" '
        'type="continuous"><parent link="a"/><child link="b"/><origin xyz="0 0 2"/></joint></robot>'
    )
    answer = morse("check", str(folder / "cubes.urdf"), "--picture", str(folder / "cubes.png"))
    assert "1 kg, because the file has no masses" in " ".join(answer.out.split())
