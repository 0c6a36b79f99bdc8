"""What components of a simulation publish."""

import math


def published(component):
    """The messages that a component publishes from now on."""
    messages = []
    component.output_functions.append(lambda sensor: messages.append(dict(sensor.local_data)))
    return messages


def angle_of(point):
    return math.degrees(math.atan2(point[1], point[0]))
