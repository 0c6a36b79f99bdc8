"""The @name@ robot: its body and its equipment."""

from morse.builder import *


class @classname@(GroundRobot):
    """A @name@, ready to be put in a scene: `robot = @classname@()`."""

    def __init__(self, name=None, debug=True):
        """Build the robot.

        name: the name of the robot, if it is not that of the variable in the scene script
        debug: let the arrow keys drive the robot
        """
        # the body: data/@env@/robots/@name@.blend
        GroundRobot.__init__(self, '@env@/robots/@name@.blend', name)

        # the behaviour: src/@env@/robots/@name@.py
        self.properties(classpath='@env@.robots.@name@.@classname@')

        # --- Actuators -------------------------------------------------------------------
        # (v, w): linear speed in m/s and angular speed in rad/s
        self.motion = MotionVW()
        self.append(self.motion)

        if debug:
            keyboard = Keyboard()
            keyboard.properties(ControlType='Position')
            self.append(keyboard)

        # --- Sensors ---------------------------------------------------------------------
        # where the robot is: x, y, z in metres; yaw, pitch, roll in radians
        self.pose = Pose()
        self.append(self.pose)
