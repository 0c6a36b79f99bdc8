"""The classes of facilities in scene scripts."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable
from itertools import islice, pairwise
from typing import TYPE_CHECKING

from morse.builder import workspace
from morse.builder.components.robot import Robot
from morse.builder.errors import checks

if TYPE_CHECKING:
    from morse.builder.abstractcomponent import AbstractComponent
    from morse.builder.components.component import Component
    from morse.scene import ComponentDeclaration, Node

_KINDS = ("hinged", "sliding", "double")
_WOOD, _STEEL, _CABIN = (0.55, 0.36, 0.2), (0.62, 0.65, 0.68), (0.75, 0.75, 0.72)
#: the colour of machines
PAINT = (0.35, 0.42, 0.5)
_RED, _DARK = (0.75, 0.1, 0.08), (0.06, 0.06, 0.07)
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
            attach(self.scene_node, one)


class Lift(Robot):
    """A lift: a cabin with doors towards its X axis; its origin is the middle of the cabin on the lowest floor.

    Args:
        name: its name, if it differs from the name of the variable that refers to it.
        levels: heights of the floors above the origin, m, from the lowest, which is 0, upwards.
        size: depth (X) and width (Y) of the cabin, m.
        height: of the cabin, m.
        speed: m/s; ``acceleration``: m/s².
        hold: how long the doors stay open, s.
        capacity: number of people of a crowd who ride at once; 0 for as many as have room.

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
        capacity: int = 0,
    ) -> None:
        floors = [checks.number(level, "Lift(levels)") for level in several(levels, "Lift(levels)", "(0.0, 3.5)")]
        if not 2 <= len(floors) <= _MOST_LEVELS or floors[0] != 0.0:
            raise ValueError(
                f"Lift(levels) takes 2 to {_MOST_LEVELS} heights of which the first is 0, got {floors[:5]}"
            )
        sides = [
            checks.number(one, "Lift(size)", minimum=0.8, maximum=50.0) for one in several(size, "Lift(size)", "(2, 2)")
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
            "Capacity": min(checks.integer(capacity, "Lift(capacity)", minimum=0), 1000),
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
            attach(self.scene_node, one)


class Stairs(Robot):
    """A straight flight of steps; its origin is on the lower floor, in the middle of the edge of the first step.

    Its X axis is the way up. The last step is the edge of the upper floor, which is an object of the scene.

    Args:
        name: its name, if it differs from the name of the variable that refers to it.
        rise: height of the upper floor above the lower one, m.
        width: between the rails, m.
        tread: depth of a step, m.
        riser: largest height of a step, m: as many steps as are needed are equally high.

    Raises:
        ValueError: a number is out of its range.
    """

    _classpath = "morse.plugins.facilities.robots.stairs.Stairs"

    def __init__(
        self,
        name: str | None = None,
        rise: float = 3.5,
        *,
        width: float = 1.5,
        tread: float = 0.29,
        riser: float = 0.175,
    ) -> None:
        tall = checks.number(rise, "Stairs(rise)", minimum=0.1, maximum=30.0)
        wide = checks.number(width, "Stairs(width)", minimum=0.6, maximum=50.0)
        deep = checks.number(tread, "Stairs(tread)", minimum=0.15, maximum=1.0)
        high = checks.number(riser, "Stairs(riser)", minimum=0.08, maximum=0.4)
        from morse.plugins.facilities.panels import flight_of_steps

        super().__init__("", name)
        steps = max(math.ceil(tall / high - 1e-9), 2)
        self.scene_node.properties.update(Rise=tall, Width=wide, Tread=deep, Steps=steps)
        for one in flight_of_steps(name or "stairs", tall, steps, deep, wide, (_CABIN, _STEEL)):
            attach(self.scene_node, one)


class Gate(Robot):
    """A barrier with an arm that swings up; its origin is on the floor, below the middle of the arm.

    The way through it is along its X axis. The post is at the right side (−Y).

    Args:
        name: its name, if it differs from the name of the variable that refers to it.
        width: of the opening, m.
        height: of the arm above the floor, m.
        automatic: it opens when somebody is nearer than that, m; 0 for a gate that opens by call alone.
        hold: how long it stays open, s.
        duration: time to open, s.

    Raises:
        ValueError: a number is out of its range.
    """

    _classpath = "morse.plugins.facilities.robots.gate.Gate"

    def __init__(
        self,
        name: str | None = None,
        width: float = 3.0,
        *,
        height: float = 0.9,
        automatic: float = 0.0,
        hold: float = 6.0,
        duration: float = 1.5,
    ) -> None:
        wide = checks.number(width, "Gate(width)", minimum=0.3, maximum=50.0)
        tall = checks.number(height, "Gate(height)", minimum=0.1, maximum=10.0)
        values = {
            "Width": wide,
            "Height": tall,
            "Automatic": checks.number(automatic, "Gate(automatic)", minimum=0.0, maximum=100.0),
            "Hold": checks.number(hold, "Gate(hold)", minimum=0.0, maximum=1e6),
            "Duration": checks.number(duration, "Gate(duration)", minimum=0.1, maximum=1000.0),
        }
        from morse.plugins.facilities.panels import gate_place, panel

        super().__init__("", name)
        self.scene_node.properties.update(values)
        own = name or "gate"
        arm = panel(f"{own} arm", (0.06, wide, 0.1), _RED)
        arm.location = gate_place(wide, tall, 0.0)[0]
        post = panel(f"{own} post", (0.25, 0.2, tall + 0.2), PAINT)
        post.location = [0.0, -0.5 * wide - 0.15, 0.5 * tall + 0.1]
        for one in (arm, post):
            attach(self.scene_node, one)


class TrafficLight(Robot):
    """A traffic light that shines along its X axis; its origin is on the floor, at the foot of its post.

    Args:
        name: its name, if it differs from the name of the variable that refers to it.
        phases: states and their durations in seconds, again and again: ``red``, ``red-yellow``, ``yellow``, ``green``,
            ``off``.
        offset: s: the schedule begins at that time within its first round.
        height: of the red light, m.

    Raises:
        TypeError, ValueError: a phase is no such pair, or a number is out of its range.
    """

    _classpath = "morse.plugins.facilities.robots.traffic_light.TrafficLight"

    def __init__(
        self,
        name: str | None = None,
        phases: Iterable[tuple[str, float]] = (("green", 20.0), ("yellow", 3.0), ("red", 25.0), ("red-yellow", 2.0)),
        *,
        offset: float = 0.0,
        height: float = 3.0,
    ) -> None:
        tall = checks.number(height, "TrafficLight(height)", minimum=0.8, maximum=20.0)
        values = {
            "Phases": json.dumps(_phases(phases)),
            "Offset": checks.number(offset, "TrafficLight(offset)", minimum=0.0, maximum=1e6),
        }
        from morse.plugins.facilities.panels import lenses, panel

        super().__init__("", name)
        self.scene_node.properties.update(values)
        own = name or "light"
        post = panel(f"{own} post", (0.1, 0.1, tall - 0.6), PAINT)
        post.location = [0.0, 0.0, 0.5 * tall - 0.3]
        housing = panel(f"{own} housing", (0.2, 0.3, 0.9), _DARK)
        housing.location = [0.0, 0.0, tall - 0.3]
        for one in (post, housing, *lenses(own, tall)):
            attach(self.scene_node, one)


class Button(Robot):
    """A button that robots and people press, and that calls services. Its cap is on the +X side of its origin.

    Args:
        name: its name, if it differs from the name of the variable that refers to it.
        reach: somebody who comes nearer than that presses it, m; 0 for a button that is pressed by touch or by call.
        size: of the cap, m.

    Raises:
        ValueError: a number is out of its range.
    """

    _classpath = "morse.plugins.facilities.robots.button.Button"

    def __init__(self, name: str | None = None, *, reach: float = 0.0, size: float = 0.1) -> None:
        wide = checks.number(size, "Button(size)", minimum=0.01, maximum=1.0)
        values = {"Reach": checks.number(reach, "Button(reach)", minimum=0.0, maximum=50.0), "Calls": "[]"}
        from morse.plugins.facilities.panels import panel

        super().__init__("", name)
        self.scene_node.properties.update(values)
        self._links: list[tuple[Component | str, str, list[object]]] = []
        own = name or "button"
        plate = panel(f"{own} plate", (0.02, 1.6 * wide, 1.6 * wide), _STEEL)
        cap = panel(f"{own} cap", (0.02, wide, wide), _RED)
        cap.location = [0.02, 0.0, 0.0]
        for one in (cap, plate):
            attach(self.scene_node, one)

    def calls(self, target: Component | str, service: str, *arguments: object) -> None:
        """Call a service each time that the button is pressed.

        Args:
            target: a component of the scene, or its name.
            service: name of a service of it, such as ``open`` of a door.
            arguments: numbers, strings, or lists of them.

        Raises:
            TypeError: the target is no component, or an argument is none of these.
        """
        if not isinstance(target, str) and not hasattr(target, "scene_node"):
            raise TypeError(f"Button.calls(target) takes a component or its name, got {checks.shown(target)}")
        checks.text(service, "Button.calls(service)")
        try:
            json.dumps(arguments, allow_nan=False)
        except (TypeError, ValueError) as error:
            raise TypeError(f"Button.calls(arguments) takes numbers, strings and lists: {error}") from None
        self._links.append((target, service, list(arguments)))

    def _declaration(self, robot: AbstractComponent) -> ComponentDeclaration:
        # components have their names only now
        links = [(one if isinstance(one, str) else str(one.name), name, values) for one, name, values in self._links]
        self.scene_node.properties["Calls"] = json.dumps(links)
        return super()._declaration(robot)


_LIGHTS = ("red", "red-yellow", "yellow", "green", "off")
_MOST_PHASES = 1000


def _phases(phases: Iterable[tuple[str, float]]) -> list[tuple[str, float]]:
    what = "TrafficLight(phases)"
    if isinstance(phases, (str, dict)) or not isinstance(phases, Iterable):
        raise TypeError(f"{what} takes pairs such as ('green', 20.0), got {checks.shown(phases)}")
    found: list[tuple[str, float]] = []
    for one in islice(phases, _MOST_PHASES + 1):
        if not isinstance(one, (tuple, list)) or len(one) != 2:
            raise TypeError(f"{what} takes pairs such as ('green', 20.0), got {checks.shown(one)}")
        state, seconds = one
        found.append((checks.choice(state, _LIGHTS, what), checks.number(seconds, what, minimum=0.1, maximum=1e6)))
    if not 1 <= len(found) <= _MOST_PHASES:
        raise ValueError(f"{what} takes 1 to {_MOST_PHASES} phases, got {len(found)} or more")
    return found


def several(values: Iterable[float], what: str, example: str) -> list[float]:
    """Return the first items of what a script gives as several numbers.

    Raises:
        TypeError: it is not a series of values.
    """
    if not isinstance(values, Iterable) or isinstance(values, str):
        raise TypeError(f"{what} takes several numbers, such as {example}, got {checks.shown(values)}")
    return list(islice(values, _MOST_LEVELS + 1))


def attach(parent: Node, child: Node) -> None:
    """Add a node to the scene of the script, below another one."""
    scene = workspace.current()
    scene.add(child)  # with a name that nothing else has
    scene.attach(parent, child)
