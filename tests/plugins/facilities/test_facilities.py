"""Doors and lifts: they let through and hold back, carry without a slip, and take no wrong values."""

import math
import re

import numpy as np
import pytest

import morse
from tests.kit.scenes import Load, script

DOOR = """
robot = ATRV()
robot.translate(x=-4.0, z=0.15)
motion = MotionVW()
robot.append(motion)
door = Door({arguments})
env = Environment("empty")
"""
LIFT = """
robot = FakeRobot()
robot.translate(x=9.0)
cargo = Cube("cargo")
cargo.scale = (0.3, 0.3, 0.2)
cargo.translate(x=-0.2, z=0.21)
cargo.set_rigid_body()
cargo.set_mass(20.0)
lift = Lift(levels=(0.0, 3.0, 7.5), hold=1.0)
env = Environment("empty")
"""
LASER = """
laser = Sick()
laser.translate(z=0.8)
laser.properties(scan_window=0.5, resolution=0.5)
robot.append(laser)
door ="""


def until(simulation, condition, seconds: float = 60.0) -> None:
    """Step until a condition holds; at most some simulated seconds."""
    for _ in range(int(seconds * 60)):
        if condition():
            return
        simulation.step(1)
    raise AssertionError("the condition did not come true")


@pytest.mark.parametrize("kind", ["hinged", "sliding", "double"])
def test_a_door_stops_rays_and_robots_until_it_is_open(load: Load, kind: str):
    scene = DOOR.format(arguments=f"kind={kind!r}, width=1.6, hold=600.0")
    scene = scene.replace("door =", LASER.strip())
    simulation = load(scene)
    simulation.step(12)
    door = simulation.context.robots["door"]
    assert min(simulation.robot.laser.get()["range_list"]) == pytest.approx(4.0, abs=0.1)
    simulation.robot.motion.set_speed(1.0, 0.0)
    simulation.step(360)
    assert simulation.context.robots["robot"].position_3d.x < -0.3
    simulation.robot.motion.set_speed(-1.0, 0.0)
    simulation.step(120)
    simulation.robot.motion.set_speed(0.0, 0.0)
    door.open()
    until(simulation, lambda: door.local_data["state"] == "open")
    simulation.step(12)
    assert min(simulation.robot.laser.get()["range_list"]) == 30.0
    simulation.robot.motion.set_speed(1.0, 0.0)
    simulation.step(360)
    assert simulation.context.robots["robot"].position_3d.x > 1.0


def test_it_opens_in_its_duration_and_closes_after_its_hold(load: Load):
    simulation = load(DOOR.format(arguments="duration=1.5, hold=2.0"))
    door = simulation.context.robots["door"]
    door.open()
    begin = simulation.context.clock.time
    until(simulation, lambda: door.local_data["state"] == "open")
    assert simulation.context.clock.time - begin == pytest.approx(1.5, abs=0.05)
    until(simulation, lambda: door.local_data["state"] == "closed")
    assert simulation.context.clock.time - begin == pytest.approx(1.5 + 2.0 + 1.5, abs=0.1)


def test_an_automatic_door_opens_for_robots_and_never_closes_on_them(load: Load):
    simulation = load(DOOR.format(arguments="kind='double', width=1.6, automatic=1.5, hold=0.5"))
    door, robot = (simulation.context.robots[name] for name in ("door", "robot"))
    simulation.robot.motion.set_speed(1.0, 0.0)
    until(simulation, lambda: door.local_data["openness"] > 0.0)
    assert robot.position_3d.x == pytest.approx(-1.5, abs=0.2)
    until(simulation, lambda: robot.position_3d.x > -0.1)
    simulation.robot.motion.set_speed(0.0, 0.0)
    simulation.step(600)
    assert door.local_data["state"] == "open"
    simulation.robot.motion.set_speed(1.0, 0.0)
    until(simulation, lambda: door.local_data["state"] == "closed")
    assert robot.position_3d.x > 1.5


def test_a_locked_door_stays_closed(load: Load):
    simulation = load(DOOR.format(arguments="kind='double', width=1.6, automatic=3.0"))
    door = simulation.context.robots["door"]
    door.lock()
    with pytest.raises(Exception, match="locked"):
        door.open()
    simulation.robot.motion.set_speed(1.0, 0.0)
    simulation.step(300)
    assert door.local_data["state"] == "closed"
    door.unlock()
    until(simulation, lambda: door.local_data["state"] == "open")


