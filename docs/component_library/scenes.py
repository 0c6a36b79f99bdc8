"""Examples: scene scripts and clients that use one component."""

from __future__ import annotations

import re

from morse.core.declarations import data_fields

#: components that need a certain robot; all others are on an ATRV
_CARRIERS = {
    "HumanPosture": "Human",
    "MotionVWDiff": "Pioneer3DX",
    "QuadrotorDynamicControl": "Quadrotor",
    "RotorcraftAttitude": "Quadrotor",
    "RotorcraftVelocity": "Quadrotor",
    "RotorcraftWaypoint": "Quadrotor",
    "StabilizedQuadrotor": "QUAD2012",
    "SteerForce": "Hummer",
    "WheelEncoders": "Pioneer3DX",
}
#: components that are appended to another component of the robot
_HOLDERS = {"ArmaturePose": "KukaLWR", "PTUPosture": "PTU"}
#: arguments of the constructors of components
ARGUMENTS = {"Armature": {"armature_name": "kuka_armature", "model_name": "kuka_lwr"}}
#: positions of components that the body of the robot would hide
_PLACES = {"Gripper": ("translate(x=0.6, z=0.5)", "rotate(y=1.5708)")}
#: fields that depend on the model
_OWN_FIELDS = {"morse.actuators.armature.Armature": {"kuka_2": 0.0, "kuka_4": 0.0}}
#: components that set their own name, with the name of one of their parts that has data
_OWN_NAMES = {"Kinect": "Kinect.depth"}
#: values for fields whose defaults are not instructive
_VALUES = {
    "LedArray": {"colours": "[[[1.0, 0.5, 0.0]] * 8] * 8"},
    "Gripper": {"grab": "True"},
    "Sound": {"mode": '"play"'},
    "ExternalForce": {"force": "[40.0, 0.0, 0.0]"},
    "ForceTorque": {"force": "[40.0, 0.0, 0.0]"},
}
#: components that need a geographic position
_ON_THE_EARTH = ("Magnetometer",)


#: scenes of components that consist of other components
OWN_SCENES = {
    "CompoundSensor": """from morse.builder import *

robot = ATRV()

pose = Pose()
robot.append(pose)

velocity = Velocity()
robot.append(velocity)

compound_sensor = CompoundSensor([pose, velocity])
robot.append(compound_sensor)

robot.add_default_interface('socket')
env = Environment('empty')"""
}


def component_scene(name: str, *, sensor: bool, fields: bool) -> str:
    """A scene script with a component on a robot."""
    if name in OWN_SCENES:
        return OWN_SCENES[name]
    variable = variable_of(name)
    robot = _CARRIERS.get(name, "ATRV")
    lines = ["from morse.builder import *", "", f"robot = {robot}()", ""]
    holder = "robot"
    if name in _HOLDERS:
        holder = variable_of(_HOLDERS[name])
        lines += [f"{holder} = {_HOLDERS[name]}()", f"robot.append({holder})", ""]
    given = ", ".join(f"{key}={value!r}" for key, value in ARGUMENTS.get(name, {}).items())
    lines.append(f"{variable} = {name}({given})")
    if sensor and holder == "robot":
        lines.append(f"{variable}.translate(x=0.3, z=0.8)")
    lines += [f"{variable}.{place}" for place in _PLACES.get(name, ())]
    lines += [f"{holder}.append({variable})", ""]
    if fields:
        lines.append("robot.add_default_interface('socket')")
    lines.append("env = Environment('empty')")
    if name in _ON_THE_EARTH:
        lines.append("env.properties(longitude=1.43, latitude=43.6, altitude=135.0)")
    return "\n".join(lines)


def robot_scene(name: str, *, motion: str, height: float) -> str:
    """A scene script with a robot that a client can drive, at some height above the ground, m."""
    up = f", z={height}" if height else ""
    return "\n".join(
        [
            "from morse.builder import *",
            "",
            f"robot = {name}()",
            f"robot.translate(x=1.0{up})",
            "",
            f"motion = {motion}()",
            "robot.append(motion)",
            "",
            "robot.add_default_interface('socket')",
            "env = Environment('empty')",
        ]
    )


def client(name: str, cls: type, *, sensor: bool) -> str:
    """A program that reads a sensor, or commands an actuator."""
    holder = f"{variable_of(_HOLDERS[name])}." if name in _HOLDERS else ""
    component = f"simu.robot.{holder}{_OWN_NAMES.get(name, variable_of(name))}"
    if sensor:
        return f"from pymorse import Morse\n\nwith Morse() as simu:\n    print({component}.get())"
    fields = {field: value.default for field, value in data_fields(cls).items()}
    fields |= _OWN_FIELDS.get(f"{cls.__module__}.{cls.__name__}", {})
    known = _VALUES.get(name, {})
    values = ", ".join(f'"{field}": {known.get(field) or _example(value)}' for field, value in fields.items())
    return f"from pymorse import Morse\n\nwith Morse() as simu:\n    {component}.publish({{{values}}})"


def variable_of(name: str) -> str:
    """The variable that holds a component of that class: ``video_camera`` for ``VideoCamera``."""
    return re.sub(r"(?<=[a-z0-9])(?=[A-Z])|(?<=[A-Z])(?=[A-Z][a-z])", "_", name).lower()


def _example(value: object) -> str:
    if isinstance(value, bool) or value is None:
        return repr(value)
    if isinstance(value, (int, float)):
        return "0.5" if isinstance(value, float) else "1"
    if isinstance(value, list) and value and not any(value):
        return repr([0.5] * len(value))  # zeros do nothing that could be seen
    # the default of many fields is the initial state of the robot, described in words
    return repr(value) if isinstance(value, (list, dict)) else "0.5"
