"""Plays a sound."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.core.actuator import Actuator
from morse.core.reports.quoting import shown
from morse.helpers.components import add_data, add_kind, add_property, add_state

if TYPE_CHECKING:
    from morse.core.robot import Robot
    from morse.core.world import Body

_MODES = ("play", "pause", "stop")


class Sound(Actuator):
    """Plays, pauses and stops a sound, and measures the played time.

    Attributes:
        played: played time since the beginning of the sound, s of simulated time.
    """

    _name = "Sound"
    _short_desc = "A loudspeaker on a robot"

    add_data("mode", "stop", "string", "Mode: play, pause or stop")
    add_kind("switch", choice="mode")
    add_property("_file", "", "file", "string", "File of the sound")

    add_state("_mode", str, "What the player does: play, pause or stop")
    add_state("played", float, "Time that the sound has played", unit="s")

    _file: str

    def __init__(self, obj: Body, parent: Robot | None = None) -> None:
        super().__init__(obj, parent)
        self.played = 0.0
        self._mode = "stop"

    @property
    def mode(self) -> str:
        """The mode: ``play``, ``pause`` or ``stop``."""
        return self._mode

    @property
    def file(self) -> str:
        """The file of the sound."""
        return self._file

    def default_action(self) -> None:
        """Advance the played time."""
        mode = self.local_data["mode"]
        if mode != self._mode:
            if mode in _MODES:
                self._mode = mode
            else:
                text = f"{self.name()}: mode {shown(mode)} is none of {', '.join(_MODES)}"
                self.context.complaints.warn(f"{self.name()}: mode", text)
                self.local_data["mode"] = self._mode
        if self._mode == "play":
            self.played += 1.0 / self.frequency
        elif self._mode == "stop":
            self.played = 0.0
