"""Parameters of a scene by name: which there are, their values, and a scene with other values."""

from __future__ import annotations

import json
import math
import os
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from morse.core.classes.classpath import load_class
from morse.core.declarations import DataField, data_fields, properties
from morse.core.exceptions import MorseBuilderError
from morse.core.reports.quoting import nearest, quoted
from morse.scene import ModifierDeclaration, PhysicsType
from morse.scene.component import RealismModel
from morse.system.regular_files import read_regular

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping, Sequence

    from morse.builder.environment import Environment
    from morse.scene import Bone, ComponentDeclaration, Node, Scene

_CALIBRATION = "morse.plugins.twin.calibration.Calibration"
#: the axes of vectors, and of places
_AXES = ("x", "y", "z", "w")
_PLACE = ("x", "y", "z", "roll", "pitch", "yaw")
#: friction of what has none of its own
_FRICTION = 0.7
#: what joints have, and its unit for joints that turn
_JOINT = ("gain", "slowing", "damping", "friction", "inertia", "stiffness")
#: largest size of a preset, bytes, and number of its values
_LARGEST, _MOST = 1 << 20, 10_000
#: greatest number that is a measurement: squares of greater ones overflow
GREATEST = 1e100
#: the key of presets, and the number of their format
FORMAT, PRESENT = "morse preset", 1
#: longest list in a field whose items are parameters
_MOST_ITEMS = 64


class ParameterError(MorseBuilderError):
    """There is no such parameter, or it cannot have this value."""


class Correction(NamedTuple):
    """A parameter that changes what a sensor says, and not what happens.

    Attributes:
        what: ``bias``, ``gain`` or ``delay``.
        field: of the sensor; empty for all.
        item: index in the field; -1 for a number.
    """

    what: str
    field: str = ""
    item: int = -1


@dataclass(frozen=True)
class Parameter:
    """A number that a scene depends on.

    Attributes:
        name: full name, such as ``robot.imu.bias.angular_velocity.x``.
        component: name of the component.
        value: in the scene.
        scale: size of a change that matters, such as 0.1 m.
        low, high: its range.
        correction: None if it changes what happens.
        guess: where a fit begins at least; None for the value in the scene.
    """

    name: str
    component: str
    value: float
    scale: float
    unit: str = ""
    low: float = -math.inf
    high: float = math.inf
    correction: Correction | None = None
    guess: float | None = None

    @property
    def is_ratio(self) -> bool:
        """Whether its changes are best told in percent."""
        return self.low >= 0.0 and self.value > 0.0 and self.scale >= 0.01 * self.value


class _Quantity(NamedTuple):
    """A parameter, and how a scene gets it."""

    parameter: Parameter
    put: Callable[[Mapping[str, ComponentDeclaration], float], object]


