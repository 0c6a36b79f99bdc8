#! /usr/bin/env morseexec
"""The scene of @env@: a robot, what it carries, and the world around it.

Start it with:    morse run @env@
"""

from morse.builder import *

# --- The robot -----------------------------------------------------------------------------
# Every robot of MORSE can stand here, and those that you add to this project:
#     morse add robot <name> @env@
# The name of the variable is the name of the robot for your controllers; in the client
# script it is simu.robot

robot = Morsy()

# where it starts: metres (x forward, y left, z up), then radians
robot.translate(1.0, 0.0, 0.0)
robot.rotate(0.0, 0.0, 3.5)

# --- What it carries -----------------------------------------------------------------------
# An actuator: the robot drives with the linear speed v (m/s) and the angular speed w (rad/s)
# that a controller sends.
motion = MotionVW()
robot.append(motion)

# The arrow keys drive the robot, too, in the window of the simulation.
keyboard = Keyboard()
keyboard.properties(ControlType='Position')
robot.append(keyboard)

# A sensor: where the robot is (x, y, z in metres; yaw, pitch, roll in radians).
pose = Pose()
robot.append(pose)

# Controllers reach all of the above through a socket; see scripts/@env@_client.py
robot.add_default_interface('socket')

# --- The world -----------------------------------------------------------------------------
# It comes last: it completes the scene.
env = Environment('sandbox', fastmode=False)
env.set_camera_location([-18.0, -6.7, 10.8])
env.set_camera_rotation([1.09, 0, -1.14])
