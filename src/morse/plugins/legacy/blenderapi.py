"""Names by which components of MORSE 1.4 access the running simulation."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.core.context import current

if TYPE_CHECKING:
    from morse.core.abstractobject import AbstractObject
    from morse.core.clock import Clock
    from morse.core.interfaces import Middleware
    from morse.core.object import Object
    from morse.core.overlay import MorseOverlay
    from morse.core.request_manager import MorseServices
    from morse.core.world import Bodies

#: version of Blender whose names are used here; components of 1.4 compare with it
_VERSION = (2, 79, 0)


class _ZoneManager:
    """Finds the zones that a component is in."""

    def contains(self, component: Object, name: str | None = None, type: str | None = None) -> set[str]:
        """Names of the zones around the component; only those of that name or type, if given."""
        return component.in_zones(name, type)


class _Scene:
    """The world under the names of Blender's game engine."""

    @property
    def objects(self) -> Bodies:
        """All objects; indexed with a name, it returns the object of that name."""
        return current().world.object_list()

    @property
    def gravity(self) -> list[float]:
        """Gravity in the world, m/s^2."""
        return gravity_vector()


class _PersistantStorage:
    """The state of the simulation under the names of 1.4."""

    @property
    def time(self) -> Clock:
        return current().clock

    @property
    def robotDict(self) -> dict[object, object]:  # noqa: N802
        return {robot.bge_object: robot for robot in current().robots.values()}

    @property
    def externalRobotDict(self) -> dict[object, object]:  # noqa: N802
        return {robot.bge_object: robot for robot in current().external_robots.values()}

    @property
    def componentDict(self) -> dict[str, Object]:  # noqa: N802
        return dict(current().components)

    @property
    def passiveObjectsDict(self) -> dict[object, object]:  # noqa: N802
        return {obj: obj for obj in current().world.objects() if "Object" in obj}

    @property
    def zone_manager(self) -> _ZoneManager:
        return _ZoneManager()

    @property
    def datastreams(self) -> dict[str, list[list[str]]]:
        return {
            component.name: [[stream.manager, stream.direction] for stream in component.streams]
            for component in current().scene.components
            if component.streams
        }

    @property
    def stream_managers(self) -> dict[str, Middleware]:
        return current().stream_managers

    @property
    def overlayDict(self) -> dict[str, MorseOverlay]:  # noqa: N802
        return current().overlays

    @property
    def serviceObjectDict(self) -> dict[str, AbstractObject]:  # noqa: N802
        return {obj.name(): obj for obj in reversed(current().service_objects)}

    @property
    def morse_services(self) -> MorseServices:
        return current().services


_storage = _PersistantStorage()


def persistantstorage() -> _PersistantStorage:
    """The state of the running simulation."""
    return _storage


_scene = _Scene()


def scene() -> _Scene:
    """The world: ``scene().objects["Ground"]`` is an object."""
    return _scene


def version() -> tuple[int, ...]:
    """Return the version of Blender whose names are used here; Blender itself is not involved."""
    return _VERSION


def isfastmode() -> bool:
    """Whether the scene asked for a view without textures."""
    return current().scene.settings.fastmode


def gravity() -> float:
    """Gravity, m/s^2, positive, downward."""
    return current().scene.settings.gravity


def gravity_vector() -> list[float]:
    """Gravity in the world, m/s^2."""
    return [0.0, 0.0, -gravity()]