class Parameters:
    """The parameters of a scene.

    Args:
        scene: plain data; it is not changed.
        wheels: radius of the wheels and track, m, of robots whose two rows of wheels are driven.
        fields: of the components of a simulation of the scene; None for those that classes and armatures declare.
    """

    def __init__(
        self,
        scene: Scene,
        wheels: Mapping[str, tuple[float, float]] | None = None,
        fields: Mapping[str, Mapping[str, DataField]] | None = None,
    ) -> None:
        self.scene, self._wheels, self._known_fields = scene, wheels, fields or {}
        self._components = {one.name: one for one in scene.components}
        self._quantities: dict[str, _Quantity] = {}
        for one in scene.components:
            for quantity in self._of(one):
                self._quantities.setdefault(quantity.parameter.name, quantity)

    def __iter__(self) -> Any:
        return iter(quantity.parameter for quantity in self._quantities.values())

    def find(self, names: Iterable[str]) -> list[Parameter]:
        """The parameters of names, which may leave out the robot, or end before the parts of a vector.

        Raises:
            ParameterError: there is none of that name, or several.
        """
        found: dict[str, Parameter] = {}
        for name in names:
            for full in self._matches(name):
                found[full] = self._quantities[full].parameter
        return list(found.values())

    def _matches(self, name: str) -> list[str]:
        own = [full for full in self._components if f".{full}".endswith(f".{name}")]
        if own:
            quantities = sorted(
                {full.removeprefix(f"{own[0]}.").partition(".")[0] for full in self._full_names(own[0])}
            )
            raise ParameterError(f"{quoted(name)} is a component: name one of its parameters, {', '.join(quantities)}")
        for matches in (
            lambda full: full == name,
            lambda full: full.startswith(f"{name}."),
            lambda full: f".{full}".endswith(f".{name}"),
            lambda full: f".{name}." in f".{full}",
        ):
            found = [full for full in self._quantities if matches(full)]
            heads = {full[: f".{full}".index(f".{name}")] for full in found}
            robots = heads & {f"{one.name}." for one in self._components.values() if one.kind == "robot"}
            if len(heads) > 1 and len(robots) == 1:
                # the mass of the robot, not that of a link
                (head,) = robots
                return [full for full in found if full == f"{head}{name}" or full.startswith(f"{head}{name}.")]
            if len(heads) > 1:
                several = ", ".join(sorted(f"{head}{name}" for head in heads))
                raise ParameterError(f"{quoted(name)} is the name of several parameters: {several}")
            if found:
                return found
        raise ParameterError(f"there is no parameter {quoted(name)}{nearest(name, self._names(), say='there are')}")

    def _full_names(self, component: str) -> list[str]:
        return [full for full, quantity in self._quantities.items() if quantity.parameter.component == component]

    def _names(self) -> list[str]:
        """What may be written: first the short names of groups, then all full names."""
        names: dict[str, None] = {}
        for full, quantity in self._quantities.items():
            component = quantity.parameter.component
            group = full.removeprefix(f"{component}.").partition(".")[0]
            names[f"{component.partition('.')[2] or ''}.{group}".lstrip(".")] = None
        return [*names, *self._quantities]

    def scene_of(self, values: Mapping[str, float]) -> Scene:
        """A copy of the scene with other values.

        Raises:
            ParameterError: there is no such parameter, or it cannot have the value.
        """
        scene = self.scene.copy()
        apply(scene, values, self)
        return scene

    def put(self, components: Mapping[str, ComponentDeclaration], name: str, value: float) -> None:
        """Set a parameter in a copy of the scene.

        Raises:
            ParameterError: there is no such parameter, or it cannot have the value.
        """
        quantity = self._quantities.get(name)
        if quantity is None:
            raise ParameterError(f"there is no parameter {quoted(name)}{nearest(name, self._names())}")
        one = quantity.parameter
        if not one.low <= value <= one.high or not math.isfinite(value):
            raise ParameterError(f"{name} is {value!r}, expected {one.low:g} to {one.high:g} {one.unit}".rstrip())
        quantity.put(components, value)

    def _fields(self, one: ComponentDeclaration) -> Mapping[str, DataField]:
        declared = self._known_fields.get(one.name) or data_fields(load_class(one.classpath))
        if declared.keys() - {"timestamp"}:
            return declared
        armature = next((node for node in (one.node, *one.node.ancestors()) if node.bones), None)
        bones = () if armature is None else armature.bones
        return {bone.name: DataField(0.0, "float", unit="rad") for bone in bones if bone.kind.has_value}

    # -- which there are -----------------------------------------------------------------------

    def _of(self, one: ComponentDeclaration) -> list[_Quantity]:
        cls = load_class(one.classpath)
        quantities = self._place(one)
        if one.kind == "robot":
            quantities += self._body(one)
        elif one.kind == "sensor":
            quantities += self._sensor(one)
        elif one.kind == "actuator":
            quantities += self._actuator(one)
        taken = {quantity.parameter.name for quantity in quantities}
        return quantities + [one for one in self._properties(one, cls) if one.parameter.name not in taken]

    def _quantity(
        self,
        one: ComponentDeclaration,
        name: str,
        value: float,
        scale: float,
        put: Callable[[ComponentDeclaration, float], object],
        **more: Any,
    ) -> _Quantity:
        own = one.name
        return _Quantity(
            Parameter(f"{own}.{name}", own, float(value), float(scale), **more),
            lambda components, value: put(components[own], value),
        )

    def _place(self, one: ComponentDeclaration) -> list[_Quantity]:
        """The pose of a component on its robot, or of a robot in the world."""
        numbers = [*one.node.location, *one.node.rotation_euler]

        def put(index: int) -> Callable[[ComponentDeclaration, float], object]:
            def put_one(there: ComponentDeclaration, value: float) -> None:
                (there.node.location if index < 3 else there.node.rotation_euler)[index % 3] = value

            return put_one

        return [
            self._quantity(one, f"place.{name}", numbers[index], 0.1, put(index), unit="m" if index < 3 else "rad")
            for index, name in enumerate(_PLACE)
        ]

    def _body(self, one: ComponentDeclaration) -> list[_Quantity]:
        node = one.node
        found = []
        is_of_mjcf = node.articulation is not None and node.articulation.model is not None
        if node.body.moves and not is_of_mjcf:

            def put_mass(there: ComponentDeclaration, value: float) -> None:
                there.node.body.mass = value

            mass = node.body.mass
            found.append(self._quantity(one, "mass", mass, mass, put_mass, unit="kg", low=1e-4 * mass, high=1e4 * mass))

        def put_friction(there: ComponentDeclaration, value: float) -> None:
            for part in _matter(there.node):
                part.body.friction = value

        own = [part.body.friction for part in _matter(node) if part.body.friction is not None]
        tags = [part.properties.get("Friction") for part in node.walk()]
        given = [float(tag) for tag in tags if isinstance(tag, (int, float)) and not isinstance(tag, bool)]
        if node.body.type is not PhysicsType.NO_COLLISION and not is_of_mjcf:
            friction = (own or given or [_FRICTION])[0]
            found.append(self._quantity(one, "friction", friction, 0.5, put_friction, low=0.0, high=100.0))
        for armature in node.walk():
            if armature.bones and not is_of_mjcf:
                found += self._joints(one, armature)
        return [*found, *self._wheeled(one)]

    def _wheeled(self, one: ComponentDeclaration) -> list[_Quantity]:
        """Radius and track, which the drive of the robot is given."""
        radius, track = (self._wheels or {}).get(one.name, (0.0, 0.0))
        drives = [
            other.name
            for other in self.scene.components
            if other.kind == "actuator" and other.robot is one.node and {"v", "w"} <= set(self._fields(other))
        ]
        is_known = bool(radius and track)
        if not drives or (self._wheels is not None and not is_known):
            return []

        def put(option: str) -> Callable[[Mapping[str, ComponentDeclaration], float], object]:
            def put_one(components: Mapping[str, ComponentDeclaration], value: float) -> None:
                for name in drives:
                    _options(components[name])[option] = value

            return put_one

        return [
            _Quantity(
                Parameter(f"{one.name}.{name}", one.name, value, value or 1.0, "m", 1e-3 * value, 1e3 * (value or 1.0)),
                put(name),
            )
            for name, value in (("wheel_radius", radius), ("track", track))
        ]

    def _joints(self, one: ComponentDeclaration, armature: Node) -> list[_Quantity]:
        found = []
        gains = {name: (stiffness, damping) for name, stiffness, damping in _gains(armature)}
        for index, bone in enumerate(armature.bones):
            dynamics = bone.dynamics
            if not bone.kind.has_value or dynamics is None:
                continue
            for what in _JOINT:
                value = getattr(dynamics, what)
                if what in ("gain", "slowing"):
                    value = gains.get(bone.name, (None, None))[what == "slowing"] or value
                    if value is None:
                        continue

                def put(
                    there: ComponentDeclaration,
                    value: float,
                    name: str = armature.name,
                    at: int = index,
                    of: str = what,
                ) -> None:
                    _put_joint(_node(there.node, name), at, of, value)

                found.append(
                    self._quantity(one, f"{bone.name}.{what}", value, abs(value) or 1.0, put, low=0.0, high=1e9)
                )
        for part in one.node.walk():
            if part.inertial is not None and part.inertial.mass > 0.0:

                def put_mass(there: ComponentDeclaration, value: float, name: str = part.name) -> None:
                    _put_mass(there.node, _node(there.node, name), value)

                mass = part.inertial.mass
                # a node of the first link has the name of the robot
                name = f"{part.source_name or part.name}.mass"
                found.append(
                    self._quantity(one, name, mass, mass, put_mass, unit="kg", low=1e-4 * mass, high=1e4 * mass)
                )
        return found

    def _sensor(self, one: ComponentDeclaration) -> list[_Quantity]:
        realism = one.options.get("realism")
        delay = realism.delay if isinstance(realism, RealismModel) else 0.0

        def put_delay(there: ComponentDeclaration, value: float) -> None:
            before = there.options.get("realism")
            model = before if isinstance(before, RealismModel) else RealismModel()
            there.options["realism"] = replace(model, delay=value)

        found = [
            self._quantity(
                one, "delay", delay, 0.1, put_delay, unit="s", low=0.0, high=10.0, correction=Correction("delay")
            )
        ]
        return found + self._corrections(one, is_sensor=True)

    def _actuator(self, one: ComponentDeclaration) -> list[_Quantity]:
        found = [
            self._quantity(
                one, what, _present(one, what, 0.0), 0.1, _put_option(what), unit="s", low=0.0, high=10.0, guess=guess
            )
            # small lags of the same effect as none have no derivative
            for what, guess in (("delay", None), ("lag", 0.03))
        ]
        return found + self._corrections(one, is_sensor=False)

    def _corrections(self, one: ComponentDeclaration, *, is_sensor: bool) -> list[_Quantity]:
        found = []
        for name, field in self._fields(one).items():
            if not field.on_level(one.level) or (is_sensor and (name == "timestamp" or field.follows)):
                continue
            for item, part in _items(field):
                for what, neutral in (("bias", 0.0), ("gain", 1.0)):
                    correction = Correction(what, name, item) if is_sensor else None
                    value = _present_item(one, what, name, item, neutral)
                    found.append(
                        self._quantity(
                            one,
                            f"{what}.{name}{part}",
                            value,
                            0.1 if what == "bias" else 1.0,
                            _put_item(what, name, item, _count(field), neutral),
                            unit=field.unit if what == "bias" else "",
                            correction=correction,
                        )
                    )
        return found

    def _properties(self, one: ComponentDeclaration, cls: type) -> list[_Quantity]:
        found = []
        for declared in properties(cls).values():
            value = one.node.properties.get(declared.name, declared.default)
            if declared.type in ("bool", "string", "int") or isinstance(value, bool):
                continue
            if not isinstance(value, (int, float)) or not math.isfinite(value):
                continue

            def put(there: ComponentDeclaration, value: float, name: str = declared.name) -> None:
                there.node.properties[name] = value

            low = -math.inf if declared.low is None else declared.low
            high = math.inf if declared.high is None else declared.high
            found.append(
                self._quantity(
                    one, declared.name, value, abs(value) or 1.0, put, unit=declared.unit, low=low, high=high
                )
            )
        return found


