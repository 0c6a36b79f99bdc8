"""The table of budgets in the documentation has the numbers of the code."""

import importlib
from pathlib import Path

import pytest

TABLE = (Path(__file__).parents[2] / "docs/budgets.md").read_text(encoding="utf-8")
TABLE = TABLE.partition("## Budgets of clients")[2].partition("\n## ")[0]
KB, MB = 1 << 10, 1 << 20
#: module, name, value, beginning of the row, and text in it
ROWS = [
    ("core.clients.budgets", "_SHARE", 0.25, "everything that clients send", "25 %"),
    ("core.clients.budgets", "_TURN", 0.004, "everything that clients send", "4 ms at once"),
    ("core.clients.budgets", "_SERVICE_SHARE", 1 / 3, "services of one", "33 %"),
    ("core.clients.budgets", "_LEAST", 0.0003, "services of one", "0.3 ms"),
    ("core.clients.budgets", "_MOST", 0.05, "services of one", "50 ms"),
    ("viewer.live_view", "_LONGEST", 0.005, "requests of pages", "5 ms"),
    ("middleware.ros2.simulation_interfaces", "_LONGEST_SEARCH", 0.02, "search", "20 ms"),
    ("core.clients.budgets", "MOST_PIXELS", 8_000_000, "sizes of images", "8,000,000"),
    ("core.clients.budgets", "RAY", 16, "sizes of images", "as 16 pixels"),
    ("core.clients.budgets", "LEAST_RATE", 10.0, "sizes of images", "less than 10 "),
    ("simulation.population", "_MOST_ROOTS", 20_000, "objects of a scene", "20,000"),
    ("simulation.population", "_MOST_COMPONENTS", 200, "robots, sensors and actuators", "200"),
    ("simulation.population", "_MOST_ADDED", 500, "components that are added", "500"),
    ("builder.assembly.spawning", "_LONGEST_DELAY", 60.0, "delay of a spawned", "60 s"),
    ("simulation.population", "_SHORTEST_STEP", 0.0005, "time step", "0.5 ms"),
    ("core.validation.names", "LONGEST_NAME", 100, "names of what", "100 letters"),
    ("builder.assembly.spawning", "_MOST_CALLS", 100, "calls that set up", "100,"),
    ("viewer.editor", "_MOST_CHANGES", 1000, "unsaved changes", "1,000"),
    ("viewer.uploads", "_MOST_UPLOADS", 100, "models that a page", "100 of"),
    ("viewer.uploads", "_LARGEST", 128 * MB, "models that a page", "128 MB each"),
    ("viewer.uploads", "_MOST_FILES", 5000, "models that a page", "5,000 files"),
    ("viewer.uploads", "_MOST_BYTES", 512 * MB, "models that a page", "512 MB together"),
    ("viewer.examination", "_MOST_TRIANGLES", 300_000, "models that a page", "300,000 triangles"),
    ("viewer.examination", "_MOST_MODELS", 20, "models that a page", "20 files"),
    ("services.state_services", "_MOST", 32, "saved states", "32"),
    ("services.time_services", "_MAX_ALARMS", 100_000, "sleeping calls", "100,000"),
    ("services.recording_services", "LEAST", 256 * MB, "files of clients", "256 MB"),
    ("core.clients.budgets", "CLIENT_BYTES", 14 * MB, "everything that is kept", "14 MB"),
    ("core.validation.commands", "_MOST_FIELDS", 4096, "fields of a command", "4,096"),
    ("core.validation.commands", "_MOST_EXTRA", 64, "fields of a command", "64 undeclared"),
    ("core.validation.commands", "_MOST_BYTES", MB, "fields of a command", "1 MB"),
    ("core.streams.extent", "MOST_ITEMS", 500_000, "a measurement", "500,000"),
    ("core.streams.extent", "MOST_FIELDS", 10_000, "a measurement", "10,000"),
    ("core.streams.extent", "MOST_CHARACTERS", 1 << 24, "a measurement", "2²⁴"),
    ("core.streams.extent", "MOST_BYTES", 1 << 28, "a measurement", "2²⁸"),
    ("core.clients.acceptors", "_MOST", 1 << 14, "of the process", "16,384"),
    ("wire.server", "MAX_CLIENTS", 256, "of one port of the socket", "256"),
    ("viewer.hub", "_MOST_CONNECTIONS", 256, "of the live view | ", "256"),
    ("viewer.hub", "MOST_PAGES", 128, "of the live view | ", "128 pages"),
    ("middleware.web.hub", "_UNFINISHED", 64, "of rosbridge, of Foxglove", "64 that have not"),
    ("plugins.yarp.port", "_MOST_CONNECTIONS", 64, "of a port of YARP", "64;"),
    ("plugins.mavlink.links", "_MOST_PEERS", 16, "of a port of YARP", "; 16"),
    ("wire.lines", "MAX_LINE", MB, "of the socket: a line", "1 MB;"),
    ("wire.lines", "_MAX_LINES", 64, "of the socket: a line", "64 lines"),
    ("wire.lines", "_MAX_BYTES", MB, "of the socket: a line", "or 1 MB"),
    ("wire.server", "MAX_HELD", 64 * MB, "of the socket: received", "64 MB"),
    ("wire.server", "MAX_UNSENT", 128 * MB, "of the socket: received", "128 MB"),
    ("middleware.socket.service_client", "MAX_UNREAD", 16 * MB, "of the socket: unread", "16 MB"),
    ("viewer.protocol", "MAX_MESSAGE", 256 * KB, "of the live view: a message;", "256 KB"),
    ("viewer.hub", "MOST_EVENTS", 1000, "of the live view: a message;", "1,000"),
    ("viewer.page", "MOST_REQUESTS", 256, "of the live view: a message;", "; 256 |"),
    ("viewer.page", "MOST_WAITING", 5000, "of the live view: messages", "5,000"),
    ("middleware.web.hub", "MAX_MESSAGE", MB, "of rosbridge and Foxglove", "1 MB"),
    ("middleware.web.requests", "MOST_CALLS", 256, "of rosbridge and Foxglove", "256"),
    ("middleware.rosbridge.client", "_MOST_OF_TOPIC", 1024, "of rosbridge: sub", "1,024"),
    ("middleware.rosbridge.client", "MOST", MB, "of rosbridge: sub", "1 MB"),
    ("middleware.foxglove.parameters", "MOST", 64, "of Foxglove: par", "64"),
    ("middleware.foxglove.assets", "LARGEST", 16 * MB, "of Foxglove: par", "16 MB"),
    ("middleware.ros2.parameters", "MOST", 64, "of ROS 2", "64;"),
    ("rosmsgs.topics.stream", "_LARGEST", 512 * KB, "of ROS 2", "512 KB"),
    ("middleware.ros2.backends.cyclone", "_MOST", 64, "of ROS 2", "; 64 |"),
    ("middleware.mqtt.datastream", "_LONGEST", MB, "of MQTT", "1 MB"),
    ("middleware.mqtt.broker", "_MOST_MESSAGES", 2000, "of MQTT", "2,000"),
    ("middleware.mqtt.broker", "_MOST_BYTES", 32 * MB, "of MQTT", "32 MB"),
    ("plugins.moos.database", "_LARGEST", 4 * MB, "of MOOS", "4 MB;"),
    ("plugins.moos.database", "_MOST_PER_SECOND", 4 * MB, "of MOOS", "; 4 MB"),
    ("plugins.yarp.port", "_LARGEST", 128 * KB, "of YARP", "128 KB"),
    ("plugins.yarp.request_manager", "_MOST_WAITING", 1024, "of YARP", "1,024"),
    ("plugins.mavlink.datastream", "_MOST_BYTES", 16 * KB, "of MAVLink", "16 KB"),
    ("plugins.mavlink.autopilot.transfers", "_MOST_ITEMS", 5000, "of MAVLink", "5,000"),
    ("plugins.multinode.messages", "MAX_LINE", MB, "of other nodes", "1 MB"),
    ("plugins.multinode.server", "_MOST_ROBOTS", 10_000, "of other nodes", "10,000"),
    ("core.reports.log", "PERIOD", 10.0, "of one kind of mistake", "ten seconds"),
    ("core.clients.complaints", "_MAX_KINDS", 20, "of one kind of mistake", "20 lines"),
]


@pytest.mark.parametrize(("module", "name", "value", "row", "text"), ROWS)
def test_a_row_has_the_number_of_the_code(module: str, name: str, value: float, row: str, text: str) -> None:
    assert getattr(importlib.import_module(f"morse.{module}"), name) == value
    (line,) = [line for line in TABLE.splitlines() if line.startswith(f"| {row}")]
    assert text in line.partition(row)[2]


def test_every_row_is_compared() -> None:
    lines = [line for line in TABLE.splitlines() if line.startswith("| ") and not line.startswith(("| **", "| item"))]
    assert [line for line in lines if not any(line.startswith(f"| {row[3]}") for row in ROWS)] == []
