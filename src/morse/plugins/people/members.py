"""Robots that walk with a crowd: the `Human` of MORSE 1.4 as a member whom the others avoid, and who avoids them.

A member is a person of the crowd whose body is that of a robot. While it walks with the crowd, the model of walking
decides its velocity, and the physics moves its body: what stops the body stops the member. Otherwise its own actuators
move it, and people see it as any robot.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Protocol, cast

import numpy as np

from morse.core.classes.classpath import load_class
from morse.core.exceptions import MorseError
from morse.core.reports.quoting import nearest as nearest_name
from morse.mathutils import portable
from morse.plugins.people.agenda import DRIVEN, WALKS
from morse.plugins.people.walking import length
from morse.scene.frames import rigid_frame

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from morse.core.context import Context
    from morse.core.world import Body
    from morse.plugins.people.agenda import Agenda
    from morse.plugins.people.floors import Floors
    from morse.plugins.people.gait import Gait
    from morse.plugins.people.riding import Riding
    from morse.plugins.people.walking import Walkers
    from morse.plugins.people.wayfinding import Ground
    from morse.scene import Node

    Floats = NDArray[np.float64]

#: m, height of a `Human`
HEIGHT = 1.79
#: rad/s, at which members turn
_TURNS = 3.0
#: m/s: a member that moves faster was put elsewhere
_FASTEST = 5.0


class Guided(Protocol):
    """What a crowd needs of a robot that walks with it.

    Attributes:
        bge_object: its body.
        active: whether it has not been deactivated.
    """

    bge_object: Body
    active: bool

    def guide(self, linear_speed: Sequence[float], angular_speed: Sequence[float]) -> None:
        """Walk for a tick, m/s and rad/s in the axes of the robot, whatever its actuators command."""


def nodes_of_members(name: str, members: list[Any], context: Context) -> dict[str, tuple[Node, bool]]:
    """Return the nodes of the robots of a plan, and whether they walk with the crowd from the beginning, by names.

    Args:
        name: of the crowd, for messages.
        members: of the plan: ``robot`` and ``joins``.
        context: of the simulation.

    Raises:
        MorseError: there is no such robot, or it is not one that people can guide.
    """
    if not isinstance(members, list):
        raise MorseError(f"{name}: the members of the property Plan are no list: leave it as Crowd() writes it")
    robots = {one.name: one for one in context.scene.components if one.kind == "robot"}
    found: dict[str, tuple[Node, bool]] = {}
    for one in members:
        robot = str(one.get("robot")) if isinstance(one, dict) else ""
        if robot not in robots:
            raise MorseError(f"{name}.joins: there is no robot '{robot:.80}'{nearest_name(robot, sorted(robots))}")
        if robot in found:
            raise MorseError(f"{name}.joins: {robot} joins twice: give all of its goals in one call")
        if not callable(getattr(load_class(robots[robot].classpath), "guide", None)):
            raise MorseError(f"{name}.joins: {robot} is a {robots[robot].classpath.rpartition('.')[2]}, not a Human")
        found[robot] = (robots[robot].node, bool(one.get("joins", True)))
    return found


def flows_of_members(members: list[Any], nodes: dict[str, tuple[Node, bool]], count: int) -> list[dict[str, Any]]:
    """Return the flows of members, who begin where their robots are.

    Args:
        members: of the plan.
        nodes: those of `nodes_of_members`.
        count: number of the people before them.
    """
    found = []
    for number, (one, (node, _)) in enumerate(zip(members, nodes.values(), strict=True)):
        place = [float(value) for value in rigid_frame(node).position]
        plan = {key: one.get(key) for key in ("goals", "then", "wait", "later")}
        found.append({**plan, "area": [place], "count": 1, "over": 0.0, "exact": True, "begin": count + number})
    return found


class Members:
    """The robots that walk, or may walk, with a crowd.

    Args:
        context: of the simulation.
        nodes: those of `nodes_of_members`.
        first: number of the first one: of the people with bodies of their own.

    Attributes:
        rows: numbers of the members by the names of their robots.
    """

    def __init__(self, context: Context, nodes: dict[str, tuple[Node, bool]], first: int) -> None:
        self._context = context
        self._nodes = nodes
        self.rows = {name: first + number for number, name in enumerate(nodes)}

    def bodies(self) -> list[Body]:
        """Return the bodies of the robots."""
        return [self._context.world.object_of(node) for node, _ in self._nodes.values()]

    def begin(self, agenda: Agenda, walkers: Walkers) -> None:
        """Let those be driven by themselves who do not join at the beginning."""
        for (_, joins), row in zip(self._nodes.values(), self.rows.values(), strict=True):
            if not joins:
                agenda.mode[row] = DRIVEN
        walkers.present = agenda.present()

    def robot(self, name: str) -> Guided | None:
        """Return a robot; None if it is not there, or was deactivated."""
        robot = self._context.robots.get(name)
        return cast("Guided", robot) if robot is not None and robot.active and name in self.rows else None

    def observe(
        self, walkers: Walkers, agenda: Agenda, riding: Riding, floors: Floors, ground: Ground, seconds: float
    ) -> None:
        """Let members be where the physics has moved their bodies.

        Those that somebody has put elsewhere stand there; those that are outside of the ground leave the crowd.

        Args:
            walkers: people; places and velocities of members are set.
            agenda: what people do; members without a robot are gone.
            riding: on which part of the plane people are.
            floors: of the crowd.
            ground: of the crowd.
            seconds: since the last tick.
        """
        for name, row in self.rows.items():
            if not walkers.present[row]:
                continue
            robot = self.robot(name)
            if robot is None:
                agenda.mode[row], walkers.present[row] = DRIVEN, False
                continue
            x, y, z = robot.bge_object.world_pose()[0]
            if not ground.reaches(np.array([x, y])):
                riding.forget(row)
                self.leave(name, walkers, agenda)
                self._context.complaints.warn(
                    f"{name} is outside", f"{name} leaves the crowd: it is at ({x:g}, {y:g}), outside of the ground"
                )
                continue
            velocity = (
                walkers.velocity[row] + (self._on_plane(x, y, row, riding, floors) - walkers.position[row]) / seconds
            )
            if length(velocity[None])[0] >= _FASTEST:
                velocity[:] = 0.0
                riding.forget(row)
                riding.area[row] = floors.floor_of(z)
            walkers.velocity[row] = velocity
            walkers.position[row] = self._on_plane(x, y, row, riding, floors)

    @staticmethod
    def _on_plane(x: float, y: float, row: int, riding: Riding, floors: Floors) -> Floats:
        return np.asarray(np.array([x, y]) + floors.shift[riding.area[row]])

    def guide(self, walkers: Walkers, before: Floats, gait: Gait, seconds: float) -> None:
        """Let the robots go where the model of walking has moved the members.

        Args:
            walkers: people.
            before: (N, 2) m, their places before this tick.
            gait: of the people, with their headings.
            seconds: of a tick.
        """
        for name, row in self.rows.items():
            robot = self.robot(name)
            if robot is None or not walkers.present[row]:
                continue
            turn = robot.bge_object.world_pose()[1]
            way = (walkers.position[row] - before[row]) / seconds
            # whoever stands in a wall is moved out of it at once, a body is not
            x, y = (way * (_FASTEST / max(float(length(way[None])[0]), _FASTEST))).tolist()
            u, v = gait.heading[row].tolist()
            ahead, aside = turn[0] * u + turn[3] * v, turn[1] * u + turn[4] * v
            angle = float(portable.arctan2(np.array([aside]), np.array([ahead]))[0])
            rate = min(max(angle / seconds, -_TURNS), _TURNS)
            robot.guide((turn[0] * x + turn[3] * y, turn[1] * x + turn[4] * y, 0.0), (0.0, 0.0, rate))

    def join(self, name: str, walkers: Walkers, agenda: Agenda, place: Floats) -> int:
        """Let a member walk with the crowd from a place (2,) on the plane, m, on; return its number."""
        row = self.rows[name]
        walkers.position[row], walkers.velocity[row] = place, 0.0
        agenda.mode[row], walkers.present[row] = WALKS, True
        return row

    def leave(self, name: str, walkers: Walkers, agenda: Agenda) -> None:
        """Leave a member to its own actuators."""
        row = self.rows[name]
        agenda.mode[row], walkers.present[row], walkers.velocity[row] = DRIVEN, False, 0.0
