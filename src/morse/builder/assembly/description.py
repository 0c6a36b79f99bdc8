"""The environment as described by the script."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from morse.builder.names.part import Part
    from morse.scene import Settings, SourceLine


class EnvironmentDescription:
    """The data that `Environment` passes to the scene.

    Attributes:
        where: the line of the script that created it.
        filename: name of its model.
        settings: settings of time, physics and view.
        environment_properties: position on the Earth, temperature, ...
    """

    where: SourceLine | None
    filename: str
    settings: Settings
    environment_properties: dict[str, object]
    _auto_tune: bool
    _display_camera: Part | None
    _simulation_managers: list[str]
    _default_interfaces: list[str]
    _manager_options: dict[str, dict[str, object]]
    _multinode: dict[str, object] | None
    _distribution: dict[str, list[str]]
    _log_levels: dict[str, str]

    def add_default_interface(self, interface: str) -> None:
        """Connect all components of all robots to a middleware."""
        raise NotImplementedError
