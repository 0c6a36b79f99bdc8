"""The environment, which a scene script creates last."""

from __future__ import annotations

import logging
import sys
from dataclasses import replace
from functools import partial
from pathlib import PurePath
from typing import TYPE_CHECKING, Any

from morse.assets import find, load
from morse.builder import workspace
from morse.builder.assembly.selection import take, viewpoint_of
from morse.builder.compatibility import value_of_today
from morse.builder.components.robot import Robot, WheeledRobot, connect
from morse.builder.environment.time import TimeMethods
from morse.builder.environment.view import ViewMethods
from morse.builder.errors import checks
from morse.builder.errors.declared import options_of_classes, warn_if_misspelled
from morse.builder.names import catalog, frames, naming
from morse.builder.names.part import Strength
from morse.builder.objects import checked_property
from morse.builder.workspace import notice
from morse.core.classes.plugins import PluginError, entry_points
from morse.core.classes.plugins import load as load_point
from morse.core.exceptions import MorseBuilderError
from morse.scene import Choice, Mist, SensorAlteration

if TYPE_CHECKING:
    from collections.abc import Callable
    from types import FrameType

    from morse.scene import Camera, Library, Node, Scene

logger = logging.getLogger(__name__)

#: entry points of functions that packages add as methods: their first argument is the environment
_GROUP = "morse.environment"
#: properties of the world that are numbers
_PLACE = ("longitude", "latitude", "altitude", "angle_against_north", "UTMXOffset", "UTMYOffset", "UTMZOffset")
_FALLEN = ("warning", "error")
#: largest angles on the Earth, degrees; longitudes are also counted from 0 to 360
_DEGREES = {"longitude": 360.0, "latitude": 90.0}
_NUMBERS = (*_PLACE, "Temperature", "WaveHeight", "WavePeriod", "WaveDirection")


