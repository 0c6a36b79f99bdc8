"""The base class of everything in a scene."""

from __future__ import annotations

import inspect
import logging
from abc import ABCMeta
from typing import TYPE_CHECKING, Any, cast

from morse.builder import workspace
from morse.builder.compatibility import call_of_today
from morse.builder.components.interfaces import Interfaces
from morse.builder.components.models import Models
from morse.builder.data import Configuration
from morse.builder.errors import checks
from morse.builder.errors.checks import hint_at_radians
from morse.builder.errors.declared import check_declared
from morse.builder.names import frames, naming
from morse.builder.names.catalog import load_class
from morse.builder.names.part import Part, Strength
from morse.builder.objects import SceneObject, checked_property, timer
from morse.core.exceptions import MorseBuilderError
from morse.scene import ComponentDeclaration

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from morse.builder.objects import LiveEuler, LiveVector
    from morse.core.values import Properties, Value
    from morse.scene import Node, SourceLine


class Placement:
    """The part of `AbstractComponent` for its pose."""

    _bpy_object: SceneObject

    @property
    def location(self) -> LiveVector:
        """Position in the frame of the parent, m; can be changed in place."""
        return self._bpy_object.location

    @location.setter
    def location(self, value: Iterable[float]) -> None:
        self._bpy_object.location = value

    @property
    def rotation_euler(self) -> LiveEuler:
        """Euler angles, rad, XYZ order; can be changed in place."""
        return self._bpy_object.rotation_euler

    @rotation_euler.setter
    def rotation_euler(self, value: Iterable[float]) -> None:
        self._bpy_object.rotation_euler = value

    @property
    def scale(self) -> LiveVector:
        """Scale along each axis; can be changed in place."""
        return self._bpy_object.scale

    @scale.setter
    def scale(self, value: Iterable[float]) -> None:
        self._bpy_object.scale = value

    def translate(self, x: float = 0.0, y: float = 0.0, z: float = 0.0) -> None:
        """Translate it along the axes of the parent, m."""
        self._add(self._bpy_object.node.location, (x, y, z), "translate")

    def rotate(self, x: float = 0.0, y: float = 0.0, z: float = 0.0) -> None:
        """Add angles to its roll, pitch and yaw, rad."""
        hint_at_radians(f"{type(self).__name__}.rotate", (x, y, z))
        self._add(self._bpy_object.node.rotation_euler, (x, y, z), "rotate")

    def _add(self, target: list[float], values: tuple[object, object, object], method: str) -> None:
        what = f"{type(self).__name__}.{method}"
        steps = [checks.number(value, f"{what}({axis})") for axis, value in zip("xyz", values, strict=True)]
        target[:] = [old + step for old, step in zip(target, steps, strict=True)]


__all__ = ["AbstractComponent", "Configuration", "timer"]

logger = logging.getLogger(__name__)

#: default frequency, Hz; the frequency of the simulation is at least that of its fastest component
HIGHEST_FREQUENCY = 10_000.0


class _Whole(ABCMeta):
    """Creates components; nothing stays in the scene of one whose constructor fails, because a script may continue."""

    if not TYPE_CHECKING:  # type checkers read the constructors

        def __call__(cls, *args: object, **kwargs: object) -> Any:
            before = workspace.current().mark()
            try:
                return super().__call__(*args, **kwargs)
            except BaseException:
                workspace.current().return_to(before)
                raise

        @property
        def __signature__(cls) -> inspect.Signature:
            """For `help` and `inspect`, which would show that of `__call__`."""
            of_constructor = inspect.signature(cls.__init__)
            return of_constructor.replace(
                parameters=[*of_constructor.parameters.values()][1:], return_annotation=inspect.Signature.empty
            )


