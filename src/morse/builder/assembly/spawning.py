r"""Describes a robot, an object or a component that is spawned in a running scene.

A kind may be followed by lines, each of which is the call of a method of the builder, with plain values:
``VideoCamera\nfrequency(10)\nalter('Noise', pos_std=0.1)``.
"""

from __future__ import annotations

import ast
import re
import tempfile
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from morse.assets.formats import of_strangers
from morse.builder import workspace
from morse.builder.abstractcomponent import AbstractComponent, find_part
from morse.builder.assembly.finalise import declare
from morse.builder.components.actuators_with_parts import PTU
from morse.builder.components.armatures import end_of
from morse.builder.components.matter import COMMON_TYPES
from morse.builder.components.passive import PassiveObject
from morse.builder.components.robot import Robot, WheeledRobot, connect
from morse.builder.components.solids import BlenderObject
from morse.builder.creator import ActuatorCreator, ComponentCreator, SensorCreator
from morse.builder.environment.environment import connect_by_default
from morse.builder.errors import checks
from morse.builder.names import naming
from morse.builder.names.part import Strength
from morse.builder.objects import SceneObject
from morse.builder.own_classes import own_class
from morse.core.declarations import properties
from morse.core.exceptions import MorseBuilderError, MorseBuilderNoComponentError, MorseError
from morse.core.reports.quoting import nearest, short
from morse.core.validation.fields import checked_value
from morse.helpers.descriptions import is_description, robot_file
from morse.scene import Node
from morse.scene.component import RealismModel

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping, Sequence

    from morse.builder.workspace import Workspace
    from morse.mathutils import Matrix
    from morse.scene import ComponentDeclaration, ModelUse


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
    most_components: int | None = None,
) -> Newcomer:
    """Return the robot or object that a function of the builder describes, with a name and a pose.

    Args:
        make: function that returns a robot or an object, e.g. a class of the builder; or a complete newcomer, which
            keeps its pose.
        position: x, y, z in the world, m.
        rotation: roll, pitch, yaw, rad.
        present: nodes of the running scene; what comes has none of their names.
        interfaces: names of the middlewares to which a robot is connected.
        most_components: the largest number of its components; None for any number.

    Raises:
        MorseBuilderError: the function does not return a robot or an object, the name already exists, or there are too
            many components.
    """
    with workspace.described(most_components) as described:
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
            # its class may have called this before the location was set
            newcomer.location = [position[0], position[1], position[2] + newcomer.ride_height()]
        naming.rename_all()
        for root in described.roots:
            _name_parts(described, root, name)
        if isinstance(newcomer, Robot):
            for interface in interfaces:
                newcomer.add_default_interface(interface)
            connect_by_default(newcomer)
        parts = [part for part in described.components if isinstance(part, AbstractComponent) and part.is_morseable()]
        # a declaration may add roots: the boxes of a dispenser move freely
        declarations = [declare(part, described) for part in parts]
        complete = Newcomer(list(described.roots), declarations, list(described.models))
        return _checked(complete, present)


CALLS = ("properties", "frequency", "level", "noise", "delay", "phase", "alter", "add_stream")
"""The methods of components that a kind may call."""
OBJECT_CALLS = ("color", "set_physics_type", "set_mass", "set_friction", "set_restitution", "set_damping")
"""The methods of objects that a kind may call."""

#: names of modifiers and middlewares: class paths may be those of any code
_PLAIN_NAME = re.compile(r"\w+")
_MOST_CALLS = 100
#: s: all measurements of this time are kept
_LONGEST_DELAY = 60.0
#: smallest and largest factor by which an object is scaled
_FACTORS = 0.01, 100.0
_APPEND = "append("


def split_kind(kind: str) -> tuple[str, list[str]]:
    """The kind itself, and its lines with calls."""
    if is_description(kind):
        return kind, []
    name, *calls = kind.split("\n")
    return name, [call for call in calls if call]


def call_text(method: str, values: Mapping[str, object]) -> str:
    """A call as text: ``alter('Noise', pos_std=0.1)``; a value with an empty name stands alone."""
    words = [f"{name}={value!r}" if name else repr(value) for name, value in values.items()]
    return f"{method}({', '.join(words)})"


