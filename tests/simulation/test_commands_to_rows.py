"""Commands of the process to actuators whose speeds last."""

import morse
from morse.builder import ATRV, Environment, MotionVW


def scene() -> None:
    for number in range(5):
        robot = ATRV(f"r{number}")
        robot.translate(y=3.0 * number)
        robot.append(MotionVW("motion"))
    Environment("empty", fastmode=True)


def test_a_command_arrives_after_the_rows_were_formed_again() -> None:
    with morse.load(scene) as simulation:
        robots = [getattr(simulation, f"r{number}") for number in range(5)]
        for robot in robots:  # the first command of each forms the rows again
            robot.motion.publish({"v": 1.0})
            simulation.step(2)
        for number, robot in enumerate(robots):
            robot.motion.publish({"v": 2.0 + number})
        simulation.step(2)
        assert [robot.motion.data["v"] for robot in robots] == [2.0, 3.0, 4.0, 5.0, 6.0]
