"""Plugins of URDF files become actuators and sensors, with the topics of the file; wheels are found without plugins."""

import math
from math import pi

import pytest

from morse.assets.urdf import read_urdf


def link(name, mass, shape="", pose='xyz="0 0 0"'):
    solid = f"<collision><origin {pose}/><geometry>{shape}</geometry></collision>" if shape else ""
    moment = 0.01 * mass
    return f"""<link name="{name}"><inertial><mass value="{mass}"/><inertia ixx="{moment}" iyy="{moment}" izz="{moment}"
    ixy="0" ixz="0" iyz="0"/></inertial>{solid}</link>"""


def joint(name, kind, parent, child, place, axis="0 1 0", rest=""):
    return f"""<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/><origin {place}/>
    <axis xyz="{axis}"/>{rest}</joint>"""


LYING = f'rpy="{pi / 2} 0 0"'
WHEEL = '<cylinder radius="0.1" length="0.04"/>'


def wheel(name, x, y, parent="base_link", axis="0 1 0"):
    return link(name, 0.5, WHEEL, LYING) + joint(f"{name}_j", "continuous", parent, name, f'xyz="{x} {y} 0"', axis)


BASE = f"""<link name="base_footprint"/>{link("base_link", 4, '<box size="0.4 0.2 0.08"/>', 'xyz="0 0 0.02"')}
{joint("up", "fixed", "base_footprint", "base_link", 'xyz="0 0 0.1"')}"""
CASTER = f"""{link("fork", 0.1)}{joint("swivel", "continuous", "base_link", "fork", 'xyz="-0.16 0 0"', "0 0 1")}
{link("roll", 0.1, '<sphere radius="0.04"/>')}{joint("roll_j", "continuous", "fork", "roll", 'xyz="0 0 -0.06"')}"""
#: the axis of the wheel on the right points to the right
CART = BASE + wheel("left", 0, 0.15) + wheel("right", 0, -0.15, axis="0 -1 0") + CASTER
SCENE = """robot = Robot({file!r})
robot.translate(z=0.002)
{lines}
pose = Pose()
robot.append(pose)
env = Environment('empty')
"""


@pytest.fixture
def file(tmp_path):
    def write(text):
        path = tmp_path / "cart.urdf"
        path.write_text(f'<robot name="cart">{text}</robot>')
        return str(path)

    return write


def plugin(name, library, content):
    return f'<gazebo><plugin name="{name}" filename="{library}">{content}</plugin></gazebo>'


ROS2 = plugin(
    "drive",
    "libgazebo_ros_diff_drive.so",
    """<ros><namespace>/front</namespace><remapping>cmd_vel:=go</remapping></ros><left_joint>left_j</left_joint>
    <right_joint>right_j</right_joint><wheel_separation>0.3</wheel_separation><wheel_diameter>0.2</wheel_diameter>
    <max_wheel_torque>20</max_wheel_torque><publish_odom_tf>false</publish_odom_tf>""",
)
ROS1 = plugin(
    "drive",
    "libgazebo_ros_diff_drive.so",
    """<commandTopic>go</commandTopic><odometryTopic>odometry</odometryTopic><leftJoint>right_j</leftJoint>
    <rightJoint>left_j</rightJoint><wheelSeparation>0.3</wheelSeparation><wheelDiameter>0.2</wheelDiameter>""",
)
GZ = plugin(
    "gz::sim::systems::DiffDrive",
    "gz-sim-diff-drive-system",
    """<left_joint>left_j</left_joint><right_joint>right_j</right_joint><wheel_separation>0.3</wheel_separation>
    <wheel_radius>0.1</wheel_radius><topic>go</topic>""",
)
MEASURED = GZ.replace("<wheel_separation>0.3</wheel_separation>", "").replace("<wheel_radius>0.1</wheel_radius>", "")


def drives(simulation) -> None:
    """A metre forward, then a radian to the left."""
    simulation.step(30)
    simulation.robot.motion.publish({"v": 0.5, "w": 0.0})
    simulation.step(60)
    start = simulation.robot.pose.get()
    simulation.step(120)
    end = simulation.robot.pose.get()
    assert math.hypot(end["x"] - start["x"], end["y"] - start["y"]) == pytest.approx(1.0, rel=0.03)
    assert end["x"] > start["x"]
    simulation.robot.motion.publish({"v": 0.0, "w": 0.5})
    simulation.step(60)
    start = simulation.robot.pose.get()["yaw"]
    simulation.step(120)
    assert math.remainder(simulation.robot.pose.get()["yaw"] - start, math.tau) == pytest.approx(1.0, rel=0.1)


# files for the older versions of Gazebo name the wheels of the other side
@pytest.mark.parametrize("plugins", [ROS2, ROS1, GZ, MEASURED], ids=["ros2", "ros1", "gz", "measured"])
def test_a_plugin_drives(simulate, file, plugins) -> None:
    drives(simulate(SCENE.format(file=file(CART + plugins), lines=""), sockets=False))


