"""The data of components as messages of an MQTT broker."""

from __future__ import annotations

from morse.core.declarations import Option
from morse.middleware.registry import Middleware

PORT, TLS_PORT = 1883, 8883

MANAGER_OPTIONS = {
    "host": Option(str, "127.0.0.1", "name or address of the broker"),
    "port": Option(int, None, "port of the broker; default: 1883, or 8883 with TLS", low=1, high=65535),
    "tls": Option(bool, False, "encrypt the connection, and verify the certificate of the broker"),
    "username": Option(str, None, "user name for the broker"),
    "password": Option(str, None, "password for the broker"),
    "client_id": Option(str, "", "client id of the simulation; by default, the broker generates it"),
    "prefix": Option(str, "morse", "first word of all topics"),
}
STREAM_OPTIONS = {
    "topic": Option(str, None, "replaces prefix/robot/component"),
    "qos": Option(int, 0, "0: at most once, 1: at least once, 2: once", low=0, high=2),
    "retain": Option(bool, False, "the broker keeps the last message for later subscribers"),
}

MIDDLEWARE = Middleware(
    name="mqtt",
    stream_manager="morse.middleware.mqtt.datastream.MqttDatastreamManager",
    manager_options=MANAGER_OPTIONS,
    stream_options=STREAM_OPTIONS,
    default_publisher="morse.middleware.mqtt.datastream.MqttPublisher",
    default_reader="morse.middleware.mqtt.datastream.MqttReader",
    # these classes carry cameras or nothing, and have no data
    not_carried=("StereoUnit", "MocapControl"),
    modules=("paho",),
    extra="mqtt",
    purpose="topics of an MQTT broker",
)
