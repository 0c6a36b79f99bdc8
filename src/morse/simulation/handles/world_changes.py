"""Places objects and changes their parameters between two ticks."""

from __future__ import annotations

import math
import os
from typing import TYPE_CHECKING

from morse.assets.search import worlds_with
from morse.core.actuator import Actuator
from morse.core.exceptions import MorseRPCInvokationError
from morse.core.journal import SERVICE
from morse.core.reports.quoting import nearest
from morse.mathutils import Euler
from morse.services import supervision_services as looks
from morse.simulation.handles.contacts import Contacts

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from morse.core.context import Context
    from morse.core.values import Value
    from morse.core.world import Body
    from morse.simulation.handles.textures import NamedPictures
    from morse.simulation.ticks.ticking import Ticker


#: largest coordinate of a pose, m
_FARTHEST = 1e7


class WorldChanges:
    """The part of `morse.simulation.simulation.Simulation` that changes the world between two ticks.

    All changes are inputs: recordings contain them.
    """

    context: Context
    rpc: Callable[..., object]
    _check_open: Callable[[], None]
    _all_handles: Callable[[], Mapping[str, Value]]
    _ticker: Ticker
    pictures: NamedPictures

    def __init__(self) -> None:
        self._contacts: dict[str, Contacts] = {}

    def place(self, name: str, pose: Sequence[float]) -> None:
        """Place a robot or an object, at rest, which ends its contacts.

        Sensors measure there at their next measurement, or by `measure`.

        Args:
            name: name of the robot or the object.
            pose: x, y, yaw, with the height, the roll and the pitch of the scene; or x, y, z, roll, pitch, yaw; or x,
                y, z and a quaternion w, x, y, z; in the world, m and rad.

        Raises:
            KeyError: there is no such object.
            ValueError: there are other than 3, 6 or 7 numbers, or one is not finite, or is farther than 10,000 km.
        """
        numbers = self.pose_of(name, pose)
        name = self._object(name).name
        self.rpc("simulation", "set_object_pose", name, numbers[:3], numbers[3:])
        for contacts in self._contacts.values():
            contacts.part(name)

    def pose_of(self, name: str, pose: Sequence[float]) -> list[float]:
        """Return the pose at which `place` places an object: x, y, z, qw, qx, qy, qz.

        Raises:
            KeyError, ValueError: see `place`.
        """
        obj = self._object(name)
        try:
            numbers = [float(number) for number in pose]
        except (TypeError, ValueError):
            raise ValueError(f"the pose of '{name}' is {pose!r:.100}, expected a list of numbers") from None
        if len(numbers) not in (3, 6, 7) or not all(map(math.isfinite, numbers)):
            raise ValueError(
                f"the pose of '{name}' is {list(pose)!r:.100}, expected finite numbers: x, y, yaw; or x, y, z, roll, "
                "pitch, yaw; or x, y, z, qw, qx, qy, qz"
            )
        if max(map(abs, numbers[:2] if len(numbers) == 3 else numbers[:3])) > _FARTHEST:
            raise ValueError(f"the pose of '{name}' is {numbers!r:.100}, expected positions within {_FARTHEST:g} m")
        if len(numbers) == 7 and not any(numbers[3:]):
            raise ValueError(f"the pose of '{name}' has the quaternion 0, 0, 0, 0, which is no orientation")
        if len(numbers) == 3:
            x, y, yaw = numbers
            matrix = obj.node.world_matrix()
            z, start = float(matrix.translation[2]), matrix.to_euler()
            numbers = [x, y, z, start[0], start[1], yaw]
        return numbers if len(numbers) == 7 else [*numbers[:3], *Euler(numbers[3:]).to_quaternion()]

    def set_mass(self, name: str, mass: float) -> None:
        """Set the mass of a robot or an object that moves freely, until the next restart.

        Args:
            mass: kg; the inertia changes in proportion.

        Raises:
            KeyError: there is no such object.
            ValueError: it does not move freely, or the mass differs by more than 10,000 from that of the scene.
        """
        self._vary("set_object_mass", name, mass)

    def set_friction(self, name: str, friction: float) -> None:
        """Set the coefficient of sliding friction of all shapes of a robot or an object, until the next restart.

        Raises:
            KeyError: there is no such object.
            ValueError: it is not a number from 0 to 100, or the object has no shapes.
        """
        self._vary("set_object_friction", name, friction)

    def set_light(self, name: str, energy: float) -> None:
        """Set the brightness of a lamp, or of all lamps of a robot or an object, until the next restart.

        Args:
            energy: relative to a normal lamp; 0 for no light.

        Raises:
            KeyError: there is no such object.
            ValueError: it has no lamp, or the energy is negative.
        """
        self._vary("set_object_light", name, energy)

    def set_color(self, name: str, color: Sequence[float]) -> None:
        """Set the colour of the surfaces of a robot or an object, or of the light of a lamp, until the next restart.

        Args:
            color: red, green, blue, linear, 0 to 1; a fourth number is the opacity of a surface. The texture of a
                surface is multiplied by it.

        Raises:
            KeyError: there is no such object.
            ValueError: it has neither a surface nor a lamp, or the colour is not valid.
        """
        numbers = _numbers(color)
        looks.check(self._object(name), "color", numbers)
        self._vary("set_object_color", name, numbers)

    def set_texture(self, name: str, picture: str | os.PathLike[str]) -> None:
        """Set the texture of the surfaces of a robot or an object, until the next restart.

        Args:
            picture: path of a PNG or JPEG file in the folder ``data`` of the project, in that of the scene or the
                program, in one of ``MORSE_RESOURCE_PATH`` or in the present folder. On a mesh without texture
                coordinates it covers each side of the bounding box once.

        Raises:
            KeyError: there is no such object.
            ValueError: the object has no surface, or the picture cannot be read.
        """
        self._vary("set_object_texture", name, os.fspath(picture))

    def restart_robot(self, name: str, seed: int | None = None) -> None:
        """Restart one robot as after the load: pose, parts, components and their random numbers.

        Time, the other robots and the objects go on. It takes about as long as spawning a robot.

        Args:
            seed: seed of the random numbers of the robot; its present seed by default.

        Raises:
            KeyError: there is no such robot.
            LoadError: a component cannot be created.
        """
        self._check_open()
        handle = self._all_handles().get(name)
        if handle is None:
            raise KeyError(f"there is no robot '{name}'{nearest(name, list(self.context.robots))}")
        self.rpc("simulation", "restart_robot", handle.fqn, seed)

    def check_variation(self, name: str, what: str, value: Value) -> None:
        """Raise the error that `set_mass` would raise, or another method: ``what`` is the part after ``set_``."""
        obj = self._object(name)
        if what == "texture":
            try:
                self.pictures.image(os.fspath(value))
            except MorseRPCInvokationError as error:
                raise ValueError(str(error)) from None
        if what in ("light", "color", "texture"):
            looks.check(obj, what, value)
        else:
            self.context.world.check_variation(obj, what, value)

    def _vary(self, service: str, name: str, value: Value) -> None:
        from pymorse.errors import MorseServiceFailed

        try:
            value = value if isinstance(value, (list, str)) else float(value)
            self.rpc("simulation", service, self._object(name).name, value)
        except MorseServiceFailed as error:
            raise ValueError(str(error)) from None

    def measure(self, sensors: Sequence[str] | None = None) -> None:
        """Let sensors measure now, between two ticks, in addition to the measurements at their rates.

        Args:
            sensors: full names, such as ``robot.laser``; None for all.

        Raises:
            KeyError: there is no such sensor.
        """
        self._check_open()
        self._measure(sensors, again=True)

    def _measure(self, sensors: Sequence[str] | bool | None, *, again: bool) -> None:
        """Let sensors measure, and note it as a call of the service."""
        names = _names(sensors)
        with self.context.journal.input(SERVICE, "simulation", ("measure", [names, again])):
            self.measure_by_service(names, again)

    def measure_by_service(self, names: Sequence[str] | None, again: bool) -> None:
        """Let sensors measure; without ``again`` only those that have not measured in the last tick."""
        self._check_sensors(names)
        self._ticker.measure(names, again=again)

    # -- rows of a batch that go on together ---------------------------------------------------

    @property
    def coasts(self) -> bool:
        """Whether nothing can happen in any of the next ticks but that robots drive; see `morse.many.batched_step`."""
        return not self.context.journal.sinks and self._ticker.coasts

    def obey(self) -> bool:
        """Take the commands of the next tick; return whether nothing can happen but that robots drive."""
        return self._ticker.obey()

    def coasted(self, ticks: int, *, measured: bool) -> None:
        """Take note of the ticks of one or more steps, of which the world knows; see `Ticker.coasted`."""
        for contacts in self._contacts.values():
            contacts.begin()
        self._ticker.coasted(ticks, measured=measured)

    def check_step(self, ticks: int, measure: Sequence[str] | bool) -> None:
        """Raise the error that `Simulation.step` would raise for these arguments."""
        if isinstance(ticks, bool) or not hasattr(ticks, "__index__"):
            raise TypeError(f"the number of ticks is an integer, not {ticks!r:.80}")
        if ticks < 0:
            raise ValueError(f"time does not go backwards: {ticks} ticks")
        if not isinstance(measure, bool):
            self._check_sensors(_names(measure))

    def _check_sensors(self, names: Sequence[str] | None) -> None:
        components = self.context.components
        for name in names or ():
            if name not in components:
                raise KeyError(f"there is no component '{name}'{nearest(name, list(components))}")
            if isinstance(components[name], Actuator):
                raise KeyError(f"{name} is an actuator: it does not measure")

    def contacts(self, name: str) -> Contacts:
        """Return what a robot or an object touches from now on; see `Contacts`.

        Raises:
            KeyError: there is no such object.
        """
        self._check_open()
        name = self._object(name).name
        if name not in self._contacts:
            self._contacts[name] = contacts = Contacts(self.context, name)
            self._ticker.observers.append(contacts)
        return self._contacts[name]

    def _object(self, name: str) -> Body:
        self._check_open()
        objects = self.context.world.objects_by_name
        if name not in objects:
            name = getattr(self._all_handles().get(name), "fqn", name)
        if name not in objects:
            raise KeyError(f"there is no object '{name}'{nearest(name, list(objects))}{worlds_with(name)}")
        return objects[name]


def _numbers(color: Sequence[float]) -> list[float]:
    try:
        return [float(number) for number in color]
    except (TypeError, ValueError):
        raise ValueError(f"a colour is red, green, blue from 0 to 1, not {color!r:.100}") from None


def _names(sensors: Sequence[str] | bool | None) -> list[str] | None:
    """Return the full names of sensors; None for all."""
    if sensors is None or isinstance(sensors, bool):
        return None
    if isinstance(sensors, str):
        return [sensors]
    try:
        return [str(name) for name in sensors]
    except TypeError:
        raise TypeError(f"sensors are given by a list of full names, not {sensors!r:.80}") from None
