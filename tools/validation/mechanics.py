"""Pendulum, slope, projectile, bodies that bounce, raft and wheels."""

from __future__ import annotations

import itertools
import math
from typing import TYPE_CHECKING

import trimesh
from figures import Figure, G, scene

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

PENDULUM = """
<mujoco><worldbody><body name="rod" pos="0 0 3" euler="0 {angle} 0">
  <joint type="hinge" axis="0 1 0"/><inertial pos="0 0 -1" mass="1" diaginertia="1e-3 1e-3 1e-3"/>
</body></worldbody></mujoco>
"""
TOP = """
<mujoco model="top"><option integrator="{integrator}" timestep="0.00208"/><worldbody>
  <body name="top_link" pos="0 0 1" euler="30 0 0"><joint type="ball"/>
  <inertial pos="0 0 0.1" mass="1" diaginertia="0.012 0.012 0.02"/></body></worldbody></mujoco>
"""
SLOPE = """
<mujoco><worldbody><geom name="ground" type="plane" size="50 50 1" euler="0 {angle} 0"/></worldbody></mujoco>
"""
_AXES = ("xx", "yy", "zz", "xy", "xz", "yz")
NO_DAMPING = "body.set_damping(0, 0)\n"


def figures() -> Iterator[Figure]:
    """Measure all figures."""
    for angle in (5, 60, 120):
        yield pendulum(angle)
    for angle, friction in ((20, 0.5), (28, 0.5), (36, 0.3)):
        yield slope(angle, friction)
    yield from projectile()
    for shape, restitution in itertools.product(("ball", "box"), (0.1, 0.3, 0.5, 0.7, 0.9)):
        yield from bounces(shape, restitution)
    yield spin()
    yield top("RK4", 0.1, "steady precession of a heavy top")
    yield top("implicitfast", 5.0, "as above; of first order, as the default is: the error is proportional to the step")
    yield from raft()
    yield from wheels()
    for half in (0.11, 0.14, 0.25):
        yield skid(half)


def pendulum(angle: float) -> Figure:
    """The period of a point mass on a rod of 1 m."""
    text = "rod = Robot('{folder}/rod.xml')\nenv = Environment('empty', fastmode=True)"
    times: list[float] = []
    with scene(text, {"rod.xml": PENDULUM.format(angle=angle)}) as sim:
        rod = sim.world.game_object("rod_link")
        before = time = 0.0
        for _ in range(60 * 12):
            sim.step(1)
            time += 1.0 / 60.0
            across = float(rod.world_pose()[1][2])
            if before < 0.0 <= across:
                times.append(time - across / (across - before) / 60.0)
            before = across
    # 2 pi sqrt(l / g) / agm(1, cos(a / 2))
    a, b = 1.0, math.cos(math.radians(angle) / 2.0)
    for _ in range(8):
        a, b = (a + b) / 2.0, math.sqrt(a * b)
    inertia = 1.0 + 1e-3
    expected = 2.0 * math.pi * math.sqrt(inertia / G) / a
    measured = (times[-1] - times[0]) / (len(times) - 1)
    return Figure(
        f"pendulum of 1 m, released at {angle}°", "period, s", expected, measured, 2e-3, "2π √(I/mgl) / agm(1, cos ½α)"
    )


def box(size: tuple[float, float, float]) -> object:
    """A function that writes a box."""
    return lambda path: trimesh.creation.box(size).export(path)


def slope(angle: float, friction: float) -> Figure:
    """The acceleration of a block on a slope."""
    alpha = math.radians(angle)
    text = (
        "body = PassiveObject('{folder}/block.obj')\n"
        f"body.translate(0, 0, {0.05 / math.cos(alpha)})\nbody.rotate(0, {alpha}, 0)\nbody.set_friction({friction})\n"
        + NO_DAMPING
        + "env = Environment('{folder}/slope.xml', fastmode=True)"
    )
    with scene(text, {"block.obj": box((0.4, 0.4, 0.1)), "slope.xml": SLOPE.format(angle=angle)}) as sim:
        body = sim.world.game_object("body")
        sim.step(30)
        first = body.world_pose()[0]
        sim.step(30)
        middle = body.world_pose()[0]
        sim.step(30)
        last = body.world_pose()[0]
    measured = (math.dist(middle, last) - math.dist(first, middle)) / 0.25
    expected = max(G * (math.sin(alpha) - friction * math.cos(alpha)), 0.0)
    return Figure(
        f"block on a slope of {angle}°, μ = {friction}",
        "acceleration, m/s²",
        expected,
        measured,
        max(0.02 * expected, 1e-3),
        "g (sin α − μ cos α)",
    )


def ball(path: Path) -> object:
    """Write a ball of 0.2 m."""
    return trimesh.creation.icosphere(subdivisions=3, radius=0.1).export(path)


