"""Describes a robot or an object that is spawned in a running scene."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from morse.builder import workspace
from morse.builder.abstractcomponent import AbstractComponent
from morse.builder.assembly.finalise import declare
from morse.builder.components.passive import PassiveObject
from morse.builder.components.robot import Robot, WheeledRobot
from morse.builder.creator import ComponentCreator
from morse.builder.environment.environment import connect_by_default
from morse.builder.errors import checks
from morse.builder.names import naming
from morse.core.exceptions import MorseBuilderError, MorseBuilderNoComponentError
from morse.core.reports.quoting import short

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence

    from morse.scene import ComponentDeclaration, ModelUse, Node


@dataclass(frozen=True)
class Newcomer:
    """The content of a spawned robot or object.

    Attributes:
        roots: its nodes without a parent.
        components: its declarations: of a robot and the components of the robot.
        models: the model files from which the nodes were loaded.
    """

    roots: list[Node] = field(default_factory=list)
    components: list[ComponentDeclaration] = field(default_factory=list)
    models: list[ModelUse] = field(default_factory=list)


def describe_newcomer(
    name: str,
    make: Callable[[], object],
    position: Sequence[float],
    rotation: Sequence[float],
    present: Iterable[Node],
    interfaces: Iterable[str],
) -> Newcomer:
    """Return the robot or object that a function of the builder describes, with a name and a pose.

    Args:
        make: function that returns a robot or an object, e.g. a class of the builder; or a complete newcomer, which
            keeps its pose.
        position: x, y, z in the world, m.
        rotation: roll, pitch, yaw, rad.
        present: nodes of the running scene; new nodes get names that do not exist there.
        interfaces: names of the middlewares to which a robot is connected.

    Raises:
        MorseBuilderError: the function does not return a robot or an object, or the name already exists.
    """
    present = list(present)
    with workspace.described() as described:
        described.reserve(present)
        newcomer = make()
        if isinstance(newcomer, Newcomer):
            return _checked(newcomer, present)
        if not isinstance(newcomer, AbstractComponent):
            raise MorseBuilderError(
                f"expected a robot or an object of morse.builder, such as ATRV(), not {checks.shown(newcomer)}"
            )
        newcomer.name = name
        newcomer.location = list(position)
        newcomer.rotation_euler = list(rotation)
        if isinstance(newcomer, WheeledRobot):
            newcomer.unparent_wheels()
        naming.rename_all()
        if isinstance(newcomer, Robot):
            for interface in interfaces:
                newcomer.add_default_interface(interface)
            connect_by_default(newcomer)
        if newcomer.name != name:
            raise MorseBuilderError(f"there is already an object '{name}' in the scene")
        parts = [part for part in described.components if isinstance(part, AbstractComponent) and part.is_morseable()]
        return Newcomer(list(described.roots), [declare(part) for part in parts], list(described.models))


def _checked(newcomer: Newcomer, others: Iterable[Node]) -> Newcomer:
    present = {node.name for node in others}
    for node in (node for root in newcomer.roots for node in root.walk()):
        if node.name in present:
            raise MorseBuilderError(f"there is already an object '{short(node.name)}' in the scene")
    return newcomer


def maker_of(kind: str) -> Callable[[], Any]:
    """Return the function that creates a kind: the name of a class of `morse.builder`, or the name of a model.

    ``props/crates#small_crate`` is one object of a model.

    Raises:
        MorseBuilderNoComponentError: there is no such class and no such model.
    """
    import morse.builder

    maker = getattr(morse.builder, kind, None) if kind in morse.builder.__all__ else None
    if isinstance(maker, type) and issubclass(maker, Robot):
        return maker
    if "/" in kind or "." in kind:
        file, _, part = kind.partition("#")
        return lambda: PassiveObject(file, object_name=part or None)
    robots = [
        name
        for name in morse.builder.__all__
        if isinstance(value := getattr(morse.builder, name), type) and issubclass(value, Robot)
    ]
    raise MorseBuilderNoComponentError(
        f"there is no robot '{kind}'{checks.suggestion(kind, robots)}; for an object, give its model, e.g. props/crates"
    )


def component_of(kind: str) -> AbstractComponent:
    """Return a new robot, object, sensor or actuator of a kind.

    Raises:
        MorseBuilderNoComponentError: there is no such kind.
    """
    import morse.builder

    cls = getattr(morse.builder, kind, None)
    if isinstance(cls, type) and issubclass(cls, ComponentCreator):
        return cls()
    component = maker_of(kind)()
    assert isinstance(component, AbstractComponent)
    return component
