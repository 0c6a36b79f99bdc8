"""The services of the simulation itself."""

from __future__ import annotations

import logging
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from morse.assets import search
from morse.core.abstractobject import AbstractObject
from morse.core.classes.plugins import PluginError, entry_points, load
from morse.core.validation.names import check_name
from morse.services.camera_services import ViewpointServices
from morse.services.communication_services import CommunicationServices
from morse.services.exchange_services import ExchangeServices
from morse.services.lockstep_services import LockstepServices
from morse.services.population_services import PopulationServices
from morse.services.pull_services import PullServices
from morse.services.recording_services import RecordingServices
from morse.services.state_services import StateServices
from morse.services.supervision_services import Supervision
from morse.services.time_services import TimeServices
from morse.simulation.handles.world_changes import NamedPictures
from morse.simulation.loader import add_request_manager

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from morse.core.context import Context
    from morse.simulation.simulation import Simulation

logger = logging.getLogger(__name__)

SOCKET_REQUESTS = "morse.middleware.socket_request_manager.SocketRequestManager"


def _folders_of_models(simulation: Simulation) -> list[Path]:
    own = [Path(folder) for folder in simulation.scene.resource_paths]
    return [*own, *search.resource_dirs(), *search.component_dirs()]


def offer_services(simulation: Simulation) -> None:
    """Create the objects that implement the services, and start the request managers that offer them, if any."""
    context, scene = simulation.context, simulation.scene
    managers = list(dict.fromkeys([SOCKET_REQUESTS, *scene.simulation_managers])) if simulation.options.sockets else []
    for manager in managers:
        add_request_manager(context, manager)
    simulation.pictures = NamedPictures(lambda: _folders_of_models(simulation))
    objects: list[AbstractObject] = [
        Supervision(context, simulation.stop, simulation.measure_by_service, simulation.pictures.image),
        LockstepServices(simulation),
        ExchangeServices(simulation, context),
        StateServices(simulation),
        RecordingServices(simulation),
        PopulationServices(simulation, lambda: _folders_of_models(simulation)),
        ViewpointServices(scene.settings.view, simulation.viewpoint_changed),
        PullServices(context, simulation.before_physics),
        TimeServices(context.clock, simulation.pacer.set_speed, begins_late=simulation.scene.settings.physics_of_1_4),
        CommunicationServices(context),
        *_of_packages(context, [declaration.name for declaration in scene.components]),
    ]
    for obj in objects:
        for manager in managers:
            context.services.register_request_manager_mapping(obj.name(), manager)
        context.services.register_object(obj.name(), obj)
        context.service_objects.append(obj)


def _of_packages(context: Context, present: list[str]) -> Iterator[AbstractObject]:
    """The objects of installed packages and of the project, whose services are those of the simulation.

    A package names a class, which gets the context, by an entry point; or a function that returns None if a scene does
    not need it::

        [project.entry-points."morse.services"]
        referee = "my_lab.referee:Referee"

    Args:
        present: the names of components of the scene, whose services they would replace.
    """
    for point in entry_points("morse.services"):
        try:
            made = load(point, partial(_made, context, point.name, present))
        except PluginError as error:
            logger.warning("the services of the package %s are left out: %s", point.value, error)
            continue
        if made is not None:
            present.append(point.name)
            yield made


def _made(context: Context, name: str, present: list[str], cls: Callable[[Context], object]) -> AbstractObject | None:
    made = cls(context)
    if made is None:
        return None
    check_name(name, present)
    if not isinstance(made, AbstractObject):
        raise TypeError(f"it is {made!r:.80}, expected an object of a class derived from AbstractObject")
    if made.name() != name:
        raise ValueError(f"its name() is {made.name()!r:.80}, expected that of the entry point, '{name}'")
    return made