def flight() -> list[tuple[float, float, float]]:
    """Time, x and z of a ball that is thrown at 4 m/s ahead and 5 m/s up."""
    text = "body = PassiveObject('{folder}/ball.obj')\nbody.translate(0, 0, 1)\n" + NO_DAMPING
    with scene(text + "env = Environment('empty', fastmode=True)", {"ball.obj": ball}) as sim:
        body = sim.world.game_object("body")
        body.set_velocity((4.0, 0.0, 5.0), (0.0, 0.0, 0.0))
        rows = [(0.0, 0.0, 1.0)]
        for tick in range(60):
            sim.step(1)
            x, _, z = body.world_pose()[0]
            rows.append(((tick + 1) / 60.0, x, z))
    return rows


def projectile() -> Iterator[Figure]:
    """A ball that is thrown."""
    time, x, z = flight()[60]
    yield Figure("ball thrown at 4 and 5 m/s", "x after 1 s, m", 4.0 * time, x, 1e-3, "v t")
    yield Figure(
        "ball thrown at 4 and 5 m/s",
        "z after 1 s, m",
        1.0 + 5.0 * time - G * time**2 / 2.0,
        z,
        0.025,
        "z + v t − ½ g t²",
    )


def bounces(shape: str, restitution: float) -> Iterator[Figure]:
    """The heights that a body reaches after its first three bounces, if a jump is longer than two ticks."""
    half = 0.1
    text = (
        f"body = PassiveObject('{{folder}}/body.obj')\nbody.translate(0, 0, {1.0 + half})\n"
        f"body.set_restitution({restitution})\n" + NO_DAMPING
    )
    write = ball if shape == "ball" else box((0.5, 0.4, 2.0 * half))
    with scene(text + "env = Environment('empty', fastmode=True)", {"body.obj": write}) as sim:
        body = sim.world.game_object("body")
        tops, speed = [], -1.0
        for _ in range(300):
            sim.step(1)
            before, speed = speed, float(sim.world.data.qvel[2])
            if before > 0.0 >= speed:
                # the apex, within this tick, of the parabola through the positions
                rising = speed - 0.5 * G * sim.world.model.opt.timestep
                tops.append(body.world_pose()[0][2] - half + rising * rising / (2.0 * G))
    for number, name in enumerate(("one bounce", "two bounces", "three bounces"), 1):
        expected = restitution ** (2 * number)
        if expected > 2.0 * G / 60.0**2:
            yield Figure(
                f"{shape} with restitution {restitution}, from 1 m",
                f"height after {name}, m",
                expected,
                tops[number - 1],
                max(0.005 * expected, 2e-4),
                "h e²ⁿ",
            )


def top(integrator: str, tolerance: float, source: str) -> Figure:
    """The tilt of a top on a ball joint, which precesses steadily."""
    spin, tilt = 20.0, math.radians(30.0)
    # moments about the pivot across the axis, and about the axis; the moment of the weight
    across, along, weight = 0.012 + 0.1**2, 0.02, G * 0.1
    a, b = across * math.cos(tilt), along * spin
    rate = (b - math.sqrt(b * b - 4.0 * a * weight)) / (2.0 * a)
    with scene(
        "top = Robot('{folder}/top.xml')\nenv = Environment('empty', fastmode=True)",
        {"top.xml": TOP.format(integrator=integrator)},
    ) as sim:
        sim.world.data.qvel[:3] = (0.0, rate * math.sin(tilt), spin)
        sim.step(180)
        axis = sim.world.game_object("top_link").world_pose()[1]
    measured = math.degrees(math.acos(axis[8]))
    return Figure(f"top of 20 rad/s, {integrator}", "tilt after 3 s, °", 30.0, measured, tolerance, source)


def spin() -> Figure:
    """The turning rate of a brick about its longest axis with an angular damping of 10 %/s."""
    text = "body = PassiveObject('{folder}/brick.obj')\nbody.translate(0, 0, 3)\nbody.set_damping(0, 0.1)\n"
    with scene(
        text + "env = Environment('empty', fastmode=True)\nenv.set_gravity(0)", {"brick.obj": box((0.6, 0.3, 0.1))}
    ) as sim:
        body = sim.world.game_object("body")
        body.set_velocity((0.0, 0.0, 0.0), (1.0, 0.0, 0.0))
        sim.step(600)
        measured = float(body.velocity()[1][0])
    return Figure(
        "brick with an angular damping of 10 %/s", "rate after 10 s, rad/s", 0.9**10, measured, 0.01, "(1 − d)^t"
    )


