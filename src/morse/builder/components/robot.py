"""Robots."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import PurePath
from typing import TYPE_CHECKING

from morse.builder.components.component import Component
from morse.builder.components.matter import Matter, set_collision
from morse.builder.errors import checks
from morse.builder.objects import material_slots
from morse.core.exceptions import MorseBuilderError
from morse.mathutils import Matrix, Quaternion
from morse.middleware import registry
from morse.scene import Bounds
from morse.scene.articulation import start_frames

if TYPE_CHECKING:
    from collections.abc import Mapping

    from morse.builder.abstractcomponent import AbstractComponent
    from morse.core.values import Options, Properties
    from morse.scene import ComponentDeclaration, Library, Material, Node
    from morse.scene.articulation import BonePose


def set_keyframe(root: Node, library: Library, name: str) -> None:
    """Give a robot the joint values and the place of a keyframe of its file.

    Raises:
        MorseBuilderError: the file has no such keyframe.
    """
    keyframe = library.keyframes.get(name)
    if keyframe is None:
        names = ", ".join(f"'{one}'" for one in library.keyframes) or "none"
        raise MorseBuilderError(
            f"{library.path} has no keyframe '{name}'{checks.suggestion(name, library.keyframes)}; it has: {names}"
        )
    if keyframe.place is not None:
        position, quaternion = keyframe.place
        root.location = list(position)
        root.rotation_euler = list(Quaternion(quaternion).to_euler())
    for armature in [node for node in root.walk() if node.bones]:
        before = [_matrix(frame) for frame in start_frames(armature.bones)]
        armature.bones = tuple(
            replace(bone, value=keyframe.joints[bone.name][0])
            if bone.kind.has_value and bone.name in keyframe.joints
            else bone
            for bone in armature.bones
        )
        after = [_matrix(frame) for frame in start_frames(armature.bones)]
        index = {bone.name: number for number, bone in enumerate(armature.bones)}
        for child in armature.children:
            if child.bone in index:
                number = index[child.bone]
                place = after[number] @ before[number].inverted() @ child.basis_matrix()
                child.location, child.rotation_euler = list(place.translation), list(place.to_euler())


def _matrix(frame: BonePose) -> Matrix:
    (x, y, z), r = frame
    matrix = Matrix((r[:3], r[3:6], r[6:])).to_4x4()
    matrix.translation = (x, y, z)
    return matrix


class Robot(Matter, Component):
    """A body that carries sensors and actuators.

    Args:
        filename: name of the model in ``robots`` (see `morse.assets.find`); empty for a robot
            without a body.
        name: its name, if it differs from the name of the variable that refers to it.
        blender_object_name: the object of the file that is the body; None for the object without a parent.
        sensors: whether the sensors that the file declares (URDF, SDF, MJCF), and the actuators that its plugins stand
            for, are created.
        arguments: of a file of xacro.
        keyframe: name of the pose of an MJCF file in which the robot starts; empty for that of the bodies of the file.
        collision: collision shapes of its meshes, see `PassiveObject`; None for those of the file.

    Attributes:
        sensors: the sensors that the file declares, by name.
        actuators: the actuators that plugins of the file stand for, by name.
    """

    _kind = "robot"
    _classpath: str = "morse.core.robot.Robot"

    def __init__(
        self,
        filename: str = "",
        name: str | None = None,
        blender_object_name: str | None = None,
        *,
        sensors: bool = True,
        keyframe: str = "",
        collision: str | None = None,
        arguments: Mapping[str, object] | None = None,
    ) -> None:
        if arguments:
            self._arguments = {str(name): str(value) for name, value in arguments.items()}
        super().__init__("robots", filename, blender_object_name, make_morseable=False)
        self.default_interfaces: list[str] = []
        self.is_external = False
        self.records_animation = False
        if not self.is_morseable():
            self.morseable()
        self.scene_node.properties.pop("Component_Tag", None)
        self.scene_node.properties["Robot_Tag"] = True
        if name is not None:
            self.name = name
        self.sensors: dict[str, AbstractComponent] = {}
        self.actuators: dict[str, AbstractComponent] = {}
        if not filename:
            return
        if collision is not None:
            set_collision(self.own_nodes(), collision, "Robot(collision)")
        library = self._library()
        if keyframe:
            set_keyframe(self.scene_node, library, checks.text(keyframe, "Robot(keyframe)"))
        if sensors and (library.sensors or library.actuators):
            from morse.builder.components.file_sensors import add_sensors

            names = {node.source_name for node in self.own_nodes()}
            file = PurePath(library.path).name
            for package, parts, declarations in (
                ("actuators", self.actuators, library.actuators),
                ("sensors", self.sensors, library.sensors),
            ):
                parts.update(add_sensors(self, [one for one in declarations if one.link in names], file, package))

    def add_default_interface(self, stream: str) -> None:
        """Connect all components of the robot to a middleware; existing streams are not changed.

        Args:
            stream: name of a middleware.

        Raises:
            MorseMiddlewareError: unknown middleware.
        """
        name = registry.middleware(checks.text(stream, "add_default_interface(stream)")).name
        if name not in self.default_interfaces:
            self.default_interfaces.append(name)

    def add_stream(
        self,
        datastream: str,
        method: str | None = None,
        path: str | None = None,
        classpath: str | None = None,
        direction: str | None = None,
        **kwargs: object,
    ) -> None:
        """Stream the data of each component of the robot that the middleware carries.

        Args:
            datastream: name of a middleware.
            method, path, classpath, direction: see the method of components, for a robot that has data itself.
            **kwargs: options of the streams.

        Raises:
            MorseMiddlewareError: unknown middleware.
            MorseBuilderUnexportableError: the robot has no component with data.
        """
        parts = [part for part in self._walk() if part is not self and part._kind in ("sensor", "actuator")]
        if method or path or classpath or direction or not parts:
            super().add_stream(datastream, method, path, classpath, direction, **kwargs)
            return
        middleware = registry.middleware(checks.text(datastream, "add_stream(datastream)"))
        for part in parts:
            if part._can_stream(middleware):
                self._stream(part, middleware.name, kwargs)

    def _stream(self, part: AbstractComponent, middleware: str, options: Options) -> None:
        part.add_stream(middleware, **options)

    # --- physics ----------------------------------------------------------------------------

    def set_collision_bounds(self) -> None:
        """Use the convex hulls of all parts of the model as collision shapes of one body."""
        self.scene_node.body.bounds = Bounds.CONVEX_HULL
        self.scene_node.body.compound = True

    def make_ghost(self, alpha: float = 0.3) -> None:
        """Make the robot transparent, and disable its collisions.

        Args:
            alpha: opacity from 0 (invisible) to 1.
        """
        opacity = checks.share(alpha, "make_ghost(alpha)")
        self.set_no_collision()
        copies: dict[Material, Material] = {}
        for node in self.own_nodes():
            _set_opacity(node, opacity, copies)

    # --- roles ------------------------------------------------------------------------------

    def make_external(self) -> None:
        """Let another simulation node control the robot."""
        self.is_external = True
        self.scene_node.properties.pop("Robot_Tag", None)
        self.scene_node.properties["External_Robot_Tag"] = True

    def set_use_record_animation(self, record: bool = True) -> None:
        """Record the motion of this robot if the scene is recorded (``env.set_animation_record``)."""
        self.records_animation = checks.boolean(record, "set_use_record_animation(record)")

    def make_grasper(self, obj_name: str) -> None:
        """Let a part of the robot grasp objects.

        Args:
            obj_name: name of the object below the robot: its hand.

        Raises:
            MorseBuilderError: the robot has no such part.
        """
        child = self.get_child(checks.text(obj_name, "make_grasper(obj_name)"))
        if child is None:
            parts = [node.plain_name for node in self.own_nodes()]
            raise MorseBuilderError(f"'{self.name}' has no part '{obj_name}'{checks.suggestion(obj_name, parts)}")
        child.node.properties["Grasper"] = True

    def _scene_kind(self) -> str:
        return "external_robot" if self.is_external else "robot"

    def _declaration(self, robot: AbstractComponent) -> ComponentDeclaration:
        declaration = super()._declaration(robot)
        # its node moves it, with its wheels and legs
        return (
            replace(declaration, classpath=Robot._classpath, options={}, streams=[], managers=[])
            if self.is_external
            else declaration
        )

    def _scene_options(self) -> Properties:
        return {"record_animation": True} if self.records_animation else {}


class GroundRobot(Robot):
    """A ground robot: commands leave its vertical speed, roll and pitch to the physics."""

    _classpath = "morse.robots.groundrobot.GroundRobot"

    def __init__(self, filename: str = "", name: str | None = None, blender_object_name: str | None = None) -> None:
        super().__init__(filename, name, blender_object_name)
        self.scene_node.properties["GroundRobot"] = True


#: parts whose names contain these words are not raised with the body
_BELOW_THE_BODY = ("wheel", "caster", "swivel")


class WheeledRobot(Robot):
    """A robot with physical wheels.

    Wheels are the objects below the body whose names contain ``wheel``, but not ``caster``, and that collide.
    """

    _classpath = "morse.core.wheeled_robot.PhysicsDifferentialRobot"

    def __init__(self, filename: str = "", name: str | None = None, blender_object_name: str | None = None) -> None:
        super().__init__(filename, name, blender_object_name)
        self._has_free_wheels = False

    def unparent_wheels(self) -> None:
        """Prepare the wheels, and raise the body by its ``RideHeight``; called by the environment.

        A script may call it, too; further calls have no effect.
        """
        if self._has_free_wheels:
            return
        self._has_free_wheels = True
        height = self.ride_height()
        self.scene_node.location[2] += height
        # of the model: wheel encoders, for example, stay where the script has put them
        own = {*self.own_nodes()}
        for node in self.scene_node.children:
            if node in own and any(word in node.plain_name.lower() for word in _BELOW_THE_BODY):
                node.location[2] -= height

    def ride_height(self) -> float:
        """Height of the body above its wheels, relative to the model: the property ``RideHeight``, m."""
        height = self.property_value("RideHeight") or 0.0
        return float(height) if isinstance(height, (int, float)) and math.isfinite(height) else 0.0

    def wheels(self) -> list[Node]:
        """The wheels."""
        return [
            node
            for node in self.own_nodes()
            if node is not self.scene_node
            and "wheel" in node.plain_name.lower()
            and "caster" not in node.plain_name.lower()
            and node.body.collides
        ]

    def _scene_options(self) -> Properties:
        options = super()._scene_options()
        if self._has_free_wheels:
            options["wheels"] = [node.name for node in self.wheels()]
        return options


def _set_opacity(node: Node, alpha: float, copies: dict[Material, Material]) -> None:
    if node.color is not None:
        node.color = (*node.color[:3], alpha)
    slots = material_slots(node)
    for material in slots:
        if material is not None and material not in copies:
            copies[material] = replace(material, color=(*material.color[:3], alpha))
    node.materials[:] = [None if material is None else copies[material] for material in slots]


def connect(robot: AbstractComponent, interface: str) -> None:
    """Connect the components of a robot to a middleware, except those that are already connected."""
    for component in robot._walk():
        if component.is_morseable() and not component.is_robot:
            component._add_missing_interface(interface)
