"""Robots drive as commanded, with wheels and casters as their makers describe them."""

import logging
import math
from math import pi

import pytest

#: wheels have a friction that holds them, unless a maker sets another
_LYING = f'rpy="{pi / 2} 0 0"'


def _link(name: str, mass: float, shape: str = "", pose: str = "", more: str = "") -> str:
    solid = f"<collision><origin {pose}/><geometry>{shape}</geometry></collision>" if shape else ""
    moment = 0.01 * mass
    inertia = f'<inertia ixx="{moment}" iyy="{moment}" izz="{moment}" ixy="0" ixz="0" iyz="0"/>'
    return f'<link name="{name}"><inertial><mass value="{mass}"/>{inertia}</inertial>{solid}</link>{more}'


def _joint(
    name: str, kind: str, child: str, place: str, axis: str = "0 1 0", rest: str = "", parent="base_link"
) -> str:
    ends = f'<parent link="{parent}"/><child link="{child}"/>'
    return f'<joint name="{name}" type="{kind}">{ends}<origin {place}/><axis xyz="{axis}"/>{rest}</joint>'


def _pair(shape: str, pose: str = "", x: float = 0.0, rest: str = "", radius: float = 0.1, name: str = "") -> str:
    return "".join(
        _link(f"{name}{side}", 0.5, shape, pose)
        + _joint(f"{name}{side}_joint", "continuous", f"{name}{side}", f'xyz="{x} {y} {radius}"', rest=rest)
        for side, y in (("left", 0.15), ("right", -0.15))
    )


CYLINDER, BOX = '<cylinder radius="0.1" length="0.06"/>', '<box size="0.2 0.06 0.2"/>'
BALL = '<sphere radius="0.03"/>'
BASE = _link("base_link", 8, '<box size="0.4 0.2 0.08"/>', 'xyz="0 0 0.12"')
#: the body of the robot is a tub that stands on the ground, as that of Fetch
TUB = _link("base_link", 8, '<box size="0.5 0.2 0.2"/>', 'xyz="0 0 0.1"')
REAR = _link("rear", 0.1, BALL) + _joint("rear_joint", "fixed", "rear", 'xyz="-0.18 0 0.03"')
FRONT = _link("front", 0.1, BALL) + _joint("front_joint", "fixed", "front", 'xyz="0.18 0 0.03"')
STIFF = '<dynamics damping="2" friction="1"/>'
WEAK = '<limit effort="3" velocity="40"/>'
MASSLESS = (
    '<link name="carrier"/>' + _joint("carry", "fixed", "carrier", 'xyz="0 0 0"')
    + _link("left", 0.5, CYLINDER, _LYING) + _link("right", 0.5, CYLINDER, _LYING)
    + _joint("left_joint", "continuous", "left", 'xyz="0 0.15 0.1"', parent="carrier")
    + _joint("right_joint", "continuous", "right", 'xyz="0 -0.15 0.1"', "0 -1 0", parent="carrier")
)  # fmt: skip
TURNED = "".join(
    _link(side, 0.5, CYLINDER)
    + _joint(f"{side}_joint", "continuous", side, f'xyz="0 {y} 0.1" rpy="{-pi / 2} 0 0"', "0 0 1")
    for side, y in (("left", 0.15), ("right", -0.15))
)
ROUND = _pair(CYLINDER, _LYING)
#: what makers do, and whether the wheels are round
MAKERS = {
    "fixed casters": BASE + ROUND + REAR + FRONT,
    "a tub on the ground": TUB + ROUND,
    "boxes around wheels and body": TUB + _pair(BOX) + REAR,
    "damping and dry friction": BASE + _pair(CYLINDER, _LYING, rest=STIFF) + REAR + FRONT,
    "motors with a largest effort": BASE + _pair(CYLINDER, _LYING, rest=WEAK) + REAR + FRONT,
    "a link without a mass, mirrored axes": BASE + MASSLESS + REAR + FRONT,
    "frames of wheels that are turned": BASE + TURNED + REAR + FRONT,
}
SCENE = """robot = Robot({file!r})
robot.translate(z=0.002)
motion = MotionVWDiff()
robot.append(motion)
pose = Pose()
robot.append(pose)
env = Environment('empty')
"""


