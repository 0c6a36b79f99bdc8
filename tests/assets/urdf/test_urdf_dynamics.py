"""Masses, friction and limits of URDF files."""

import math
from pathlib import Path

import numpy as np
import pytest

import morse
from morse.assets.errors import AssetError
from morse.assets.urdf import read_urdf
from morse.core.kinds import bind
from morse.scene import PhysicsType

JOINT = """<joint name="j" type="revolute"><parent link="a"/><child link="b"/><limit lower="-1" upper="2" effort="{e}"
velocity="{v}"/><dynamics damping="0.3" friction="0.1"/></joint>"""


def robot(tmp_path: Path, inertial: str, joint: str = JOINT.format(e=5, v=3), base='<mass value="3"/>'):
    file = tmp_path / "robot.urdf"
    file.write_text(
        f'<robot name="r"><link name="a"><inertial>{base}</inertial></link><link name="b"><inertial>{inertial}'
        f"</inertial></link>{joint}</robot>"
    )
    return read_urdf(file)


def link_of(library, name="b"):
    return next(node for node in library.nodes() if node.name == name)


def tensor(*moments: float) -> str:
    names = ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")
    return "<inertia " + " ".join(f'{n}="{m}"' for n, m in zip(names, moments, strict=True)) + "/>"


def test_an_inertia_is_turned_into_the_axes_of_the_link(tmp_path: Path) -> None:
    library = robot(
        tmp_path, f'<origin xyz="1 2 3" rpy="0 0 {math.pi / 2}"/><mass value="2"/>{tensor(0.1, 0.2, 0.25, 0, 0, 0)}'
    )
    inertial = link_of(library).inertial
    assert inertial.mass == 2.0
    assert inertial.centre == (1.0, 2.0, 3.0)
    assert np.reshape(inertial.inertia, (3, 3)) == pytest.approx(np.diag([0.2, 0.1, 0.25]), abs=1e-12)
    assert library.warnings == []


def test_dynamics_and_limits_of_joints(tmp_path: Path) -> None:
    (bone,) = robot(tmp_path, '<mass value="2"/>').roots[0].children[0].bones
    moves = bone.dynamics
    assert (moves.damping, moves.friction, moves.effort, moves.speed, moves.limited) == (0.3, 0.1, 5.0, 3.0, True)
    # no number stands for no limit
    (bone,) = robot(tmp_path, '<mass value="2"/>', JOINT.format(e=0, v=0)).roots[0].children[0].bones
    assert (bone.dynamics.effort, bone.dynamics.speed) == (math.inf, math.inf)


def test_a_mass_without_inertia_is_that_of_a_ball_of_water(tmp_path: Path) -> None:
    inertial = link_of(robot(tmp_path, '<mass value="4.18879"/>')).inertial
    # a ball of 0.1 m radius has 4.18879 kg
    assert inertial.inertia[0] == pytest.approx(0.4 * 4.18879 * 0.01, rel=1e-5)


@pytest.mark.parametrize(
    ("moments", "words"),
    [
        ((0.1, 0.1, 0.5, 0, 0, 0), "none can be larger than the sum"),
        ((0.1, -0.1, 0.1, 0, 0, 0), "expected positive"),
        ((0.1, 0.1, 0.1, 0.5, 0, 0), "expected positive"),
    ],
)
def test_an_inertia_that_no_body_has_is_mended_and_said(tmp_path: Path, moments: tuple[float, ...], words: str) -> None:
    library = robot(tmp_path, f'<mass value="2"/>{tensor(*moments)}')
    (warning,) = library.warnings
    assert "the link 'b'" in warning
    assert words in warning
    values = np.linalg.eigvalsh(np.reshape(link_of(library).inertial.inertia, (3, 3)))
    assert values[0] > 0.0
    assert values[2] <= (values[0] + values[1]) * 1.001


def test_an_inertia_that_is_no_number_is_refused(tmp_path: Path) -> None:
    with pytest.raises(AssetError, match=r"robot\.urdf.*ixx='nan'"):
        robot(tmp_path, f'<mass value="2"/>{tensor(math.nan, 1, 1, 0, 0, 0)}')


def test_a_robot_whose_base_has_no_mass_is_bolted(tmp_path: Path) -> None:
    assert robot(tmp_path, '<mass value="2"/>', base='<mass value="0"/>').roots[0].body.type is PhysicsType.STATIC
    assert robot(tmp_path, '<mass value="2"/>').roots[0].body.type is PhysicsType.RIGID_BODY


