"""Plugins of SDF files become actuators: they drive, fly and lift as their formulas say."""

import math

import pytest

import morse
from morse.assets.sdf import read_sdf


def link(name, pose, mass, shape, turned="0 0 0"):
    return f"""<link name="{name}"><pose>{pose}</pose><inertial><mass>{mass}</mass><inertia><ixx>{0.01 * mass}</ixx>
    <iyy>{0.01 * mass}</iyy><izz>{0.01 * mass}</izz></inertia></inertial><collision name="c"><pose>0 0 0 {turned}</pose>
    <geometry>{shape}</geometry></collision></link>"""


def hinge(name, parent, child, axis, limit=""):
    return f"""<joint name="{name}" type="revolute"><parent>{parent}</parent><child>{child}</child><axis>
    <xyz>{axis}</xyz>{limit}</axis></joint>"""


WHEEL = "<cylinder><radius>0.1</radius><length>0.04</length></cylinder>"
TURNED = f"{math.pi / 2} 0 0"
CART = f"""<sdf version="1.7"><model name="cart">
{link("chassis", "0 0 0.12 0 0 0", 4, "<box><size>0.4 0.2 0.08</size></box>")}
{link("left", "0 0.15 0.1 0 0 0", 0.5, WHEEL, TURNED)}{link("right", "0 -0.15 0.1 0 0 0", 0.5, WHEEL, TURNED)}
{link("caster", "-0.16 0 0.04 0 0 0", 0.2, "<sphere><radius>0.04</radius></sphere>")}
{hinge("left_joint", "chassis", "left", "0 1 0")}{hinge("right_joint", "chassis", "right", "0 1 0")}
<joint name="ball" type="ball"><parent>chassis</parent><child>caster</child></joint>
<plugin name="gz::sim::systems::DiffDrive" filename="gz-sim-diff-drive-system"><left_joint>left_joint</left_joint>
<right_joint>right_joint</right_joint><wheel_separation>0.3</wheel_separation><wheel_radius>0.1</wheel_radius></plugin>
<plugin name="mystery" filename="libmystery.so"/>
</model></sdf>"""
SCENE = """robot = Robot({file!r})
robot.translate(z={z})
pose = Pose()
robot.append(pose)
env = Environment('empty')
"""


@pytest.fixture
def file(tmp_path):
    def write(text):
        path = tmp_path / "model.sdf"
        path.write_text(text)
        return str(path)

    return write


def test_a_cart_drives(simulate, file) -> None:
    simulation = simulate(SCENE.format(file=file(CART), z=0.002), sockets=False)
    simulation.robot.motion.publish({"v": 0.5, "w": 0.0})
    simulation.step(60)
    start = simulation.robot.pose.get()
    simulation.step(120)
    end = simulation.robot.pose.get()
    assert end["x"] - start["x"] == pytest.approx(1.0, rel=0.03)
    assert end["y"] == pytest.approx(0.0, abs=0.05)
    simulation.robot.motion.publish({"v": 0.0, "w": 0.5})
    simulation.step(60)
    start = simulation.robot.pose.get()["yaw"]
    simulation.step(120)
    assert math.remainder(simulation.robot.pose.get()["yaw"] - start, math.tau) == pytest.approx(1.0, rel=0.1)


def test_plugins_that_are_not_known_are_one_line(file) -> None:
    library = read_sdf(file(CART))
    assert library.warnings == ["plugins that MORSE does not have are left out: mystery"]
    assert [(one.name, one.product) for one in library.actuators] == [("motion", "MotionVWDiff")]


def wheel(name, x, y):
    return link(name, f"{x} {y} 0.1 0 0 0", 0.5, WHEEL, TURNED)


CAR = f"""<sdf version="1.7"><model name="car">
{link("chassis", "0 0 0.15 0 0 0", 8, "<box><size>0.6 0.2 0.05</size></box>")}
{wheel("rl", -0.3, 0.2)}{wheel("rr", -0.3, -0.2)}{wheel("fl", 0.3, 0.2)}{wheel("fr", 0.3, -0.2)}
{link("kl", "0.3 0.2 0.1 0 0 0", 0.5, "<sphere><radius>0.02</radius></sphere>")}
{link("kr", "0.3 -0.2 0.1 0 0 0", 0.5, "<sphere><radius>0.02</radius></sphere>")}
{hinge("rl_j", "chassis", "rl", "0 1 0")}{hinge("rr_j", "chassis", "rr", "0 1 0")}
{hinge("kl_j", "chassis", "kl", "0 0 1", "<limit><lower>-0.6</lower><upper>0.6</upper></limit>")}
{hinge("kr_j", "chassis", "kr", "0 0 1", "<limit><lower>-0.6</lower><upper>0.6</upper></limit>")}
{hinge("fl_j", "kl", "fl", "0 1 0")}{hinge("fr_j", "kr", "fr", "0 1 0")}
<plugin name="gz::sim::systems::AckermannSteering" filename="x"><left_joint>rl_j</left_joint>
<right_joint>rr_j</right_joint><left_steering_joint>kl_j</left_steering_joint>
<right_steering_joint>kr_j</right_steering_joint><wheel_base>0.6</wheel_base><wheel_separation>0.4</wheel_separation>
<wheel_radius>0.1</wheel_radius><steering_limit>0.6</steering_limit></plugin></model></sdf>"""


