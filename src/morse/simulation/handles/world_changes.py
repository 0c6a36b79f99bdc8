"""Places objects and changes their parameters between two ticks."""

from __future__ import annotations

import contextlib
import math
import os
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

from morse.assets.pictures import Pictures
from morse.assets.search import worlds_with
from morse.core.actuator import Actuator
from morse.core.exceptions import MorseRPCInvokationError
from morse.core.journal import SERVICE
from morse.core.observer import Observer
from morse.core.reports.quoting import nearest, quoted
from morse.mathutils import Euler
from morse.scene import shared_image
from morse.services import supervision_services as looks
from morse.services.foreign_models import check_model
from morse.system.pictures import open_picture
from morse.system.regular_files import read_regular

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    import numpy as np
    from numpy.typing import NDArray

    from morse.core.context import Context
    from morse.core.rows.columns import Setpoints
    from morse.core.values import Value
    from morse.core.world import Body
    from morse.physics import World
    from morse.rendering import Renderer
    from morse.scene import Image
    from morse.simulation.ticks.ticking import Ticker
    from morse.viewer.notebook import Frame

# Pictures that clients and programs name.

#: size of a file, bytes
_LARGEST = 1 << 26
#: number of pictures that are kept
_MOST = 100


class NamedPictures:
    """Pictures in the folders of models, and in the folder in which the simulation was started.

    Args:
        folders: returns the folders with models.
    """

    def __init__(self, folders: Callable[[], Sequence[str | os.PathLike[str]]]) -> None:
        self._folders = folders
        #: by path, time and size of the file
        self._images: dict[tuple[Path, int, int], Image] = {}

    def image(self, name: str) -> Image:
        """Read a PNG or JPEG file, given its path, or its path in one of the folders.

        Raises:
            MorseRPCInvokationError: it is not there, in another folder, or no picture.
        """
        folders = [Path(folder) for folder in self._folders()]
        check_model(name, folders)
        with contextlib.suppress(OSError):  # the present folder was deleted
            folders.append(Path.cwd())
        path = next((folder / name for folder in folders if (folder / name).is_file()), None)
        if path is None:
            places = ", ".join(map(str, folders))
            raise MorseRPCInvokationError(f"there is no picture {quoted(name)} in {places}")
        reader = Pictures()
        try:
            facts = path.stat()
            version = path, facts.st_mtime_ns, facts.st_size
            if version in self._images:
                return self._images[version]
            if facts.st_size > _LARGEST:
                raise OSError(f"it has more than {_LARGEST >> 20} MB")
            with open_picture(read_regular(path, _LARGEST)) as picture:
                image = reader.image(path.name, picture)
        except (OSError, ValueError) as error:
            raise MorseRPCInvokationError(f"the picture {path} cannot be read: {error!s:.200}") from None
        if reader.warnings:
            raise MorseRPCInvokationError(f"the picture {path} cannot be used: {reader.warnings[0]}")
        if len(self._images) >= _MOST:
            self._images.clear()
        image_file = self._images[version] = shared_image(image.name, image.data, image.mime)
        return image_file


# What a robot or an object touches, apart from the floor.


@dataclass(slots=True)
class Contact:
    """A contact, from its begin to its end.

    Attributes:
        other: name of the other body.
        begin: simulated time of the end of the tick in which it began, s.
        end: likewise, of the first tick without the contact; None while it lasts.
        impulse: sum of the magnitudes of its impulses since the last `Simulation.step`, N·s.
    """

    other: str
    begin: float
    end: float | None = None
    impulse: float = 0.0


