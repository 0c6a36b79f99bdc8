"""Creates the components of a scene."""

from __future__ import annotations

import inspect
import logging
import threading
import traceback
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from morse.builder.names.catalog import fitting_modifier
from morse.core.abstractobject import AbstractObject
from morse.core.actuator import Actuator
from morse.core.classes.classpath import load_class
from morse.core.declarations import levels
from morse.core.exceptions import MorseError
from morse.core.external_object import ExternalObject
from morse.core.hidden_methods import hidden_methods, laziness, lazy_methods
from morse.core.kinds import findings_of
from morse.core.reports.faults import ENDINGS, attribute, describe, is_a, name_of, trace_of
from morse.core.robot import Robot
from morse.core.rows.marks import Unclaimed
from morse.core.validation.fields import with_defaults
from morse.middleware.registry import middleware_of_stream_manager, needs_network
from morse.scene import ModifierDeclaration
from morse.scene.component import RealismModel
from morse.scene.scene_warnings import about

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from morse.core.context import Context
    from morse.core.interfaces import Middleware
    from morse.core.modifier import AbstractModifier
    from morse.core.object import Object
    from morse.core.request_manager import RequestManager
    from morse.core.world import Body
    from morse.scene import ComponentDeclaration, SensorAlteration, SourceLine


def watch_threads() -> None:
    """Report errors in the threads of components to the guard; those in other threads are reported as before."""
    if not isinstance(threading.excepthook, _Hook):
        threading.excepthook = _Hook(threading.excepthook)


class _Hook:
    """An exception hook of `threading` that knows components.

    Args:
        before: the hook for threads that do not belong to a component.
    """

    def __init__(self, before: Callable[[threading.ExceptHookArgs], object]) -> None:
        self._before = before

    def __call__(self, failure: threading.ExceptHookArgs) -> object:
        error = failure.exc_value
        component = None if error is None or is_a(error, SystemExit) else _component(error)
        guard = attribute(attribute(component, "context"), "guard")
        if error is None or guard is None:
            return self._before(failure)
        thread = failure.thread.name if failure.thread is not None else "(without a name)"
        guard.failed(component, f"the thread {thread} of {name_of(component)}", "has ended", error)
        return None


def _component(error: BaseException) -> AbstractObject | None:
    """Return the component whose function a thread ran: that of the outermost function with a component."""
    for frame, _ in traceback.walk_tb(trace_of(error)):
        for value in frame.f_locals.values():
            if is_a(value, AbstractObject):
                component: AbstractObject = value
                return component
    return None


logger = logging.getLogger(__name__)


class LoadError(MorseError):
    """A component of the scene cannot be created.

    Attributes:
        where: the line of the script that created it, or None.
    """

    def __init__(self, value: object = "", where: SourceLine | None = None) -> None:
        super().__init__(value)
        self.where = where


@dataclass(eq=False)
class Loaded:
    """The components that were created from declarations.

    Attributes:
        robots, actuators, sensors: in the order of the scene.
        modifiers: class paths in use.
    """

    robots: list[Robot] = field(default_factory=list)
    actuators: list[Object] = field(default_factory=list)
    sensors: list[Object] = field(default_factory=list)
    modifier_objects: list[object] = field(default_factory=list)
    modifiers: list[str] = field(default_factory=list)

    def join(self, other: Loaded) -> None:
        """Add components that were created later."""
        for name in ("robots", "actuators", "sensors", "modifier_objects"):
            getattr(self, name).extend(getattr(other, name))
        self.modifiers += [path for path in other.modifiers if path not in self.modifiers]

    def drop(self, component: Object) -> None:
        """Remove a component that was deleted."""
        for table in (self.robots, self.actuators, self.sensors):
            if component in table:
                table.remove(component)  # type: ignore[arg-type]
        modifier_ids = {id(modifier) for modifier in [*component.input_modifiers, *component.output_modifiers]}
        self.modifier_objects[:] = [modifier for modifier in self.modifier_objects if id(modifier) not in modifier_ids]


