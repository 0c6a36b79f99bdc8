"""Actuators with parts of their own, or with keys."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING

from morse.assets import solids
from morse.assets.search import find_file
from morse.builder import workspace
from morse.builder.creator import ActuatorCreator
from morse.builder.errors import checks
from morse.builder.names import frames
from morse.core.exceptions import MorseBuilderError
from morse.scene import Light as Lamp
from morse.scene import Material, Node, NodeKind

if TYPE_CHECKING:
    from collections.abc import Iterable

    from morse.builder.abstractcomponent import AbstractComponent

_MOST_LEDS = 4096


class Light(ActuatorCreator):
    """A lamp along the X axis; its component class is `morse.actuators.light.Light`."""

    _classpath = "morse.actuators.light.Light"

    def __init__(self, name: str | None = None) -> None:
        super().__init__(name)
        lamp = Node("Lamp", kind=NodeKind.LIGHT, light=Lamp("SPOT"))
        # lamps shine along -Z
        lamp.rotation_euler = [0.0, -math.pi / 2.0, 0.0]
        workspace.current().add(lamp)
        workspace.current().attach(self.scene_node, lamp)


class Sound(ActuatorCreator):
    """A loudspeaker; its component class is `morse.actuators.sound.Sound`."""

    _classpath = "morse.actuators.sound.Sound"

    def open(self, path: str) -> None:
        """Set the sound file.

        Args:
            path: path of the file; a relative path is that below the directory in which the simulation is started, the
                folder of the script, or the ``data`` of the project, as for models.

        Raises:
            MorseBuilderError: there is no such file.
        """
        where = frames.source_line(self)
        try:
            file = find_file(str(path), *([Path(where.file).parent] if where else []))
        except (OSError, ValueError) as error:
            raise MorseBuilderError(f"Sound.open(path): {error}") from None
        self.properties(file=str(file.resolve()))


class MotionVWDiff(ActuatorCreator):
    """A differential drive; its component class is `morse.actuators.v_omega_diff_drive.MotionVWDiff`.

    Args:
        name: its name, if it differs from the name of the variable that refers to it.
        left: the joint that turns the wheel on the left, or several ones; by default, the wheels are found.
        right: those on the right.
    """

    _classpath = "morse.actuators.v_omega_diff_drive.MotionVWDiff"

    def __init__(
        self, name: str | None = None, *, left: str | Iterable[str] = (), right: str | Iterable[str] = ()
    ) -> None:
        super().__init__(name)
        for side, joints in (("LeftWheels", left), ("RightWheels", right)):
            if joints:
                self.properties(**{side: joints if isinstance(joints, str) else ", ".join(map(str, joints))})


class PTU(ActuatorCreator):
    """A pan-tilt unit; its component class is `morse.actuators.ptu.PTU`."""

    _classpath = "morse.actuators.ptu.PTU"
    CARRIER = "TiltBase"
    """The part that pans and tilts."""

    def append(self, obj: AbstractComponent, child: str | None = None, level: int = 1) -> None:
        """Attach a component to the part that pans and tilts.

        Args:
            obj: the component; its pose becomes relative to that part.
            child: name of another part to which it is attached.
            level: stack level of the variables that are searched for the name: 1 for the caller.
        """
        super().append(obj, self.CARRIER if child is None else child, level + 1)


class LedArray(ActuatorCreator):
    """Rows of lights in the YZ plane, seen from the front; component class `morse.actuators.led_array.LedArray`.

    Args:
        name: its name, if it differs from the name of the variable that refers to it.
        rows: number of rows, the first one at the top.
        columns: number of lights in a row, the first one at the left for a viewer in front.
        pitch: distance between two lights, m.
    """

    _classpath = "morse.actuators.led_array.LedArray"

    def __init__(self, name: str | None = None, rows: int = 8, columns: int = 8, pitch: float = 0.03) -> None:
        super().__init__(name)
        rows = checks.integer(rows, "LedArray(rows)", minimum=1)
        columns = checks.integer(columns, "LedArray(columns)", minimum=1)
        pitch = checks.number(pitch, "LedArray(pitch)", above=0.0)
        if rows * columns > _MOST_LEDS:
            raise MorseBuilderError(f"LedArray: {rows} x {columns} are more than {_MOST_LEDS} lights")
        body = solids.cube()
        material = Material("Led", (0.02, 0.02, 0.02, 1.0), shadeless=True)
        for row in range(rows):
            for column in range(columns):
                led = Node("Led", kind=NodeKind.MESH, mesh=body, materials=[material])
                # for a viewer in front, the Y axis points to the right
                led.location = [0.0, (column - 0.5 * (columns - 1)) * pitch, (0.5 * (rows - 1) - row) * pitch]
                led.scale = [0.2 * pitch, 0.4 * pitch, 0.4 * pitch]
                led.properties.update(LedRow=row, LedColumn=column)
                workspace.current().add(led)
                workspace.current().attach(self.scene_node, led)


class Joystick(ActuatorCreator):
    """A gamepad at the live view; its component class is `morse.actuators.joystick.Joystick`."""

    _classpath = "morse.actuators.joystick.Joystick"

    def __init__(self, name: str | None = None, index: int = 0) -> None:
        """Create a joystick.

        Args:
            index: pair of axes of the gamepad: 0 for the first stick.
        """
        super().__init__(name)
        self.properties(Index=checks.integer(index, "Joystick(index)", minimum=0))