class AbstractComponent(Placement, Interfaces, Models, Part, metaclass=_Whole):
    """A robot, a sensor, an actuator or another object of the scene.

    Attributes:
        parent: the component to which it is attached, or None.
        children: the components attached to it.
        basename: its name without the names of its parents, or None until it has a name.
        name_strength: source of ``basename``.
        _where: the line of the script that created it.
    """

    #: ``robot``, ``sensor``, ``actuator``, or empty for an object without behaviour
    _kind = ""

    def __init__(self, obj: SceneObject | None = None, filename: str = "", category: str = "") -> None:
        naming.guess_names()
        self.parent: AbstractComponent | None = None
        self.children: list[AbstractComponent] = []
        self.basename: str | None = None
        self.name_strength = Strength.NONE
        self._where: SourceLine | None = frames.source_line(self)
        self._blendname = filename
        self._category = category
        self._frequency: float | None = None
        #: whether its frequency, which a file sets, is at most that of the simulation
        self._keeps_tick = False
        #: the line of the script that has set the frequency
        self._rate_where: SourceLine | None = None
        self._exportable = True
        self._profiled = False
        self._is_optional = False
        self._init_interfaces()
        if obj is not None:
            self.set_blender_object(obj)

    if not TYPE_CHECKING:  # hidden from type checkers, so that they report misspelt names

        def __getattr__(self, name: str) -> Any:
            if not self.is_complete:
                # also called for properties whose object does not exist
                raise AttributeError(
                    f"this {type(self).__name__} is not complete (no {name}): its __init__ has to call the __init__ of "
                    f"its base class, {type(self).__mro__[1].__name__}, first",
                    name=name,
                    obj=self,
                )
            if name.startswith("_"):
                raise AttributeError(f"{type(self).__name__} has no attribute '{name}'", name=name, obj=self)
            return checks.missing_attribute(self, name)

    def __repr__(self) -> str:
        return f"<{type(self).__name__} '{self.name}'>" if self.is_complete else f"<{type(self).__name__}>"

    # --- the object -------------------------------------------------------------------------

    @property
    def is_complete(self) -> bool:
        """Whether it has an object of the scene."""
        return "_bpy_object" in self.__dict__

    @property
    def is_robot(self) -> bool:
        """Whether it can carry sensors and actuators."""
        return self._kind == "robot"

    @property
    def scene_node(self) -> Node:
        """The node of the scene."""
        return self._bpy_object.node

    def set_blender_object(self, obj: SceneObject) -> None:
        """Make an object of the scene the body of this component."""
        if not isinstance(obj, SceneObject):
            raise TypeError(f"set_blender_object takes an object of the scene, got {checks.shown(obj)}")
        if not self.is_complete:
            # not checked earlier: a script may continue after a model was not found
            workspace.current().register(self)
        self._bpy_object = obj

    def select(self) -> None:
        """Select its object (see `morse.builder.bpymorse`)."""
        workspace.current().selected = self.scene_node

    # --- names ------------------------------------------------------------------------------

    @property
    def name(self) -> str:
        """The name in the scene; fully qualified (``robot.arm.pose``) after the environment is created."""
        return self._bpy_object.name

    @name.setter
    def name(self, value: str) -> None:
        new_name = naming.check_given_name(value)
        if self._kind:
            naming.check_address(new_name)
        self.basename = new_name
        self.name_strength = Strength.GIVEN
        self._bpy_object.name = value

    @staticmethod
    def close_context(level: int = 1) -> None:
        """Name the components after the variables that refer to them now.

        Call it at the end of the body of a loop or function that creates components, before the variables get other
        values.

        Args:
            level: stack level of the variables: 1 for the calling function, 2 for its caller, ...
        """
        frame = frames.frame_above(checks.integer(level, "close_context(level)", minimum=1))
        if frame is not None:
            naming.name_unparented(frame.f_locals, Strength.VARIABLE)

    # --- the tree ---------------------------------------------------------------------------

    def append(self, obj: AbstractComponent, child: str | None = None, level: int = 1) -> None:
        """Attach a component to this one; it is named after the variable or attribute that refers to it.

        Args:
            obj: the component; its pose becomes relative to this one. An object that is already below this one, such as
                an armature of the model of a robot, keeps its pose.
            child: name of an object below this one, to which the component is attached instead.
            level: stack level of the variables that are searched for the name: 1 for the caller.

        Raises:
            MorseBuilderError: there is no such child, or the component would be its own ancestor.
        """
        if not isinstance(obj, AbstractComponent):
            given = f"the class: write {obj.__name__}()" if isinstance(obj, type) else checks.shown(obj)
            raise TypeError(f"{type(self).__name__}.append takes a component such as Pose(), got {given}")
        mount = self._bpy_object if child is None else self._named_child(child)
        frame = frames.frame_above(level)
        if frame is not None:
            if (name := naming.name_in_frame(obj, self, frame)) is not None:
                obj.suggest_name(name, Strength.VARIABLE)
            naming.name_unparented(frame.f_locals, Strength.GUESSED)
        # an object of the model that is already below this one keeps its pose
        is_below = obj.parent is None and any(above is mount.node for above in obj.scene_node.ancestors())
        try:
            if not is_below:
                workspace.current().attach(mount.node, obj.scene_node)
        except ValueError:
            raise MorseBuilderError(f"'{obj.name}' cannot be appended to '{self.name}', which is part of it") from None
        if obj.parent is not None:
            mend = "leave it out" if obj.parent is self else "create a component for each of them"
            logger.warning("'%s' was appended to '%s' before: %s", obj.name, obj.parent.name, mend)
            obj.parent.children.remove(obj)
        obj.parent = self
        self.children.append(obj)

    def _named_child(self, name: str) -> SceneObject:
        child = self.get_child(name)
        if child is None:
            candidates = [node.plain_name for node in self.scene_node.walk() if node is not self.scene_node]
            raise MorseBuilderError(f"'{self.name}' has no child '{name}'{checks.suggestion(name, candidates)}")
        return child

    def get_child(
        self, name: str, objects: Iterable[SceneObject] | None = None, recursive: bool = True
    ) -> SceneObject | None:
        """Return the object of that name below this one, else the object with the shortest matching prefix, else None.

        Args:
            name: without the copy suffix that Blender adds (``left_eye`` for ``left_eye.001``).
            objects: objects to search instead of the children.
            recursive: whether to search the whole tree.
        """
        nodes = [obj.node for obj in (self._bpy_object.children if objects is None else objects)]
        if recursive:
            nodes = [node for top in nodes for node in top.walk()]
        found = find_part(nodes, name)
        return None if found is None else SceneObject(found)

    def _walk(self) -> Iterator[AbstractComponent]:
        """Return this component and all components below it."""
        yield self
        for child in self.children:
            yield from child._walk()

    # --- properties -------------------------------------------------------------------------

    def properties(self, **kwargs: Value) -> None:
        """Set properties: parameters of the component, or tags that other components use.

        A property that the component does not declare is kept, with a warning.
        """
        properties: Properties = kwargs
        if "classpath" in kwargs:
            self.classpath = kwargs["classpath"]
        elif self._kind in ("sensor", "actuator") and (cls := self.component_class()) is not None:
            properties = check_declared(cls, kwargs)
        elif self._kind == "robot" and (cls := self.component_class()) is not None:
            properties = check_declared(cls, kwargs, has_own=True)
        for key, value in properties.items():
            self.scene_node.properties[key] = checked_property(key, value)
        if "frequency" in properties:
            self.frequency(cast("float", properties["frequency"]))

    def property_value(self, name: str) -> Value:
        """Return the value of a property, or None if it is not set."""
        return self.scene_node.properties.get(name)

    def frequency(self, frequency: float | None = None, **earlier: object) -> None:
        """Set the frequency, Hz (per simulated second); None leaves it as it is.

        Args:
            **earlier: arguments of earlier versions, as plug-ins understand them.
        """
        if earlier:
            frequency = call_of_today(self, "frequency", {"frequency": frequency}, earlier)["frequency"]
        if frequency is not None:
            self._set_frequency(frequency)

    def _set_frequency(self, frequency: float) -> None:
        self._keeps_tick = False
        what = f"{type(self).__name__}.frequency(hz)"
        self._frequency = checks.number(frequency, what, above=0.0, maximum=HIGHEST_FREQUENCY)
        self._rate_where = frames.calling_line()
        self.scene_node.properties["frequency"] = self._frequency

    def profile(self) -> None:
        """Show the share of time that a sensor uses while the simulation runs."""
        if self._kind != "sensor":
            logger.warning("%s is not a sensor: profile() has no effect on it", self.name)
            return
        self._profiled = True

    def set_color(self, r: float = 0.0, g: float = 0.0, b: float = 0.0) -> None:
        """Give all its surfaces one colour: red, green, blue, 0..1."""
        rgb = checks.color((r, g, b), f"{type(self).__name__}.set_color")
        for node in self.own_nodes():
            if node.mesh is not None:
                node.color = (*rgb, 1.0)

    def own_nodes(self) -> Iterator[Node]:
        """Return the nodes of its model, without those of attached components."""
        others = {component.scene_node for component in self._walk() if component is not self}
        stack = [self.scene_node]
        while stack:
            node = stack.pop()
            yield node
            stack.extend(child for child in reversed(node.children) if child not in others)

    # --- the component class ----------------------------------------------------------------

    @property
    def classpath(self) -> str | None:
        """Class path of the component class, or None for an object without behaviour."""
        found = self.scene_node.properties.get("classpath")
        return None if found is None else str(found)

    @classpath.setter
    def classpath(self, value: str) -> None:
        self.scene_node.properties["classpath"] = checks.text(value, "classpath")

    def component_class(self) -> type | None:
        """Load the class of `classpath`.

        Raises:
            MorseBuilderNoComponentError: it cannot be loaded.
        """
        return None if self.classpath is None else load_class(self.classpath)

    def is_morseable(self) -> bool:
        """Whether it has a component class."""
        return self.classpath is not None

    def morseable(self, calling_module: str | None = None) -> None:
        """Assign a component class.

        Args:
            calling_module: class path of the component class, if the builder class does not define it.
        """
        classpath = calling_module or getattr(type(self), "_classpath", None)
        if classpath is None:
            raise MorseBuilderError(
                f"{type(self).__name__} does not declare a component class: give the path of a class, e.g. "
                "morseable('my_sim.sensors.sonar.Sonar')"
            )
        self.scene_node.properties["Component_Tag"] = True
        self.scene_node.properties["classpath"] = checks.text(classpath, "morseable(calling_module)")

    def is_exportable(self) -> bool:
        """Whether it has data that can be streamed."""
        return self._exportable

    def mark_unexportable(self) -> None:
        """Declare that it has no data to stream."""
        self._exportable = False

    def _declaration(self, robot: AbstractComponent) -> ComponentDeclaration:
        """Return the declaration of this component on ``robot`` for the simulation."""
        return ComponentDeclaration(
            node=self.scene_node,
            kind=self._scene_kind(),
            classpath=self.classpath or "",
            robot=robot.scene_node,
            frequency=self._frequency,
            level=self._level,
            streams=list(self._streams),
            managers=list(self._managers),
            modifiers=list(self._modifiers),
            overlays=list(self._overlays),
            options=self._scene_options(),
            profile=self._profiled,
            where=self._where,
            is_optional=self._is_optional,
            measures_joint=self._kind == "sensor" and bool(getattr(self.component_class(), "measures_joint", False)),
        )

    def _scene_kind(self) -> str:
        return self._kind

    def _scene_options(self) -> Properties:
        """The part of the declaration that depends on the kind of component."""
        return {}


def find_part(nodes: Sequence[Node], name: str) -> Node | None:
    """The node of that name, else the node with the shortest matching prefix, else None."""
    # one after the other: a robot of 1,000 sensors is searched 1,000 times
    found = next((node for node in nodes if node.name == name), None)
    found = found or next((node for node in nodes if node.plain_name == name), None)
    prefixed = (node for node in nodes if node.plain_name.startswith(name))
    return found or min(prefixed, key=lambda node: len(node.plain_name), default=None)
