"""Describes a robot or an object that is spawned in a running scene."""

from __future__ import annotations

import re
import tempfile
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

from morse.builder import workspace
from morse.builder.abstractcomponent import AbstractComponent
from morse.builder.assembly.finalise import declare
from morse.builder.components.passive import PassiveObject
from morse.builder.components.robot import Robot, WheeledRobot
from morse.builder.creator import ComponentCreator
from morse.builder.environment.environment import connect_by_default
from morse.builder.errors import checks
from morse.builder.names import naming
from morse.builder.own_classes import own_class
from morse.core.exceptions import MorseBuilderError, MorseBuilderNoComponentError, MorseError
from morse.core.reports.quoting import short
from morse.helpers.descriptions import is_description

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence

    from morse.scene import ComponentDeclaration, ModelUse, Node


_SUFFIXES = {"robot": ".urdf", "sdf": ".sdf", "mujoco": ".xml"}
#: the root element, after declarations and comments
_ROOT = re.compile(r"\A\s*(?:<\?[^>]*>\s*|<!--(?:(?!-->).)*-->\s*)*<(robot|sdf|mujoco)\b", re.DOTALL)


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
        present: nodes of the running scene; what comes has none of their names.
        interfaces: names of the middlewares to which a robot is connected.

    Raises:
        MorseBuilderError: the function does not return a robot or an object, or the name already exists.
    """
    with workspace.described() as described:
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
        # the names of the parts follow from that of the whole only: what is there when it comes differs in another
        # process, in which a state is restored or a recording repeated
        for node in list(described.nodes()):
            if node.name != name and not node.name.startswith(f"{name}."):
                node.source_name = node.source_name or node.name
                described.rename(node, f"{name}.{node.name}")
        if isinstance(newcomer, Robot):
            for interface in interfaces:
                newcomer.add_default_interface(interface)
            connect_by_default(newcomer)
        parts = [part for part in described.components if isinstance(part, AbstractComponent) and part.is_morseable()]
        complete = Newcomer(list(described.roots), [declare(part) for part in parts], list(described.models))
        return _checked(complete, present)


def _checked(newcomer: Newcomer, others: Iterable[Node]) -> Newcomer:
    present = {node.name for node in others}
    for node in (node for root in newcomer.roots for node in root.walk()):
        if node.name in present:
            raise MorseBuilderError(f"there is already an object '{short(node.name)}' in the scene")
    return newcomer


def maker_of(kind: str) -> Callable[[], object]:
    """Return the function that creates a kind: a class of `morse.builder`, a model, or the text of a description.

    ``props/crates#small_crate`` is one object of a model, ``ranger_sim.builder.robots:Ranger`` a robot of the project;
    a text that begins with ``<`` is a robot in URDF, SDF or MJCF.

    Raises:
        MorseBuilderNoComponentError: there is no such class and no such model.
    """
    import morse.builder

    if is_description(kind):
        return lambda: _described_by(kind)
    maker = getattr(morse.builder, kind, None) if kind in morse.builder.__all__ else None
    if isinstance(maker, type) and issubclass(maker, Robot):
        return maker
    own = own_class(kind)
    if own is not None and issubclass(own, Robot):
        return own
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


def _described_by(text: str) -> Robot:
    """A robot from the text of its description, which may be that of a stranger."""
    root = _ROOT.search(text)
    if root is None:
        raise MorseBuilderError(
            f"a description is a <robot> (URDF), <sdf> or <mujoco> (MJCF), not {checks.shown(text[:80])}"
        )
    if "$(" in text:
        raise MorseBuilderError("a description that is sent cannot contain substitutions, such as $(env NAME)")
    with tempfile.TemporaryDirectory(prefix="morse-description-") as folder:
        # meshes may be in the parent of the folder of a model: it must not be that of all temporary files
        path = Path(folder) / "model" / f"description{_SUFFIXES[root[1]]}"
        path.parent.mkdir()
        path.write_text(text, encoding="utf-8")
        try:
            return Robot(str(path))
        except (MorseError, ValueError, OSError) as error:
            raise MorseBuilderError(str(error).replace(str(path), "the description")) from None


def component_of(kind: str) -> AbstractComponent:
    """Return a new robot, object, sensor or actuator of a kind.

    Raises:
        MorseBuilderNoComponentError: there is no such kind.
    """
    import morse.builder

    cls = getattr(morse.builder, kind, None) or own_class(kind)
    if isinstance(cls, type) and issubclass(cls, (ComponentCreator, Robot)):
        return cls()
    component = maker_of(kind)()
    assert isinstance(component, AbstractComponent)
    return component
