"""The classes of what handles goods in scene scripts: conveyors, turntables, dispensers, chargers, forklifts."""

from __future__ import annotations

import json
from collections.abc import Iterable
from typing import TYPE_CHECKING

from morse.builder import workspace
from morse.builder.components.robot import Robot
from morse.builder.creator import ActuatorCreator, SensorCreator
from morse.builder.errors import checks
from morse.plugins.facilities.builder import PAINT, attach, several

if TYPE_CHECKING:
    from collections.abc import Iterable

    from morse.builder.abstractcomponent import AbstractComponent
    from morse.scene import ComponentDeclaration

_BELT, _PAD = (0.12, 0.12, 0.13), (0.1, 0.45, 0.25)
_MOST_BOXES = 200


class Conveyor(Robot):
    """A conveyor belt; its origin is on the floor, below the middle of the edge where the belt begins.

    A straight belt extends along the X axis. A curved belt begins along the X axis and turns to the left or right.

    Args:
        name: its name, if it differs from the name of the variable that refers to it.
        length: of the belt, along its middle, m.
        width: of the belt, m.
        height: of its surface, m.
        turn: angle by which the belt turns, rad, positive to the left; 0 for a straight belt.
        speed: m/s, negative backwards; ``acceleration``: m/s².
        friction: coefficient of sliding friction of the belt, and of whatever lies on it.
        rails: whether it has rails along both sides, 6 cm high.
        running: whether it runs from the beginning.

    Raises:
        ValueError: a number is out of its range, or the inner side of a curved belt has no radius.
    """

    _classpath = "morse.plugins.facilities.robots.conveyor.Conveyor"

    def __init__(
        self,
        name: str | None = None,
        length: float = 2.0,
        *,
        width: float = 0.6,
        height: float = 0.8,
        turn: float = 0.0,
        speed: float = 0.5,
        acceleration: float = 1.0,
        friction: float = 0.7,
        rails: bool = False,
        running: bool = True,
    ) -> None:
        long = checks.number(length, "Conveyor(length)", minimum=0.1, maximum=1000.0)
        wide = checks.number(width, "Conveyor(width)", minimum=0.05, maximum=50.0)
        tall = checks.number(height, "Conveyor(height)", minimum=0.1, maximum=50.0)
        angle = checks.number(turn, "Conveyor(turn)", minimum=-6.2, maximum=6.2)
        grip = checks.number(friction, "Conveyor(friction)", minimum=0.0, maximum=10.0)
        radius = long / angle if angle else 0.0
        if radius and abs(radius) <= 0.5 * wide + 0.05:
            raise ValueError(
                f"Conveyor(turn): the middle of the belt has the radius length / turn = {abs(radius):g} m; the belt is "
                f"{wide:g} m wide, so expected more than {0.5 * wide + 0.05:g} m"
            )
        values = {
            "Speed": checks.number(speed, "Conveyor(speed)", minimum=-10.0, maximum=10.0),
            "Acceleration": checks.number(acceleration, "Conveyor(acceleration)", minimum=0.01, maximum=100.0),
            "Radius": radius,
            "Running": checks.boolean(running, "Conveyor(running)"),
        }
        rails = checks.boolean(rails, "Conveyor(rails)")
        from morse.plugins.facilities.panels import belt_panels

        super().__init__("", name)
        self.scene_node.properties.update(values)
        for one in belt_panels(name or "conveyor", (long, wide, tall), angle, (_BELT, PAINT), rails=rails):
            one.body.friction = grip
            attach(self.scene_node, one)


