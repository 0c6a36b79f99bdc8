"""A small world with the component on a robot, and objects for sensors."""

from __future__ import annotations

import ast
import logging
import math
import os
import sys
import tempfile
from contextlib import contextmanager
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from morse.builder.errors import ScriptError
from morse.core.actuator import Actuator, PendingCommands
from morse.core.classes.project_imports import ProjectImports
from morse.core.declarations import fields_of_component
from morse.core.reports.faults import describe
from morse.launch.load import described, start
from morse.simulation.loader import LoadError
from morse.simulation.options import RunOptions
from morse.system.regular_files import read_regular
from morse.verification.contract.subjects import Subject, SubjectError
from morse.wire.encoding import to_json

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping
    from types import TracebackType

    from morse.core.declarations import DataField
    from morse.core.object import Object
    from morse.core.values import Fields
    from morse.simulation.simulation import Simulation


# The log of a simulation during the check of a component.


class LogCapture(logging.Handler):
    """Collects the errors of the simulation, so that they are not printed; used as a context manager."""

    def __init__(self) -> None:
        super().__init__(logging.ERROR)
        self._errors: list[str] = []
        self._listens = True
        self._before: tuple[bool, list[logging.Handler]] = (True, [])

    def emit(self, record: logging.LogRecord) -> None:
        """See `logging.Handler`."""
        if self._listens:
            self._errors.append(record.getMessage())

    def take(self) -> list[str]:
        """The errors since the last call."""
        errors, self._errors = self._errors, []
        return errors

    def last(self, otherwise: str) -> str:
        """The last error; clears the list."""
        errors = self.take()
        return errors[-1] if errors else otherwise

    @contextmanager
    def unheard(self) -> Iterator[None]:
        """Ignore errors in the block."""
        self._listens = False
        try:
            yield
        finally:
            self._listens = True

    def __enter__(self) -> LogCapture:
        logger = logging.getLogger("morse")
        self._before = logger.propagate, logger.handlers[:]
        logger.propagate, logger.handlers[:] = False, [self]
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        logger = logging.getLogger("morse")
        logger.propagate, logger.handlers[:] = self._before


# The file and line in which a component declares something.

_KEPT = 64


class Places:
    """Finds declarations.

    Args:
        files: files of modules that only one simulation has imported, by name.
    """

    def __init__(self, files: Mapping[str, str]) -> None:
        self._files = dict(files)

    def of_class(self, cls: type) -> str:
        """File and line of a class, as ``path:line``; empty if it has no file."""
        file = self._file(cls)
        definition = _definition(cls, file)
        return _shown(file, definition.lineno) if definition is not None else ""

    def of(self, cls: type, function: str, name: str) -> str:
        """File and line in which a class or one of its bases declares something.

        Args:
            function: ``add_data``, ``add_property``, ``add_level``; ``def`` for a method.
            name: the name that is declared, as any of the first three arguments.
        """
        for base in cls.__mro__:
            file = self._file(base)
            definition = _definition(base, file)
            for line in () if definition is None else _declared(definition, function, name):
                return _shown(file, line)
        return self.of_class(cls)

    def _file(self, cls: type) -> str:
        file = self._files.get(cls.__module__)
        return file or str(getattr(sys.modules.get(cls.__module__), "__file__", "") or "")


def _declared(definition: ast.ClassDef, function: str, name: str) -> Iterator[int]:
    for statement in definition.body:
        if isinstance(statement, (ast.FunctionDef, ast.AsyncFunctionDef)):
            if function == "def" and statement.name == name:
                yield statement.lineno
            continue
        for node in ast.walk(statement):
            if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == function:
                words = [argument.value for argument in node.args[:3] if isinstance(argument, ast.Constant)]
                if name in words:
                    yield node.lineno


def _definition(cls: type, file: str) -> ast.ClassDef | None:
    return next((d for d in _classes(file) if d.name == cls.__name__), None) if file else None


@lru_cache(maxsize=_KEPT)
def _parsed(file: str, _modified: float) -> tuple[ast.ClassDef, ...]:
    tree = ast.parse(read_regular(file), file)
    return tuple(node for node in ast.walk(tree) if isinstance(node, ast.ClassDef))


def _classes(file: str) -> tuple[ast.ClassDef, ...]:
    try:
        return _parsed(file, os.stat(file).st_mtime)
    except (OSError, SyntaxError, ValueError):
        return ()


