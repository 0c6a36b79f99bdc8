"""A small world with the component on a robot, and objects for sensors."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

from morse.builder.errors import ScriptError
from morse.core.actuator import Actuator
from morse.core.classes.project_imports import ProjectImports
from morse.core.reports.faults import describe
from morse.core.streams.pending_commands import PendingCommands
from morse.launch.load import described, start
from morse.simulation.loader import LoadError
from morse.simulation.options import RunOptions
from morse.verification.contract.examples import example
from morse.verification.contract.places import Places
from morse.verification.contract.subjects import Subject, SubjectError
from morse.wire.encoding import to_json

if TYPE_CHECKING:
    from types import TracebackType

    from morse.core.object import Object
    from morse.simulation.simulation import Simulation
    from morse.verification.contract.log_capture import LogCapture

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
        messages = []
        for _ in range(ticks):
            self.simulation.step()
            messages.append(to_json(component.local_data))
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