def test_people_open_automatic_doors(load: Load):
    scene = """
door = Door(kind="double", width=2.0, automatic=1.5)
for side in (-1, 1):
    wall = Cube(f"wall {side}")
    wall.scale = (0.1, 4.0, 2.0)
    wall.translate(y=side * 5.05)
    wall.set_physics_type("STATIC")
crowd = Crowd("crowd", 3)
crowd.start([(-5.0, -1.0), (-3.0, 1.0)])
crowd.goals([(4.0, 0.0)])
env = Environment("empty")
"""
    simulation = load(scene)
    door, crowd = (simulation.context.robots[name] for name in ("door", "crowd"))
    until(simulation, lambda: bool((np.asarray(crowd.local_data["positions"])[:, 0] > 1.0).all()))
    until(simulation, lambda: door.local_data["state"] == "closed")


def test_a_lift_travels_as_its_speed_and_acceleration_say(load: Load):
    """A trapezoid of velocity: way / v + v / a."""
    simulation = load(LIFT)
    lift = simulation.context.robots["lift"]
    lift.call(2)
    begin = simulation.context.clock.time
    until(simulation, lambda: lift.local_data["height"] == 7.5)
    assert simulation.context.clock.time - begin == pytest.approx(7.5 / 1.0 + 1.0 / 0.8, abs=0.1)


def test_a_lift_carries_what_stands_in_it(load: Load):
    simulation = load(LIFT)
    lift = simulation.context.robots["lift"]
    simulation.step(60)
    cargo = simulation.context.world.objects_by_name["cargo"]
    begin = tuple(cargo.worldPosition)
    lift.call(1)
    worst = 0.0
    for _ in range(600):
        simulation.step(1)
        if lift.local_data["openness"] > 0.0:
            break
        worst = max(worst, abs(cargo.worldPosition.z - begin[2] - lift.local_data["height"]))
    assert worst < 0.02
    simulation.step(60)
    x, y, z = cargo.worldPosition
    assert math.hypot(x - begin[0], y - begin[1]) < 0.01
    assert z - begin[2] == pytest.approx(3.0, abs=0.005)


def test_a_lift_serves_calls_in_their_order_with_closed_doors(load: Load):
    simulation = load(LIFT)
    lift = simulation.context.robots["lift"]
    for level in (2, 1, 2, 0):
        lift.call(level)
    opened, moving = [], True
    for _ in range(60 * 60):
        simulation.step(1)
        data = lift.local_data
        assert not (data["openness"] > 0.0 and data["speed"] != 0.0)
        if data["state"] == "open" and moving:
            opened.append(data["level"])
        moving = data["state"] != "open"
        if len(opened) == 3 and data["state"] == "stopped":
            break
    assert opened == [2, 1, 0]


@pytest.mark.parametrize("text", [LIFT, DOOR.format(arguments="automatic=9.0, hold=0.2")])
def test_states_and_rows_agree(load: Load, tmp_path, text: str):
    def see(context):
        names = sorted(
            name for name in context.world.objects_by_name if "panel" in name or "floor" in name or "cargo" in name
        )
        return [tuple(context.world.objects_by_name[name].worldPosition) for name in names]

    def act(simulation):
        if "lift" in simulation.context.robots:
            simulation.context.robots["lift"].call(1)

    simulation = load(text, seed=1)
    act(simulation)
    simulation.step(90)
    state = simulation.save()
    simulation.step(90)
    after = see(simulation.context)
    simulation.step(50)
    simulation.restore(state)
    simulation.step(90)
    assert see(simulation.context) == after
    with morse.batch(script(tmp_path, text), rows=2, seed=1) as rows:
        for row in rows:
            act(row)
        rows.step(180)
        assert see(rows[1].context) == after