def _shown(file: str, line: int) -> str:
    path, here = Path(file), Path.cwd()
    return f"{path.relative_to(here) if path.is_relative_to(here) else path}:{line}"


# Commands and values for checks: some valid ones, and many invalid ones.

#: a number that is valid for most quantities
_SOME = 0.3
_deep: list[object] = []
for _ in range(100):
    _deep = [_deep]
_endless: Fields = {}
_endless["again"] = _endless

#: invalid or malicious values of clients
BAD_VALUES: tuple[object, ...] = (
    None, True, "nonsense", "", "\ud800", b"bytes", math.nan, math.inf, -math.inf, 1e308, -1e308, 1e30, -1e30, 5e-324,
    -1, 0, 10**400, 2**63, [], {}, [[]], [math.nan] * 3, [1e308] * 3, ["a", "b", "c"], [1.0] * 1000, {"x": None}, _deep,
    _endless, object(),
)  # fmt: skip


def example(component: Object) -> Fields:
    """A valid command for an actuator."""
    declarations = fields_of_component(component)
    values = {
        name: _example(declarations[name], initial)
        for name, initial in component.local_data.items()
        if name in declarations
    }
    return {name: value for name, value in values.items() if value is not None}


def _example(field: DataField, value: Any) -> object:
    if isinstance(value, bool):
        return not value
    if isinstance(value, (int, float)):
        return _inside(type(value)(value + _SOME), field)
    if field.shape is not None and not field.quaternion and None not in field.shape and len(field.shape) == 1:
        return [_inside(float(number) + _SOME, field) for number in value]
    return None


def _inside(number: Any, field: DataField) -> object:
    if field.low is not None and number < field.low:
        return field.low
    return field.high if field.high is not None and number > field.high else number


_NAME = "part"
#: robots to try, with their drives: components may need wheels, rotors or a steering wheel
CARRIERS = {
    "ATRV": "MotionVW",
    "Pioneer3DX": "MotionVWDiff",
    "Quadrotor": "",
    "QUAD2012": "",
    "Hummer": "",
    "Submarine": "",
    "FakeRobot": "",
    "Human": "",
}
#: components that are appended to another one
HOLDERS = {"ArmaturePose": "KukaLWR", "PTUPosture": "PTU"}
_SCRIPT = """
from morse.builder import *
from morse.core.declarations import properties as _properties
from morse.core.object import Object as _Object
from morse.core.robot import Robot as _RobotClass
{imports}

if not issubclass({name}, (Robot, ComponentCreator, _Object)):
    raise TypeError(
        "it is derived neither from Sensor nor from Actuator nor from Robot; test it with a component that uses it"
    )

def _carry(holder, component, name):
    component.name = name
    holder.append(component)
    return component

def _small(component):
    # images of a few pixels are sufficient
    names = [declared.name for declared in _properties(component.component_class() or object).values()]
    if "cam_width" in names:
        component.properties(cam_width=32, cam_height=24)
    for inner in component.children:
        _small(inner)

if issubclass({name}, (Robot, _RobotClass)):
    part = {call}
    part.translate(z=0.2)
else:
    _robot = {robot}()
    _robot.name = "robot"
    _robot.translate(z=0.2)
    {drive}
    _member = _carry(_robot, Pose(), "member")
    part = _carry({holder}, {call}, "part")
    _small(part)
part.name = "part"
{level}
wall = Cube("Wall")
wall.location = (4.0, 0.0, 1.0)
wall.properties(Object=True, Fire=True, Robot_Tag=True, Injured=True, Catched_Object=True)
wall.static()
env = Environment("empty")
env.properties(longitude=1.43, latitude=43.6, altitude=135.0)
"""


