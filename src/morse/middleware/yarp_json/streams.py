"""The streams of components, under the names that scripts may use."""

from __future__ import annotations

from morse.middleware.yarp.streams import YarpPublisher, YarpReader


class YarpJsonPublisher(YarpPublisher):
    """Sends the data of a component as a JSON text."""


class YarpJsonReader(YarpReader):
    """Writes the fields of JSON objects into the data of an actuator."""
