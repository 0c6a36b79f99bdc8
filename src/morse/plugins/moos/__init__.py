"""The data of components as variables of a MOOS database."""

from __future__ import annotations

from morse.core.declarations import Option
from morse.middleware.registry import Middleware

PORT = 9000

MANAGER_OPTIONS = {
    "moos_host": Option(str, "127.0.0.1", "name or address of the database"),
    "moos_port": Option(int, PORT, "port of the database", low=1, high=65535),
    "moos_name": Option(str, "iMorse", "name of the simulation in the MOOS community"),
    "rate": Option(float, 50.0, "exchanges with the database per wall-clock second", low=1.0, high=200.0),
}
STREAM_OPTIONS = {
    "prefix": Option(str, "MORSE", "begin of the names of the variables"),
    "moos_host": Option(str, None, "name or address of the database of this stream"),
    "moos_port": Option(int, None, "port of the database of this stream", low=1, high=65535),
    "moos_name": Option(str, None, "name of the simulation in the community of this stream"),
}

MIDDLEWARE = Middleware(
    name="moos",
    stream_manager="morse.middleware.moos_datastream.MOOSDatastreamManager",
    manager_options=MANAGER_OPTIONS,
    stream_options=STREAM_OPTIONS,
    default_publisher="morse.plugins.moos.datastream.MoosPublisher",
    default_reader="morse.plugins.moos.datastream.MoosReader",
    # images and clouds would be megabytes of text in each tick
    not_carried=("Camera", "CameraUnit", "StereoUnit", "MocapControl"),
    modules=("pymoos2",),
    extra="moos",
    purpose="variables of a MOOS database",
)
