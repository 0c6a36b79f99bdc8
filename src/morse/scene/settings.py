"""Settings of a scene that do not belong to a node."""

from __future__ import annotations

import time
from dataclasses import dataclass, field
from enum import IntEnum
from typing import Literal


class TimeStrategies(IntEnum):
    """How simulated time relates to the wall clock.

    ``BestEffort`` keeps up with the wall clock, and reports if it cannot. ``FixedSimulationStep`` runs every tick, even
    if it falls behind the wall clock.
    """

    BestEffort = 0
    FixedSimulationStep = 1

    @property
    def human_repr(self) -> str:
        """The name that the service ``time.mode`` returns."""
        return ("Best Effort", "Fixed Simulation Step")[self.value]


@dataclass(slots=True)
class Mist:
    """Fog from ``start`` m on, full after ``depth`` more; falloff QUADRATIC, LINEAR or INVERSE_QUADRATIC."""

    enabled: bool = True
    intensity: float = 0.0
    start: float = 5.0
    depth: float = 25.0
    falloff: str = "QUADRATIC"


#: overlays of the world that the live view can show
Overlay = Literal["rays", "frustums", "cones", "trails", "names", "frames", "contacts", "masses", "shapes"]
#: panels of the live view
PanelPlace = Literal["tree", "details", "plots"]


@dataclass(slots=True)
class Display:
    """What the live view shows at first, by the names of components; the user may close all of it.

    Attributes:
        rays: sensors whose rays or points are shown.
        images: cameras whose images are shown.
        plots: the curves of each diagram: component and field.
        follow: the node that the camera moves with; empty for none.
        select: the component whose panel is open; empty for none.
        overlays: what else is shown in the world, of all robots.
        panels: the open panels; None for those that the user opened last.
    """

    rays: tuple[str, ...] = ()
    images: tuple[str, ...] = ()
    plots: tuple[tuple[tuple[str, str], ...], ...] = ()
    follow: str = ""
    select: str = ""
    overlays: tuple[Overlay, ...] = ()
    panels: tuple[PanelPlace, ...] | None = None


@dataclass(slots=True)
class ViewSettings:
    """Initial settings of the live view. The camera looks along its -Z axis.

    Attributes:
        daylight: factor of the light of sun and sky, 0..1; 0 is a night without a moon.
    """

    camera_location: tuple[float, float, float] = (5.0, -5.0, 5.0)
    camera_rotation: tuple[float, float, float] = (0.7854, 0.0, 0.7854)
    camera_clip: tuple[float, float] = (0.1, 100.0)
    camera_speed: float = 2.0
    camera_focal_length: float = 20.0
    horizon_color: tuple[float, float, float] | None = None
    ambient_color: tuple[float, float, float] | None = None
    daylight: float = 1.0
    mist: Mist | None = None
    show_debug_properties: bool = False
    show_framerate: bool = False
    show_physics: bool = False
    fullscreen: bool = False
    display: Display = field(default_factory=Display)
    material_mode: str = "GLSL"
    viewport: str | None = None
    stereo: dict[str, object] | None = None


@dataclass(slots=True)
class Settings:
    """Physics, time and view.

    Attributes:
        gravity: m/s^2, downward.
        frequency: ticks per simulated second.
        physics_of_1_4: whether friction and damping act on driven robots as in the engine of MORSE 1.4.
        physics_steps: smallest number of physics steps per tick; their number if `steps_are_exact`.
        steps_are_exact: whether the script has set the number of steps. Otherwise steps are at most 1/240 s, or as long
            as in the file if all robots come from MJCF files.
        time_scale: simulated seconds per wall-clock second.
        relative_time: whether time starts at 0; otherwise at the epoch time of the start.
        start_time: seconds since the epoch at the start, UTC; None for the present time. Only without relative time.
        seed: seed of all random numbers.
        cameras_on: where images are rendered, see `morse.scene.image_workers`.
        fastmode: whether the view shows wireframes and cameras give no images.
        fallen: what follows if a robot falls below everything: a ``warning``, or the end of the run with an ``error``.
    """

    gravity: float = 9.81
    frequency: float = 60.0
    physics_steps: int = 2
    steps_are_exact: bool = False
    physics_of_1_4: bool = False
    time_strategy: TimeStrategies = TimeStrategies.BestEffort
    time_scale: float = 1.0
    relative_time: bool = True
    start_time: float | None = None
    seed: int = 0
    cameras_on: int | str = 0
    fastmode: bool = False
    fallen: str = "warning"
    auto_start: bool = True
    internal_syncer: bool = False
    node_name: str | None = None
    view: ViewSettings = field(default_factory=ViewSettings)

    @property
    def origin(self) -> float:
        """Simulated time at the start, s: 0, or the date since the epoch."""
        if self.relative_time:
            return 0.0
        return time.time() if self.start_time is None else self.start_time