@pytest.mark.parametrize("arguments", ["", "left='left_j', right=['right_j']"], ids=["found", "named"])
def test_wheels_without_a_plugin(simulate, file, arguments) -> None:
    lines = f"motion = MotionVWDiff({arguments})\nrobot.append(motion)"
    drives(simulate(SCENE.format(file=file(CART), lines=lines), sockets=False))


CORNERS = {"fl": (0.14, 0.2), "fr": (0.14, -0.2), "rl": (-0.14, 0.2), "rr": (-0.14, -0.2)}
FOUR = BASE + "".join(wheel(name, *place) for name, place in CORNERS.items())


def test_four_wheels_are_found(simulate, file) -> None:
    lines = "motion = MotionVWDiff()\nrobot.append(motion)"
    simulation = simulate(SCENE.format(file=file(FOUR), lines=lines), sockets=False)
    simulation.robot.motion.publish({"v": 0.5, "w": 0.0})
    simulation.step(60)
    start = simulation.robot.pose.get()["x"]
    simulation.step(120)
    assert simulation.robot.pose.get()["x"] - start == pytest.approx(1.0, rel=0.03)


MJCF = """<mujoco model="cart"><worldbody><body name="base" pos="0 0 0.1"><freejoint/>
<geom type="box" size="0.2 0.1 0.04" pos="0 0 0.02" mass="4"/>
<body name="left" pos="0 0.15 0"><joint name="left_j" axis="0 1 0"/>
<geom type="cylinder" size="0.1 0.02" euler="90 0 0" mass="0.5"/></body>
<body name="right" pos="0 -0.15 0"><joint name="right_j" axis="0 1 0"/>
<geom type="cylinder" size="0.1 0.02" euler="90 0 0" mass="0.5"/></body>
<geom type="sphere" size="0.04" pos="-0.16 0 -0.06" mass="0.1" friction="0.01"/></body></worldbody>MOTORS</mujoco>"""
MOTORS = '<actuator><motor joint="left_j" ctrlrange="-5 5"/><motor joint="right_j" ctrlrange="-5 5"/></actuator>'


@pytest.mark.parametrize("motors", ["", MOTORS], ids=["rolling", "motors"])
def test_wheels_of_mjcf_files(simulate, tmp_path, motors) -> None:
    path = tmp_path / "cart.xml"
    path.write_text(MJCF.replace("MOTORS", motors))
    lines = "motion = MotionVWDiff()\nrobot.append(motion)"
    drives(simulate(SCENE.format(file=str(path), lines=lines), sockets=False))


def test_a_robot_without_wheels_names_its_joints(simulate, file) -> None:
    arm = (
        BASE + link("arm", 1) + joint("elbow", "revolute", "base_link", "arm", "", rest='<limit lower="-1" upper="1"/>')
    )
    lines = "motion = MotionVWDiff()\nrobot.append(motion)"
    with pytest.raises(Exception, match=r"has no wheels to drive.*elbow \(no wheel"):
        simulate(SCENE.format(file=file(arm), lines=lines), sockets=False)
    lines = "motion = MotionVWDiff(left='lef_j', right='right_j')\nrobot.append(motion)"
    with pytest.raises(Exception, match=r"no joint 'lef_j'.*did you mean 'left_j'.*right_j"):
        simulate(SCENE.format(file=file(CART), lines=lines), sockets=False)


CAR = BASE + wheel("rl", -0.3, 0.2) + wheel("rr", -0.3, -0.2) + "".join(
    link(f"k{side}", 0.5) + joint(f"k{side}_j", "revolute", "base_link", f"k{side}", f'xyz="0.3 {y} 0"', "0 0 1",
    '<limit lower="-0.6" upper="0.6" effort="100" velocity="10"/>') + wheel(f"f{side}", 0, 0, f"k{side}")
    for side, y in (("l", 0.2), ("r", -0.2))
)  # fmt: skip
ACKERMANN = plugin(
    "car",
    "libgazebo_ros_ackermann_drive.so",
    """<front_left_joint>fl_j</front_left_joint><front_right_joint>fr_j</front_right_joint>
    <rear_left_joint>rl_j</rear_left_joint><rear_right_joint>rr_j</rear_right_joint>
    <left_steering_joint>kl_j</left_steering_joint><right_steering_joint>kr_j</right_steering_joint>
    <max_steer>0.6</max_steer>""",
)


def test_a_car_is_measured(simulate, file) -> None:
    simulation = simulate(SCENE.format(file=file(CAR + ACKERMANN), lines=""), sockets=False)
    simulation.robot.motion.publish({"v": 0.4, "w": 0.2})
    simulation.step(120)
    start = simulation.robot.pose.get()["yaw"]
    simulation.step(120)
    turned = math.remainder(simulation.robot.pose.get()["yaw"] - start, math.tau)
    assert turned == pytest.approx(0.4, rel=0.1)