def load_components(
    context: Context, declarations: Sequence[ComponentDeclaration] | None = None, *, by_client: bool = False
) -> Loaded:
    """Instantiate robots, then sensors and actuators.

    Args:
        declarations: the components to create; None for all components of the scene.
        by_client: whether a client chose them: then their pixels and rays count in its budget.

    Raises:
        LoadError: the message contains the component and the line of the script that created it.
    """
    watch_threads()
    parts = Loaded()
    declarations = context.scene.components if declarations is None else declarations
    by_node: dict[object, Robot] = {}
    for declaration in declarations:
        if declaration.kind in ("robot", "external_robot"):
            robot = make_component(context, declaration, None)
            if not isinstance(robot, Robot):
                raise LoadError(
                    f"{_where(declaration)}: {declaration.classpath} is not a subclass of morse.core.robot.Robot",
                    declaration.where,
                )
            by_node[declaration.node] = robot
            own = declaration.kind == "robot"
            (context.robots if own else context.external_robots)[declaration.name] = robot
            if own:
                parts.robots.append(robot)
    # a constructor may keep a reference to the data of a sensor that was created before
    with Unclaimed() as leftovers:
        for declaration in declarations:
            # a component may come later than its robot
            carrier = by_node.get(declaration.robot) or context.robots.get(declaration.robot.name)
            if declaration.kind in ("robot", "external_robot") or not isinstance(carrier, Robot):
                continue
            try:
                component = make_component(context, declaration, carrier)
            except LoadError as error:
                if not declaration.is_optional:
                    raise
                with about(declaration.where):
                    logger.warning("a model file declares it, but it is left out: %s", error)
                continue
            context.components[declaration.name] = component
            (parts.sensors if declaration.kind == "sensor" else parts.actuators).append(component)
            leftovers.add(component)
    _warn_of_rivals(context, declarations)
    if not by_client:
        context.sensing.grant([*parts.sensors, *parts.actuators])
    return parts


def _warn_of_rivals(context: Context, declarations: Sequence[ComponentDeclaration]) -> None:
    drives: dict[str, ComponentDeclaration] = {}
    for declaration in declarations:
        component = context.components.get(declaration.name)
        if not isinstance(component, Actuator) or not component.commands_speed:
            continue
        rival = drives.setdefault(declaration.robot.name, declaration)
        if rival is not declaration:
            mend = (
                f"use robot.actuators['{rival.name.rpartition('.')[2]}'] of the model file" if rival.is_optional else ""
            )
            logger.warning(
                "%s and %s both set the speed of '%s' in each tick, and work against each other: %s",
                _where(rival),
                _where(declaration),
                declaration.robot.name,
                mend or "remove one of them",
                extra={"where": declaration.where},
            )


def _where(declaration: ComponentDeclaration) -> str:
    place = f" ({declaration.where})" if declaration.where else ""
    return f"{declaration.kind} '{declaration.name}'{place}"


@contextmanager
def _blamed(where: SourceLine | None, who: str, failed: str) -> Iterator[None]:
    """Errors of a part of the scene become messages with its line in the script.

    Args:
        where: the line that has created it.
        who: before the text of errors that are messages already.
        failed: before what has failed in the classes of users.
    """
    try:
        yield
    except MorseError as error:
        raise LoadError(f"{who}: {error}", where) from None
    except ENDINGS:
        raise
    except BaseException as error:
        raise LoadError(f"{failed}: {describe(error)}", where) from error


def make_component(context: Context, declaration: ComponentDeclaration, robot: Robot | None) -> Any:
    """Instantiate one component.

    Raises:
        LoadError: the message contains the component and the line of the script that created it.
    """
    with about(declaration.where):
        return _made(context, declaration, robot)


def _made(context: Context, declaration: ComponentDeclaration, robot: Robot | None) -> Any:
    obj = context.world.object_of(declaration.node)
    if declaration.frequency is not None:
        obj["frequency"] = declaration.frequency
    if declaration.level is not None:
        obj["abstraction_level"] = declaration.level
    name = _where(declaration)
    with _blamed(declaration.where, name, f"{name} could not be created"):
        cls = load_class(declaration.classpath)
        cls = _class_of_level(cls, declaration.level)
        component = _instance(cls, obj, robot)
        if "output_modifiers" not in vars(component):
            raise LoadError(f"{cls.__name__}.__init__ does not call super().__init__(obj, parent)")
        _check_methods(component, declaration)
        timeouts = [stream.options["timeout"] for stream in declaration.streams if "timeout" in stream.options]
        limits = [seconds for seconds in timeouts if isinstance(seconds, (int, float))]
        if limits and isinstance(component, Actuator):
            component.limit_commands(min(limits))
        realism = declaration.options.get("realism")
        if isinstance(realism, RealismModel):
            component.realism = component.make_realism(realism)
        return component