@pytest.fixture
def robot(simulate, tmp_path):
    def load(text: str):
        path = tmp_path / "cart.urdf"
        path.write_text(f'<robot name="cart">{text}</robot>')
        simulation = simulate(SCENE.format(file=str(path)), sockets=False)
        simulation.step(60)
        return simulation

    return load


def driven(simulation) -> tuple[float, float]:
    """The distance in 4 s at 0.3 m/s, m, and the angle turned in 2 s at 0.5 rad/s, from rest."""
    pose, motion = simulation.robot.pose, simulation.robot.motion
    start = pose.get()
    motion.publish({"v": 0.3, "w": 0.0})
    simulation.step(240)
    end = pose.get()
    motion.publish({"v": 0.0, "w": 0.0})
    simulation.step(60)
    yaw = pose.get()["yaw"]
    motion.publish({"v": 0.0, "w": 0.5})
    simulation.step(120)
    turned = math.remainder(pose.get()["yaw"] - yaw, math.tau)
    return math.hypot(end["x"] - start["x"], end["y"] - start["y"]), turned


@pytest.mark.parametrize("text", MAKERS.values(), ids=MAKERS)
def test_a_robot_drives_as_commanded(robot, text) -> None:
    distance, turned = driven(robot(text))
    assert distance == pytest.approx(1.2, rel=0.02)
    assert turned == pytest.approx(1.0, rel=0.05)


#: places of the centre of mass and of the axles: in the middle of four wheels or behind it, short and long
SKIDDING = {"even": (0.0, 0.14), "heavy behind": (-0.06, 0.14), "short": (0.0, 0.11), "long": (0.0, 0.25)}


@pytest.mark.parametrize(("middle", "x"), SKIDDING.values(), ids=SKIDDING)
def test_four_wheels_turn_as_commanded(robot, middle: float, x: float) -> None:
    """The distance between the wheels that counts follows from where they are, and from the centre of mass.

    Wheels that slide sideways hopped in the engine, and the robots turned at 0.8 to 1.1 of the rate.
    """
    corners = _pair(CYLINDER, _LYING, x=x, name="front_") + _pair(CYLINDER, _LYING, x=-x, name="rear_")
    distance, turned = driven(robot(BASE.replace("<inertial>", f'<inertial><origin xyz="{middle} 0 0"/>') + corners))
    assert distance == pytest.approx(1.2, rel=0.02)
    assert turned == pytest.approx(1.0, rel=0.04)


#: places of the axles of robots with more wheels than their weight needs, and of the centre of mass
MANY_WHEELS = {
    "six": ((-0.28, 0.0, 0.28), 0.0),
    "six, two of them near": ((-0.25, 0.02, 0.25), 0.0),
    "six, heavy behind": ((-0.28, 0.0, 0.28), -0.06),
    "eight": ((-0.33, -0.11, 0.11, 0.33), 0.0),
}


@pytest.mark.parametrize(("axles", "middle"), MANY_WHEELS.values(), ids=MANY_WHEELS)
def test_many_wheels_turn_as_commanded(robot, axles: tuple[float, ...], middle: float) -> None:
    """The weight does not determine the loads of six wheels: those in the middle bore half of what the others did.

    They bear the same if nothing bends and the centre of mass is in the middle. Robots turned at 0.84 of the rate.
    """
    wheels = "".join(_pair(CYLINDER, _LYING, x=x, name=f"axle_{n}_") for n, x in enumerate(axles))
    distance, turned = driven(robot(BASE.replace("<inertial>", f'<inertial><origin xyz="{middle} 0 0"/>') + wheels))
    assert distance == pytest.approx(1.2, rel=0.02)
    assert turned == pytest.approx(1.0, rel=0.04)


