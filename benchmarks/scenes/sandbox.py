"""The world of the tutorial with a robot that is driven by keys."""

from morse.builder import *

robot = Morsy("robot")
keyboard = Keyboard("keyboard")
robot.append(keyboard)
pose = Pose("pose")
robot.append(pose)
robot.add_default_interface("socket")

env = Environment("sandbox")
