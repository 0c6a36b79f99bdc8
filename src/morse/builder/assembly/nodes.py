"""Distributes the robots of a script over several simulation nodes."""

from __future__ import annotations

import logging
from typing import TYPE_CHECKING

from morse.builder.components.robot import Robot
from morse.core.node_name import node_name
from morse.core.reports.hints import nearest
from morse.scene import PhysicsType
from morse.system import OF_MACHINE

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from morse.builder.abstractcomponent import AbstractComponent

logger = logging.getLogger(__name__)


def distribute(robots: Sequence[Robot], shares: Mapping[str, Sequence[str]]) -> None:
    """Mark the robots that other nodes simulate as external.

    Args:
        robots: of the script.
        shares: name of a node to the names of its robots. Without nodes, each node simulates all robots of its script.
    """
    names = [robot.name for robot in robots]
    for node, share in shares.items():
        for name in share:
            if name not in names:
                logger.warning(
                    "env.configure_multinode(distribution): the robot '%s' of the node '%s' is not in the script%s",
                    name,
                    node,
                    nearest(name, names),
                )
    own = node_name()
    if shares and own not in shares:
        logger.warning(
            "this node is called '%s', and the distribution has no such node%s: it simulates all robots; to name it: "
            "morse run --name NODE",
            own,
            nearest(own, list(shares)),
            # the name is that of this computer or of an option, not of the script
            extra=OF_MACHINE,
        )
    elif shares:
        for robot in robots:
            if robot.name not in shares[own]:
                robot.make_external()
    for robot in robots:
        if robot.is_external:
            _hold(robot)


def _hold(robot: Robot) -> None:
    """Leave the motion of a robot to its node: it has no physics of its own here."""
    for node in robot.scene_node.walk():
        if node.body.moves:
            node.body.type = PhysicsType.STATIC


def of_own_robots(parts: Iterable[AbstractComponent]) -> list[AbstractComponent]:
    """Return the parts without the components of robots that other nodes simulate."""
    return [part for part in parts if isinstance(part, Robot) or not _is_elsewhere(part)]


def _is_elsewhere(part: AbstractComponent) -> bool:
    owner = part.parent
    while owner is not None and not owner.is_robot:
        owner = owner.parent
    return isinstance(owner, Robot) and owner.is_external
