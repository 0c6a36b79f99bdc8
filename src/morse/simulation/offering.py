"""The services of the simulation itself."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from morse.assets import search
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
from morse.simulation.handles.textures import NamedPictures
from morse.simulation.loader import add_request_manager

if TYPE_CHECKING:
    from morse.core.abstractobject import AbstractObject
    from morse.simulation.running import Running

SOCKET_REQUESTS = "morse.middleware.socket_request_manager.SocketRequestManager"


def _folders_of_models(simulation: Running) -> list[Path]:
    own = [Path(folder) for folder in simulation.scene.resource_paths]
    return [*own, *search.resource_dirs(), *search.component_dirs()]


def offer_services(simulation: Running) -> None:
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
        TimeServices(context.clock, simulation.pacer.set_speed),
        CommunicationServices(context),
    ]
    for obj in objects:
        for manager in managers:
            context.services.register_request_manager_mapping(obj.name(), manager)
        context.services.register_object(obj.name(), obj)
        context.service_objects.append(obj)
