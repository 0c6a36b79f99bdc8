"""What the live view shows at first."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.builder.abstractcomponent import AbstractComponent
from morse.builder.assembly.description import EnvironmentDescription, Wish
from morse.builder.errors import checks
from morse.builder.names import frames

if TYPE_CHECKING:
    from collections.abc import Iterable

    from morse.scene.settings import Overlay, PanelPlace


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
