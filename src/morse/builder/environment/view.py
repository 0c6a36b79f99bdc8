"""Initial settings of the live view."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from morse.builder.abstractcomponent import AbstractComponent
from morse.builder.assembly.description import EnvironmentDescription, Wish
from morse.builder.errors import checks
from morse.builder.errors.checks import hint_at_radians
from morse.builder.names import frames
from morse.builder.workspace import notice
from morse.scene import Mist

if TYPE_CHECKING:
    from collections.abc import Iterable

    from morse.scene.scene import Overlay, PanelPlace


class DisplayMethods(EnvironmentDescription):
    """The part of `Environment` that says what the live view shows."""

    def show(
        self,
        *,
        rays: bool | Iterable[AbstractComponent | str] | None = None,
        images: Iterable[AbstractComponent | str] | None = None,
        plots: Iterable[str | Iterable[str]] | None = None,
        follow: AbstractComponent | str | None = None,
        select: AbstractComponent | str | None = None,
        overlays: Iterable[Overlay] | None = None,
        layout: Iterable[PanelPlace] | None = None,
    ) -> None:
        """Set what the live view shows at first; its user may close all of it. A later call replaces what it sets.

        Components are given as objects or by their names, such as ``"robot.laser"``.

        Args:
            rays: the sensors whose rays or points are shown; True for all.
            images: the cameras whose images are shown.
            plots: the diagrams: a field such as ``"robot.pose.x"`` each, or a list of fields for several curves.
            follow: the robot or the object that the camera moves with, at the distance that the script sets.
            select: the component whose panel is open.
            overlays: what else is shown in the world: ``rays``, ``frustums`` (fields of view of cameras), ``cones``,
                ``trails`` (paths of robots), ``names``, ``frames``, ``contacts``, ``masses``, ``shapes`` (collision).
            layout: the open panels: ``tree``, ``details``, ``plots``; none for the world alone. Default: those that
                the user opened last, and the plots if there are any.
        """
        values = {
            "rays": rays,
            "images": images,
            "plots": plots,
            "follow": follow,
            "select": select,
            "overlays": overlays,
            "layout": layout,
        }
        where = frames.source_line(self)
        self._wishes.update({name: Wish(where, value) for name, value in values.items() if value is not None})

    def select_display_camera(self, robot_camera: AbstractComponent) -> None:
        """Show the image of a camera of a robot in the view. See `show` for several cameras."""
        if not isinstance(robot_camera, AbstractComponent):
            raise TypeError(f"env.select_display_camera takes a camera of a robot, got {checks.shown(robot_camera)}")
        # MORSE 1.4 accepted any component
        self._wishes["display_camera"] = Wish(frames.source_line(self), robot_camera)


_MATERIAL_MODES = ("GLSL", "MULTITEXTURE", "SINGLETEXTURE", "TEXTURE_FACE")
_VIEWPORTS = ("BOUNDBOX", "WIREFRAME", "SOLID", "TEXTURED", "MATERIAL", "RENDERED")
_FALLOFFS = ("QUADRATIC", "LINEAR", "INVERSE_QUADRATIC")
_STEREO = ("NONE", "STEREO", "DOME")
_STEREO_MODES = (
    "QUADBUFFERED",
    "ABOVEBELOW",
    "INTERLACED",
    "ANAGLYPH",
    "SIDEBYSIDE",
    "VINTERLACE",
)


class ViewMethods(DisplayMethods):
    """The part of `Environment` that sets up the view."""

    # --- camera -----------------------------------------------------------------------------

    def set_camera_location(self, camera_location: Iterable[float] = (5.0, -5.0, 5.0)) -> None:
        """Set the position of the camera in the world, m."""
        self.settings.view.camera_location = checks.triple(camera_location, "env.set_camera_location([x, y, z])")

    def set_camera_rotation(self, camera_rotation: Iterable[float] = (0.7854, 0.0, 0.7854)) -> None:
        """Set the rotation of the camera, which looks along its -Z axis: Euler angles, rad, XYZ order."""
        angles = checks.triple(camera_rotation, "env.set_camera_rotation([rx, ry, rz])")
        hint_at_radians("env.set_camera_rotation", angles)
        self.settings.view.camera_rotation = angles

    def place_camera(self, camera_location: Iterable[float]) -> None:
        """Old name of `set_camera_location`."""
        _deprecated("place_camera", "set_camera_location")
        self.set_camera_location(camera_location)

    def aim_camera(self, camera_rotation: Iterable[float]) -> None:
        """Old name of `set_camera_rotation`."""
        _deprecated("aim_camera", "set_camera_rotation")
        self.set_camera_rotation(camera_rotation)

    def set_camera_clip(self, clip_start: float = 0.1, clip_end: float = 100.0) -> None:
        """Set the near and far clipping distances, m."""
        near = checks.number(clip_start, "env.set_camera_clip(clip_start)", above=0.0)
        far = checks.number(clip_end, "env.set_camera_clip(clip_end)", above=near)
        self.settings.view.camera_clip = (near, far)

    def set_camera_speed(self, speed: float = 2.0) -> None:
        """Set the speed of the camera, m/s."""
        self.settings.view.camera_speed = checks.number(speed, "env.set_camera_speed(speed)", above=0.0)

    def set_camera_focal_length(self, focal_length: float = 20.0) -> None:
        """Set the focal length in mm, for a sensor 32 mm wide."""
        length = checks.number(focal_length, "env.set_camera_focal_length(focal_length)", above=0.0)
        self.settings.view.camera_focal_length = length

    # --- colours ----------------------------------------------------------------------------

    def set_horizon_color(self, color: Iterable[float] = (0.05, 0.22, 0.4)) -> None:
        """Set the colour of the sky: red, green, blue, 0..1."""
        self.settings.view.horizon_color = checks.color(color, "env.set_horizon_color(color)")

    def set_ambient_color(self, color: Iterable[float] = (0.0, 0.0, 0.0)) -> None:
        """Set the colour of the ambient light: red, green, blue, 0..1."""
        self.settings.view.ambient_color = checks.color(color, "env.set_ambient_color(color)")

    def set_daylight(self, share: float = 1.0) -> None:
        """Set the share of the light of sun and sky, 0..1, at which lamps keep theirs: 0 is a dark night."""
        what = "env.set_daylight(share)"
        self.settings.view.daylight = checks.number(share, what, minimum=0.0, maximum=1.0)

    def enable_mist(self, enable: bool = True) -> None:
        """Switch the mist on or off."""
        self.set_mist_settings(enable=enable)

    def set_mist_settings(
        self,
        enable: bool = True,
        intensity: float | None = None,
        start: float | None = None,
        depth: float | None = None,
        falloff: str | None = None,
    ) -> None:
        """Set the mist; settings that are not given do not change.

        Args:
            enable: whether to show it.
            intensity: minimum intensity, 0..1.
            start: distance at which it begins, m.
            depth: distance from the start to full intensity, m.
            falloff: ``QUADRATIC``, ``LINEAR`` or ``INVERSE_QUADRATIC``.
        """
        mist = replace(self.settings.view.mist or Mist())
        what = "env.set_mist_settings({})"
        mist.enabled = checks.boolean(enable, what.format("enable"))
        for key, value in (("intensity", intensity), ("start", start), ("depth", depth)):
            if value is not None:
                setattr(mist, key, checks.number(value, what.format(key), minimum=0.0))
        if falloff is not None:
            mist.falloff = checks.choice(falloff, _FALLOFFS, what.format("falloff"))
        self.settings.view.mist = mist

    def set_material_mode(self, material_mode: str = "GLSL") -> None:
        """Set the material mode: ``GLSL``, ``MULTITEXTURE`` or ``SINGLETEXTURE``."""
        mode = checks.choice(material_mode, _MATERIAL_MODES, "env.set_material_mode(material_mode)")
        self.settings.view.material_mode = mode

    def set_viewport(self, viewport_shade: str = "WIREFRAME", clip_end: float = 1000.0) -> None:
        """Set the rendering mode, e.g. ``WIREFRAME`` or ``SOLID``, and the far clipping distance, m."""
        shade = checks.choice(viewport_shade, _VIEWPORTS, "env.set_viewport(viewport_shade)")
        near = self.settings.view.camera_clip[0]
        far = checks.number(clip_end, "env.set_viewport(clip_end)", above=near)
        self.settings.view.viewport = shade
        self.settings.view.camera_clip = (near, far)

    def set_stereo(self, mode: str = "ANAGLYPH", eye_separation: float = 0.1, stereo: str = "STEREO") -> None:
        """Set stereo rendering; ``eye_separation`` in metres."""
        self.settings.view.stereo = {
            "mode": checks.choice(mode, _STEREO_MODES, "env.set_stereo(mode)"),
            "eye_separation": checks.number(eye_separation, "env.set_stereo(eye_separation)", minimum=0.0),
            "stereo": checks.choice(stereo, _STEREO, "env.set_stereo(stereo)"),
        }

    # --- overlays ---------------------------------------------------------------------------

    def show_debug_properties(self, value: bool = True) -> None:
        """Show the properties that components set at run time, and those marked in the model files."""
        self.settings.view.show_debug_properties = checks.boolean(value, "env.show_debug_properties(value)")

    def show_framerate(self, value: bool = True) -> None:
        """Show the frame rate of the live view."""
        self.settings.view.show_framerate = checks.boolean(value, "env.show_framerate(value)")

    def show_physics(self, value: bool = True) -> None:
        """Show the collision shapes."""
        self.settings.view.show_physics = checks.boolean(value, "env.show_physics(value)")

    def fullscreen(self, fullscreen: bool = True) -> None:
        """Use the full screen for the view."""
        self.settings.view.fullscreen = checks.boolean(fullscreen, "env.fullscreen(fullscreen)")


def _deprecated(old: str, new: str) -> None:
    notice(f"env.{old} is an old name, write env.{new}", old, new)
