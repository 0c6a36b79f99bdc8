"""A page on the services that every simulation has."""

from __future__ import annotations

from component_library.declared import service_list
from component_library.markdown import page, section
from morse.core.sensor import Sensor
from morse.core.services import declared_services
from morse.middleware.socket.datastream import StreamDirectory
from morse.services.camera_services import ViewpointServices
from morse.services.communication_services import CommunicationServices
from morse.services.lockstep_services import LockstepServices
from morse.services.supervision_services import Supervision
from morse.services.time_services import TimeServices

_INTRODUCTION = "The services of every simulation and of every component. How to call them: [services](../services.md)."
_SECTIONS = {
    "simulation": "The life of the simulation, its robots, objects and components.",
    "time": "Simulated time.",
    "communication": "Communication between robots.",
}


def pages() -> dict[str, str]:
    """Name of a page, below the folder of the library, to its text."""
    classes = {
        "simulation": (Supervision, LockstepServices, ViewpointServices, StreamDirectory),
        "time": (TimeServices,),
        "communication": (CommunicationServices,),
    }
    parts = [
        section(name, _SECTIONS[name] + "\n", *(service_list(cls, declared_services(cls)) for cls in classes[name]))
        for name in _SECTIONS
    ]
    every = section(
        "Every component",
        "Under its own name, such as `robot.pose`.\n",
        service_list(Sensor, declared_services(Sensor)),
    )
    return {"services": page("Services of the simulation", _INTRODUCTION, *parts, every)}