class Contacts(Observer):
    """The contacts of one body with anything but the floor since the begin of the last `Simulation.step`.

    The floor is what is static and carries the body from below: contacts whose normal is within 45 degrees of the
    vertical. Contacts are found in each step of the physics, 240 times per second, so that no touch is lost.

    Attributes:
        body: name of the robot or object.
        events: the contacts that lasted or began since then, in the order of their begins.
    """

    def __init__(self, context: Context, body: str) -> None:
        self.body = body
        self.events: list[Contact] = []
        self._context = context
        self._impulses: Mapping[str, float] = context.world.watch_touches(body)
        self._lasting: dict[str, Contact] = {}
        self._tick = context.clock.tick
        self._callbacks: list[Callable[[Contact], object]] = []

    @property
    def touched(self) -> bool:
        """Whether there was any contact."""
        return bool(self.events)

    @property
    def impulse(self) -> float:
        """The sum of the magnitudes of all impulses, N·s."""
        return sum(contact.impulse for contact in self.events)

    @property
    def waits(self) -> bool:
        """Whether nothing touches the body."""
        return not (self._lasting or self._impulses)

    @property
    def sees_steps(self) -> bool:
        """Whether nobody has subscribed."""
        return not self._callbacks

    def subscribe(self, callback: Callable[[Contact], object]) -> None:
        """Call ``callback(contact)`` after each tick in which a contact begins; one that fails is removed."""
        self._callbacks.append(callback)

    def unsubscribe(self, callback: Callable[[Contact], object]) -> None:
        """Remove a callback."""
        if callback in self._callbacks:
            self._callbacks.remove(callback)

    def begin(self) -> None:
        """Begin a step: contacts that have ended are forgotten."""
        self.events = list(self._lasting.values())
        for contact in self.events:
            contact.impulse = 0.0

    def after_tick(self) -> None:
        """Take the contacts of a tick."""
        clock, lasting, impulses = self._context.clock, self._lasting, self._impulses
        if clock.tick == self._tick or not (impulses or lasting):
            self._tick = clock.tick
            return
        self._tick = clock.tick
        for other in [other for other in lasting if other not in impulses]:
            lasting.pop(other).end = clock.time
        began = []
        for other, impulse in impulses.items():
            if other not in lasting:
                lasting[other] = Contact(other, clock.time)
                self.events.append(lasting[other])
                began.append(lasting[other])
            lasting[other].impulse += impulse
        if self._callbacks:
            self._tell(began)

    def _tell(self, began: Sequence[Contact]) -> None:
        guard, callbacks = self._context.guard, self._callbacks
        for contact in began:
            guard.each(
                list(callbacks),
                lambda callback, contact=contact: callback(contact),  # type: ignore[misc]
                lambda callback, error: guard.remove(callbacks, callback, error),
            )

    def part(self, name: str) -> None:
        """End the contacts of a body that has been placed: the next step begins without them."""
        lasting = self._lasting
        for other in list(lasting) if name == self.body else [name] if name in lasting else []:
            lasting.pop(other).end = self._context.clock.time

    def restarted(self) -> None:
        """Forget all contacts, because the simulation has restarted."""
        self.rearranged()
        self.events = []

    def rearranged(self) -> None:
        """Forget what lasts, because bodies may be elsewhere."""
        self._lasting.clear()

    def __repr__(self) -> str:
        others = ", ".join(contact.other for contact in self.events) or "nothing"
        return f"<Contacts of {self.body} with {others}, {self.impulse:.3g} N·s>"


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
            given = [*pose]
            if any(isinstance(number, (str, bytes, bool)) for number in given):
                raise TypeError
            numbers = [float(number) for number in given]
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
            raise ValueError(f"the pose of '{name}' has the quaternion 0, 0, 0, 0, which is not an orientation")
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

        Those of the links that its joints carry, such as feet, are set, too.

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
        journal = self.context.journal
        if isinstance(sensors, bool) and not (journal.sinks or journal.is_blank):
            # nobody takes note of it: the usual end of a step
            self._ticker.measure(None, again=again)
            return
        names = sensor_names(sensors)
        with journal.input(SERVICE, "simulation", ("measure", [names, again])):
            self.measure_by_service(names, again)

    def measure_by_service(self, names: Sequence[str] | None, again: bool) -> None:
        """Let sensors measure; without ``again`` only those that have not measured in the last tick."""
        self._check_sensors(names)
        self._ticker.measure(names, again=again)

    # -- rows of a batch that go on together ---------------------------------------------------

    @property
    def coasts(self) -> bool:
        """Whether nothing can happen in any of the next ticks but that robots drive; see `morse.many.gliding_rows`."""
        return not self.context.journal.sinks and self._ticker.coasts

    def moved_joints(self) -> Sequence[tuple[Actuator, Setpoints]] | None:
        """The actuators, if nothing else can happen than that they move joints; see `Ticker.moved_joints`."""
        return None if self.context.journal.sinks else self._ticker.moved_joints()

    def missed(self, ticks: int) -> None:
        """Take note of ticks of `moved_joints` that were computed elsewhere, at whose end all sensors have measured."""
        if ticks:
            self.context.clock.advance(ticks)
            self._ticker.missed()

    def obey(self) -> bool:
        """Take the commands of the next tick; return whether nothing can happen but that robots drive."""
        return self._ticker.obey()

    def coasted(self, ticks: int, *, measured: bool) -> None:
        """Take note of the ticks of one or more steps, of which the world knows; see `Ticker.coasted`."""
        for contacts in self._contacts.values():
            contacts.begin()
        self._ticker.coasted(ticks, measured=measured)

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