class Turntable(Robot):
    """A disc that turns objects, with a belt on it; its origin is on the floor, below the middle of the disc.

    Args:
        name: its name, if it differs from the name of the variable that refers to it.
        diameter: of the disc, m.
        height: of its surface, m.
        speed: angular velocity, rad/s; ``acceleration``: rad/s².
        friction: coefficient of sliding friction of the disc, and of whatever lies on it.

    Raises:
        ValueError: a number is out of its range.
    """

    _classpath = "morse.plugins.facilities.robots.turntable.Turntable"

    def __init__(
        self,
        name: str | None = None,
        diameter: float = 1.0,
        *,
        height: float = 0.8,
        speed: float = 0.8,
        acceleration: float = 1.0,
        friction: float = 0.7,
    ) -> None:
        wide = checks.number(diameter, "Turntable(diameter)", minimum=0.1, maximum=50.0)
        tall = checks.number(height, "Turntable(height)", minimum=0.05, maximum=50.0)
        grip = checks.number(friction, "Turntable(friction)", minimum=0.0, maximum=10.0)
        values = {
            "Speed": checks.number(speed, "Turntable(speed)", minimum=0.01, maximum=20.0),
            "Acceleration": checks.number(acceleration, "Turntable(acceleration)", minimum=0.01, maximum=100.0),
        }
        from morse.plugins.facilities.panels import disc, panel

        super().__init__("", name)
        self.scene_node.properties.update(values)
        own = name or "turntable"
        plate = disc(f"{own} disc", 0.5 * wide, 0.04, _BELT)
        plate.body.friction = grip
        plate.location = [0.0, 0.0, tall - 0.02]
        stand = panel(f"{own} stand", (0.3 * wide, 0.3 * wide, tall - 0.04), PAINT)
        stand.location = [0.0, 0.0, 0.5 * tall - 0.02]
        for one in (plate, stand):
            attach(self.scene_node, one)


class Dispenser(Robot):
    """A cabinet that puts out boxes, one by one; its origin is on the floor, below the place where they appear.

    The cabinet is behind that place, on its −X side. Its boxes are objects of the scene: ``NAME box 0`` and so on.

    Args:
        name: its name, if it differs from the name of the variable that refers to it.
        stock: number of boxes, up to 200.
        size: of a box: length, width and height, m.
        mass: of a box, kg.
        height: at which the bottom of a box appears, m.
        interval: s between two boxes; 0 for a dispenser that puts them out by call alone.
        friction: coefficient of sliding friction of the boxes; None for the default of the simulation.
        color: of the boxes: red, green and blue, 0 to 1.

    Raises:
        ValueError: a number is out of its range.
    """

    _classpath = "morse.plugins.facilities.robots.dispenser.Dispenser"

    def __init__(
        self,
        name: str | None = None,
        stock: int = 12,
        *,
        size: Iterable[float] = (0.3, 0.3, 0.2),
        mass: float = 2.0,
        height: float = 0.82,
        interval: float = 0.0,
        friction: float | None = None,
        color: Iterable[float] = (0.72, 0.53, 0.33),
    ) -> None:
        count = checks.integer(stock, "Dispenser(stock)", minimum=1)
        if count > _MOST_BOXES:
            raise ValueError(f"Dispenser(stock) takes 1 to {_MOST_BOXES} boxes, got {count}")
        sides = [
            checks.number(one, "Dispenser(size)", minimum=0.02, maximum=5.0)
            for one in several(size, "Dispenser(size)", "(0.3, 0.3, 0.2)")
        ]
        if len(sides) != 3:
            raise ValueError(f"Dispenser(size) takes three numbers, length, width and height, got {len(sides)}")
        weight = checks.number(mass, "Dispenser(mass)", minimum=0.01, maximum=1e4)
        level = checks.number(height, "Dispenser(height)", minimum=0.0, maximum=50.0)
        paint = checks.color(color, "Dispenser(color)")
        grip = None if friction is None else checks.number(friction, "Dispenser(friction)", minimum=0.0, maximum=10.0)
        values = {
            "Size": json.dumps(sides),
            "Height": level,
            "Interval": checks.number(interval, "Dispenser(interval)", minimum=0.0, maximum=1e6),
        }
        from morse.plugins.facilities.panels import cabinet, panel
        from morse.scene import PhysicsType

        super().__init__("", name)
        self.scene_node.properties.update(values)
        own = name or "dispenser"
        walls, places = cabinet(own, count, (sides[0], sides[1], sides[2]), PAINT)
        self._walls = {one.name.rpartition(" ")[2]: one for one in walls}
        for one in walls:
            attach(self.scene_node, one)
        self._boxes = [panel(f"{own} box", sides, paint) for _ in places]
        for box, place in zip(self._boxes, places, strict=True):
            box.location = place
            box.body.type, box.body.mass, box.body.friction = PhysicsType.RIGID_BODY, weight, grip
            attach(self.scene_node, box)

    def _declaration(self, robot: AbstractComponent) -> ComponentDeclaration:
        # the pose and the name of the dispenser are known only now; what is attached to it would neither move freely
        # nor let anything sleep that lies on it
        scene = workspace.current()
        for one in (*self._walls.values(), *self._boxes):
            if one.parent is not None:
                above = one.parent.world_matrix()
                scene.detach(one)
                one.parent_inverse = above
        # the same names whether a script or a running simulation creates it
        for side, wall in self._walls.items():
            scene.rename(wall, f"{self.name} {side}")
        for number, box in enumerate(self._boxes):
            scene.rename(box, f"{self.name} box {number}")
            box.properties.update(Object=True, Graspable=True, Label=box.name)
        self.scene_node.properties["Boxes"] = json.dumps([box.name for box in self._boxes])
        return super()._declaration(robot)