def _matter(node: Node) -> list[Node]:
    return [part for part in node.walk() if part.body.type is not PhysicsType.NO_COLLISION]


def _node(root: Node, name: str) -> Node:
    return next(part for part in root.walk() if part.name == name)


def apply(scene: Scene, values: Mapping[str, float], parameters: Parameters | None = None) -> None:
    """Change the values of parameters of a scene.

    Raises:
        ParameterError: there is no such parameter, or it cannot have the value.
    """
    known = parameters or Parameters(scene)
    components = {one.name: one for one in scene.components}
    for name, value in values.items():
        known.put(components, name, value)


def _gains(armature: Node) -> Sequence[tuple[str, float | None, float | None]]:
    return armature.articulation.gains if armature.articulation is not None else ()


def _put_joint(armature: Node, index: int, what: str, value: float) -> None:
    bones = list(armature.bones)
    bone: Bone = bones[index]
    if what in ("gain", "slowing") and any(name == bone.name for name, *_ in _gains(armature)):
        assert armature.articulation is not None
        changed = tuple(
            (name, value if what == "gain" else one, value if what == "slowing" else other)
            if name == bone.name
            else (name, one, other)
            for name, one, other in armature.articulation.gains
        )
        armature.articulation = replace(armature.articulation, gains=changed)
        return
    assert bone.dynamics is not None
    changes: dict[str, Any] = {what: value}
    bones[index] = replace(bone, dynamics=replace(bone.dynamics, **changes))
    armature.bones = tuple(bones)