def sensor_names(sensors: Sequence[str] | bool | None) -> list[str] | None:
    """Return the full names of sensors; None for all."""
    if sensors is None or isinstance(sensors, bool):
        return None
    if isinstance(sensors, str):
        return [sensors]
    try:
        return [str(name) for name in sensors]
    except TypeError:
        raise TypeError(f"sensors are given by a list of full names, not {sensors!r:.80}") from None


class LiveView(Protocol):
    """What shows a simulation while it runs: the pages in browsers, or the viewer of MuJoCo."""

    @property
    def url(self) -> str:
        """The address for a browser."""

    def announce(self) -> None:
        """Log the address."""


class SimulationPictures:
    """The part of `morse.simulation.simulation.Simulation` that shows the world."""

    world: World
    view: LiveView | None
    #: what `picture` has read of the world
    _renderer: Renderer | None = None

    def _check_open(self) -> None:
        raise NotImplementedError

    def show(self, height: int = 480) -> Frame:
        """Return the live view as an HTML frame, which a notebook displays if it is the value of a cell.

        Args:
            height: height of the frame, px.

        Raises:
            RuntimeError: the simulation was not loaded with ``view="web"``, or is closed.
        """
        self._check_open()
        show: Callable[[int], Frame] | None = getattr(self.view, "show", None)
        if show is None:
            raise RuntimeError(
                "there is no live view: load the scene with morse.load(SCENE, view='web'), or draw it by sim.picture()"
            )
        return show(height)

    def show_task(
        self, title: str, text: str, points: Sequence[tuple[str, bool, str]] = (), *, is_checked: bool = False
    ) -> None:
        """Show in the live view what its user is to do, and what has been checked of it; without a page, do nothing.

        Args:
            title: a few words.
            text: paragraphs, lists and code in Markdown.
            points: what is expected, whether it is so, and what might help.
            is_checked: whether the check has ended.
        """
        show: Callable[..., object] | None = getattr(self.view, "show_task", None)
        if show is not None:
            show(title, text, points, is_checked=is_checked)

    def picture(self, width: int = 960, height: int = 600, **view: Any) -> NDArray[np.uint8]:
        """Render an image of the present world, from the initial viewpoint of the live view.

        Args:
            width: pixels.
            height: pixels.
            view: ``location``, m, and ``rotation``, Euler angles in rad (``[0, 0, 0]`` looks straight down), of the
                camera; ``focal_length``, mm, of a sensor 32 mm wide.

        Returns:
            (height, width, 3) uint8, red, green and blue.

        Raises:
            ValueError: an argument is not valid for an image.
            RuntimeError: the simulation is closed.
        """
        self._check_open()
        from morse.rendering import Renderer, photograph

        if self._renderer is None:
            self._renderer = Renderer(self.world)
        return photograph(self.world, width, height, **view, renderer=self._renderer)
