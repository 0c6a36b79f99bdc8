"""The text formats: a block, or a row, for each measurement."""

from __future__ import annotations

from abc import abstractmethod
from typing import TYPE_CHECKING, Any

from morse.core.streams.kind_stream import KindStream
from morse.middleware.text import STREAM_OPTIONS
from morse.wire.encoding import written

if TYPE_CHECKING:
    from morse.middleware.text.file import TextFile


class TextStream(KindStream):
    """Writes one component into a file.

    Attributes:
        file: set before `initialize`.
        index: number of written measurements.
    """

    options = STREAM_OPTIONS
    file: TextFile

    def initialize(self) -> None:
        """Write the header of the file."""
        super().initialize()
        self.index = 0
        self.file.begin(self.header())

    @abstractmethod
    def header(self) -> str:
        """The header of the file; may be empty."""

    @abstractmethod
    def encode_data(self) -> str:
        """A measurement, with a final line end."""


class Publisher(TextStream):
    """A line with the pose of the robot and the time, and below it a line for each data field."""

    def header(self) -> str:
        """Names of robot and sensor."""
        robot = self.component_instance.robot_parent
        return f"ROBOT {robot.name() if robot is not None else ''} || SENSOR {self.component_name}\n"

    def encode_data(self) -> str:
        """Position in m, angles in rad, simulated time in s."""
        pose = (self.component_instance.robot_parent or self.component_instance).position_3d
        place = " ".join(f"{number:.6f}" for number in (pose.x, pose.y, pose.z))
        angles = " ".join(f"{number:.6f}" for number in (pose.yaw, pose.pitch, pose.roll))
        lines = [
            f"==> Data at X,Y,Z: [{place}] yaw,pitch,roll: [{angles}] | index {self.index} | time {self._time():.2f}",
            *(f"\t{name} = {written(value)}" for name, value in self.data.items()),
        ]
        return "\n".join(lines) + "\n"

    def _time(self) -> float:
        time: Any = self.data.get("timestamp")
        return float(time) if isinstance(time, (int, float)) else self.component_instance.clock.time


class CSVPublisher(TextStream):
    """A row for each measurement, with fields separated by semicolons; the first row contains their names."""

    def header(self) -> str:
        """The names of the fields."""
        return ";".join(map(_cell, self.data)) + "\n"

    def encode_data(self) -> str:
        """The values of the fields."""
        return ";".join(_cell(written(value)) for value in self.data.values()) + "\n"


def _cell(text: str) -> str:
    """A text as one cell of a table (RFC 4180)."""
    return '"' + text.replace('"', '""') + '"' if ";" in text or '"' in text else text
