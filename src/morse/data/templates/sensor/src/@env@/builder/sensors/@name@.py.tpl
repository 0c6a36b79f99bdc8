"""The @name@ sensor, for scene scripts.

This file rarely needs a change. To give the sensor a body of its own (the casing of a laser
scanner, say), a frequency or other default settings, write them below.
"""

from morse.builder.creator import SensorCreator


class @classname@(SensorCreator):
    """@shortdesc@"""

    # the class that runs in the simulation: src/@env@/sensors/@name@.py
    _classpath = "@env@.sensors.@name@.@classname@"
    _blendname = "@name@"

    def __init__(self, name=None):
        """name: the name of the sensor, if it is not that of the variable in the scene script"""
        SensorCreator.__init__(self, name)
