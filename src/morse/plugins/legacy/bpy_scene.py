"""``bpy.context.scene``: world, game settings and camera under the names of Blender, and its objects."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

from morse.builder import bpymorse, workspace
from morse.builder.errors import checks
from morse.builder.objects import LiveEuler, LiveVector, NamedList, SceneObject
from morse.builder.workspace import notice
from morse.plugins.legacy.blender import Facade
from morse.plugins.legacy.bpymorse import set_frequency
from morse.plugins.legacy.object_data import CameraData, LampData, MeshData, take_data
from morse.scene import Mist, Node

if TYPE_CHECKING:
    from collections.abc import Iterable

    from morse.scene import Settings, ViewSettings

NAME = "CameraFP"


def _view() -> ViewSettings:
    return workspace.current().settings.view


class _Place(LiveVector):
    """The position of the camera; assigning items moves it."""

    def __setitem__(self, index: object, value: object) -> None:
        super().__setitem__(index, value)
        x, y, z = self
        _view().camera_location = (x, y, z)


class _Turn(LiveEuler):
    """The angles of the camera; assigning items turns it."""

    def __setitem__(self, index: object, value: object) -> None:
        super().__setitem__(index, value)
        x, y, z = self
        _view().camera_rotation = (x, y, z)


class Viewpoint(Facade):
    """The camera of the live view under the names of an object of Blender."""

    _path = NAME
    name = NAME
    type = "CAMERA"

    @property
    def data(self) -> Lens:
        """Its lens."""
        return Lens()

    @property
    def location(self) -> LiveVector:
        """Position in the world, m."""
        return _Place(list(_view().camera_location), "location")

    @location.setter
    def location(self, value: Iterable[float]) -> None:
        _view().camera_location = checks.triple(value, "location")

    @property
    def rotation_euler(self) -> LiveEuler:
        """Euler angles, rad, XYZ order."""
        return _Turn(list(_view().camera_rotation), "rotation_euler")

    @rotation_euler.setter
    def rotation_euler(self, value: Iterable[float]) -> None:
        _view().camera_rotation = checks.triple(value, "rotation_euler")


class Lens(Facade):
    """The lens of the view."""

    _path = f"{NAME}.data"
    name = NAME

    @property
    def clip_start(self) -> float:
        """Distance of the near plane, m."""
        return _view().camera_clip[0]

    @clip_start.setter
    def clip_start(self, value: object) -> None:
        _view().camera_clip = (checks.number(value, "clip_start", above=0.0), self.clip_end)

    @property
    def clip_end(self) -> float:
        """Distance of the far plane, m."""
        return _view().camera_clip[1]

    @clip_end.setter
    def clip_end(self, value: object) -> None:
        _view().camera_clip = (self.clip_start, checks.number(value, "clip_end", above=0.0))

    @property
    def lens(self) -> float:
        """Focal length, mm, for a sensor 32 mm wide."""
        return _view().camera_focal_length

    @lens.setter
    def lens(self, value: object) -> None:
        _view().camera_focal_length = checks.number(value, "lens", above=0.0)


_Data = MeshData | LampData | CameraData | None


class Objects(NamedList[Any]):
    """All objects of the scene, and the camera of the view."""

    def __init__(self) -> None:
        objects: list[Any] = list(bpymorse.get_objects())
        if all(item.name != NAME for item in objects):
            objects.append(Viewpoint())
        super().__init__(objects, "object")

    @property
    def active(self) -> SceneObject | None:
        """The object that operators change."""
        return bpymorse.get_context_object()

    @active.setter
    def active(self, obj: SceneObject | None) -> None:
        workspace.current().selected = None if obj is None else obj.node

    def new(self, name: str, object_data: _Data = None) -> SceneObject:
        """Create an object; it is part of the scene at once.

        Args:
            name: its name.
            object_data: a mesh, lamp or camera of ``bpy.data``, or None for an empty object.
        """
        node = Node(checks.text(name, "bpy.data.objects.new(name)"))
        if object_data is not None:
            node.body.type = object_data._node.body.type
            take_data(node, object_data)
            # the data belong to the object from now on
            object_data._node = node
        workspace.current().add(node)
        return SceneObject(node)

    def link(self, obj: SceneObject) -> None:
        """Accepted for old scripts: objects are part of the scene from the beginning."""

    def unlink(self, obj: SceneObject) -> None:
        """Remove an object from the scene."""
        bpymorse.delete(obj)

    def remove(self, obj: Any, *_: object, **__: object) -> None:
        """Remove an object from the scene."""
        bpymorse.delete(obj)


def _settings() -> Settings:
    return workspace.current().settings


class Scene(Facade):
    """The scene that is being described."""

    _path = "bpy.context.scene"
    name = "Scene"
    frame_start = 1
    frame_end = 250

    @property
    def objects(self) -> Objects:
        """All objects."""
        return Objects()

    @property
    def world(self) -> World:
        """Sky and mist."""
        return World()

    @world.setter
    def world(self, value: object) -> None:
        if not isinstance(value, World):
            notice("bpy.context.scene.world has no effect: there is one world")

    @property
    def camera(self) -> Viewpoint:
        """The camera of the view."""
        return Viewpoint()

    @camera.setter
    def camera(self, value: object) -> None:
        if not isinstance(value, Viewpoint):
            notice("bpy.context.scene.camera has no effect: write env.set_camera_location and env.set_camera_rotation")

    @property
    def game_settings(self) -> GameSettings:
        """Gravity, frequency and overlays."""
        return GameSettings()

    @property
    def render(self) -> Render:
        """Settings for pictures."""
        return Render()

    @property
    def cursor_location(self) -> tuple[float, float, float]:
        """The origin: where operators create objects without a location."""
        return (0.0, 0.0, 0.0)

    @cursor_location.setter
    def cursor_location(self, value: object) -> None:
        notice("bpy.context.scene.cursor_location has no effect: give the location to the operator")

    def update(self) -> None:
        """Accepted for old scripts: poses are always up to date."""

    frame_current = frame_start

    def frame_set(self, frame: int, *_: object) -> None:
        """Accepted for old scripts: there are no animations."""


class World(Facade):
    """Sky, ambient light and mist."""

    _path = "bpy.context.scene.world"
    name = "World"

    @property
    def horizon_color(self) -> tuple[float, float, float]:
        """Colour of the sky, 0..1."""
        return _settings().view.horizon_color or (0.05, 0.22, 0.4)

    @horizon_color.setter
    def horizon_color(self, value: Iterable[float]) -> None:
        _settings().view.horizon_color = checks.color(value, "world.horizon_color")

    @property
    def ambient_color(self) -> tuple[float, float, float]:
        """Colour of the ambient light, 0..1."""
        return _settings().view.ambient_color or (0.0, 0.0, 0.0)

    @ambient_color.setter
    def ambient_color(self, value: Iterable[float]) -> None:
        _settings().view.ambient_color = checks.color(value, "world.ambient_color")

    @property
    def mist_settings(self) -> MistSettings:
        """The mist."""
        return MistSettings()


class MistSettings(Facade):
    """The mist."""

    _path = "bpy.context.scene.world.mist_settings"

    @staticmethod
    def _mist() -> Mist:
        return _settings().view.mist or Mist(enabled=False)

    def _change(self, **values: Any) -> None:
        _settings().view.mist = replace(self._mist(), **values)

    @property
    def use_mist(self) -> bool:
        """Whether it is shown."""
        return self._mist().enabled

    @use_mist.setter
    def use_mist(self, value: object) -> None:
        self._change(enabled=checks.boolean(value, "mist_settings.use_mist"))

    @property
    def intensity(self) -> float:
        """Minimum intensity, 0..1."""
        return self._mist().intensity

    @intensity.setter
    def intensity(self, value: object) -> None:
        self._change(intensity=checks.number(value, "mist_settings.intensity", minimum=0.0))

    @property
    def start(self) -> float:
        """Distance at which it begins, m."""
        return self._mist().start

    @start.setter
    def start(self, value: object) -> None:
        self._change(start=checks.number(value, "mist_settings.start", minimum=0.0))

    @property
    def depth(self) -> float:
        """Distance from the start to full intensity, m."""
        return self._mist().depth

    @depth.setter
    def depth(self, value: object) -> None:
        self._change(depth=checks.number(value, "mist_settings.depth", minimum=0.0))

    @property
    def falloff(self) -> str:
        """QUADRATIC, LINEAR or INVERSE_QUADRATIC."""
        return self._mist().falloff

    @falloff.setter
    def falloff(self, value: object) -> None:
        kinds = ("QUADRATIC", "LINEAR", "INVERSE_QUADRATIC")
        self._change(falloff=checks.choice(value, kinds, "mist_settings.falloff"))


class GameSettings(Facade):
    """Settings of the game engine."""

    _path = "bpy.context.scene.game_settings"

    @property
    def physics_gravity(self) -> float:
        """Gravity along -Z, m/s^2."""
        return _settings().gravity

    @physics_gravity.setter
    def physics_gravity(self, value: object) -> None:
        _settings().gravity = checks.number(value, "game_settings.physics_gravity", minimum=0.0)

    @property
    def fps(self) -> float:
        """Ticks per simulated second."""
        return _settings().frequency

    @fps.setter
    def fps(self, value: object) -> None:
        set_frequency(checks.number(value, "game_settings.fps", above=0.0))

    @property
    def logic_step_max(self) -> int:
        """Accepted for old scripts; all ticks have the same length."""
        return 20

    @logic_step_max.setter
    def logic_step_max(self, value: object) -> None:
        checks.integer(value, "game_settings.logic_step_max", minimum=1)

    physics_step_max = logic_step_max

    @property
    def physics_step_sub(self) -> int:
        """Minimum number of physics steps per tick."""
        return _settings().physics_steps

    @physics_step_sub.setter
    def physics_step_sub(self, value: object) -> None:
        _settings().physics_steps = checks.integer(value, "game_settings.physics_step_sub", minimum=1)

    @property
    def show_debug_properties(self) -> bool:
        """Whether the view shows properties."""
        return _settings().view.show_debug_properties

    @show_debug_properties.setter
    def show_debug_properties(self, value: object) -> None:
        _settings().view.show_debug_properties = checks.boolean(value, "game_settings.show_debug_properties")

    @property
    def show_framerate_profile(self) -> bool:
        """Whether the view shows its frame rate."""
        return _settings().view.show_framerate

    @show_framerate_profile.setter
    def show_framerate_profile(self, value: object) -> None:
        _settings().view.show_framerate = checks.boolean(value, "game_settings.show_framerate_profile")

    @property
    def show_physics_visualization(self) -> bool:
        """Whether the view shows collision shapes."""
        return _settings().view.show_physics

    @show_physics_visualization.setter
    def show_physics_visualization(self, value: object) -> None:
        _settings().view.show_physics = checks.boolean(value, "game_settings.show_physics_visualization")

    @property
    def use_auto_start(self) -> bool:
        """Whether the simulation starts immediately."""
        return _settings().auto_start

    @use_auto_start.setter
    def use_auto_start(self, value: object) -> None:
        _settings().auto_start = checks.boolean(value, "game_settings.use_auto_start")


class Render(Facade):
    """Settings for pictures; those of cameras are properties of the sensors."""

    _path = "bpy.context.scene.render"
    engine = "BLENDER_GAME"
    resolution_x = 1920
    resolution_y = 1080
    resolution_percentage = 50

    @property
    def fps(self) -> float:
        """Ticks per simulated second."""
        return _settings().frequency

    @fps.setter
    def fps(self, value: object) -> None:
        GameSettings().fps = value

    def __setattr__(self, name: str, value: object) -> None:
        if name == "fps":
            super().__setattr__(name, value)
        elif name == "engine":
            checks.text(value, "render.engine")
        else:
            mend = ": a camera has properties(cam_width=..., cam_height=...)" if name.startswith("resolution") else ""
            notice(f"{self._path}.{name} has no effect{mend}")