def test_a_car_follows_its_circle(simulate, file) -> None:
    simulation = simulate(SCENE.format(file=file(CAR), z=0.002), sockets=False)
    simulation.robot.motion.publish({"v": 0.4, "w": 0.2})
    simulation.step(120)
    start = simulation.robot.pose.get()["yaw"]
    simulation.step(120)
    turned = math.remainder(simulation.robot.pose.get()["yaw"] - start, math.tau)
    assert turned == pytest.approx(0.4, rel=0.1)


def rotor(i, x, y, spin):
    return f"""{link(f"rotor_{i}", f"{x} {y} 0.1 0 0 0", 0.02, "<box><size>0.1 0.01 0.002</size></box>")}
    {hinge(f"rotor_{i}_joint", "base", f"rotor_{i}", "0 0 1")}
    <plugin name="gz::sim::systems::MulticopterMotorModel" filename="gz-sim-multicopter-motor-model-system">
    <jointName>rotor_{i}_joint</jointName><linkName>rotor_{i}</linkName><turningDirection>{spin}</turningDirection>
    <motorConstant>1e-5</motorConstant><momentConstant>0.02</momentConstant><maxRotVelocity>2000</maxRotVelocity>
    <rotorDragCoefficient>0</rotorDragCoefficient><rollingMomentCoefficient>0</rollingMomentCoefficient></plugin>"""


COPTER = f"""<sdf version="1.9"><model name="copter">
{link("base", "0 0 0.1 0 0 0", 1.92, "<box><size>0.3 0.3 0.1</size></box>")}
{rotor(0, 0.2, -0.2, "ccw")}{rotor(1, -0.2, 0.2, "ccw")}{rotor(2, 0.2, 0.2, "cw")}{rotor(3, -0.2, -0.2, "cw")}
</model></sdf>"""


def test_a_multicopter_climbs_as_its_thrust_says(simulate, file) -> None:
    simulation = simulate(SCENE.format(file=file(COPTER), z=5.0), sockets=False)
    # 2 kg; a fifth more thrust than weight
    speed = math.sqrt(1.2 * 2.0 * 9.81 / (4 * 1e-5))
    for i in range(4):
        simulation.robot[f"rotor_{i}_joint"].publish({"speed": speed})
    simulation.step(30)
    first = simulation.robot.pose.get()["z"]
    simulation.step(30)
    second = simulation.robot.pose.get()["z"]
    simulation.step(30)
    third = simulation.robot.pose.get()
    # 0.2 g, less the damping of 4 % a second of free bodies
    assert (third["z"] - 2 * second + first) / 0.25 == pytest.approx(0.2 * 9.81, rel=0.08)
    assert third["yaw"] == pytest.approx(0.0, abs=0.02)


def test_rotors_of_one_direction_turn_the_body_back(simulate, file) -> None:
    simulation = simulate(SCENE.format(file=file(COPTER), z=5.0), sockets=False)
    for i in (0, 1):
        simulation.robot[f"rotor_{i}_joint"].publish({"speed": 600.0})
    simulation.step(30)
    assert simulation.robot.pose.get()["yaw"] < -0.1


WING = f"""<sdf version="1.9"><model name="wing">
{link("base", "0 0 0 0 0 0", 1, "<box><size>0.3 0.3 0.02</size></box>")}
<plugin name="gz::sim::systems::LiftDrag" filename="gz-sim-lift-drag-system"><link_name>base</link_name><a0>0.1</a0>
<cla>4</cla><cda>0.5</cda><cma>0</cma><alpha_stall>0.3</alpha_stall><area>0.05</area><air_density>1.2</air_density>
<forward>1 0 0</forward><upward>0 0 1</upward><cp>0 0 0</cp></plugin></model></sdf>"""


