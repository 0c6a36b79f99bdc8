"""A simulation for abuse."""

from morse.testing.process import SimulationProcess
from tests.kit.programs import Line

SCENE = """
from morse.builder import *

for number, name in enumerate(("anna", "bert")):
    robot = ATRV(name)
    robot.translate(0.0, 3.0 * number, 0.0)
    pose, odometry, motion = Pose("pose"), Odometry("odometry"), MotionVW("motion")
    for component in (pose, odometry, motion):
        robot.append(component)
    robot.add_default_interface("socket")
env = Environment("empty", fastmode=True)
"""


class Victim:
    """A running simulation and its ports."""

    def __init__(self, process: SimulationProcess) -> None:
        self.process = process
        self.port = process.port
        line = Line(self.port)
        self.streams: dict[str, int] = line.call("simulation", "get_all_stream_ports")
        line.close()

    def log(self) -> str:
        return self.process.log.read_text(encoding="utf-8", errors="replace")