class ContractWorld:
    """A loaded simulation for the check; used as a context manager.

    Attributes:
        simulation: a simulation without sockets.
        carrier: class path of the robot.
        robot: name of its class; empty for a component that is a robot itself.
        name: the full name of the component.
    """

    def __init__(self, simulation: Simulation, carrier: str) -> None:
        self.simulation = simulation
        self.carrier = carrier
        self._inbox: tuple[Actuator, PendingCommands] | None = None
        is_robot = _NAME in simulation.context.robots
        self.name = _NAME if is_robot else self._full_name()
        self.robot = "" if is_robot else carrier.rpartition(".")[2]

    def _full_name(self) -> str:
        return next(name for name in self.simulation.context.components if name.rpartition(".")[2] == _NAME)

    @property
    def component(self) -> Object:
        """The present component: a restart creates another one."""
        component = self.simulation.context.component(self.name)
        assert component is not None
        return component

    @property
    def failed(self) -> bool:
        """Whether the simulation has deactivated the component because it raised an exception."""
        return self.name in self.simulation.context.failed

    @property
    def places(self) -> Places:
        """The positions of the declarations of its class."""
        project = self.simulation.scene.project
        return Places(project.sources() if isinstance(project, ProjectImports) else {})

    def run(self, ticks: int) -> list[bytes]:
        """Run ticks while the component is active, and return its published data, as JSON, tick by tick.

        Raises:
            TypeError: its data cannot be written as JSON.
            ValueError: its data contain themselves.
        """
        component = self.component
        if isinstance(component, Actuator):
            self.publish(example(component))
        drive = self.simulation.context.component("robot.drive")
        if drive is not None:
            drive.local_data.update(v=0.4, w=0.3)
        messages: list[bytes] = []
        last: object = None
        for _ in range(ticks):
            self.simulation.step()
            # a lidar publishes megabytes, and not in each tick
            present = _flat(component.local_data)
            messages.append(messages[-1] if messages and present == last is not None else to_json(component.local_data))
            last = present
        return messages

    def publish(self, message: object) -> None:
        """Send a command to an actuator.

        Raises:
            CommandError: it is invalid.
        """
        component = self.component
        assert isinstance(component, Actuator)
        if self._inbox is None or self._inbox[0] is not component:
            self._inbox = component, PendingCommands(component)
        self._inbox[1].give(message)

    def __enter__(self) -> ContractWorld:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.simulation.close()


def _flat(data: Mapping[str, object]) -> object:
    """Values that are equal only if the JSON of the data is; None if they are more than arrays, numbers and words."""
    values: list[object] = []
    for name, value in data.items():
        if isinstance(value, np.ndarray) and not value.dtype.hasobject:
            values += name, value.dtype, value.shape, value.tobytes()
        elif value is None or type(value) in (bool, int, float, str):
            values += name, type(value), repr(value)
        else:
            return None
    return values


def set_up(subject: Subject, journal: LogCapture, robot: str | None = None, level: str | None = None) -> ContractWorld:
    """The simulation for a component, on the first suitable robot.

    Args:
        robot: class of `morse.builder` or ``package.module.Class``; None to try those of MORSE.
        level: abstraction level; None for the default level.

    Raises:
        SubjectError: no robot is suitable; the message is that of the first robot.
    """
    errors: list[str] = []
    for carrier in (robot,) if robot else CARRIERS:
        try:
            with journal.unheard():
                return ContractWorld(_load(subject, _script(subject, carrier, level)), carrier)
        except (LoadError, ScriptError, ValueError) as error:
            in_stand = isinstance(error, ScriptError) and str(error.where).startswith(str(error.script))
            errors.append(error.message if isinstance(error, ScriptError) and in_stand else str(error))
        except SystemExit as leaving:
            raise SubjectError(f"it ends the program: {describe(leaving)}") from None
    if len(set(errors)) == 1:  # an error of the component itself
        raise SubjectError(errors[0])
    raise SubjectError(f"no robot can carry it; --robot names one that can carry it: {errors[0]}")


def _load(subject: Subject, text: str) -> Simulation:
    with tempfile.TemporaryDirectory() as folder:
        script = Path(folder, "stand.py")
        script.write_text(text, encoding="utf-8")
        options = RunOptions(
            sockets=False,
            view="none",
            open_browser=False,
            seed=1,
            source_paths=list(subject.source_paths),
            resource_paths=list(subject.resource_paths),
        )
        return start(described(script, options), options)


def _script(subject: Subject, carrier: str, level: str | None) -> str:
    package, _, robot = carrier.rpartition(".")
    drive, holder = CARRIERS.get(carrier, ""), HOLDERS.get(subject.name, "")
    return _SCRIPT.format(
        imports="\n".join([subject.imports, f"from {package} import {robot}" if package else ""]),
        name=subject.name,
        call=subject.call,
        robot=robot,
        drive=f'_carry(_robot, {drive}(), "drive")' if drive else "",
        holder=f'_carry(_robot, {holder}(), "holder")' if holder else "_robot",
        level=f"part.level({level!r})" if level else "",
    )