def raft() -> Iterator[Figure]:
    """The draught and the heave of a raft."""
    mass, area = 2000.0, 8.0
    text = (
        f"body = Submarine()\nbody.set_mass({mass})\nbody.translate(0, 0, 0.421)\nwater = Hydrodynamics()\n"
        "water.properties(Density=1000.0, Volume=8.0, Length=4.0, Width=2.0, Height=1.0, Surface=0.0)\n"
        "body.append(water)\n"
    )
    with scene(text + "env = Environment('water-1/deep_water', fastmode=True)") as sim:
        body = sim.world.game_object("body")
        middle = float(sim.context.component("body.water").hull().centre[2])
        heights = []
        for _ in range(60 * 15):
            sim.step(1)
            heights.append(body.world_pose()[0][2] + middle)
    name = "raft of 4 × 2 × 1 m and 2 t"
    yield Figure(name, "draught, m", 0.25, 0.5 - heights[-1], 5e-3, "Archimedes: m / ρA")
    offsets = [height - heights[-1] for height in heights]
    down = [k for k in range(1, 200) if offsets[k - 1] > 0.0 >= offsets[k]]
    # DNV-RP-N103: half of the added mass of a plate of 4 x 2 m
    added = 0.5 * 0.757 * math.pi / 4.0 * 2.0**2 * 4.0 * 1000.0
    period = 2.0 * math.pi * math.sqrt((mass + added) / (1000.0 * G * area)) / math.sqrt(1.0 - 0.3**2)
    source = "2π √((m + A) / ρgA) / √(1 − ζ²), A by DNV-RP-N103, ζ = 0.3 by Fossen"
    yield Figure(name, "period of heave, s", period, (down[1] - down[0]) / 60.0, 0.15, source)


def wheels() -> Iterator[Figure]:
    """The path of a robot on two wheels."""
    text = """
robot = Pioneer3DX()
motion = MotionVWDiff()
robot.append(motion)
encoders = WheelEncoders()
robot.append(encoders)
odometry = Odometry()
robot.append(odometry)
pose = Pose()
robot.append(pose)
env = Environment('empty', fastmode=True)
"""
    with scene(text) as sim:
        sim.step(60)
        part = {name: sim.context.component(f"robot.{name}") for name in ("motion", "encoders", "odometry", "pose")}
        part["motion"].local_data.update(v=0.5, w=0.0)
        sim.step(60)
        before = part["odometry"].local_data["x"]
        start, angles = part["pose"].local_data["x"], list(part["encoders"].local_data["position"])
        sim.step(240)
        way = part["pose"].local_data["x"] - start
        turned = [b - a for a, b in zip(angles, part["encoders"].local_data["position"], strict=True)]
        odometry = part["odometry"].local_data["x"] - before
    source = "r φ, with the radius of the model"
    yield Figure("Pioneer3DX, 0.5 m/s for 4 s", "path of its wheels, m", way, 0.0977 * sum(turned) / 2.0, 0.01, source)
    yield Figure("Pioneer3DX, 0.5 m/s for 4 s", "odometry, m", way, odometry, 2e-3, "its pose")


def skid(half: float) -> Figure:
    """The turn of a robot with four wheels that do not steer.

    Args:
        half: distance of the axles from the middle, m.
    """

    def link(name: str, mass: float, shape: str, pose: str) -> str:
        moments = " ".join(f'i{axes}="{0.01 * mass if axes[0] == axes[1] else 0}"' for axes in _AXES)
        return (
            f'<link name="{name}"><inertial><mass value="{mass}"/><inertia {moments}/></inertial><collision>'
            f"<origin {pose}/><geometry>{shape}</geometry></collision></link>"
        )

    text = link("base", 8.0, f'<box size="{2.0 * half} 0.18 0.08"/>', 'xyz="0 0 0.12"')
    for x in (half, -half):
        for y in (0.15, -0.15):
            wheel = f"wheel_{'f' if x > 0.0 else 'r'}{'l' if y > 0.0 else 'r'}"
            text += link(wheel, 0.5, '<cylinder radius="0.1" length="0.06"/>', f'rpy="{math.pi / 2.0} 0 0"')
            text += f'<joint name="{wheel}_joint" type="continuous"><parent link="base"/><child link="{wheel}"/>'
            text += f'<origin xyz="{x} {y} 0.1"/><axis xyz="0 1 0"/></joint>'
    script = """
robot = Robot('{folder}/skid.urdf')
motion = MotionVWDiff()
robot.append(motion)
pose = Pose()
robot.append(pose)
env = Environment('empty', fastmode=True)
"""
    with scene(script, {"skid.urdf": f'<robot name="skid">{text}</robot>'}) as sim:
        sim.step(60)
        start = sim.robot.pose.get()["yaw"]
        sim.robot.motion.publish({"v": 0.0, "w": 0.5})
        sim.step(240)
        turned = sim.robot.pose.get()["yaw"] - start
    return Figure(
        f"skid steering, wheels {2.0 * half:g} m apart along and 0.3 m across", "turn in 4 s at 0.5 rad/s, rad", 2.0,
        turned, 0.08, "balance of Coulomb friction (Mandow et al., IROS 2007)",
    )  # fmt: skip