def test_wheels_on_legs_drive(robot) -> None:
    """The joints of a leg do not steer. A knee sprang back in each hop of a sliding wheel: 0.67 rad."""
    legs = "".join(
        _link(f"leg_{end}_{side}", 0.5)
        + _joint(
            f"knee_{end}_{side}", "revolute", f"leg_{end}_{side}", f'xyz="{x} {y} 0.3"',
            rest='<limit lower="-1" upper="1" effort="200" velocity="20"/>',
        )
        + _link(f"{end}_{side}", 0.5, CYLINDER, _LYING)
        + _joint(f"w_{end}_{side}", "continuous", f"{end}_{side}", 'xyz="0 0 -0.2"', parent=f"leg_{end}_{side}")
        for end, x in (("front", 0.15), ("rear", -0.15)) for side, y in (("left", 0.2), ("right", -0.2))
    )  # fmt: skip
    body = _link("base_link", 8, '<box size="0.4 0.2 0.08"/>', 'xyz="0 0 0.35"')
    distance, turned = driven(robot(body + legs))
    assert distance == pytest.approx(1.2, rel=0.02)
    assert turned == pytest.approx(1.0, rel=0.03)


def _friction(link: str, value: float) -> str:
    return f'<gazebo reference="{link}"><mu1>{value}</mu1><mu2>{value}</mu2></gazebo>'


def test_what_keeps_a_robot_from_its_speed_is_named(robot, caplog) -> None:
    with caplog.at_level(logging.WARNING):
        robot(BASE + ROUND + REAR + FRONT + _friction("left", 0.1) + _friction("right", 0.1))
        robot(BASE + _pair(CYLINDER, _LYING, rest=STIFF + '<limit effort="2" velocity="40"/>') + REAR)
        robot(BASE + _pair(CYLINDER, _LYING, rest='<limit effort="20" velocity="1"/>') + REAR)
        robot(TUB + _pair(BOX))
    assert "the friction of 0.1 of its wheels in the file lets them slip" in caplog.text
    assert "'left_joint' take 7 N m at 0.3 m/s, more than the 2 N m of its motor" in caplog.text
    assert "'left_joint' turns at most at 1 rad/s in the file, 0.1 m/s" in caplog.text
    assert "'left_joint', 'right_joint' are boxes in the file, which do not roll" in caplog.text


def test_a_caster_of_a_file_keeps_its_friction(robot) -> None:
    """Casters are found by where they end, not by names, and brake if their file says so."""
    slides, turned = driven(robot(BASE + ROUND + REAR + FRONT))
    brakes, _ = driven(robot(BASE + ROUND + REAR.replace("rear", "caster") + FRONT + _friction("caster", 0.9)))
    assert slides == pytest.approx(1.2, rel=0.02)
    assert turned == pytest.approx(1.0, rel=0.05)
    assert brakes < slides


def _legs(knee: str, motor: str = CYLINDER, shank: str = '<box size="0.03 0.03 0.3"/>') -> str:
    """Four motors about lateral axes, each with a leg, as those of Minitaur."""
    return "".join(
        _link(f"motor_{end}_{side}", 0.3, motor, _LYING)
        + _joint(f"m_{end}_{side}", "continuous", f"motor_{end}_{side}", f'xyz="{x} {y} 0.1"')
        + _link(f"leg_{end}_{side}", 0.1, shank, 'xyz="0 0 0.15"')
        + _joint(f"k_{end}_{side}", knee, f"leg_{end}_{side}", 'xyz="0.1 0 0"', parent=f"motor_{end}_{side}")
        for end, x in (("front", 0.2), ("rear", -0.2)) for side, y in (("left", 0.2), ("right", -0.2))
    )  # fmt: skip


@pytest.mark.parametrize("shank", ['<box size="0.03 0.03 0.3"/>', '<cylinder radius="0.2" length="0.02"/>'])
@pytest.mark.parametrize("knee", ["continuous", "fixed", "revolute"])
def test_motors_that_carry_legs_are_no_wheels(robot, knee, shank) -> None:
    with pytest.raises(Exception, match="has no wheels to drive"):
        robot(BASE + _legs(knee, shank=shank))


@pytest.mark.parametrize("ends", ["", 'lower="" upper=" "'])
def test_a_wheel_whose_joint_has_no_range_turns_without_end(robot, ends) -> None:
    """MuJoCo and PyBullet read a <limit> that gives an effort alone so; the format itself would lock the joint."""
    wheels = _pair(CYLINDER, _LYING, rest=f'<limit effort="5" velocity="40" {ends}/>').replace("continuous", "revolute")
    distance, _ = driven(robot(BASE + wheels + REAR + FRONT))
    assert distance == pytest.approx(1.2, rel=0.02)