class Environment(ViewMethods, TimeMethods):
    """The world around the robots, and the settings of the simulation.

    Create it after all other objects, because it assigns the names of components.

    Args:
        filename: name of the model in ``environments`` (see `morse.assets.find`).
        main_scene: accepted for old scripts; the whole file is always used.
        fastmode: whether the view shows wireframes and cameras give no images.
        component_renaming: whether components are named after variables (see `morse.builder.names.naming`).
        auto_tune_time: whether the frequency of the simulation is raised to that of the fastest component.
        fallen: what follows if a robot leaves the world, that is, falls 10 m below the lowest shape: a ``warning``; or
            an ``error``, which ends the run.

    Raises:
        FileNotFoundError: the environment does not exist.
        MorseBuilderError: the scene already has an environment.
    """

    def __init__(
        self,
        filename: str,
        main_scene: str | None = None,
        fastmode: bool = False,
        component_renaming: bool = True,
        auto_tune_time: bool = True,
        fallen: str = "warning",
    ) -> None:
        scene = workspace.current()
        if scene.environment is not None:
            raise MorseBuilderError(f"a scene has only one Environment; it was created at {scene.environment.where}")
        self.where = frames.source_line(self)
        self.filename = checks.text(filename, "Environment(filename)")
        self.settings = scene.settings
        self.settings.fastmode = checks.boolean(fastmode, "Environment(fastmode)")
        self.settings.fallen = checks.choice(fallen, _FALLEN, "Environment(fallen)")
        self.environment_properties = {}
        self._alterations = []
        self._auto_tune = checks.boolean(auto_tune_time, "Environment(auto_tune_time)")
        self._wishes = {}
        self._completions = []
        self._init_time()
        if scene.speed is not None:
            self.simulator_frequency(*scene.speed)
        renaming = checks.boolean(component_renaming, "Environment(component_renaming)")
        library = load(find(self.filename, "environments"))
        scene.environment = self
        if renaming:
            self._name_components()
        self._load(library)
        for component in scene.components:
            if isinstance(component, Robot):
                connect_by_default(component)
            if isinstance(component, WheeledRobot):
                component.unparent_wheels()

    if not TYPE_CHECKING:  # lets type checkers find misspelt names

        def __getattr__(self, name: str) -> Any:
            method = None if name.startswith("_") else _method_of_a_package(name)
            return checks.missing_attribute(self, name) if method is None else partial(method, self)

        def __dir__(self) -> list[str]:
            return [*super().__dir__(), *(point.name for point in entry_points(_GROUP))]

    def __repr__(self) -> str:
        return f"<Environment '{self.filename}'>"

    def _name_components(self) -> None:
        frame: FrameType | None = sys._getframe(1)
        # the variables belong to the script, not to a subclass of Environment
        while frame is not None and frame.f_locals.get("self") is self:
            frame = frame.f_back
        if frame is not None:
            naming.name_unparented(frame.f_locals, Strength.VARIABLE)
        for outer in frames.user_frames():
            naming.name_unparented(outer.f_locals, Strength.VARIABLE)
            naming.name_unparented(outer.f_globals, Strength.VARIABLE)
        naming.rename_all()

    def _load(self, library: Library) -> None:
        roots, use = take(library, Choice("environment"))
        workspace.current().add_model(roots, use)
        if library.walkers:
            from morse.builder.components.file_sensors import add_walkers

            add_walkers(roots, library.walkers, PurePath(library.path).name)
        viewpoint = viewpoint_of(library)
        if viewpoint is not None and viewpoint.camera is not None:
            self._look_from(viewpoint, viewpoint.camera)
        view = self.settings.view
        for name in ("horizon_color", "ambient_color"):
            if name in library.world:
                setattr(view, name, library.world[name])
        properties = library.world.get("properties")
        if isinstance(properties, dict):
            self.environment_properties.update(properties)
        mist, gravity = library.world.get("mist"), library.world.get("gravity")
        if isinstance(mist, Mist):
            view.mist = replace(mist)
        if isinstance(gravity, float):
            # files contain single precision numbers: 9.81 is read as 9.8100004
            self.settings.gravity = round(gravity, 5)

    def _look_from(self, node: Node, lens: Camera) -> None:
        view, pose = self.settings.view, node.world_matrix()
        x, y, z = pose.to_translation()
        turn_x, turn_y, turn_z = pose.to_3x3().to_euler()
        view.camera_location, view.camera_rotation = (x, y, z), (turn_x, turn_y, turn_z)
        view.camera_focal_length = lens.focal_length

    # --- end of the script ------------------------------------------------------------------

    def create(self, name: str | None = None) -> None:
        """Declare that the scene is complete; optional. Settings can still be changed.

        Args:
            name: name of this simulation node.
        """
        if name is not None:
            self.settings.node_name = checks.text(name, "env.create(name)")

    def properties(self, **kwargs: object) -> None:
        """Set properties of the world.

        Args:
            **kwargs: ``longitude``, ``latitude`` (degrees), ``altitude`` (m),
                ``angle_against_north`` (radians), ``UTMXOffset``, ``Temperature``, ...
        """
        warn_if_misspelled("the environment", kwargs, _NUMBERS)
        for key, value in kwargs.items():
            if key in _NUMBERS:
                value = value_of_today("number", value, f"env.properties({key})")
            most = _DEGREES.get(key)
            if most is not None and isinstance(value, (int, float)) and not -most <= value <= most:
                logger.warning("env.properties(%s) takes degrees from %g to %g, got %g", key, -most, most, value)
            self.environment_properties[key] = checked_property(key, value)

    def alter(self, modifier_name: str, **kwargs: object) -> None:
        """Add a modifier to all sensors that it fits, also to those that are created while the simulation runs.

        Args:
            modifier_name: e.g. ``NED`` or ``Noise``.
            **kwargs: options of the modifier.

        Raises:
            MorseBuilderError: there is no such modifier.
            OptionError: the modifier has no such option, or the value is not valid.
        """
        name = checks.text(modifier_name, "env.alter(modifier_name)")
        classpaths = set(catalog.modifier_classes().get(name, {}).values())
        if not classpaths:
            choices = catalog.modifier_classes()
            hint = checks.suggestion(name, choices) or f"; there are {', '.join(sorted(choices))}"
            raise MorseBuilderError(f"there is no modifier '{name}'{hint}")
        options = options_of_classes(sorted(classpaths), kwargs)
        self._alterations.append(SensorAlteration(name, options, frames.source_line()))

    def when_complete(self, change: Callable[[Scene], object]) -> None:
        """Call a function with the scene, plain data with all names, when the script has described all of it.

        Args:
            change: changes the scene, in the order of the calls of this method. A `MorseBuilderError` that it raises
                names the line of the script that has called this method.
        """
        self._completions.append((frames.source_line(), change))

    # --- accepted for old scripts -----------------------------------------------------------

    def set_background_scene(self, scene: object = None) -> None:
        """Accepted for old scripts, without effect, because there is one scene."""
        _without_effect("set_background_scene")

    def set_debug(self, debug: bool = True) -> None:
        """Log all messages of MORSE."""
        if checks.boolean(debug, "env.set_debug(debug)"):
            logging.getLogger("morse").setLevel(logging.DEBUG)

    def set_animation_record(self, record: bool = True) -> None:
        """Accepted for old scripts, without effect, because motion is not recorded in model files."""
        if checks.boolean(record, "env.set_animation_record(record)"):
            _without_effect("set_animation_record")

    def save(self, filepath: str | None = None, check_existing: bool = False) -> None:
        """Accepted for old scripts, without effect, because scenes are not written to model files."""
        _without_effect("save")


def _method_of_a_package(name: str) -> Callable[..., object] | None:
    """The function that an installed package, or the project, adds to `Environment` under that name; None for no such.

    Raises:
        MorseBuilderError: the package cannot be loaded.
    """
    point = next((point for point in entry_points(_GROUP) if point.name == name), None)
    if point is None:
        return None
    try:
        return load_point(point, _function)
    except PluginError as error:
        raise MorseBuilderError(f"env.{name} of the package {point.value} cannot be used: {error}") from None


def _function(method: Callable[..., object]) -> Callable[..., object]:
    if not callable(method):
        raise TypeError(f"it is {method!r:.80}, expected a function whose first argument is the environment")
    return method


def connect_by_default(robot: Robot) -> None:
    """Connect the components of a robot to its default interfaces, except those that are already connected."""
    for interface in robot.default_interfaces:
        connect(robot, interface)


def _without_effect(method: str) -> None:
    notice(f"env.{method} has no effect: leave it out")