def _configure(component: AbstractComponent, calls: Sequence[str]) -> None:
    """Call methods of a component, as the lines of a kind say, which may be those of a client.

    Raises:
        MorseBuilderError: a line is not such a call, or the method refuses the values.
    """
    if len(calls) > _MOST_CALLS:
        raise MorseBuilderError(f"a component gets at most {_MOST_CALLS} calls, not {len(calls)}")
    for line in calls:
        method, arguments, values = _parsed(line)
        known = OBJECT_CALLS if isinstance(component, (BlenderObject, PassiveObject)) else CALLS
        if method == "properties":
            _check_properties(component, values)
        elif method in ("alter", "add_stream"):
            name, options = (*arguments, None)[0], set(values) & {"classpath", "method", "path"}
            if not isinstance(name, str) or not _PLAIN_NAME.fullmatch(name) or options or len(arguments) > 1:
                raise MorseBuilderError(f"{method} takes the name of one that is installed, not {short(line)}")
        elif method == "delay" and any(
            isinstance(s, (int, float)) and s > _LONGEST_DELAY for s in (*arguments, *values.values())
        ):
            raise MorseBuilderError(
                f"a component that is spawned is delayed by at most {_LONGEST_DELAY:g} s, not {short(line)}"
            )
        function = getattr(component, method, None) if method in known else None
        if function is None:
            what = type(component).__name__
            raise MorseBuilderError(f"'{short(line)}' is not a setting of {what}{nearest(method, known)}")
        try:
            if method == "set_physics_type":
                checks.choice((*arguments, *values.values(), None)[0], COMMON_TYPES, method)
            function(*arguments, **values)
        except (TypeError, ValueError) as error:
            raise MorseBuilderError(f"{short(line)}: {error}") from None


def _parsed(line: str) -> tuple[str, list[object], dict[str, object]]:
    """Method and values of a call."""
    try:
        call = ast.parse(line, mode="eval").body
        if isinstance(call, ast.Call) and isinstance(call.func, ast.Name):
            words = [(word.arg, ast.literal_eval(word.value)) for word in call.keywords]
            values = {name: value for name, value in words if name is not None}
            if len(values) == len(words):
                return call.func.id, [ast.literal_eval(one) for one in call.args], values
    except (ValueError, SyntaxError, TypeError, RecursionError, MemoryError):
        pass
    raise MorseBuilderError(f"expected a call with plain values, such as frequency(10), not '{short(line)}'")


def _check_properties(component: AbstractComponent, values: Mapping[str, object]) -> None:
    """Check properties as those that clients set: files, for example, are for scripts only."""
    known = {one.name: one for one in properties(component.component_class() or object).values()}
    for name, value in values.items():
        if name not in known:
            raise MorseBuilderError(f"{type(component).__name__} has no property '{short(name)}'{nearest(name, known)}")
        checked_value(type(component).__name__, known[name], value)


def component_again(declaration: ComponentDeclaration) -> AbstractComponent:
    """A component like one that has left a running scene, for the current scene of the builder.

    Raises:
        MorseBuilderError: it consists of several components.
    """
    node = _copy(declaration.node)
    workspace.current().add(node)
    creator = SensorCreator if declaration.kind == "sensor" else ActuatorCreator
    component = creator(
        action=ComponentCreator.LINK_EXISTING_OBJECT, blendobject=node.name, classpath=declaration.classpath
    )
    component.scene_node.properties = dict(declaration.node.properties)
    component._frequency, component._level = declaration.frequency, declaration.level
    component._streams, component._managers = [*declaration.streams], [*declaration.managers]
    component._modifiers, component._overlays = [*declaration.modifiers], [*declaration.overlays]
    component._where = declaration.where
    realism = declaration.options.get("realism")
    if isinstance(component, SensorCreator) and isinstance(realism, RealismModel):
        component._realism = realism
    return component


def _copy(node: Node) -> Node:
    twin = replace(
        node,
        parent=None,
        children=[],
        location=[*node.location],
        rotation_euler=[*node.rotation_euler],
        properties=dict(node.properties),
    )
    for child in node.children:
        below = _copy(child)
        below.parent = twin
        twin.children.append(below)
    return twin


