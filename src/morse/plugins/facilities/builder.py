"""The classes of doors and lifts in scene scripts."""

from __future__ import annotations

import json
from collections.abc import Iterable
from itertools import islice, pairwise
from typing import TYPE_CHECKING

from morse.builder import workspace
from morse.builder.components.robot import Robot
from morse.builder.errors import checks

if TYPE_CHECKING:
    from morse.scene import Node

_KINDS = ("hinged", "sliding", "double")
_WOOD, _STEEL, _CABIN = (0.55, 0.36, 0.2), (0.62, 0.65, 0.68), (0.75, 0.75, 0.72)
_MOST_LEVELS = 100


class Door(Robot):
    """A door in the wall plane across its X axis; its origin is on the floor, in the middle of the opening.

    Args:
        name: its name, if it differs from the name of the variable that refers to it.
        kind: ``hinged`` at the right side (−Y), opening towards +X; ``sliding`` to the left; or ``double``, two panels
            that slide apart.
        width, height: of the opening, m.
        automatic: it opens when somebody is nearer than that, m; 0 for a door that opens by call alone.
        hold: how long it stays open, s.
        duration: time to open, s.

    Raises:
        ValueError: a number is out of its range.
    """

    _classpath = "morse.plugins.facilities.robots.door.Door"

    def __init__(
        self,
        name: str | None = None,
        kind: str = "hinged",
        *,
        width: float = 0.95,
        height: float = 2.1,
        automatic: float = 0.0,
        hold: float = 4.0,
        duration: float = 2.0,
    ) -> None:
        values = {
            "Kind": checks.choice(kind, _KINDS, "Door(kind)"),
            "Width": checks.number(width, "Door(width)", minimum=0.3, maximum=50.0),
            "Height": checks.number(height, "Door(height)", minimum=0.3, maximum=50.0),
            "Automatic": checks.number(automatic, "Door(automatic)", minimum=0.0, maximum=100.0),
            "Hold": checks.number(hold, "Door(hold)", minimum=0.0, maximum=1e6),
            "Duration": checks.number(duration, "Door(duration)", minimum=0.1, maximum=1000.0),
        }
        # `from morse.builder import *` loads no numpy
        from morse.plugins.facilities.panels import door_places, panel

        super().__init__("", name)
        self.scene_node.properties.update(values)
        paint, count = (_WOOD, 1) if kind == "hinged" else (_STEEL, 2 if kind == "double" else 1)
        for number in range(count):
            one = panel(f"{name or 'door'} panel {number}", (0.05, width / count, height), paint)
            one.location = door_places(kind, width, height, 0.0)[0][number].tolist()
            _attach(self.scene_node, one)


class Lift(Robot):
    """A lift: a cabin with doors towards its X axis; its origin is the middle of the cabin on the lowest floor.

    Args:
        name: its name, if it differs from the name of the variable that refers to it.
        levels: heights of the floors above the origin, m, from the lowest, which is 0, upwards.
        size: depth (X) and width (Y) of the cabin, m.
        height: of the cabin, m.
        speed: m/s; ``acceleration``: m/s².
        hold: how long the doors stay open, s.

    Raises:
        ValueError: a number is out of its range, or the floors are not above each other.
    """

    _classpath = "morse.plugins.facilities.robots.lift.Lift"

    def __init__(
        self,
        name: str | None = None,
        levels: Iterable[float] = (0.0, 3.5),
        *,
        size: Iterable[float] = (2.0, 1.8),
        height: float = 2.2,
        speed: float = 1.0,
        acceleration: float = 0.8,
        hold: float = 5.0,
    ) -> None:
        floors = [checks.number(level, "Lift(levels)") for level in _several(levels, "levels", "(0.0, 3.5)")]
        if not 2 <= len(floors) <= _MOST_LEVELS or floors[0] != 0.0:
            raise ValueError(
                f"Lift(levels) takes 2 to {_MOST_LEVELS} heights of which the first is 0, got {floors[:5]}"
            )
        sides = [
            checks.number(one, "Lift(size)", minimum=0.8, maximum=50.0) for one in _several(size, "size", "(2, 2)")
        ]
        if len(sides) != 2:
            raise ValueError(f"Lift(size) takes two numbers, depth and width, got {len(sides)}")
        depth, width = sides
        tall = checks.number(height, "Lift(height)", minimum=1.0, maximum=20.0)
        if any(upper - lower < tall + 0.3 for lower, upper in pairwise(floors)):
            raise ValueError(
                f"Lift(levels): floors are at least {tall + 0.3:g} m above each other: the height of the cabin, and 0.3"
            )
        values = {
            "Levels": json.dumps(floors),
            "Size": json.dumps([depth, width, tall]),
            "Speed": checks.number(speed, "Lift(speed)", minimum=0.05, maximum=20.0),
            "Acceleration": checks.number(acceleration, "Lift(acceleration)", minimum=0.05, maximum=10.0),
            "Hold": checks.number(hold, "Lift(hold)", minimum=0.0, maximum=1e6),
        }
        from morse.plugins.facilities.panels import lift_places, panel

        super().__init__("", name)
        self.scene_node.properties.update(values)
        own = name or "lift"
        cabin = [
            panel(f"{own} floor", (depth, width, 0.1), _STEEL),
            panel(f"{own} back", (0.05, width, tall), _CABIN),
            panel(f"{own} left", (depth, 0.05, tall), _CABIN),
            panel(f"{own} right", (depth, 0.05, tall), _CABIN),
        ]
        doors = [f"{own} door", *(f"{own} landing {floor}" for floor in range(len(floors)))]
        leaf = (0.04, width / 2.0, tall - 0.1)
        cabin += [panel(f"{one} {side}", leaf, _STEEL) for one in doors for side in range(2)]
        for one, place in zip(cabin, lift_places(floors, (depth, width, tall), 0.0, 0.0).tolist(), strict=True):
            one.location = place
            _attach(self.scene_node, one)


def _several(values: Iterable[float], name: str, example: str) -> list[float]:
    if not isinstance(values, Iterable) or isinstance(values, str):
        raise TypeError(f"Lift({name}) takes several numbers, such as {example}, got {checks.shown(values)}")
    return list(islice(values, _MOST_LEVELS + 1))


def _attach(parent: Node, child: Node) -> None:
    scene = workspace.current()
    scene.add(child)  # with a name that nothing else has
    scene.attach(parent, child)
