"""Scenes with four robots and one component of MORSE on each, as plain names, so that other processes can make them."""

import contextlib
import math
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import morse
import morse.builder as builder
from morse.builder.names import catalog
from morse.core.actuator import PendingCommands
from morse.core.declarations import properties
from morse.verification.contract.contract_world import example

PARTS = str(Path(__file__).parent)
COUNT = 4
#: the robots to try, because components may need wheels, rotors or a skeleton
_CARRIERS = ("ATRV", "Pioneer3DX", "Quadrotor", "QUAD2012", "Hummer", "Submarine", "Human", "FakeRobot")
_ARGUMENTS: dict[str, tuple[Any, ...]] = {"Armature": ("arm", "kuka_armature", "kuka_lwr")}
_HOLDERS = {"ArmaturePose": "KukaLWR", "PTUPosture": "PTU"}
#: services that take time, with their arguments: what they do is under way when the state is saved
_SERVICES = {
    "Waypoint": ("goto", (3.0, 2.0, 0.0, 0.2, 0.8)),
    "RotorcraftWaypoint": ("goto", (3.0, 2.0, 2.0, 0.0, 0.5)),
    "PTU": ("set_pan_tilt", (0.8, 0.4)),
    "KukaLWR": ("set_rotation", ("kuka_2", 0.7)),
}


def names() -> list[str]:
    """The classes of all sensors and actuators of MORSE in scene scripts."""
    return [name for package in ("morse.sensors", "morse.actuators") for name in catalog.components(package)]


def _shrink(component: Any) -> None:
    # images of a few pixels are sufficient
    if "cam_width" in {prop.name for prop in properties(component.component_class() or object).values()}:
        component.properties(cam_width=16, cam_height=12)
    for inner in component.children:
        _shrink(inner)


def _carry(robot: Any, name: str) -> Any:
    holder = robot
    if name in _HOLDERS:
        holder = getattr(builder, _HOLDERS[name])("holder")
        robot.append(holder)
    if name == "CompoundSensor":
        member = builder.Pose("member")
        robot.append(member)
        part = builder.CompoundSensor([member])
    else:
        part = getattr(builder, name)(*_ARGUMENTS.get(name, ()))
    part.name = "part"
    holder.append(part)
    _shrink(part)
    return part


def scene(name: str, carrier: str, *, real: bool = False) -> Callable[[], None]:
    """A function that builds the scene.

    Args:
        real: whether sensors have noise and a delay.
    """

    def build() -> None:
        for number in range(COUNT):
            robot = getattr(builder, carrier)()
            robot.name = f"r{number}"
            robot.translate(x=6.0 * number, z=0.3)
            part = _carry(robot, name)
            if real:
                part.delay(0.04)
                with contextlib.suppress(builder.MorseBuilderError):
                    part.noise(gaussian=0.01)
            if carrier == "ATRV" and name != "MotionVW":
                robot.append(builder.MotionVW("drive"))
        wall = builder.Cube("Wall")
        wall.location = (4.0, 0.5, 1.0)
        wall.properties(Object=True, Fire=True, Robot_Tag=True, Injured=True, Catched_Object=True)
        wall._bpy_object.game.physics_type = "STATIC"
        env = builder.Environment("empty", fastmode=True)
        env.properties(longitude=1.43, latitude=43.6, altitude=135.0)

    return build


def load(name: str, *, real: bool = False) -> tuple[Any, str]:
    """A simulation with the first robot that can carry the component, and the class of the robot."""
    first: Exception | None = None
    for carrier in ("Human", *_CARRIERS) if name == "HumanPosture" else _CARRIERS:
        try:
            return morse.load(scene(name, carrier, real=real), seed=3), carrier
        except Exception as error:
            first = first or error
    assert first is not None
    raise first


def go(simulation: Any, name: str, ticks: int) -> list[Any]:
    """Step with commands that depend on the tick only; return the data of all components and all poses, per tick."""
    said = []
    for _ in range(ticks):
        tick = simulation.ticks
        for actuator in simulation.loaded.actuators:
            if actuator.name().endswith("drive"):
                actuator.local_data.update(v=0.4 * math.sin(0.1 * tick), w=0.3)
            elif tick % 17 == 3:
                pending = PendingCommands.all_of(actuator)
                (pending[0] if pending else PendingCommands(actuator)).give(example(actuator))
        if tick == 5 and name in _SERVICES:
            service, arguments = _SERVICES[name]
            for number in range(COUNT):
                simulation.call(f"r{number}.part", service, *arguments)
        simulation.step()
        data = {name: repr(dict(part.local_data)) for name, part in simulation.context.components.items()}
        poses = [list(map(list, obj.world_pose())) for obj in simulation.context.world.objects_by_name.values()]
        said.append((data, repr(poses)))
    return said


def go_on(name: str, carrier: str, content: bytes, ticks: int, *, real: bool) -> tuple[list[Any], str]:
    """For another process: restore a state, go on, and return what `go` returns and the hash."""
    from morse.simulation.states.state import State

    if PARTS not in sys.path:
        sys.path.insert(0, PARTS)
    with morse.load(scene(name, carrier, real=real), seed=3) as simulation:
        simulation.restore(State.from_bytes(content))
        return go(simulation, name, ticks), simulation.state_hash()