def test_too_many_joints_in_a_row_are_refused(tmp_path: Path) -> None:
    count = 300
    links = "".join(f'<link name="l{i}"/>' for i in range(count))
    joints = "".join(
        f'<joint name="j{i}" type="continuous"><parent link="l{i}"/><child link="l{i + 1}"/></joint>'
        for i in range(count - 1)
    )
    file = tmp_path / "long.urdf"
    file.write_text(f"<robot name='long'>{links}{joints}</robot>")
    with pytest.raises(AssetError, match="more than 200 joints in a chain"):
        read_urdf(file)


def test_entities_are_refused(tmp_path: Path) -> None:
    file = tmp_path / "bomb.urdf"
    file.write_text(
        '<!DOCTYPE robot [<!ENTITY a "aaaaaaaaaa"><!ENTITY b "&a;&a;&a;&a;&a;&a;&a;&a;">]><robot name="&b;"/>'
    )
    with pytest.raises(AssetError, match="defines the entity 'a'"):
        read_urdf(file)


# -- sensors that URDF files declare become components ---------------------------------------------

ROBOT = """<robot name="scout">
  <link name="base"><inertial><mass value="9"/></inertial>
    <collision><geometry><box size="0.4 0.3 0.2"/></geometry></collision></link>
  <link name="mast"/>
  <joint name="up" type="fixed"><parent link="base"/><child link="mast"/><origin xyz="0 0 0.5" rpy="0 0
  {turn}"/></joint>
  <gazebo reference="mast">
    <sensor name="front cam" type="camera"><update_rate>15</update_rate><pose>0.1 0 0 0 0 0</pose>
      <camera><horizontal_fov>1.0</horizontal_fov><image><width>64</width><height>48</height></image>
      <clip><near>0.05</near><far>50</far></clip></camera></sensor>
    <sensor name="scan" type="gpu_ray"><ray><scan><horizontal><samples>91</samples><min_angle>-0.785398</min_angle>
      <max_angle>0.785398</max_angle></horizontal></scan><range><min>0.1</min><max>8</max></range></ray></sensor>
    <sensor name="imu" type="imu"/>
    <sensor name="nose" type="chemical"/>
  </gazebo>
  <gazebo><plugin name="p"/></gazebo>
  <sensor name="old" update_rate="5"><parent link="base"/><origin xyz="0 0 0.1"/>
    <camera><image width="32" height="32" hfov="1.57" near="0.1" far="9"/></camera></sensor>
  {more}
</robot>"""
SCENE = """
from morse.builder import *
robot = Robot({file!r})
robot.translate(z=0.1)
assert sorted(robot.sensors) == ['front_cam', 'imu', 'old', 'scan']
camera = robot.sensors['front_cam'].scene_node.world_matrix()
# the mast is turned to the left; a camera looks along its Z axis, and its Y axis points down
assert [round(camera[i][2], 6) for i in range(3)] == [0.0, 1.0, 0.0]
assert [round(camera[i][1], 6) for i in range(3)] == [0.0, 0.0, -1.0]
env = Environment('empty')
"""


def write(tmp_path: Path, more: str = "", turn: float = 0.0) -> Path:
    file = tmp_path / "scout.urdf"
    file.write_text(ROBOT.format(more=more, turn=turn))
    return file


def test_what_the_file_says_of_sensors(tmp_path: Path) -> None:
    library = read_urdf(write(tmp_path))
    found = {one.name: one for one in library.sensors}
    camera = found["front cam"]
    assert (camera.product, camera.link, camera.position, camera.frequency) == (
        "VideoCamera",
        "mast",
        (0.1, 0.0, 0.0),
        15.0,
    )
    assert dict(camera.properties) == pytest.approx(
        {"cam_width": 64, "cam_height": 48, "cam_fov": math.degrees(1.0), "cam_near": 0.05, "cam_far": 50.0}
    )
    scan = dict(found["scan"].properties)
    expected = {"laser_range": 8.0, "range_min": 0.1, "scan_window": 90.0, "resolution": 1.0}
    assert scan == pytest.approx(expected, rel=1e-5)
    assert found["old"].frequency == 5.0
    (warning,) = [text for text in library.warnings if "sensors" in text]
    assert "'nose' (chemical)" in warning


def test_they_are_components_of_the_robot(tmp_path: Path) -> None:
    script = tmp_path / "scene.py"
    script.write_text(SCENE.format(file=str(write(tmp_path, turn=math.pi / 2))))
    with morse.load(script) as sim:
        sim.step(30)
        assert {"front_cam", "imu", "old", "scan"} <= set(dir(sim.robot))
        # a fan of 90 degrees with a ray per degree
        assert len(sim.robot.scan.get()["range_list"]) == 91


