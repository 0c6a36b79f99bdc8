"""A complete simulation whose ticks are run by the test."""

from __future__ import annotations

import math

import morse


class Ticking:
    """The simulation of a scene script; components are reached by name."""

    def __init__(self, script, path, *, seed=None):
        path.write_text("from morse.builder import *\n" + script)
        self.simulation = morse.load(path, seed=seed, sockets=True)

    def __getitem__(self, name):
        return self.simulation.context.components.get(name) or self.simulation.context.robots[name]

    def run(self, seconds, each_tick=None):
        for _ in range(round(seconds * self.simulation.clock.frequency)):
            self.simulation.tick()
            if each_tick is not None:
                each_tick()
        return self

    @property
    def time(self):
        return self.simulation.clock.time

    def close(self):
        self.simulation.close()


def published(component):
    """The messages that a component publishes from now on."""
    messages = []
    component.output_functions.append(lambda sensor: messages.append(dict(sensor.local_data)))
    return messages


def angle_of(point):
    return math.degrees(math.atan2(point[1], point[0]))