def _check_methods(component: Object, declaration: ComponentDeclaration) -> None:
    for text, is_essential in [*hidden_methods(component), *lazy_methods(component)]:
        if is_essential:
            raise LoadError(text)
        logger.warning("%s: %s", _where(declaration), text)


def _instance(cls: type[Any], obj: Body, robot: Robot | None) -> Any:
    try:
        return cls(obj, robot)
    except TypeError:
        signature = inspect.signature(cls.__init__)
        try:
            signature.bind(None, obj, robot)
        except TypeError:
            form = "expected __init__(self, obj, parent=None)"
            raise LoadError(f"{cls.__name__}.__init__{signature} cannot be called; {form}") from None
        raise


def _class_of_level(cls: type, level: str | None) -> type:
    choices = levels(cls)
    choice = choices.get(level) if level is not None else next((v for v in choices.values() if v.default), None)
    return load_class(choice.classpath) if choice is not None and choice.classpath else cls


def connect(context: Context, parts: Loaded, declarations: Sequence[ComponentDeclaration] | None = None) -> None:
    """Add modifiers and overlays, and open streams and services.

    Without a network, only streams that do not need one are opened.

    Args:
        declarations: declarations of the components to connect; None for all components of the scene.
    """
    declarations = context.scene.components if declarations is None else declarations
    everything: dict[str, Any] = {**context.robots, **context.components}
    present = [(d, everything[d.name]) for d in declarations if d.name in everything]
    if context.scene.alterations:
        for declaration, component in present:
            if declaration.kind == "sensor":
                _alter(declaration, type(component), context.scene.alterations)
    with Unclaimed(component for _, component in present):
        for declaration, component in present:
            for modifier in declaration.modifiers:
                with about(modifier.where or declaration.where):
                    _add_modifier(component, declaration, modifier, parts)
    check_kinds(present)
    for declaration, component in present:
        with about(declaration.where):
            _add_interfaces(context, component, declaration)
    for declaration, component in present:
        name = _where(declaration)
        with _blamed(declaration.where, name, f"{name} cannot check the scene"):
            component.check_scene()


def _alter(declaration: ComponentDeclaration, cls: type, alterations: Sequence[SensorAlteration]) -> None:
    """Declare the modifiers of all sensors that fit one sensor, unless an earlier run of the scene has done so.

    A sensor that has such a modifier of its own keeps it, with its options.
    """
    places = {one.where for one in alterations}
    own = {each.classpath for each in declaration.modifiers if each.where not in places}
    for one in alterations:
        path = fitting_modifier(one.name, cls)
        known = any(each.classpath == path and each.where == one.where for each in declaration.modifiers)
        if path is not None and path not in own and not known:
            # the rest are options of the classes of this modifier for other kinds of sensors
            accepted = getattr(load_class(path), "options", None)
            options = {name: value for name, value in one.options.items() if accepted is None or name in accepted}
            declaration.modifiers.append(ModifierDeclaration(path, options, one.where))


def _add_interfaces(context: Context, component: Object, declaration: ComponentDeclaration) -> None:
    try:
        with Unclaimed([component]):
            overlays = [
                (load_class(overlay.classpath)(component, **overlay.options), overlay.manager)
                for overlay in declaration.overlays
            ]
        for instance, _ in overlays:
            context.overlays[instance.name()] = instance
    except (MorseError, *ENDINGS):
        raise
    except BaseException as error:
        raise LoadError(f"overlay of {_where(declaration)}: {describe(error)}", declaration.where) from error
    for stream in declaration.streams:
        if (context.network is None and needs_network(stream.manager)) or stream.manager in context.guard.managers_off:
            continue
        try:
            manager = context.stream_managers.get(stream.manager)
            if manager is None:
                manager = context.stream_managers[stream.manager] = make_stream_manager(context, stream.manager)
            with about(stream.where):
                manager.connect(component, stream)
        except MorseError as error:
            raise LoadError(f"{_where(declaration)}: {error}", declaration.where) from None
        except (OSError, *ENDINGS):
            raise
        except BaseException as error:
            text = f"the stream {stream.stream} of {_where(declaration)} cannot be opened: {describe(error)}"
            raise LoadError(text, stream.where or declaration.where) from error
    if context.network is None:
        return
    for name in declaration.managers:
        add_request_manager(context, name, declaration.where)
        context.services.register_request_manager_mapping(declaration.name, name)
    context.services.register_object(declaration.name, component)
    for instance, manager_name in overlays:
        add_request_manager(context, manager_name, declaration.where)
        context.services.register_request_manager_mapping(instance.name(), manager_name)
        context.services.register_object(instance.name(), instance)