def test_they_can_be_left_out(tmp_path: Path) -> None:
    script = tmp_path / "scene.py"
    script.write_text(
        f"from morse.builder import *\nrobot = Robot({str(write(tmp_path))!r}, sensors=False)\n"
        "assert not robot.sensors\nenv = Environment('empty')\n"
    )
    with morse.load(script) as sim:
        sim.step()


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ('<gazebo reference="base"><sensor name="s" type="camera"><pose>1 2</pose></sensor></gazebo>', "expected 6"),
        (
            '<gazebo reference="base"><sensor name="s" type="camera"><update_rate>x</update_rate></sensor></gazebo>',
            "'x'",
        ),
        ('<gazebo reference="gone"><sensor name="s" type="camera"/></gazebo>', "'gone', which does not exist"),
        ('<gazebo reference="base"><sensor name="s"/></gazebo>', "'s' (no type)"),
        (
            '<gazebo reference="base"><sensor name="s" type="camera"><camera><image><width>nan</width></image></camera>'
            "</sensor></gazebo>",
            "'nan'",
        ),
    ],
)
def test_sensors_that_make_no_sense_are_left_out_with_a_warning(tmp_path: Path, text: str, words: str) -> None:
    library = read_urdf(write(tmp_path, more=text))
    assert words in " ".join(library.warnings)
    assert "s" not in {one.name for one in library.sensors}


def test_absurd_sizes_are_limited(tmp_path: Path) -> None:
    image = "<camera><image><width>999999</width><height>-1</height></image></camera>"
    text = f'<gazebo reference="base"><sensor name="s" type="camera">{image}</sensor></gazebo>'
    (one,) = [one for one in read_urdf(write(tmp_path, more=text)).sensors if one.name == "s"]
    assert dict(one.properties) == {"cam_width": 4096, "cam_height": 1}


FAST = """<robot name="rover"><link name="base"><inertial><mass value="1"/></inertial>{visual}<collision><geometry>
<box size="0.2 0.2 0.1"/></geometry></collision></link>
<gazebo reference="base"><sensor name="imu" type="imu"><update_rate>1000</update_rate><imu><angular_velocity><x>
<noise type="gaussian"><stddev>0.02</stddev></noise></x></angular_velocity></imu></sensor>
<sensor name="scan" type="gpu_lidar"><topic>front/scan</topic><update_rate>10</update_rate><lidar><scan><horizontal>
<samples>181</samples><min_angle>-1.57</min_angle><max_angle>1.57</max_angle></horizontal></scan><range><min>0.5</min>
<max>8</max></range></lidar><plugin name="p" filename="libgazebo_ros_ray_sensor.so"><ros><namespace>/a</namespace>
<remapping>~/out:=laser</remapping></ros></plugin></sensor></gazebo></robot>"""


def saved(tmp_path, text):
    path = tmp_path / "rover.urdf"
    path.write_text(text)
    return str(path)


def test_a_fast_sensor_does_not_change_the_tick(simulate, tmp_path, caplog) -> None:
    file = saved(tmp_path, FAST.format(visual=""))
    simulation = simulate(f"robot = Robot({file!r})\nenv = Environment('empty')\n", sockets=False)
    simulation.step(60)
    assert simulation.clock.time == pytest.approx(1.0)
    (line,) = (record.message for record in caplog.records if "measure in each tick" in record.message)
    assert "imu (1000 Hz)" in line
    # unless the script asks for it
    scene = f"robot = Robot({file!r})\nrobot.sensors['imu'].frequency(1000)\nenv = Environment('empty')\n"
    simulation = simulate(scene, sockets=False)
    simulation.step(60)
    assert simulation.clock.time == pytest.approx(0.06)


def test_noise_of_a_file(simulate, tmp_path) -> None:
    file = saved(tmp_path, FAST.format(visual=""))
    simulation = simulate(
        f"robot = Robot({file!r})\nrobot.translate(z=0.06)\nenv = Environment('empty')\n", sockets=False
    )
    simulation.step(120)
    values = []
    for _ in range(300):
        simulation.step(1)
        values.append(simulation.robot.imu.get()["angular_velocity"][2])
    # five standard errors of a standard deviation of 300 values
    assert np.std(values) == pytest.approx(0.02, rel=5.0 / math.sqrt(600.0))


def test_topics_ranges_and_visuals_of_a_file(tmp_path) -> None:
    box = '<visual><geometry><box size="0.2 0.2 0.1"/></geometry></visual>'
    for visual in ("", box):
        library = read_urdf(saved(tmp_path, FAST.format(visual=visual)))
        imu, scan = library.sensors
        assert dict(scan.stream) == {"topic": "/a/laser"}
        assert dict(imu.stream) == {}
        assert dict(scan.properties)["range_min"] == 0.5
        assert scan.has_own_visual is imu.has_own_visual is bool(visual)


