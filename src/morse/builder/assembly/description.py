"""The environment as described by the script."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Callable

    from morse.scene import Scene, SensorAlteration, Settings, SourceLine


class Wish(NamedTuple):
    """An argument of ``env.show``, which is checked when all components have their names.

    Attributes:
        where: the line of the script.
        value: components, or names of components and fields.
    """

    where: SourceLine | None
    value: object


class EnvironmentDescription:
    """The data that `Environment` passes to the scene.

    Attributes:
        where: the line of the script that created it.
        filename: name of its model.
        settings: settings of time, physics and view.
        environment_properties: position on the Earth, temperature, ...
        _completions: functions that change the complete scene, and the lines of the script that have added them.
        _wishes: what ``env.show`` was called with, by argument.
    """

    where: SourceLine | None
    filename: str
    settings: Settings
    environment_properties: dict[str, object]
    _auto_tune: bool
    _wishes: dict[str, Wish]
    _simulation_managers: list[str]
    _alterations: list[SensorAlteration]
    _default_interfaces: list[str]
    _manager_options: dict[str, dict[str, object]]
    _distribution: dict[str, list[str]] | None
    _distribution_where: SourceLine | None
    _log_levels: dict[str, str]
    _completions: list[tuple[SourceLine | None, Callable[[Scene], object]]]

    def add_default_interface(self, interface: str) -> None:
        """Connect all components of all robots to a middleware."""
        raise NotImplementedError