def _name_parts(described: Workspace, top: Node, name: str) -> None:
    """Give the parts of what comes names that follow from its own name only.

    What is there when it comes differs in another process, in which a state is restored or a recording repeated.
    """
    for node in list(top.walk()):
        if node.name != name and not node.name.startswith(f"{name}."):
            node.source_name = node.source_name or node.name
            described.rename(node, f"{name}.{node.name}")


class Mount(NamedTuple):
    """Where a component is attached in a running scene.

    Attributes:
        node: the node that carries it.
        turn: 4x4 from the frame in which its pose is given to that of the node; None if these are the same.
        usual: the place of a component whose position is the origin, in the frame in which its pose is given, m.
    """

    node: Node
    turn: Matrix | None = None
    usual: Sequence[float] = (0.0, 0.0, 0.0)


def mount_of(owner: ComponentDeclaration, part: str = "") -> Mount:
    """Where ``append`` of the builder attaches a component to a robot or to a component of a running scene.

    Args:
        owner: the robot or the component.
        part: the name of a node below it; empty for the end effector of an arm, the part of a pan-tilt unit that tilts,
            or the node of the owner itself.

    Raises:
        MorseBuilderError: there is no such part, or an arm has no end effector.
    """
    node = owner.node
    part = part or (PTU.CARRIER if owner.classpath == PTU._classpath else "")
    if part:
        below = [one for child in node.children for one in child.walk()]
        found = find_part(below, part)
        if found is None:
            hint = nearest(part, [one.plain_name for one in below])
            raise MorseBuilderError(f"'{short(node.name)}' has no part '{short(part)}'{hint}")
        return Mount(found)
    return Mount(*end_of(node)) if node.bones and owner.kind == "actuator" else Mount(node)


def part_and_calls(calls: Sequence[str]) -> tuple[str, list[str]]:
    """The part to which ``append(child='hand')`` attaches a component, and the other calls.

    Raises:
        MorseBuilderError: a part is not given like that, or there are several.
    """
    own = [call for call in calls if call.startswith(_APPEND)]
    parts = []
    for call in own:
        _, numbers, words = _parsed(call)
        if numbers or {*words} != {"child"} or not isinstance(words["child"], str):
            raise MorseBuilderError(f"expected append(child='hand'), the name of a part, not {short(call)}")
        parts.append(words["child"])
    if len(parts) > 1:
        raise MorseBuilderError(f"a component is attached to one part, not to {len(parts)}")
    return "".join(parts), [call for call in calls if call not in own]


def append_text(part: str) -> str:
    """The call that attaches a component to a part."""
    return call_text("append", {"child": part})


class _Carrier(AbstractComponent):
    """Stands for the robot or the component of a running scene to which a component is attached."""

    _kind = "robot"

    def __init__(self, name: str) -> None:
        node = Node(name)
        workspace.current().add(node)
        super().__init__(SceneObject(node))
        self.basename, self.name_strength = name, Strength.GIVEN


def describe_component(
    name: str,
    make: Callable[[], object],
    calls: Sequence[str],
    position: Sequence[float],
    rotation: Sequence[float],
    present: Iterable[Node],
    interfaces: Iterable[str],
) -> Newcomer:
    """Return the sensor or the actuator that a function of the builder describes, for a robot of a running scene.

    Args:
        name: name of the robot or of the component that carries it, a dot, and a word: ``robot.camera``.
        make: function that returns a sensor or an actuator; or a complete newcomer, which keeps its pose.
        calls: calls of its methods, see `split_kind`.
        position: x, y, z in the frame of what carries it, m.
        rotation: roll, pitch, yaw, rad.
        present: nodes of the running scene; what comes has none of their names.
        interfaces: names of the middlewares to which it is connected.

    Raises:
        MorseBuilderError: the function returns something else, or the name already exists.
    """
    with workspace.described() as described:
        component = make()
        if isinstance(component, Newcomer):
            return _checked(component, present)
        if not isinstance(component, AbstractComponent) or component._kind not in ("sensor", "actuator"):
            raise MorseBuilderError(
                f"'{short(name)}': expected a sensor or an actuator of morse.builder, such as Pose(), not "
                f"{checks.shown(component)}"
            )
        robot, _, component.name = name.rpartition(".")
        component.location = list(position)
        component.rotation_euler = list(rotation)
        carrier = _Carrier(robot)
        carrier.append(component)
        _configure(component, calls)
        naming.rename_all()
        if above := robot.rpartition(".")[0]:
            for part in component._walk():
                described.rename(part.scene_node, f"{above}.{part.name}")
        for interface in interfaces:
            connect(carrier, interface)
        _name_parts(described, component.scene_node, name)
        parts = [part for part in component._walk() if part.is_morseable()]
        complete = Newcomer(
            [component.scene_node], [declare(part, described) for part in parts], list(described.models)
        )
        described.detach(component.scene_node)
        return _checked(complete, present)


