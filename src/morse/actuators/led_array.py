"""Rows of coloured lights."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import numpy as np

from morse.core.actuator import Actuator
from morse.core.exceptions import MorseRPCTypeError
from morse.core.services import service
from morse.core.validation.arguments import Range
from morse.helpers.components import add_data, add_kind, add_property, add_state, scaled

if TYPE_CHECKING:
    from morse.core.robot import Robot
    from morse.core.world import Body

Share = Annotated[float, Range(0.0, 1.0)]
Picture = Annotated[list[float], Range(0.0, 1.0, shape=(None, None, 3))]


class LedArray(Actuator):
    """Shows a pattern on rows of lights, steady or blinking.

    The first row is at the top, and the first light of a row is at the left for a viewer in front of the array.
    Blinking lights are on for the first half of each period of simulated time.
    """

    _name = "LED array"
    _short_desc = "Rows of coloured lights on a robot"

    add_data(
        "colours",
        [],
        "list",
        "Red, green and blue of each light, row by row",
        shape=(None, None, 3),
        dtype="float64",
        low=0.0,
        high=1.0,
    )
    add_kind("image", pixels=scaled("colours", 255.0), encoding="rgb8")
    add_property("_blink_period", 0.0, "BlinkPeriod", "float", "Period of blinking; 0 for steady", unit="s", low=0.0)

    add_state("_shown", np.ndarray, "Colours of the pattern")
    add_state("_since", float, "Start of the present blinking", unit="s")
    add_state("_warned", bool, "Whether a wrong pattern was reported")

    _blink_period: float

    def __init__(self, obj: Body, parent: Robot | None = None) -> None:
        super().__init__(obj, parent)
        lights = {(part["LedRow"], part["LedColumn"]): part for part in obj.children if "LedRow" in part}
        self.rows = max((row for row, _ in lights), default=-1) + 1
        self.columns = max((column for _, column in lights), default=-1) + 1
        self._lights = lights
        self.local_data["colours"] = np.zeros((self.rows, self.columns, 3))
        #: start time of the present blinking, s
        self._since = 0.0
        self._warned = False
        self._shown: np.ndarray = self.local_data["colours"]
        #: the last pattern that was sent to the view
        self._drawn: np.ndarray | None = None

    def begin_anew(self) -> None:
        """Show the first pattern again, after a restart."""
        self._drawn = None

    # -- services --------------------------------------------------------------------------

    @service
    def set_all(self, red: Share, green: Share, blue: Share) -> None:
        """Set all lights to one colour.

        Args:
            red: 0 to 1.
            green: 0 to 1.
            blue: 0 to 1.
        """
        self.local_data["colours"] = np.full((self.rows, self.columns, 3), (red, green, blue), dtype=np.float64)

    @service
    def set_led(self, row: int, column: int, red: Share, green: Share, blue: Share) -> None:
        """Set the colour of one light.

        Args:
            row: from 0, at the top.
            column: from 0, at the left.
            red: 0 to 1.
            green: 0 to 1.
            blue: 0 to 1.
        """
        if (row, column) not in self._lights:
            raise MorseRPCTypeError(
                f"there is no light in row {row}, column {column}: rows go from 0 to {self.rows - 1}, "
                f"columns from 0 to {self.columns - 1}"
            )
        colours = np.array(self._picture())
        colours[row, column] = (red, green, blue)
        self.local_data["colours"] = colours

    @service
    def set_pattern(self, colours: Picture) -> None:
        """Show a pattern.

        Args:
            colours: red, green and blue (0 to 1) of each light, row by row.
        """
        picture = np.asarray(colours, dtype=np.float64)
        if picture.shape != (self.rows, self.columns, 3):
            raise MorseRPCTypeError(self._wrong_shape(picture.shape))
        self.local_data["colours"] = picture

    @service
    def blink(self, period: Annotated[float, Range(0.0, 1e6, "s")]) -> None:
        """Start blinking.

        Args:
            period: period of blinking, s; 0 for steady lights.
        """
        self._blink_period = float(period)
        self._since = self.clock.time

    @service
    def off(self) -> None:
        """Switch all lights off."""
        self.set_all(0.0, 0.0, 0.0)

    # -- showing ---------------------------------------------------------------------------

    def _wrong_shape(self, shape: tuple[int, ...]) -> str:
        return f"a pattern for these lights has the shape {(self.rows, self.columns, 3)}, not {tuple(shape)}"

    def _picture(self) -> np.ndarray:
        picture = self.local_data["colours"]
        if np.shape(picture) == (self.rows, self.columns, 3):
            self._warned = False
            self._shown = np.asarray(picture)
        elif not self._warned:
            text = f"{self.name()}: {self._wrong_shape(np.shape(picture))}; the last pattern stays"
            self.context.complaints.warn(f"{self.name()}: pattern", text)
            self._warned = True
        return self._shown

    @property
    def is_lit(self) -> bool:
        """Whether the lights are in the on phase of blinking."""
        period = self._blink_period
        return not period or (self.clock.time - self._since) % period < 0.5 * period

    def default_action(self) -> None:
        """Show the pattern."""
        picture = self._picture()
        if not self.is_lit:
            picture = np.zeros_like(picture)
        if self._drawn is not None and np.array_equal(picture, self._drawn):
            return
        self._drawn = picture.copy()
        world = self.context.world
        rows = picture.tolist()
        for (row, column), light in self._lights.items():
            color = (*rows[row][column], 1.0)
            if light.node.color != color:
                light.node.color = color
                world.appearance_changed(light)