def _put_mass(robot: Node, link: Node, mass: float) -> None:
    """Change the mass of a link, with its inertia in proportion, and that of the robot with it."""
    before = link.inertial
    assert before is not None
    share = mass / before.mass
    link.inertial = replace(before, mass=mass, inertia=tuple(share * number for number in before.inertia))  # type: ignore[arg-type]
    for node in robot.walk():
        if node.articulation is not None and node.articulation.mass:
            whole = node.articulation.mass + mass - before.mass
            # the masses of links are those of the file times this ratio
            node.body.mass *= whole / node.articulation.mass
            node.articulation = replace(node.articulation, mass=whole)


def _options(one: ComponentDeclaration) -> dict[str, object]:
    """The options of the calibration of a component, which is created before its other modifiers."""
    for modifier in one.modifiers:
        if modifier.classpath == _CALIBRATION:
            return modifier.options
    one.modifiers.insert(0, ModifierDeclaration(_CALIBRATION, {}, one.where))
    return one.modifiers[0].options


def _present(one: ComponentDeclaration, what: str, neutral: Any) -> Any:
    for modifier in one.modifiers:
        if modifier.classpath == _CALIBRATION:
            return modifier.options.get(what, neutral)
    return neutral


def _present_item(one: ComponentDeclaration, what: str, field: str, item: int, neutral: float) -> float:
    numbers = np.atleast_1d(_present(one, what, {}).get(field, neutral))
    return float(numbers[min(max(item, 0), len(numbers) - 1)])


