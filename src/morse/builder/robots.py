"""The robots of MORSE, for scene scripts. Their models are in ``morse/data/robots``."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from morse.builder import checks, workspace
from morse.builder.objects import material_slots
from morse.builder.robot import GroundRobot, Robot, WheeledRobot

if TYPE_CHECKING:
    from collections.abc import Iterable

    from morse.scene import Material

__all__ = [
    "ATRV",
    "B21",
    "QUAD2012",
    "FakeRobot",
    "Hummer",
    "Jido",
    "Morsy",
    "PatrolBot",
    "Pioneer3DX",
    "Quadrotor",
    "RMax",
    "SegwayRMP400",
    "Submarine",
    "Victim",
]

_MORSY_COLORS = ((0.9, 0.35, 0.1), (0.1, 0.45, 0.8), (0.2, 0.6, 0.25), (0.75, 0.1, 0.3), (0.45, 0.25, 0.7))


class FakeRobot(Robot):
    """A frame without a body, that only carries components."""

    def __init__(self, name: str | None = None) -> None:
        super().__init__("", name)
        self.set_no_collision()


class Morsy(GroundRobot):
    """The mascot of MORSE, a small rigid robot to drive around."""

    def __init__(self, name: str | None = None) -> None:
        super().__init__("morsy", name)
        self.set_collision_bounds()
        self.scene_node.body.radius = 0.08

    def set_color(
        self, color: Iterable[float] | float | None = None, g: float | None = None, b: float | None = None
    ) -> None:
        """Paint its body.

        Args:
            color: red, green and blue, 0..1, as one sequence; None for one that depends on how many
                there are already.
            g: green, if ``color`` is red alone.
            b: blue, if ``color`` is red alone.
        """
        if color is None:
            row = [robot for robot in workspace.current().components if isinstance(robot, Morsy)]
            color = _MORSY_COLORS[row.index(self) % len(_MORSY_COLORS)]
        elif g is not None or b is not None:
            color = (color, g or 0.0, b or 0.0)  # type: ignore[assignment]
        rgb = checks.color(color, "Morsy.set_color(color)")
        copies: dict[Material | None, Material] = {}
        for node in self.own_nodes():
            slots = material_slots(node)
            for material in slots:
                if material is not None and "body" in material.name.lower():
                    copies.setdefault(material, replace(material, color=(*rgb, material.color[3])))
            node.materials[:] = [copies.get(material, material) for material in slots]


class ATRV(GroundRobot):
    """A four-wheeled outdoor robot, driven as one rigid body."""

    def __init__(self, name: str | None = None) -> None:
        super().__init__("atrv", name)


class B21(GroundRobot):
    """A round indoor robot."""

    def __init__(self, name: str | None = None) -> None:
        super().__init__("b21", name)


class Hummer(GroundRobot):
    """An off-road vehicle with steered wheels."""

    def __init__(self, name: str | None = None) -> None:
        super().__init__("hummer", name)


class Jido(GroundRobot):
    """An indoor robot with a mast."""

    def __init__(self, name: str | None = None) -> None:
        super().__init__("jido", name)


class Pioneer3DX(WheeledRobot):
    """A small indoor robot with two driven wheels and a caster."""

    def __init__(self, name: str | None = None) -> None:
        super().__init__("pioneer3dx", name)
        # 1.4 had a FixTurningSpeed of 0.52 here, against the slip of its wheels: these do not slip
        self.properties(HasSuspension=False, Influence=0.1, Friction=0.8, FixTurningSpeed=0.0)


class PatrolBot(WheeledRobot):
    """An indoor robot with two driven wheels and casters."""

    def __init__(self, name: str | None = None) -> None:
        super().__init__("patrolbot", name)
        self.properties(HasSuspension=False, Influence=0.1, Friction=0.8)


class SegwayRMP400(WheeledRobot):
    """An outdoor robot with four driven wheels."""

    def __init__(self, name: str | None = None) -> None:
        super().__init__("segwayrmp400", name)
        self.properties(HasSuspension=False, Influence=0.1, Friction=0.8, FixTurningSpeed=1.16)


class QUAD2012(Robot):
    """A quadrotor that nothing touches."""

    def __init__(self, name: str | None = None) -> None:
        super().__init__("quadrotor", name)


class Quadrotor(Robot):
    """A quadrotor with a rigid body."""

    def __init__(self, name: str | None = None) -> None:
        super().__init__("quadrotor_dynamic", name)


class RMax(Robot):
    """A helicopter."""

    def __init__(self, name: str | None = None) -> None:
        super().__init__("rmax", name)
        self.set_rigid_body()
        self.properties(NoGravity=True)


class Submarine(Robot):
    """A submarine that neither sinks nor rises by itself."""

    def __init__(self, name: str | None = None) -> None:
        super().__init__("submarine", name)
        self.set_rigid_body()
        self.properties(NoGravity=True)


class Victim(GroundRobot):
    """A person to be found and healed (see the sensor SearchAndRescue)."""

    def __init__(self, name: str | None = None) -> None:
        super().__init__("victim", name)
        self.properties(Victim_Tag=True, Requirements="1,2,3", Injured=True, Severity=10)