class Charger(Robot):
    """A charging station; its origin is on the floor, in the middle of the pad on which a robot stands.

    It charges the `Battery` sensors of robots within its reach. Its column stands on the −X side.

    Args:
        name: its name, if it differs from the name of the variable that refers to it.
        rate: charge that a battery gains, % per second.
        reach: distance of a battery from the middle of the pad, seen from above, m.

    Raises:
        ValueError: a number is out of its range.
    """

    _classpath = "morse.plugins.facilities.robots.charger.Charger"

    def __init__(self, name: str | None = None, *, rate: float = 1.0, reach: float = 0.5) -> None:
        wide = checks.number(reach, "Charger(reach)", minimum=0.05, maximum=50.0)
        values = {"Rate": checks.number(rate, "Charger(rate)", minimum=0.0, maximum=1e4), "Reach": wide}
        from morse.plugins.facilities.panels import ghost, panel

        super().__init__("", name)
        self.scene_node.properties.update(values)
        own = name or "charger"
        pad = ghost(panel(f"{own} pad", (2.0 * wide, 2.0 * wide, 0.01), _PAD))
        pad.location = [0.0, 0.0, 0.005]
        column = panel(f"{own} column", (0.15, 0.4, 0.9), PAINT)
        column.location = [-wide - 0.45, 0.0, 0.45]
        for one in (pad, column):
            attach(self.scene_node, one)


class Forklift(Robot):
    """A forklift with its motion controller ``motion`` (`MotionVWAckermann`), and ``scales`` (`ContactForce`).

    Its origin is on the floor, in the middle of the front axle; its fork is in the direction of its X axis.

    Args:
        name: its name, if it differs from the name of the variable that refers to it.
        capacity: largest load, kg, up to 1500.
        speed: of the fork, m/s.

    Attributes:
        motion: drives and steers it; ``properties(MaxSpeed=..., MaxAcceleration=...)`` has its limits.
        scales: measure the forces on the fork.

    Raises:
        ValueError: a number is out of its range.
    """

    _classpath = "morse.plugins.facilities.robots.forklift.Forklift"

    def __init__(self, name: str | None = None, *, capacity: float = 1000.0, speed: float = 0.3) -> None:
        values = {
            "Capacity": checks.number(capacity, "Forklift(capacity)", minimum=0.0, maximum=1500.0),
            "Speed": checks.number(speed, "Forklift(speed)", minimum=0.01, maximum=1.0),
        }
        super().__init__("forklift", name)
        self.scene_node.properties.update(values)
        self.motion = ActuatorCreator("motion", classpath="morse.actuators.ackermann.MotionVWAckermann")
        self.motion.properties(
            LeftWheels="left_wheel",
            RightWheels="right_wheel",
            LeftSteering="left_steering",
            RightSteering="right_steering",
            SteeringLimit=1.2,
            MaxSpeed=3.0,
            MaxAcceleration=1.0,
        )
        self.append(self.motion)
        self.scales = SensorCreator("scales", classpath="morse.sensors.contact_force.ContactForce")
        self.append(self.scales, "fork")