def _put_option(what: str) -> Callable[[ComponentDeclaration, float], object]:
    def put(there: ComponentDeclaration, value: float) -> None:
        _options(there)[what] = value

    return put


def _put_item(
    what: str, field: str, item: int, count: int, neutral: float
) -> Callable[[ComponentDeclaration, float], object]:
    def put(there: ComponentDeclaration, value: float) -> None:
        options = _options(there)
        tables: Any = options.get(what, {})
        table = options[what] = dict(tables)
        if item < 0:
            table[field] = value
            return
        numbers = np.broadcast_to(np.asarray(table.get(field, neutral), float), count).tolist()
        numbers[item] = value
        table[field] = numbers

    return put


def _count(field: DataField) -> int:
    """Number of items of a field; -1 for one that is a single number, 0 for one that is none."""
    default = field.default
    if isinstance(default, bool) or field.quaternion:
        return 0
    if isinstance(default, (int, float)):
        return 0 if field.type in ("int", "integer", "bool") else -1
    if isinstance(field.shape, int):
        return field.shape
    try:
        numbers = [*default]
    except TypeError:
        return 0
    is_vector = all(isinstance(one, (int, float)) and not isinstance(one, bool) for one in numbers)
    return len(numbers) if is_vector else 0


def _items(field: DataField) -> list[tuple[int, str]]:
    """The items of a field, and what their names end with."""
    count = _count(field)
    if count == -1:
        return [(-1, "")]
    if not 0 < count <= _MOST_ITEMS:
        return []
    return [(item, f".{_AXES[item] if count <= len(_AXES) else item}") for item in range(count)]


# -- presets ---------------------------------------------------------------------------------


def read_preset(path: str | os.PathLike[str]) -> dict[str, float]:
    """The values in a preset.

    Raises:
        ParameterError: there is no such file, or it is no preset.
    """
    file = Path(path)
    try:
        content = json.loads(read_regular(file, _LARGEST))
    except OSError as error:
        near = nearest(file.name, [one.name for one in file.parent.glob("*.json")]) if file.parent.is_dir() else ""
        raise ParameterError(f"the preset {file} cannot be read: {error.strerror or error}{near}") from None
    except (ValueError, RecursionError) as error:
        raise ParameterError(f"{file} is no preset: {str(error)[:200]}") from None
    if not isinstance(content, dict) or content.get(FORMAT) != PRESENT or not isinstance(content.get("values"), dict):
        raise ParameterError(
            f'{file} is no preset: expected {{"{FORMAT}": {PRESENT}, "values": {{NAME: NUMBER, ...}}}}'
        )
    values = content["values"]
    if len(values) > _MOST:
        raise ParameterError(f"{file} has more than {_MOST:,} values")
    for name, value in values.items():
        if isinstance(value, bool) or not isinstance(value, (int, float)) or not abs(value) <= GREATEST:
            raise ParameterError(f"{file}: {quoted(name)} is {quoted(value)}, expected a number")
    return {name: float(value) for name, value in values.items()}


def preset_text(values: Mapping[str, float], spreads: Mapping[str, float], facts: Mapping[str, object]) -> str:
    """The content of a preset.

    Args:
        values, spreads: by the names of parameters.
        facts: what else a reader wants to know, such as the name of the log.
    """
    content = {FORMAT: PRESENT, **facts, "values": dict(values), "spreads": dict(spreads)}
    return json.dumps(content, indent=1, ensure_ascii=False, default=str) + "\n"


def preset(environment: Environment, file: str | os.PathLike[str]) -> None:
    """Set parameters of the scene to the values in a file of ``morse twin``: ``env.preset("drive.json")``.

    Args:
        file: its path; a relative one begins at the folder of the scene script, else at the present one.

    Raises:
        ParameterError: there is no such file, or it is no preset.
    """
    if not isinstance(file, (str, os.PathLike)):
        raise ParameterError(f"env.preset takes the path of a file, not {quoted(file)}")
    path = Path(file)
    where = environment.where
    beside = Path(where.file).parent / path if where is not None else path
    values = read_preset(path if path.is_file() and not beside.is_file() else beside)
    environment.when_complete(lambda scene: apply(scene, values))