def test_a_wing_lifts(simulate, file) -> None:
    scene = SCENE.format(file=file(WING), z=50.0).replace(
        "env =", "push = ExternalForce()\nrobot.append(push)\nspeed = Velocity()\nrobot.append(speed)\nenv ="
    )
    simulation = simulate(scene, sockets=False)
    simulation.robot.push.publish({"force": [300.0, 0.0, 9.81], "torque": [0.0, 0.0, 0.0]})
    simulation.step(3)
    simulation.robot.push.publish({"force": [0.0, 0.0, 9.81], "torque": [0.0, 0.0, 0.0]})
    simulation.step(3)
    before = simulation.robot.speed.get()
    simulation.step(6)
    after = simulation.robot.speed.get()
    x, _, z = before["world_linear_velocity"]
    assert x > 5.0
    ticks = round((after["timestamp"] - before["timestamp"]) * 60.0)
    for _ in range(ticks):
        # lift across the flow, drag along it; free bodies lose 4 % of their speed in a second
        speed, path = math.hypot(x, z), math.atan2(z, x)
        pressure, angle = 0.5 * 1.2 * speed**2 * 0.05, 0.1 - path
        lift, drag, loss = 4.0 * angle * pressure, abs(0.5 * angle * pressure), -math.log(0.96)
        x += (-lift * math.sin(path) - drag * math.cos(path) - loss * x) / 60.0
        z += (lift * math.cos(path) - drag * math.sin(path) - loss * z) / 60.0
    assert after["world_linear_velocity"] == pytest.approx([x, 0.0, z], abs=0.01)
    assert z > before["world_linear_velocity"][2] + 0.05


_WRONG = {
    "<wheel_radius>0.1<": ("-1", "the plugin 'gz::sim::systems::DiffDrive' (line {line}) is left out"),
    "<wheel_separation>0.3<": ("-0.5", "the plugin 'gz::sim::systems::DiffDrive' (line {line}) is left out"),
    "<motorConstant>8.5e-6<": ("-1e9", "the plugin 'prop' (line {line}) is left out"),
    "<maxRotVelocity>800<": ("-1", "the plugin 'prop' (line {line}) is left out"),
    "<area>0.2<": ("-0.2", "the plugin 'wing' (line {line}) is left out"),
    "<a0>0.05<": ("77", "the plugin 'wing' (line {line}) is left out"),
    "<pose>0 0 0.12 0 0 0<": ("0 0 0.12 inf 0 0", "(line {line})"),
    "<update_rate>30<": ("many", "the plugin 'states' (line {line}) is left out"),
    "<wheel_base>0.3<": ("-3", "the plugin 'steer' (line {line}) is left out"),
}
_MORE = """
<plugin name="prop" filename="libgazebo_motor_model.so"><jointName>ball</jointName><linkName>caster</linkName>
<motorConstant>8.5e-6</motorConstant><maxRotVelocity>800</maxRotVelocity></plugin>
<plugin name="wing" filename="libLiftDragPlugin.so"><link_name>chassis</link_name><area>0.2</area><a0>0.05</a0></plugin>
<plugin name="states" filename="gz-sim-joint-state-publisher-system"><update_rate>30</update_rate></plugin>
<plugin name="steer" filename="libgazebo_ros_ackermann_drive.so"><left_joint>left_joint</left_joint>
<right_joint>right_joint</right_joint><left_steering_joint>left_joint</left_steering_joint>
<right_steering_joint>right_joint</right_steering_joint><wheel_base>0.3</wheel_base></plugin>
"""


@pytest.mark.parametrize("number", _WRONG)
def test_a_number_that_no_component_takes_names_file_line_and_plugin(file, tmp_path, caplog, number: str) -> None:
    """A negative diameter stopped the scene, without a word about the file."""
    text = CART.replace("</model>", f"{_MORE}</model>")
    value, expected = _WRONG[number]
    tag = number[1:].partition(">")[0]
    assert number in text
    changed = text.replace(number, f"<{tag}>{value}<", 1)
    place = changed.index(f"<{tag}>{value}<")
    if "plugin" in expected:
        place = changed.rindex("<plugin", 0, place)
    script = tmp_path / "scene.py"
    script.write_text("from morse.builder import *\n" + SCENE.format(file=file(changed), z=0.002))
    line = changed.count("\n", 0, place) + 1
    wanted = expected.format(line=line)
    try:
        with morse.load(script) as simulation:
            simulation.step(1)
    except Exception as error:
        said = str(error)
    else:
        said = "\n".join(record.getMessage() for record in caplog.records)
    assert "model.sdf: " in said
    assert wanted in said