@pytest.mark.parametrize("marker", ["", '<visual><geometry><sphere radius="0.01"/></geometry></visual>'])
def test_a_robot_that_floats_beside_a_marker_is_free(robot, marker) -> None:
    marked = f'<link name="footprint">{marker}</link>' + _joint(
        "float", "floating", "base_link", "", parent="footprint"
    )
    simulation = robot(marked + BASE + ROUND + REAR + FRONT)
    assert simulation.robot.pose.get()["z"] == pytest.approx(0.0, abs=0.005)
    assert driven(simulation)[0] == pytest.approx(1.2, rel=0.02)


@pytest.mark.parametrize(("reach", "words"), [(0.1, ""), (0.16, "reaches the ground"), (0.25, "below the wheels")])
def test_an_arm_that_reaches_the_ground_is_named(robot, caplog, reach, words) -> None:
    arm = _link("hand", 0.3, f'<box size="0.04 0.04 {reach}"/>', f'xyz="0 0 {-reach / 2}"') + _joint(
        "wrist", "revolute", "hand", 'xyz="0.3 0 0.15"', rest='<limit lower="-1" upper="1" effort="9" velocity="1"/>'
    )
    with caplog.at_level(logging.WARNING):
        robot(BASE + ROUND + REAR + FRONT + arm)
    assert ("the link 'hand' reaches the ground" in caplog.text) == bool(words)
    assert words in caplog.text


@pytest.mark.parametrize(("effort", "lag"), [(0.4, 5.1), (2.0, 0.0)])
def test_motors_that_start_a_robot_slowly_are_named(robot, caplog, effort, lag) -> None:
    """Two motors at wheels of 0.1 m, 9.1 kg: v^2 / 2 a = v^2 m r / 4 M."""
    with caplog.at_level(logging.WARNING):
        text = BASE + _pair(CYLINDER, _LYING, rest=f'<limit effort="{effort}" velocity="40"/>') + REAR
        distance, _ = driven(robot(text))
    if not lag:
        assert "accelerate" not in caplog.text
        return
    assert f"0.88 m/s^2, by the efforts in the file: after a start to 0.3 m/s it is {lag} cm behind" in caplog.text
    assert distance == pytest.approx(1.2 - lag / 100.0, abs=0.01)


@pytest.mark.parametrize(
    ("kind", "ends", "is_named"),
    [("revolute", '<limit lower="-0.5" upper="0.5" effort="9" velocity="9"/>', True), ("continuous", "", False)],
    ids=["steered", "casters"],
)
def test_steered_wheels_are_named(robot, caplog, kind, ends, is_named) -> None:
    front = "".join(
        _link(f"fork_{side}", 0.2)
        + _joint(f"steer_{side}", kind, f"fork_{side}", f'xyz="0.3 {y} 0.15"', "0 0 1", ends)
        + _link(f"front_{side}", 0.3, CYLINDER, _LYING)
        + _joint(f"roll_{side}", "continuous", f"front_{side}", 'xyz="0 0 -0.05"', parent=f"fork_{side}")
        for side, y in (("left", 0.15), ("right", -0.15))
    )
    with caplog.at_level(logging.WARNING):
        robot(BASE + ROUND + front)
    assert ("MotionVWAckermann drives such a robot" in caplog.text) == is_named


def _hub_and_tyre(radius: float) -> str:
    """Wheels whose joint turns a hub, to which a tyre is fixed."""
    return "".join(
        _link(f"hub_{side}", 0.3, f'<cylinder radius="{radius}" length="0.02"/>', _LYING)
        + _joint(f"{side}_joint", "continuous", f"hub_{side}", f'xyz="0 {y} 0.1"')
        + _link(f"tyre_{side}", 0.2, CYLINDER, _LYING)
        + _joint(f"{side}_fixed", "fixed", f"tyre_{side}", 'xyz="0 0 0"', parent=f"hub_{side}")
        for side, y in (("left", 0.15), ("right", -0.15))
    )


@pytest.mark.parametrize("radius", [0.07, 0.02])
def test_a_tyre_that_is_fixed_to_a_hub_is_the_wheel(robot, radius) -> None:
    distance, turned = driven(robot(BASE + _hub_and_tyre(radius) + REAR + FRONT))
    assert distance == pytest.approx(1.2, rel=0.02)
    assert turned == pytest.approx(1.0, rel=0.05)
