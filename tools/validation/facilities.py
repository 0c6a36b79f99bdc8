"""Belts, turntables and lifts: they carry as friction says, and move as their speeds say."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from figures import Figure, G, scene

if TYPE_CHECKING:
    from collections.abc import Iterator

_BOX = """
box = Cube("box")
box.scale = (0.15, 0.15, 0.1)
box.set_rigid_body()
box.set_damping()
box.set_mass(5.0)
"""
_END = '\nEnvironment("empty", fastmode=True)\n'


def figures() -> Iterator[Figure]:
    """Measure all figures."""
    for speed in (0.1, 0.5, 2.0):
        yield carried(speed)
    for friction in (0.1, 0.3):
        yield started(friction)
    for slope in (0.24, 0.36):
        yield steep(slope, 0.3)
    yield curved()
    yield lift()


def carried(speed: float) -> Figure:
    """Measure the speed of a box on a belt."""
    text = f"belt = Conveyor(length=20.0, speed={speed}, acceleration=100.0)\n{_BOX}box.translate(x=5.0, z=0.902)"
    with scene(text + _END) as simulation:
        box = simulation.context.world.objects_by_name["box"]
        simulation.step(90)
        begin = box.worldPosition.x
        simulation.step(180)
        measured = (box.worldPosition.x - begin) / 3.0
    return Figure(f"box on a belt of {speed:g} m/s", "speed, m/s", speed, measured, 0.01 * speed, "that of the belt")


def started(friction: float) -> Figure:
    """Measure the acceleration of a box on a belt that is faster at once."""
    text = (
        f"belt = Conveyor(length=20.0, speed=3.0, acceleration=100.0, friction={friction}, running=False)\n"
        f"{_BOX}box.translate(x=5.0, z=0.902)"
    )
    with scene(text + _END) as simulation:
        box = simulation.context.world.objects_by_name["box"]
        simulation.step(60)
        simulation.belt.start()
        simulation.step(10)
        before = box.worldLinearVelocity.x
        simulation.step(30)
        measured = (box.worldLinearVelocity.x - before) / 0.5
    name = f"box that slips on a belt, μ = {friction:g}"
    return Figure(name, "acceleration, m/s²", friction * G, measured, 0.03 * friction * G, "μ g")


def steep(slope: float, friction: float) -> Figure:
    """Measure the acceleration of a box on a belt that runs uphill."""
    x, z = 10.0 * math.cos(slope) - 0.902 * math.sin(slope), 10.0 * math.sin(slope) + 0.902 * math.cos(slope)
    text = (
        f"belt = Conveyor(length=20.0, speed=0.3, acceleration=100.0, friction={friction})\nbelt.rotate(y={-slope})\n"
        f"{_BOX}box.rotate(y={-slope})\nbox.translate(x={x}, z={z})"
    )
    with scene(text + _END) as simulation:
        box = simulation.context.world.objects_by_name["box"]
        simulation.step(60)
        velocity = box.worldLinearVelocity
        before = velocity.x * math.cos(slope) + velocity.z * math.sin(slope)
        simulation.step(30)
        velocity = box.worldLinearVelocity
        measured = 2.0 * (velocity.x * math.cos(slope) + velocity.z * math.sin(slope) - before)
    expected = min(0.0, G * (friction * math.cos(slope) - math.sin(slope)))
    name = f"box on a belt uphill, {math.degrees(slope):.0f}°, μ = {friction:g}"
    return Figure(name, "acceleration, m/s²", expected, measured, 0.05, "0 up to arctan μ, then g (μ cos α − sin α)")


def curved() -> Figure:
    """Measure how fast a curved belt turns a box."""
    text = f"belt = Conveyor(length=2.0, turn={math.pi / 2}, speed=0.5)\n{_BOX}box.translate(x=0.2, z=0.902)"
    with scene(text + _END) as simulation:
        box = simulation.context.world.objects_by_name["box"]
        simulation.step(60)
        begin = box.worldOrientation.to_euler().z
        simulation.step(90)
        measured = (box.worldOrientation.to_euler().z - begin) / 1.5
    expected = 0.5 * (math.pi / 2) / 2.0
    return Figure("box on a curved belt of 0.5 m/s", "rate, rad/s", expected, measured, 0.02 * expected, "v / r")


def lift() -> Figure:
    """Measure the time of a lift between two floors."""
    with scene("lift = Lift(levels=(0.0, 3.0, 7.5))" + _END) as simulation:
        data = simulation.context.robots["lift"].local_data
        simulation.lift.call(2)
        ticks = 0
        while data["height"] < 7.5:
            simulation.step(1)
            ticks += 1
    return Figure("lift, 7.5 m at 1 m/s and 0.8 m/s²", "time, s", 7.5 + 1.25, ticks / 60.0, 0.1, "s / v + v / a")