def check_kinds(present: list[tuple[ComponentDeclaration, Object]]) -> None:
    """Raise one error for all invalid message kinds; it is called after the modifiers have changed the fields.

    Raises:
        LoadError: the message contains the names of the components.
    """
    declarations = {component: declaration for declaration, component in present}
    findings = findings_of(component for _, component in present)
    if findings:
        text = "\n".join(f"{_where(declarations[one])}: {finding}" for one, finding in findings)
        raise LoadError(text, declarations[findings[0][0]].where)


def make_modifier(
    component: Object, declaration: ComponentDeclaration, modifier: ModifierDeclaration
) -> AbstractModifier:
    """Instantiate one modifier of a component.

    Raises:
        LoadError: the message contains the component and the line of the script that created it.
    """
    owner = _where(declaration)
    with _blamed(modifier.where, f"modifier of {owner}", f"modifier {modifier.classpath} of {owner}"):
        cls = load_class(modifier.classpath)
        if reason := laziness(getattr(cls, "modify", None)):
            raise LoadError(f"{cls.__name__}.modify {reason}: a call of it runs nothing")
        instance: AbstractModifier = cls(component, dict(modifier.options))
        instance.initialize()
        return instance


def _add_modifier(
    component: Object, declaration: ComponentDeclaration, modifier: ModifierDeclaration, parts: Loaded
) -> None:
    instance = make_modifier(component, declaration, modifier)
    direction = "OUT" if declaration.kind == "sensor" else "IN"
    if isinstance(component, ExternalObject) and modifier.direction is not None:
        direction = modifier.direction
    (component.output_modifiers if direction == "OUT" else component.input_modifiers).append(instance)
    component.offer(instance)
    parts.modifier_objects.append(instance)
    if modifier.classpath not in parts.modifiers:
        parts.modifiers.append(modifier.classpath)


def make_stream_manager(context: Context, classpath: str) -> Middleware:
    """Start the stream manager of a class path.

    Raises:
        LoadError: its class raises an error.
    """
    options = dict(context.scene.manager_options.get(classpath, {}))
    with _starting(f"the stream manager {classpath}"):
        cls: Any = load_class(classpath)
        description = middleware_of_stream_manager(classpath)
        if description is not None and description.manager_options and getattr(cls, "manager_options", None) is None:
            options = with_defaults(description.manager_options, options)
        # those of MORSE 1.4 take (args, kwargs), of which the second are the options
        is_of_1_4 = list(inspect.signature(cls).parameters)[1:2] == ["kwargs"]
        manager: Middleware = cls(context, options) if is_of_1_4 else cls(options, context)
    return manager


def add_request_manager(context: Context, classpath: str, where: SourceLine | None = None) -> None:
    """Start the request manager of a class path, unless it is already running.

    Args:
        where: the line of the script that wants it, for errors.

    Raises:
        LoadError: its class raises an error.
    """
    if classpath not in context.services.request_managers():
        with _starting(f"the request manager {classpath}", where):
            context.services.add_request_manager(_make_request_manager(context, load_class(classpath)))


@contextmanager
def _starting(what: str, where: SourceLine | None = None) -> Iterator[None]:
    """Errors of classes of users become messages with their lines; those that are messages already stay."""
    try:
        yield
    except (MorseError, OSError, *ENDINGS):
        raise
    except BaseException as error:
        raise LoadError(f"{what} cannot start: {describe(error)}", where) from error


def _make_request_manager(context: Context, cls: Any) -> RequestManager:
    try:
        inspect.signature(cls).bind(context)
    except TypeError:
        # those of MORSE 1.4 take no arguments; what they need of the context is there before `initialization`
        manager: RequestManager = cls()
        manager.context = context
        return manager
    return cls(context)  # type: ignore[no-any-return]
