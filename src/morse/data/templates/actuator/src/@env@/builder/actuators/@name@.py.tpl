"""The @name@ actuator, for scene scripts.

This file rarely needs a change. To give the actuator a body of its own (the casing of a laser
scanner, say), a frequency or other default settings, write them below.
"""

from morse.builder.creator import ActuatorCreator


class @classname@(ActuatorCreator):
    """@shortdesc@"""

    # the class that runs in the simulation: src/@env@/actuators/@name@.py
    _classpath = "@env@.actuators.@name@.@classname@"
    _blendname = "@name@"

    def __init__(self, name=None):
        """name: the name of the actuator, if it is not that of the variable in the scene script"""
        ActuatorCreator.__init__(self, name)
