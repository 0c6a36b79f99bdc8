"""A four-bar linkage, a screw, a wrist with a sensor of forces, and an inertial unit on an arm that turns."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from figures import Figure, G, scene

if TYPE_CHECKING:
    from collections.abc import Iterator

FIXED = '<joint name="ground" type="fixed"><parent>world</parent><child>base</child></joint><link name="base"/>'
#: m: crank, coupler, rocker, distance of the pivots; rad: angle of the crank at the start; rad/s
CRANK, COUPLER, ROCKER, GROUND, START, RATE = 0.2, 0.5, 0.4, 0.5, 0.5, 2.0
#: kg m², of a nut of 1 kg, and m per turn
INERTIA, LEAD = 0.04, 0.1
SCREW = f"""<sdf version="1.9"><model name="screw">{FIXED}
<link name="nut"><pose>0 0 9 0 0 0</pose><inertial><mass>1</mass>
<inertia><ixx>{INERTIA}</ixx><iyy>{INERTIA}</iyy><izz>{INERTIA}</izz></inertia></inertial></link>
<joint name="thread" type="screw"><parent>base</parent><child>nut</child><axis><xyz>0 0 1</xyz></axis>
<screw_thread_pitch>{LEAD}</screw_thread_pitch></joint></model></sdf>"""
#: a sensor at a joint that is fixed; the centre of the tool of 1 kg is 0.3 m aside
WRIST = f"""<sdf version="1.9"><model name="wrist">{FIXED}
<link name="mast"><pose>0 0 1 0 0 0</pose><inertial><mass>2</mass></inertial></link>
<link name="flange"><pose>0 0 1.2 0 0 0</pose><inertial><mass>1e-6</mass></inertial></link>
<link name="tool"><pose>0 0 1.25 0 0 0</pose><inertial><pose>0.3 0 0.1 0 0 0</pose><mass>1</mass></inertial></link>
<joint name="turn" type="revolute"><parent>base</parent><child>mast</child><axis><xyz>0 0 1</xyz></axis></joint>
<joint name="ft" type="fixed"><parent>mast</parent><child>flange</child>
<sensor name="pull" type="force_torque"/></joint>
<joint name="hold" type="fixed"><parent>flange</parent><child>tool</child></joint></model></sdf>"""
ARM = f"""<sdf version="1.9"><model name="arm">{FIXED}
<link name="boom"><pose>0 0 1 0 0 0</pose><inertial><mass>1</mass></inertial></link>
<link name="tip"><pose>0.8 0 1 0 0 0</pose><inertial><mass>0.1</mass></inertial><sensor name="imu" type="imu"/></link>
<joint name="hinge" type="continuous"><parent>base</parent><child>boom</child><axis><xyz>0 0 1</xyz></axis></joint>
<joint name="end" type="fixed"><parent>boom</parent><child>tip</child></joint></model></sdf>"""


def figures() -> Iterator[Figure]:
    """Measure all figures."""
    yield four_bars()
    yield from screw()
    yield from wrist()
    yield from arm()


def _text(name: str, *settings: str) -> str:
    lines = [f"robot = Robot('{{folder}}/{name}.sdf')", f"arm = Armature(armature_name='{name}_joints')", *settings]
    return "\n".join([*lines, "robot.append(arm)", "env = Environment('empty', fastmode=True)"])


def rocker_at(crank: float) -> tuple[float, float, float]:
    """The end of the coupler, m, and the angle of the rocker, rad, by the law of cosines."""
    x, y = GROUND - CRANK * math.cos(crank), -CRANK * math.sin(crank)
    far = math.hypot(x, y)
    along = (COUPLER**2 - ROCKER**2 + far**2) / (2.0 * far)
    up = math.sqrt(COUPLER**2 - along**2)
    end = CRANK * math.cos(crank) + (along * x - up * y) / far, CRANK * math.sin(crank) + (along * y + up * x) / far
    return *end, math.atan2(end[1], end[0] - GROUND)


def four_bars() -> Figure:
    """The error of the rocker of a linkage whose crank turns once and more."""

    def link(name: str, x: float, z: float, angle: float, length: float) -> str:
        return (
            f'<link name="{name}"><pose>{x} 0 {z + 1.0} 0 {-angle} 0</pose><inertial><mass>0.5</mass>'
            f"<pose>{length / 2.0} 0 0 0 0 0</pose><inertia><ixx>0.001</ixx><iyy>0.01</iyy><izz>0.01</izz></inertia>"
            "</inertial></link>"
        )

    def hinge(name: str, parent: str, child: str, pose: str = "") -> str:
        return (
            f'<joint name="{name}" type="revolute"><parent>{parent}</parent><child>{child}</child>{pose}'
            '<axis><xyz expressed_in="__model__">0 -1 0</xyz></axis></joint>'
        )

    x, y, angle = rocker_at(START)
    pin = CRANK * math.cos(START), CRANK * math.sin(START)
    closing = f'<pose relative_to="coupler">{COUPLER} 0 0 0 0 0</pose>'
    bars = (
        f'<sdf version="1.9"><model name="bars">{FIXED}'
        + link("crank", 0.0, 0.0, START, CRANK)
        + link("coupler", *pin, math.atan2(y - pin[1], x - pin[0]), COUPLER)
        + link("rocker", GROUND, 0.0, angle, ROCKER)
        + hinge("drive", "base", "crank")
        + hinge("pin", "crank", "coupler")
        + hinge("rock", "base", "rocker")
        + hinge("close", "rocker", "coupler", closing)
        + "</model></sdf>"
    )
    text = _text("bars", "arm.control('velocity', ['drive'])", "arm.control('effort', ['pin', 'rock'])")
    with scene(text, {"bars.sdf": bars}) as sim:
        joints = [sim.world.data.joint(f"robot.arm/{name}") for name in ("drive", "rock")]
        sim.robot.arm.publish({"drive": RATE})
        sim.step(3)  # the motor brings the crank to this speed within a tick
        worst = 0.0
        for _ in range(240):
            sim.step(1)
            drive, rock = (float(joint.qpos[0]) for joint in joints)
            worst = max(worst, abs(angle + rock - rocker_at(START + drive)[2]))
    source = "law of cosines, from the angle of the crank"
    return Figure(
        "four-bar linkage of 0.2, 0.5, 0.4 and 0.5 m at 2 rad/s",
        "largest error of the rocker, mrad",
        0.0,
        1e3 * worst,
        1.0,
        source,
    )


def screw() -> Iterator[Figure]:
    """The way and the fall of a nut of 1 kg that turns down a thread."""
    pitch = LEAD / math.tau
    with scene(_text("screw", "arm.control('effort')"), {"screw.sdf": SCREW}) as sim:
        sim.step(60)
        turn, way = (float(value) for value in sim.world.data.qpos)
    name = f"nut of 1 kg and {INERTIA:g} kg m² on a thread of {LEAD:g} m per turn"
    yield Figure(name, "way per turn, m", LEAD, math.tau * way / turn, 0.001, "its pitch")
    fall = 0.5 * G / (1.0 + INERTIA / pitch**2)
    yield Figure(name, "fall in 1 s, m", fall, -way, 0.01 * fall, "½ g t² / (1 + I / m p²), p = lead / 2π")


def wrist() -> Iterator[Figure]:
    """What a sensor at a fixed joint measures of a tool."""
    with scene(
        "robot = Robot('{folder}/wrist.sdf')\nenv = Environment('empty', fastmode=True)", {"wrist.sdf": WRIST}
    ) as sim:
        sim.step(120)
        load = sim.robot.pull.get()
    name = "sensor in a wrist, tool of 1 kg 0.3 m aside"
    yield Figure(name, "force along Z, N", -G, load["force"][2], 0.01, "m g, on the side of the robot")
    yield Figure(name, "torque about Y, N m", 0.3 * G, load["torque"][1], 0.01, "r × m g")


def arm() -> Iterator[Figure]:
    """The specific force at the tip of an arm that turns steadily."""
    rate, length = 3.0, 0.8
    with scene(_text("arm", "arm.control('velocity')"), {"arm.sdf": ARM}) as sim:
        sim.robot.arm.publish({"hinge": rate})
        sim.step(300)
        force = sim.robot.imu.get()["linear_acceleration"]
    name = f"IMU on an arm of {length:g} m at {rate:g} rad/s, 60 Hz"
    yield Figure(name, "outward, m/s²", -(rate**2) * length, force[0], 1e-3, "−ω² r")
    yield Figure(name, "along the path, m/s²", 0.0, force[1], 1e-3, "0: the rate is constant")