def _checked(newcomer: Newcomer, others: Iterable[Node]) -> Newcomer:
    present = {node.name for node in others}
    for node in (node for root in newcomer.roots for node in root.walk()):
        if node.name in present:
            raise MorseBuilderError(f"there is already an object '{short(node.name)}' in the scene")
    return newcomer


def maker_of(kind: str) -> Callable[[], object]:
    """Return the function that creates a kind: a class of `morse.builder`, a model, or the text of a description.

    ``props/crates#small_crate`` is one object of a model, ``ranger_sim.builder.robots:Ranger`` a robot of the project,
    ``Robot('arm/arm.urdf')`` a robot of a file; a text that begins with ``<`` is a robot in URDF, SDF or MJCF.

    Raises:
        MorseBuilderNoComponentError: there is no such class and no such model.
    """
    import morse.builder

    if is_description(kind):
        return lambda: _described_by(kind)
    maker = getattr(morse.builder, kind, None) if kind in morse.builder.__all__ else None
    if isinstance(maker, type) and issubclass(maker, (Robot, BlenderObject)):
        return maker
    own = own_class(kind)
    if own is not None and issubclass(own, Robot):
        return own
    if (model := robot_file(kind)) is not None:
        return lambda: Robot(model)
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
    with tempfile.TemporaryDirectory(prefix="morse-description-") as folder:
        # meshes may be in the parent of the folder of a model: it must not be that of all temporary files
        path = Path(folder) / "model" / f"description{_SUFFIXES[root[1]]}"
        path.parent.mkdir()
        path.write_text(text, encoding="utf-8")
        try:
            with of_strangers():
                return Robot(str(path))
        except (MorseError, ValueError, OSError) as error:
            raise MorseBuilderError(str(error).replace(str(path), "the description")) from None


def object_maker(kind: str) -> Callable[[], object]:
    """As `maker_of`, for a kind that lines with calls may follow: settings of a robot or an object, or its scale."""
    own, calls = split_kind(kind)
    make = maker_of(own)
    return partial(_made_with, make, calls) if calls else make


def _made_with(make: Callable[[], object], calls: Sequence[str]) -> object:
    made = make()
    if not isinstance(made, AbstractComponent):
        raise MorseBuilderError(f"expected a robot or an object with {len(calls)} settings, not {checks.shown(made)}")
    _configure(made, [call for call in calls if not call.startswith("scale(")])
    for call in calls:
        if call.startswith("scale("):
            _resize(made, call)
    return made


def _resize(made: AbstractComponent, call: str) -> None:
    _, numbers, words = _parsed(call)
    if isinstance(made, Robot):
        raise MorseBuilderError("a robot cannot be scaled: its model has the size of the real one")
    if len(numbers) != 3 or words or not all(_is_factor(number) for number in numbers):
        low, high = _FACTORS
        raise MorseBuilderError(f"scale takes 3 factors of {low:g} to {high:g}, not {short(call)}")
    made.scale = [float(number) for number in numbers if isinstance(number, (int, float))]


def _is_factor(number: object) -> bool:
    is_number = isinstance(number, (int, float)) and not isinstance(number, bool)
    return is_number and _FACTORS[0] <= float(str(number)) <= _FACTORS[1]


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
