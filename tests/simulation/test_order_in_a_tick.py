"""What happens first at one simulated time. The order is that of MORSE 1.4."""

from collections.abc import Callable
from typing import Any

import pytest

from morse.core.request_manager import RequestManager
from morse.simulation.simulation import Simulation

TWO = """
robot = FakeRobot()
{actuators}
pose = Pose()
robot.append(pose)
robot.add_default_interface("socket")
env = Environment("empty")
"""
MOTION = "motion = MotionXYW()\nrobot.append(motion)\nmotion.properties(ControlType='Position')"
OTHER = "other = MotionVW()\nrobot.append(other)\nother.properties(ControlType='Position')"
TELEPORT = "teleport = Teleport()\nrobot.append(teleport)"


def test_with_the_physics_of_1_4_a_sleeper_is_awake_a_tick_later_after_the_messages(
    load: Callable[..., Simulation],
) -> None:
    simulation = load(TWO.format(actuators="") + "env.use_physics_of_1_4()\n")
    pose = simulation.context.component("robot.pose")
    seen: list[tuple[float, float]] = []
    nap = simulation.call("time", "sleep", 0.5)
    nap.add_done_callback(lambda _: seen.append((simulation.clock.time, pose.local_data["timestamp"])))
    simulation.step(30)
    assert not seen
    simulation.step(1)
    assert seen == [(pytest.approx(31 / 60), pytest.approx(31 / 60))]


def test_a_sleeper_is_awake_before_the_messages_of_that_time(load: Callable[..., Simulation]) -> None:
    simulation = load(TWO.format(actuators=""))
    pose = simulation.context.component("robot.pose")
    seen: list[tuple[float, float]] = []
    nap = simulation.call("time", "sleep", 0.5)
    nap.add_done_callback(lambda _: seen.append((simulation.clock.time, pose.local_data["timestamp"])))
    simulation.step(29)
    assert not seen
    simulation.step(1)
    ((now, measured),) = seen
    assert now == pytest.approx(0.5)
    assert measured == pytest.approx(29 / 60)


class Caller(RequestManager):
    """Makes a call, once, when the simulation answers services."""

    def __init__(self, call: Callable[[], object]) -> None:
        super().__init__()
        self._calls = [call]

    def initialization(self) -> bool:
        return True

    def finalization(self) -> bool:
        return True

    def on_service_completion(self, request_id: object, result: object) -> None:
        """Nobody waits."""

    def main(self) -> None:
        while self._calls:
            self._calls.pop()()


def test_a_service_acts_in_the_tick_at_whose_beginning_it_is_called(load: Callable[..., Simulation]) -> None:
    simulation = load(TWO.format(actuators="motion = MotionVW()\nrobot.append(motion)"))
    motion: Any = simulation.context.component("robot.motion")
    simulation.context.services.add_internal(Caller(lambda: motion.set_speed(1.0, 0.0)))
    simulation.step(1)
    pose = simulation.context.component("robot.pose")
    assert pose.local_data["x"] == pytest.approx(1 / 60, abs=1e-3)


@pytest.mark.parametrize("first", ["motion", "other"])
def test_the_actuator_created_first_has_the_last_word(load: Callable[..., Simulation], first: str) -> None:
    actuators = [MOTION, OTHER] if first == "motion" else [OTHER, MOTION]
    simulation = load(TWO.format(actuators="\n".join(actuators)))
    simulation.robot.motion.publish({"x": 0.0, "y": 1.0, "w": 0.0})
    simulation.robot.other.publish({"v": 1.0, "w": 0.0})
    simulation.step(60)
    pose = simulation.context.component("robot.pose").local_data
    moved = (pose["y"], pose["x"]) if first == "motion" else (pose["x"], pose["y"])
    assert moved == pytest.approx((1.0, 0.0), abs=0.03)


@pytest.mark.parametrize("order", [(MOTION, TELEPORT), (TELEPORT, MOTION)], ids=["motion first", "teleport first"])
@pytest.mark.parametrize("robot", ["FakeRobot", "ATRV"])
def test_a_teleport_holds_the_start_pose_until_it_is_deactivated(
    load: Callable[..., Simulation], order: tuple[str, str], robot: str
) -> None:
    script = TWO.format(actuators="\n".join(order)).replace("FakeRobot", robot)
    simulation = load(script.replace("'Position'", "'Velocity'"))
    simulation.robot.motion.publish({"x": 1.0, "y": 0.0, "w": 0.0})
    simulation.step(60)
    assert simulation.context.component("robot.pose").local_data["x"] == pytest.approx(0.0, abs=0.02)
    simulation.deactivate("robot.teleport")
    simulation.step(61)
    assert simulation.context.component("robot.pose").local_data["x"] == pytest.approx(1.0, abs=0.05)