def test_echoes_nearer_than_the_smallest_distance(simulate, tmp_path) -> None:
    (tmp_path / "wall.urdf").write_text(
        """<robot name="wall"><link name="world"/><link name="w"><inertial><mass value="1"/></inertial><collision>
        <geometry><box size="0.1 2 2"/></geometry></collision></link>
        <joint name="j" type="fixed"><parent link="world"/><child link="w"/></joint></robot>"""
    )
    scene = f"""robot = Robot({saved(tmp_path, FAST.format(visual=""))!r})
robot.translate(z=0.051)
wall = Robot({str(tmp_path / "wall.urdf")!r})
wall.translate(x=0.35)
env = Environment('empty')
"""
    simulation = simulate(scene, sockets=False)
    simulation.step(30)
    (kind,) = (one for one in bind(simulation.context.components["robot.scan"]) if one.kind.name == "scan")
    message = kind.gather()
    assert message.range_min == 0.5
    # straight ahead, the wall is 0.3 m away; REP 117
    assert np.asarray(message.ranges)[90] == -math.inf
    assert np.asarray(message.ranges)[0] == math.inf


def test_noise_of_a_camera_is_in_codes_of_its_image(simulate, tmp_path, caplog) -> None:
    camera = """<sensor name="eye" type="camera"><camera><image><width>8</width><height>8</height></image><noise>
    <type>gaussian</type><stddev>0.01</stddev></noise></camera></sensor></gazebo>"""
    file = saved(tmp_path, FAST.format(visual="").replace("</gazebo>", camera))
    (eye,) = (one for one in read_urdf(file).sensors if one.name == "eye")
    assert dict(eye.noise) == pytest.approx({"image": 2.55})
    simulate(f"robot = Robot({file!r})\nenv = Environment('empty')\n", sockets=False).step(10)
    assert not [record for record in caplog.records if "noise" in record.message.rpartition(".py:")[2]]


def test_a_component_with_the_name_of_one_of_the_file_is_told(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    file = str(write(tmp_path))
    script = f"""
from morse.builder import *
robot = Robot({file!r}, name="scout")
robot.append(Hokuyo("scan"))
robot.append(Pose("pose"))
env = Environment('empty')
"""
    (tmp_path / "double.py").write_text(script)
    with morse.load(tmp_path / "double.py") as sim:
        assert {"scout.scan", "scout.scan_001"} <= sim.context.components.keys()
    (line,) = (record.message for record in caplog.records if "has a component" in record.message)
    assert "scout.scan_001" in line
    assert "scout.sensors['scan']" in line


WRIST = """<robot name="r"><link name="base"/><link name="hand"/><joint name="wrist" type="continuous">
<parent link="base"/><child link="hand"/></joint>{}<sensor name="force" {}><parent joint="wrist"/></sensor></robot>"""
OF_GAZEBO, TYPE = '<gazebo reference="wrist"><sensor name="force" type="force_torque"/></gazebo>', 'type="force_torque"'


@pytest.mark.parametrize(("gazebo", "kind"), [(OF_GAZEBO, ""), (OF_GAZEBO, TYPE), ("", TYPE)])
def test_a_sensor_of_a_joint_is_read_once_and_not_left_out(tmp_path, gazebo, kind) -> None:
    (tmp_path / "r.urdf").write_text(WRIST.format(gazebo, kind))
    library = read_urdf(tmp_path / "r.urdf")
    assert [(sensor.name, sensor.link) for sensor in library.sensors] == [("force", "hand")]
    assert library.warnings == []


def test_the_mass_of_a_robot_is_that_of_all_its_links(tmp_path: Path) -> None:
    robot(tmp_path, f'<mass value="2"/>{tensor(0.1, 0.1, 0.1, 0, 0, 0)}')

    def script() -> None:
        from morse.builder import Environment, Pioneer3DX, Robot

        Robot(str(tmp_path / "robot.urdf"), name="whole").translate(z=2)
        heavy = Robot(str(tmp_path / "robot.urdf"), name="heavy")
        heavy.translate(x=3, z=2)
        heavy.set_mass(10.0)
        Pioneer3DX("wheels").translate(x=6)
        Environment("empty", fastmode=True)

    with morse.load(script) as sim:
        masses = {name: sim.world.game_object(name).mass for name in ("whole", "heavy", "wheels", "b")}
    # the wheels of a robot of MORSE are objects of their own
    assert masses == pytest.approx({"whole": 5.0, "heavy": 10.0, "wheels": 9.0, "b": 2.0})
