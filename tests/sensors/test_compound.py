"""Several sensors in one message."""

import pytest

from morse.core.exceptions import MorseRPCTypeError
from morse.core.kinds import bind
from morse.wire.encoding import to_json

SCRIPT = """
robot = FakeRobot()
robot.translate(1.0, 2.0, 3.0)
pose = Pose()
robot.append(pose)
clock = Clock()
robot.append(clock)
both = CompoundSensor([pose, clock])
robot.append(both)
env = Environment("empty", fastmode=True)
"""


def test_the_data_of_its_members(simulate):
    simulation = simulate(SCRIPT, sockets=False)
    simulation.sleep(0.5)
    data = simulation.context.component("robot.both").local_data
    assert list(data) == ["timestamp", "robot.pose", "robot.clock"]
    assert data["robot.pose"] == simulation.context.component("robot.pose").local_data
    assert data["robot.clock"] == {"timestamp": pytest.approx(0.5)}
    assert b'"robot.pose": {"timestamp": 0.5, "x": 1.0, "y": 2.0, "z": 3.0' in to_json(data)


def test_it_may_have_a_name_of_its_own(simulate):
    simulation = simulate(SCRIPT.replace("[pose, clock]", "[pose, clock], 'named'"), sockets=False)
    simulation.sleep(0.1)
    assert "robot.pose" in simulation.context.component("robot.named").local_data


@pytest.mark.parametrize("members", ["['pose']", "[None]"])
def test_a_member_that_is_none(simulate, members):
    with pytest.raises(Exception, match=r"CompoundSensor\(sensors\) takes a list of sensors"):
        simulate(SCRIPT.replace("[pose, clock]", members), sockets=False)


@pytest.mark.parametrize("names", ["robot.pose,robot.nobody", "robot.both"])
def test_names_of_no_other_sensor_are_refused_while_it_runs(simulate, names):
    simulation = simulate(SCRIPT, sockets=False)
    simulation.sleep(0.1)
    with pytest.raises(MorseRPCTypeError, match="there is no other sensor 'robot"):
        simulation.context.component("robot.both").set_property("sensors", names)
    simulation.sleep(0.1)
    assert "robot.clock" in simulation.context.component("robot.both").local_data


def test_other_members_while_it_runs(simulate):
    simulation = simulate(SCRIPT, sockets=False)
    simulation.sleep(0.1)
    simulation.context.component("robot.both").set_property("sensors", "robot.clock")
    simulation.sleep(0.1)
    assert list(simulation.context.component("robot.both").local_data) == ["timestamp", "robot.clock"]


def test_the_message_kinds_of_its_members(simulate):
    simulation = simulate(SCRIPT, sockets=False)
    simulation.sleep(0.5)
    messages = {one.topic: one.gather() for one in bind(simulation.context.component("robot.both"))}
    assert {topic: message.kind.name for topic, message in messages.items()} == {"pose": "pose", "clock": "clock"}
    assert messages["pose"].position == pytest.approx([1.0, 2.0, 3.0])
    assert messages["clock"].now == pytest.approx(0.5)


def test_members_of_the_same_name(simulate):
    more = "other = FakeRobot()\nother.pose = Pose()\nother.append(other.pose)\n"
    script = SCRIPT.replace("both = ", more + "both = ").replace("[pose, clock]", "[pose, other.pose]")
    simulation = simulate(script, sockets=False)
    simulation.sleep(0.1)
    assert [one.topic for one in bind(simulation.context.component("robot.both"))] == ["robot_pose", "other_pose"]