PLANAR = plugin("move", "libgazebo_ros_planar_move.so", "<ros><remapping>cmd_vel:=go</remapping></ros>")


def test_a_body_moves_in_any_direction(simulate, file) -> None:
    simulation = simulate(SCENE.format(file=file(FOUR + PLANAR), lines=""), sockets=False)
    simulation.robot.motion.publish({"x": 0.0, "y": 0.5, "w": 0.0})
    simulation.step(60)
    start = simulation.robot.pose.get()["y"]
    simulation.step(120)
    assert simulation.robot.pose.get()["y"] - start == pytest.approx(1.0, rel=0.05)


def test_joint_states_need_no_armature(simulate, file) -> None:
    states = plugin("states", "libgazebo_ros_joint_state_publisher.so", "<joint_name>left_j</joint_name>")
    simulation = simulate(SCENE.format(file=file(CART + GZ + states), lines=""), sockets=False)
    simulation.step(30)
    simulation.robot.motion.publish({"v": 0.5, "w": 0.0})
    simulation.step(60)
    start = simulation.robot.joint_states.get()["left_j"]
    simulation.step(60)
    assert simulation.robot.joint_states.get()["left_j"] - start == pytest.approx(5.0, rel=0.03)


def topics(file_name):
    library = read_urdf(file_name)
    return {one.name: dict(one.stream).get("topic") for one in (*library.actuators, *library.sensors)}


def test_the_topics_are_those_of_the_file(file) -> None:
    assert topics(file(CART + ROS2)) == {"motion": "/front/go", "odom": "/front/odom"}
    assert topics(file(CART + ROS1)) == {"motion": "go", "odom": "odometry"}
    assert topics(file(CART + GZ)) == {"motion": "go", "odom": "odom"}


def test_what_is_not_understood_is_one_line(file) -> None:
    text = (
        CART + plugin("a", "libfoo.so", "") + plugin("b", "libbar.so", "") + plugin("c", "libgazebo_ros_control.so", "")
    )
    assert read_urdf(file(text)).warnings == ["plugins that MORSE does not have are left out: a, b"]
    own_sensors = plugin("i", "libgazebo_ros_imu.so", "") + plugin("g", "libhector_gazebo_ros_gps.so", "")
    assert read_urdf(file(CART + own_sensors)).warnings == ["plugins that MORSE does not have are left out: i, g"]


CONTROL = """<ros2_control name="x" type="system"><joint name="left_j"><command_interface name="velocity"/></joint>
</ros2_control><transmission name="t"><joint name="right_j"><hardwareInterface>
hardware_interface/VelocityJointInterface</hardwareInterface></joint></transmission>"""


def test_interfaces_set_what_motors_control(file) -> None:
    armature = read_urdf(file(CART + CONTROL)).roots[0].children[0]
    assert {bone.name for bone in armature.bones if str(bone.dynamics.control) == "velocity"} == {"left_j", "right_j"}


def test_wheels_with_velocity_interfaces_drive(simulate, file) -> None:
    drives(simulate(SCENE.format(file=file(CART + CONTROL), lines=""), sockets=False))


def test_friction_of_links(file) -> None:
    text = link("base_link", 1, '<box size="0.4 0.4 0.1"/>')
    for number, friction in (("0.2", 0.2), ("100.0", None)):
        gazebo = f'<gazebo reference="base_link"><mu1>{number}</mu1><mu2>{number}</mu2></gazebo>'
        (box,) = (node for node in read_urdf(file(text + gazebo)).roots[0].walk() if node.name.endswith("collision1"))
        assert box.body.friction == friction


SETTINGS = """<gazebo reference="base_link"><mu1>0.3</mu1><mu2>0.2</mu2><kp>1e6</kp><minDepth>0.001</minDepth>
<selfCollide>false</selfCollide></gazebo>
<gazebo reference="base_link"><kp>1e5</kp><material>Gazebo/Orange</material></gazebo>"""


def test_settings_of_links_without_a_counterpart_are_one_line(file) -> None:
    visual = '<visual><geometry><box size="0.4 0.4 0.1"/></geometry></visual></link>'
    text = link("base_link", 1, '<box size="0.4 0.4 0.1"/>').replace("</link>", visual) + SETTINGS
    library = read_urdf(file(text))
    (line,) = (one for one in library.warnings if "Gazebo" in one)
    assert line.endswith("are left out: kp, minDepth, mu2")
    shapes = {node.name: node for node in library.nodes()}
    assert shapes["base_link_collision1"].body.friction == 0.3, "of the first element"
    red, green, blue, _ = shapes["base_link_visual1"].color
    assert red > green > blue