@pytest.mark.parametrize(
    ("call", "words"),
    [
        ("Door(kind='revolving')", "Door(kind)"),
        ("Door(width=0.0)", "Door(width)"),
        ("Door(hold=float('nan'))", "Door(hold)"),
        ("Door(automatic=-1)", "Door(automatic)"),
        ("Lift(levels=(0.0,))", "2 to 100 heights"),
        ("Lift(levels=(0.0, 1.0))", "above each other"),
        ("Lift(levels=(1.0, 5.0))", "the first is 0"),
        ("Lift(levels=range(0, 5000, 5))", "2 to 100 heights"),
        ("Lift(speed=1e9)", "Lift(speed)"),
        ("Lift(size=(2.0, float('inf')))", "Lift(size)"),
        ("Lift(size=(2.0,))", "takes two numbers, depth and width, got 1"),
        ("Lift(size=3.0)", "Lift(size) takes several numbers"),
        ("Lift(levels=5)", "Lift(levels) takes several numbers"),
        ("Lift(levels=__import__('itertools').count())", "2 to 100 heights"),
        ("Lift(levels=(0.0, 10**400))", "Lift(levels) takes a finite number"),
        ("Door(width=10**400)", "Door(width) takes a finite number"),
    ],
)
def test_mistakes_are_named(tmp_path, call: str, words: str):
    with pytest.raises(Exception, match=re.escape(words)):
        morse.load(script(tmp_path, f'one = {call}\nenv = Environment("empty")')).close()


def test_services_refuse_what_is_no_floor(load: Load):
    simulation = load(LIFT)
    lift = simulation.lift
    for level in (3, -1, 1e300, "up", None, float("nan")):
        with pytest.raises(Exception, match=r"floors 0 to 2|expected|0 to 99|level"):
            lift.call(level).result()
    simulation.step(2)
    assert simulation.context.robots["lift"].local_data["state"] == "stopped"


def test_many_doors_without_names(load: Load):
    scene = """
doors = [Door(kind="double") for _ in range(20)]
for number, door in enumerate(doors):
    door.translate(x=3.0 * number)
env = Environment("empty")
"""
    assert len(load(scene).context.robots) == 20


@pytest.mark.parametrize("kind", ["hinged", "sliding", "double"])
def test_a_door_does_not_close_on_the_rear_of_a_robot(load: Load, kind: str):
    """The rear of an ATRV is 0.57 m behind its middle."""
    simulation = load(DOOR.format(arguments=f"kind={kind!r}, width=1.6, hold=0.2"))
    door, robot = (simulation.context.robots[name] for name in ("door", "robot"))
    simulation.robot.motion.set_speed(1.0, 0.0)

    def is_through() -> bool:
        door.open()
        return robot.position_3d.x > 0.5

    until(simulation, is_through)
    simulation.robot.motion.set_speed(0.0, 0.0)
    begin = tuple(robot.bge_object.worldPosition)
    simulation.step(300)
    assert door.local_data["state"] == "open"
    assert tuple(robot.bge_object.worldPosition) == pytest.approx(begin, abs=1e-3)
    simulation.robot.motion.set_speed(1.0, 0.0)
    until(simulation, lambda: door.local_data["state"] == "closed")


def test_panels_are_turned_with_their_door(load: Load):
    scene = DOOR.format(arguments="")
    simulation = load(scene.replace("env =", "door.rotate(x=1.5707963267948966, z=0.5)\ndoor.translate(z=2.0)\nenv ="))
    world = simulation.context.world
    (panel,) = (one for name, one in world.objects_by_name.items() if "panel" in name)
    turn = simulation.context.robots["door"].bge_object.world_pose()[1]
    assert panel.world_pose()[1] == pytest.approx(turn, abs=1e-6)


def test_properties_of_clients_change_no_panels(load: Load):
    """What the panels were made for stays, also after a restart."""
    scene = DOOR.format(arguments="automatic=2.0")
    simulation = load(scene.replace("env =", "lift = Lift()\nlift.translate(y=9.0)\nenv ="))
    for name, value in (("Kind", "double"), ("Width", 5.0), ("Height", 9.0)):
        with pytest.raises(Exception, match=rf"'{name}' of door is written by Door\({name.lower()}="):
            simulation.door.set_property(name, value).result()
    simulation.door.open()
    simulation.lift.call(1)
    simulation.step(200)
    assert simulation.door.data["state"] == "open"
    state = simulation.save()
    simulation.restore(state)
    simulation.reset()
    simulation.step(10)
    assert not simulation.failures
