"""Names that components of MORSE 1.4 reach the running simulation by."""

from __future__ import annotations

from typing import Any

from morse.core.context import current


class _PersistantStorage:
    """The state of the simulation under the names of 1.4."""

    @property
    def time(self) -> Any:
        return current().clock

    @property
    def robotDict(self) -> dict[Any, Any]:  # noqa: N802
        return {robot.bge_object: robot for robot in current().robots.values()}

    @property
    def externalRobotDict(self) -> dict[Any, Any]:  # noqa: N802
        return {robot.bge_object: robot for robot in current().external_robots.values()}

    @property
    def componentDict(self) -> dict[str, Any]:  # noqa: N802
        return dict(current().components)

    @property
    def passiveObjectsDict(self) -> dict[Any, Any]:  # noqa: N802
        return {obj: obj for obj in current().world.objects() if "Object" in obj}

    @property
    def stream_managers(self) -> dict[str, Any]:
        return current().stream_managers

    @property
    def overlayDict(self) -> dict[str, Any]:  # noqa: N802
        return current().overlays

    @property
    def serviceObjectDict(self) -> dict[str, Any]:  # noqa: N802
        return dict(current().service_objects)

    @property
    def morse_services(self) -> Any:
        return current().services


_storage = _PersistantStorage()


def persistantstorage() -> _PersistantStorage:
    """The state of the running simulation."""
    return _storage


def scene() -> Any:
    """The world: ``scene().objects`` holds every object by name."""
    return current().world
