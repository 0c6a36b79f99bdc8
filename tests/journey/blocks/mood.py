from typing import Literal

from morse.actuators.led_array import LedArray
from morse.core import status
from morse.core.services import async_service, interruptible
from morse.helpers.components import add_property

GREEN, BLUE, DARK = (0.1, 1.0, 0.2), (0.1, 0.3, 1.0), (0.0, 0.0, 0.0)

MOODS = {
    'happy': (GREEN, ["..#.#..",
                      "..#.#..",
                      ".......",
                      "#.....#",
                      ".#####."]),
    'sad':   (BLUE,  ["..#.#..",
                      "..#.#..",
                      ".......",
                      ".#####.",
                      "#.....#"]),
}

class Mood(LedArray):
    """Shows the mood of the Ranger in coloured lights."""

    _name = "Mood"
    _short_desc = "Shows the mood of the Ranger in coloured lights"

    add_property('_duration', 2.0, 'Duration', 'float', 'How long a mood lasts', unit='s', low=0.0)

    def __init__(self, obj, parent=None):
        LedArray.__init__(self, obj, parent)
        self.end = None

    @interruptible
    @async_service
    def show(self, mood: Literal['happy', 'sad']):
        """Show a mood; ends when it is over."""
        colour, rows = MOODS[mood]
        self.set_pattern([[colour if letter == '#' else DARK for letter in row] for row in rows])
        self.end = self.clock.time + self._duration

    def interrupt(self):
        self.end = None
        LedArray.interrupt(self)

    def default_action(self):
        if self.end is not None and self.clock.time >= self.end:
            self.end = None
            self.off()
            self.completed(status.SUCCESS)

        LedArray.default_action(self)
