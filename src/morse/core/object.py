"""The base class of robots, sensors and actuators."""

from __future__ import annotations

import copy
import logging
from collections.abc import Sized
from functools import partial
from typing import TYPE_CHECKING, ClassVar, Self

from morse.core import context as _context
from morse.core.abstractobject import AbstractObject
from morse.core.classes import builder_defaults
from morse.core.classes.fixed import OfOneClass
from morse.core.clients.budgets import RAY
from morse.core.declarations import add_state, data_fields, levels, properties
from morse.core.requests import Requesting
from morse.core.services import ServiceDeclaration, declared_services, service
from morse.core.state.attributes import replace, state_of
from morse.core.state.values import StateError
from morse.core.values import JsonObject, Value
from morse.helpers.transformation import FollowingPose, Transformation3d

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from morse.core.context import Context
    from morse.core.declarations import DataField
    from morse.core.interfaces import Carrier, Entry, Modifier
    from morse.core.robot_parts import MovingPart
    from morse.core.values import Fields, StateData
    from morse.core.world import Body

logger = logging.getLogger(__name__)


#: methods that the simulation calls in each tick
_OF_EACH_TICK = ("action", "update_pose")


def _if_active(component: Object, method: Callable[[], object]) -> None:
    if component._active:
        method()


class Object(Requesting, AbstractObject):
    """A component: an object with a pose in the world that acts at its own frequency.

    Attributes:
        bge_object: the object of the world that carries it (`morse.physics.GameObject`).
        robot_parent: the robot that carries it, or None for a robot.
        position_3d: its pose in the world, updated before each action.
        level: abstraction level.
        frequency: Hz.
        context: the running simulation.
    """

    add_state("_active", bool, "Whether the component acts")
    add_state("frequency", float, "Frequency of its action", unit="Hz")
    add_state("level", str | None, "Abstraction level")
    add_state("position_3d", Transformation3d, "Pose at the last action")
    add_state("initial_position_3d", Transformation3d, "Pose at the start")

    #: whether the class is the user's, so that its data may have any size
    _is_checked: ClassVar[bool] = False

    def __init_subclass__(cls, **kwargs: object) -> None:
        super().__init_subclass__(**kwargs)
        cls._is_checked = not cls.__module__.startswith("morse.")

    def __new__(cls, *args: object, **kwargs: object) -> Self:
        """In a scene script, ``Sonar()`` and ``Sonar("name")`` return the builder object of the component."""
        if builder_defaults.describe is not None and (isinstance(args[0], str) if args else "obj" not in kwargs):
            description = builder_defaults.describe(cls, *args, **kwargs)
            if description is not None:
                return description  # type: ignore[no-any-return] # what scripts use in place of the component
        return super().__new__(cls)

    def __init__(self, obj: Body, parent: Carrier | None = None) -> None:
        super().__init__()
        self.bge_object = obj
        #: a `Robot` for sensors and actuators
        self.robot_parent: Carrier = parent  # type: ignore[assignment] # only that of a robot is None
        self.context: Context = _context.current()
        self.clock = self.context.clock
        self._active = True
        self._offered: list[ServiceDeclaration] = []
        ticks = self.clock.frequency
        self.frequency = ticks if self.applies_forces else float(obj.get("frequency", ticks))
        self.level = self._chosen_level(obj.get("abstraction_level"))
        for name, field in data_fields(type(self)).items():
            if field.level == "all" or self.level is None or self.level in _as_tuple(field.level):
                self.local_data[name] = copy.deepcopy(field.default)
        for python_name, prop in properties(type(self)).items():
            setattr(self, python_name, obj[prop.name] if prop.name in obj else copy.deepcopy(prop.default))
        self.position_3d = FollowingPose(obj) if self.acts_in_rows else Transformation3d(obj)
        self.initial_position_3d = Transformation3d(obj)
        self.input_functions: list[Callable[[Object], object]] = []
        self.output_functions: list[Callable[[Object], object]] = []
        self.input_modifiers: list[Modifier] = []
        self.output_modifiers: list[Modifier] = []

    def _chosen_level(self, level_name: object) -> str | None:
        choices = levels(type(self))
        if level_name in choices:
            return str(level_name)
        return next((name for name, level in choices.items() if level.default), None)

    #: attributes that are not part of the state: they are created from the scene and do not change
    not_state: ClassVar[tuple[str, ...]] = (
        "_counted",
        "bge_object",
        "robot_parent",
        "context",
        "clock",
        "input_functions",
        "output_functions",
        "input_modifiers",
        "output_modifiers",
        "requests",
        "rays",
        "on_completion",
        "_offered",
        "_in_rows",
        "_is_read",
        *_OF_EACH_TICK,
    )

    #: whether it is a camera, whose object has the axes of its image: X right, Y down, Z forward
    is_camera: ClassVar[bool] = False
    #: whether a camera captures images at present; None for a component without images
    capturing: bool | None = None
    #: whether components on it may move
    moves_parts: bool = True
    #: whether it applies forces, which last for a tick: it acts in each tick, so that it pulls all the time
    applies_forces: ClassVar[bool] = False

    def frame_owner(self) -> Object | None:
        """Return the component in whose frame its data are; None for itself."""
        return None

    #: whether instances may be rows, see `morse.core.rows`
    acts_in_rows: ClassVar[bool] = False
    #: the rows of which this component is one; None if it acts in each tick
    _in_rows: Entry | None = None
    #: whether somebody may have a reference to its data
    _is_read = False

    @property
    def field_changes(self) -> Mapping[str, Mapping[str, object]]:
        """Return changes of the declarations of fields that depend on the properties of this component.

        For example ``{"x": {"frame": "enu"}}``; ``stddev`` is the standard deviation of noise that the component itself
        adds.
        """
        return {}

    @property
    def own_fields(self) -> Mapping[str, DataField]:
        """Fields of ``local_data`` that depend on the model, in addition to those declared: e.g. one for each joint.

        The component adds them to ``local_data`` when it is created.
        """
        return {}

    @property
    def kind_members(self) -> Mapping[str, Object]:
        """Return components whose messages are sent on sub-topics of this one: sub-topic to component."""
        return {}

    def moving_parts(self) -> Sequence[MovingPart]:
        """The joints of the component and the parts that they move, parents before their children."""
        return ()

    def get_state(self) -> StateData:
        """Return the state of the component: its attributes, except those in `not_state`.

        Override it together with `set_state` for a component that keeps a part of its state elsewhere.
        """
        data = None if self._in_rows is None else self._in_rows.kept_of(self)
        own = state_of(self)
        # the same order, whether it is a row or not; the others keep their order, because views follow their arrays
        if data is not None or "local_data" in own:
            own["local_data"] = own.pop("local_data", data)
        return own

    def set_state(self, state: StateData) -> None:
        """Restore a state that `get_state` returned.

        Raises:
            StateError: the state would replace a method, or lacks an attribute that every component of the class has.
        """
        present = vars(self)
        # a subclass with its own `set_state` may have removed entries from the state
        is_whole = type(self).set_state is Object.set_state
        options = {name for name, prop in properties(type(self)).items() if prop.default is None}
        for name in ("position_3d", "initial_position_3d", "frequency", "_active", *properties(type(self))):
            lacking = is_whole and name in present and name not in state
            if lacking or (state.get(name, self) is None and present.get(name) is not None and name not in options):
                raise StateError(f"'{name}' of {self.name()} is missing")
        if self._in_rows is not None:
            self._in_rows.release()
        replace(self, [name for name in self.get_state() if name in present] if is_whole else (), state)
        # the client that called a running service may have disconnected; the service continues nevertheless
        self.on_completion = None if self.running_service is None else _nobody

    def begin_anew(self) -> None:
        """Renew what depends on the seed, after a restart has given the component its state of the launch.

        A component that has random numbers, and lacks this method, is created again.
        """

    def services(self) -> list[ServiceDeclaration]:
        """Return the services of this component, including those of its modifiers."""
        return [*super().services(), *self._offered]

    def offer(self, other: object) -> None:
        """Offer the services that another object declares, such as a modifier, as services of this component."""
        for declaration in declared_services(type(other)):
            setattr(self, declaration.attribute, getattr(other, declaration.attribute))
            self._offered.append(declaration)

    def __repr__(self) -> str:
        body = getattr(self, "bge_object", None)  # a class of a user may fail before it has one
        return f"<{type(self).__name__}{'' if body is None else f' {body.name}'}>"

    def name(self) -> str:
        """The fully qualified name, e.g. ``robot.arm.pose``."""
        return str(self.bge_object.name)

    @property
    def active(self) -> bool:
        """Whether it acts at all."""
        return self._active

    @active.setter
    def active(self, value: bool) -> None:
        self._active = bool(value)
        if self._in_rows is not None:
            self._in_rows.is_changed = True

    def switch_off(self) -> None:
        """Deactivate the component after an error, also if its class overrides `active` or does not observe it."""
        vars(self)["_active"] = False
        if self._in_rows is not None:
            self._in_rows.is_changed = True
        for name in _OF_EACH_TICK:
            method = getattr(self, name, None)
            if callable(method) and not str(getattr(method, "__module__", "")).startswith("morse."):
                vars(self)[name] = partial(_if_active, self, method)

    def toggle_active(self) -> None:
        """Switch between active and inactive."""
        self.active = not self._active

    def is_wanted(self) -> bool:
        """Whether its requests are answered: those of a sensor that nobody reads may cost more than the physics."""
        return True

    def may_wait(self) -> bool:
        """Whether the action may be omitted while it has nothing to do, as its class declares (`morse.core.rows`).

        It is called when the component is loaded, and after its properties have changed.
        """
        return True

    def check_scene(self) -> None:
        """Check what it needs of other components, once all of them exist.

        An error of the class `morse.core.exceptions.MorseError` refuses the scene, with the line of this component.
        """

    def periodic_call(self) -> bool:
        """Return True: the action of a component is only called at its frequency. Kept for components of 1.4."""
        return True

    def gettime(self) -> float:
        """Simulated time, s."""
        return self.clock.time

    def sensor_to_robot_position_3d(self) -> Transformation3d:
        """The pose of the component in the frame of its robot."""
        main = Transformation3d(self.robot_parent.bge_object)
        return main.transformation3d_with(Transformation3d(self.bge_object))

    def in_zones(self, name: str | None = None, type: str | None = None) -> set[str]:
        """Names of the zones that contain the component; only those of that name or type, if given."""
        x, y, z = self.bge_object.worldPosition
        inside = set()
        for zone in self.context.scene.zones:
            if (name is not None and zone.node.name != name) or (type is not None and zone.type != type):
                continue
            centre, half = zone.node.location, zone.node.scale
            if all(abs(p - c) <= h for p, c, h in zip((x, y, z), centre, half, strict=True)):
                inside.add(zone.node.name)
        return inside

    @service(changes=False)
    def get_properties(self) -> dict[str, dict[str, tuple[Value, str, str, str]]]:
        """Return the properties: name to (value, type, documentation, name in Python)."""
        return {
            "properties": {
                prop.name: (getattr(self, python_name), prop.type, prop.doc, python_name)
                for python_name, prop in properties(type(self)).items()
            }
        }

    def sensing_cost(self) -> float:
        """Return the pixels of a measurement with the present properties, with 16 for each ray; 0 without either.

        Clients can only set and spawn what fits into the budget of `morse.core.clients.budgets`. Override it if the
        pixels or rays depend on properties that clients set.
        """
        return RAY * sum(len(request) for request in self.requests if isinstance(request, Sized))

    @service
    def set_property(self, name: str, value: object) -> None:
        """Change a property while the simulation runs."""
        from morse.core.validation import checked_property

        python_name, new_value = checked_property(self, name, value)
        old_value = getattr(self, python_name)
        before = self.sensing_cost()
        setattr(self, python_name, new_value)
        try:
            if self.sensing_cost() > before:
                self.context.sensing.check(f"{self.name()}, {name}", [self])
        except BaseException:
            setattr(self, python_name, old_value)
            raise
        if self._in_rows is not None:
            self._in_rows.is_changed = True

    @service(changes=False)
    def get_configurations(self) -> JsonObject:
        """Return the values of the properties, and the pose of the component on its robot."""
        configuration: Fields = {
            prop.name: getattr(self, python_name) for python_name, prop in properties(type(self)).items()
        }
        if self.robot_parent is not None:
            pose = self.sensor_to_robot_position_3d()
            configuration["object_to_robot"] = {"rotation": pose.rotation_matrix, "translation": pose.translation}
        return {"configurations": configuration}

    def update_pose(self) -> None:
        """Copy the present pose of the object into ``position_3d``."""
        self.position_3d.update(self.bge_object)


#: the simulation needs them also after the component has failed
_NEEDED = (
    *("bge_object", "robot_parent", "context", "clock"),
    *("input_functions", "output_functions", "input_modifiers", "output_modifiers"),
)
for _name in _NEEDED:
    setattr(Object, _name, OfOneClass(_name))


def _nobody(_outcome: object) -> None:
    """Completion callback of a service whose client has disconnected."""


def _as_tuple(level: str | tuple[str, ...]) -> tuple[str, ...]:
    return (level,) if isinstance(level, str) else level
