"""The summary that a simulation prints when it is ready."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from morse.core.context import Context

_RULE = "-" * 36


def summary(context: Context, modifiers: list[str], datastreams: list[str], *, verbose: bool = False) -> list[str]:
    """Return the lines of the summary; the names of all services only if ``verbose``."""
    lines = [_RULE, "-        SIMULATION SUMMARY        -", _RULE, "Robots in the simulation:"]
    for name in context.robots:
        lines += _robot(context, name)
    if not context.robots:
        lines.append("\tNone: in a scene script, robot = Morsy() before the environment adds one")
    if context.external_robots:
        lines.append("External robots (from other simulation nodes):")
        lines += [f"\tROBOT: '{name}'" for name in context.external_robots]
    lines.append("Available services:")
    for classpath, manager in context.services.request_managers().items():
        lines.append(f"\t- Interface {classpath}")
        services_of = manager.services()
        if verbose:
            lines += [f"\t\t- {component}: {services}" for component, services in services_of.items()]
        else:
            count = sum(map(len, services_of.values()))
            lines.append(f"\t\t- {count} services of {len(services_of)} components; --verbose lists them")
    lines.append("Modifiers in use:")
    lines += [f"\t- '{classpath}'" for classpath in modifiers] or ["\tNone"]
    lines.append("Datastream interfaces configured:")
    lines += [f"\t- '{classpath}'" for classpath in datastreams] or ["\tNone"]
    lines.append(_RULE)
    return lines


def _robot(context: Context, name: str) -> list[str]:
    robot = context.robots[name]
    components = [n for n, c in context.components.items() if c.robot_parent is robot]
    return [f"\tROBOT: '{name}'", *(f"\t\t- Component: '{component}'" for component in components)]
