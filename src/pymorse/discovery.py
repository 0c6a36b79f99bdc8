"""Queries the robots and components of a simulation."""

from __future__ import annotations

import contextlib
from typing import TYPE_CHECKING, Any

from pymorse.component import Component, Robot
from pymorse.errors import MorseServiceError, MorseServiceFailed, MorseTimeoutError
from pymorse.names import checked_name, checked_port, normalize_name

if TYPE_CHECKING:
    from pymorse.pymorse import Morse

_TIMEOUT = 15.0


def discover(morse: Morse) -> list[Robot]:
    """Return the robots of a simulation, with their components.

    Raises:
        ConnectionError: the answer is not from a simulation.
    """
    where = f"{morse.host}:{morse.port}"
    try:
        details = morse.rpc_t(_TIMEOUT, "simulation", "details")
        described = details["robots"]
        ports = _stream_ports(morse, described)
        return [_robot(morse, robot, ports) for robot in described]
    except MorseTimeoutError:
        raise ConnectionError(
            f"{where} did not list the robots of the simulation within {_TIMEOUT:.0f} s: is this server MORSE, and "
            "has it finished loading?"
        ) from None
    except (AttributeError, KeyError, TypeError, ValueError, MorseServiceError) as error:
        raise ConnectionError(f"{where} did not answer in the format of MORSE: {error!r:.500}") from error


def _stream_ports(morse: Morse, described: list[dict[str, Any]]) -> dict[str, int]:
    components = {checked_name(name): part for robot in described for name, part in robot["components"].items()}
    names = sorted(name for name, part in components.items() if part.get("stream_interfaces"))
    ports = {}
    # all requests are sent first, so that the simulation answers them in one tick
    for name, answer in [(name, morse.call("simulation", "get_stream_port", name)) for name in names]:
        # a stream of another middleware has no port
        with contextlib.suppress(MorseServiceFailed):
            ports[name] = checked_port(answer.result(_TIMEOUT))
    return ports


def _robot(morse: Morse, described: dict[str, Any], ports: dict[str, int]) -> Robot:
    name = checked_name(described["name"])
    robot = Robot(morse, name, name, map(checked_name, described.get("services", ())))
    components = described["components"]
    for fqn in sorted(components, key=lambda name: name.count(".")):
        *path, last = fqn.removeprefix(name + ".").split(".")
        holder: Component = robot
        for step in path:
            holder = holder._part(normalize_name(step)) or holder._add_part(
                Component(morse, step, f"{holder.fqn}.{step}")
            )
        part = components[fqn]
        # a component may also have streams on other middlewares
        directions = [direction for _, direction in part["stream_interfaces"]] if fqn in ports else ()
        services = map(checked_name, part.get("services", ()))
        holder._add_part(Component(morse, last, fqn, directions, ports.get(fqn), services))
    return robot
