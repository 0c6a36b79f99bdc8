"""Belts, turntables, dispensers, chargers: they carry as friction says, and what they count is so."""

import math
import re

import numpy as np
import pytest

import morse
from morse.core.state import StateError
from tests.kit.scenes import Load, script

_G = 9.81
BOX = """
box = Cube("box")
box.scale = (0.15, 0.15, 0.1)
box.translate({place})
box.set_rigid_body()
box.set_mass(5.0)
"""
EMPTY = '\nenv = Environment("empty")\n'


def belt(arguments: str, place: str = "x=0.4, z=0.902") -> str:
    return f"belt = Conveyor({arguments})\n" + BOX.format(place=place) + EMPTY


def until(simulation, condition, seconds: float = 60.0) -> None:
    for _ in range(int(seconds * 60)):
        if condition():
            return
        simulation.step(1)
    raise AssertionError("the condition did not come true")


@pytest.mark.parametrize("speed", [0.1, 0.5, 2.0, -0.2])
def test_a_box_moves_at_the_speed_of_the_belt(load: Load, speed: float):
    simulation = load(belt(f"length=20.0, speed={speed}, acceleration=100.0", "x=10.0, z=0.902"))
    box = simulation.context.world.objects_by_name["box"]
    simulation.step(90)
    begin = box.worldPosition.x
    simulation.step(180)
    assert (box.worldPosition.x - begin) / 3.0 == pytest.approx(speed, rel=0.01)
    assert abs(box.worldPosition.y) < 1e-3
    assert box.worldPosition.z == pytest.approx(0.9, abs=1e-3)


@pytest.mark.parametrize("friction", [0.1, 0.3])
def test_a_box_slips_with_the_acceleration_that_friction_allows(load: Load, friction: float):
    """It starts with µ g on a belt that is faster at once."""
    scene = belt(f"length=20.0, speed=3.0, acceleration=100.0, friction={friction}, running=False")
    simulation = load(scene.replace("box.set_rigid", "box.set_damping()\nbox.set_rigid"))
    box = simulation.context.world.objects_by_name["box"]
    simulation.step(60)
    simulation.belt.start()
    simulation.step(10)
    before = box.worldLinearVelocity.x
    simulation.step(30)
    assert (box.worldLinearVelocity.x - before) / 0.5 == pytest.approx(friction * _G, rel=0.03)


def test_a_box_stops_with_its_belt(load: Load):
    """After the belt has come to rest at once: v² / (2 µ g)."""
    simulation = load(belt("length=20.0, speed=1.0, acceleration=100.0, friction=0.3"))
    box = simulation.context.world.objects_by_name["box"]
    simulation.step(90)
    simulation.belt.stop()
    begin = box.worldPosition.x
    simulation.step(90)
    assert box.worldLinearVelocity.length < 1e-3
    assert box.worldPosition.x - begin == pytest.approx(1.0 / (2.0 * 0.3 * _G), rel=0.1)


@pytest.mark.parametrize(("slope", "carries"), [(0.24, True), (0.36, False)])
def test_a_steep_belt_carries_up_to_the_angle_of_friction(load: Load, slope: float, carries: bool):
    """tan 0.24 = 0.245 and tan 0.36 = 0.376, with µ = 0.3. Beyond, a box slides with g (sin - µ cos)."""
    scene = (
        "belt = Conveyor(length=20.0, speed=0.3, acceleration=100.0, friction=0.3)\n"
        f"belt.rotate(y=-{slope})\n"
        + BOX.format(place="x=0.0")
        + f"box.rotate(y=-{slope})\nbox.translate(x={10 * math.cos(slope) - 0.902 * math.sin(slope)}, "
        f"z={10 * math.sin(slope) + 0.902 * math.cos(slope)})" + EMPTY
    )
    simulation = load(scene)
    box = simulation.context.world.objects_by_name["box"]
    along = np.array([math.cos(slope), 0.0, math.sin(slope)])
    simulation.step(60)
    before = float(along @ np.array(box.worldLinearVelocity))
    if carries:
        assert before == pytest.approx(0.3, rel=0.01)
        return
    simulation.step(30)
    gained = float(along @ np.array(box.worldLinearVelocity)) - before
    assert gained / 0.5 == pytest.approx(-_G * (math.sin(slope) - 0.3 * math.cos(slope)), rel=0.05)


@pytest.mark.parametrize("turn", [math.pi / 2, -math.pi / 2])
def test_a_curved_belt_turns_what_it_carries(load: Load, turn: float):
    scene = f"belt = Conveyor(length=2.0, turn={turn}, speed=0.5)\n" + BOX.format(place="x=0.2, z=0.902") + EMPTY
    simulation = load(scene)
    box = simulation.context.world.objects_by_name["box"]
    radius = 2.0 / abs(turn)
    simulation.step(60)
    begin = box.worldOrientation.to_euler().z
    simulation.step(90)
    assert box.worldOrientation.to_euler().z - begin == pytest.approx(math.copysign(0.75 / radius, turn), rel=0.02)
    x, y, _ = box.worldPosition
    assert math.hypot(x, y - math.copysign(radius, turn)) == pytest.approx(math.hypot(0.2, radius), abs=0.03)


def test_belts_merge_in_line_and_at_right_angles(load: Load):
    scene = (
        "first = Conveyor(length=2.0, speed=0.5)\n"
        "side = Conveyor(length=1.5, speed=0.5)\nside.rotate(z=1.5707963267948966)\nside.translate(x=3.0, y=-1.8)\n"
        "main = Conveyor(length=4.0, speed=0.5)\nmain.translate(x=2.0)\n"
        + BOX.format(place="x=0.3, z=0.902")
        + BOX.format(place="x=3.0, y=-1.4, z=0.902").replace("box", "other")
        + EMPTY
    )
    simulation = load(scene)
    world = simulation.context.world
    ends: dict[str, tuple[float, ...]] = {}

    def both_at_the_end() -> bool:
        for name in {"box", "other"} - ends.keys():
            place = tuple(world.objects_by_name[name].worldPosition)
            if place[0] > 5.5:
                ends[name] = place
        return len(ends) == 2

    until(simulation, both_at_the_end, 15.0)
    assert all(abs(y) < 0.3 and z == pytest.approx(0.9, abs=0.01) for _, y, z in ends.values())


def test_what_has_waited_on_a_belt_moves_when_it_starts(load: Load):
    simulation = load(belt("length=9.0, running=False"))
    box = simulation.context.world.objects_by_name["box"]
    simulation.step(1200)
    begin = box.worldPosition.x
    simulation.belt.set_speed(-0.1)
    simulation.step(120)
    assert box.worldPosition.x - begin == pytest.approx(-0.195, abs=0.01)


def test_belts_move_only_what_touches_them(load: Load):
    """A box beside the belt has the bits that it has without a belt."""
    beside = BOX.format(place="x=0.4, y=3.0, z=0.3").replace("box", "beside")
    with_belt = load(belt("length=4.0") + beside)
    alone = load(belt("length=4.0, running=False") + beside)
    for simulation in (with_belt, alone):
        simulation.step(120)
    places = [tuple(one.context.world.objects_by_name["beside"].worldPosition) for one in (with_belt, alone)]
    assert places[0] == places[1]


def test_a_belt_carries_robots(load: Load):
    scene = (
        "belt = Conveyor(length=12.0, width=2.0, height=0.3, speed=0.4)\n"
        "robot = ATRV()\nrobot.translate(x=3.0, z=0.5)\n" + EMPTY
    )
    simulation = load(scene)
    robot = simulation.context.robots["robot"]
    simulation.step(120)
    begin = robot.position_3d.x
    simulation.step(180)
    assert robot.position_3d.x - begin == pytest.approx(1.2, rel=0.01)


def test_a_turntable_turns_and_feeds(load: Load):
    scene = "table = Turntable(diameter=1.2)\n" + BOX.format(place="z=0.902") + EMPTY
    simulation = load(scene)
    box = simulation.context.world.objects_by_name["box"]
    simulation.step(30)
    simulation.table.turn_to(math.pi / 2)
    until(simulation, lambda: simulation.table.data["angle"] == pytest.approx(math.pi / 2, abs=1e-9))
    simulation.step(30)
    assert simulation.table.data["state"] == "stopped"
    assert box.worldOrientation.to_euler().z == pytest.approx(math.pi / 2, abs=0.02)
    assert simulation.table.objects().result() == ["box"]
    simulation.table.run(0.3)
    simulation.step(60)
    assert box.worldPosition.y == pytest.approx(0.3, abs=0.02)
    assert abs(box.worldPosition.x) < 0.02


def test_a_turntable_takes_the_shorter_way_in_the_time_of_its_speed(load: Load):
    simulation = load("table = Turntable(speed=0.5, acceleration=1.0)" + EMPTY)
    simulation.table.turn_to(1.75 * math.pi)
    begin = simulation.context.clock.time
    until(simulation, lambda: simulation.table.data["state"] == "turning")
    until(simulation, lambda: simulation.table.data["state"] == "stopped")
    # a trapezoid of velocity: way / v + v / a
    assert simulation.context.clock.time - begin == pytest.approx(0.25 * math.pi / 0.5 + 0.5, abs=0.1)
    assert simulation.table.data["angle"] == pytest.approx(-0.25 * math.pi, abs=1e-9)


def test_a_dispenser_puts_out_its_stock_and_takes_it_back(load: Load):
    scene = (
        "source = Dispenser(stock=3, interval=1.0)\n"
        "belt = Conveyor(length=9.0, speed=0.8)\nbelt.translate(x=-0.3)\n" + EMPTY
    )
    simulation = load(scene)
    source, world = simulation.source, simulation.context.world
    until(simulation, lambda: source.data["left"] == 0, 10.0)
    simulation.step(60)
    assert source.data["count"] == 3
    boxes = source.boxes().result()
    assert boxes == ["source box 0", "source box 1", "source box 2"]
    places = [world.objects_by_name[name].worldPosition for name in boxes]
    assert all(place.z == pytest.approx(0.9, abs=0.01) for place in places)
    assert places[0].x - places[1].x == pytest.approx(0.8, abs=0.05)
    with pytest.raises(Exception, match="0 boxes left"):
        source.dispense().result()
    source.take_back("source box 0").result()
    simulation.step(2)
    assert source.data["left"] == 1
    until(simulation, lambda: source.data["count"] == 4, 10.0)
    for name, words in (("source box 9", "no box"), ("nothing", "no box")):
        with pytest.raises(Exception, match=words):
            source.take_back(name).result()


def test_a_box_that_is_not_taken_blocks_the_next(load: Load):
    simulation = load("source = Dispenser(stock=4, height=0.0)" + EMPTY)
    simulation.source.dispense(3)
    simulation.step(120)
    assert (simulation.source.data["count"], simulation.source.data["blocked"]) == (1, True)
    simulation.context.world.objects_by_name["source box 0"].set_pose((5.0, 0.0, 0.1), (1, 0, 0, 0, 1, 0, 0, 0, 1))
    until(simulation, lambda: simulation.source.data["count"] == 2, 5.0)


def test_the_boxes_of_a_dispenser_wait_at_rest_where_it_was_put(load: Load):
    scene = "source = Dispenser(stock=24)\nsource.translate(x=3.0, y=1.0)\nsource.rotate(z=1.5707963267948966)" + EMPTY
    simulation = load(scene)
    simulation.step(60)
    world = simulation.context.world
    boxes = [one for name, one in world.objects_by_name.items() if name.startswith("source box")]
    assert len(boxes) == 24
    assert all(2.0 < one.worldPosition.x < 4.0 and -2.0 < one.worldPosition.y < 0.9 for one in boxes)
    before = [tuple(one.worldPosition) for one in boxes]
    simulation.step(120)
    assert [tuple(one.worldPosition) for one in boxes] == before
    simulation.source.dispense()
    simulation.step(2)
    place = world.objects_by_name["source box 0"].worldPosition
    assert (place.x, place.y) == pytest.approx((3.0, 1.0), abs=0.01)


def test_a_charger_charges_who_stands_on_it(load: Load):
    scene = """
robot = ATRV()
battery = Battery()
battery.properties(DischargingRate=2.0)
robot.append(battery)
charger = Charger(rate=5.0)
charger.translate(x=4.0)
env = Environment("empty")
"""
    simulation = load(scene)
    simulation.step(600)
    low = simulation.robot.battery.data["charge"]
    assert low == pytest.approx(80.0, abs=0.1)
    simulation.context.robots["robot"].force_pose((4.0, 0.0, 0.2), None)
    simulation.step(120)
    assert simulation.robot.battery.data["charge"] == pytest.approx(low + 10.0, abs=0.2)
    assert simulation.robot.battery.data["status"] == "Charging"
    assert simulation.charger.data["robots"] == ["robot"]
    simulation.charger.switch(False)
    simulation.step(60)
    assert simulation.robot.battery.data["status"] == "Discharging"
    simulation.charger.switch(True)
    simulation.step(360)
    assert simulation.robot.battery.data["status"] == "Charged"


PLANT = """
source = Dispenser(stock=6, interval=1.5)
belt = Conveyor(length=2.0, speed=0.5)
belt.translate(x=-0.3)
curve = Conveyor(length=1.5, turn=1.2, speed=0.6)
curve.translate(x=1.7)
table = Turntable()
table.translate(y=-3.0)
env = Environment("empty")
"""


def test_states_and_rows_of_a_plant_agree(load: Load, tmp_path):
    def see(context):
        names = sorted(name for name in context.world.objects_by_name if "box" in name or "disc" in name)
        return [tuple(context.world.objects_by_name[name].worldPosition) for name in names]

    simulation = load(PLANT, seed=1)
    simulation.context.robots["table"].turn(0.4)
    simulation.step(150)
    state = simulation.save()
    simulation.step(150)
    after, end = see(simulation.context), simulation.save()
    simulation.step(50)
    simulation.restore(state)
    simulation.step(150)
    assert see(simulation.context) == after
    assert simulation.save() == end
    with morse.batch(script(tmp_path, PLANT), rows=2, seed=1) as rows:
        for row in rows:
            row.context.robots["table"].turn(0.4)
        rows.step(300)
        assert see(rows[1].context) == after


@pytest.mark.parametrize("numbers", [[-1], [99], ["a"], [True], [0.5], [0, 0], [math.nan], [[1]]])
def test_states_with_floors_and_boxes_that_are_not_there_are_refused(load: Load, numbers: list[object]):
    simulation = load('lift = Lift(levels=(0.0, 3.5))\ncabinet = Dispenser(stock=2)\nenv = Environment("empty")\n')
    for name, attribute in (("lift", "_calls"), ("cabinet", "_out")):
        component = simulation.context.robots[name]
        with pytest.raises(StateError, match="numbers from 0 to 1"):
            component.set_state(component.get_state() | {attribute: numbers})
    simulation.step(3)
    assert not simulation.failures


@pytest.mark.parametrize("number", [math.nan, math.inf, -math.inf, 1e300, 10.5])
def test_states_of_belts_and_discs_that_no_belt_has_are_refused(load: Load, number: float):
    """A speed that is none would move what lies on the belt by nothing that is a number."""
    simulation = load('belt = Conveyor()\ntable = Turntable()\ntable.translate(y=3.0)\nenv = Environment("empty")\n')
    for name, fields in (("belt", ("speed", "target")), ("table", ("rate", "belt", "angle"))):
        component = simulation.context.robots[name]
        own = component.get_state()
        for field in fields:
            if field == "rate" and number == 10.5:
                continue
            with pytest.raises(StateError, match=f"'{field}' of {name}"):
                component.set_state(own | {"local_data": own["local_data"] | {field: number}})
        with pytest.raises(StateError, match="missing"):
            component.set_state({key: value for key, value in own.items() if key != "local_data"})
        component.set_state(own)
    table = simulation.context.robots["table"]
    with pytest.raises(StateError, match="'_rate' of table"):
        table.set_state(table.get_state() | {"_rate": math.nan})
    simulation.step(3)
    assert not simulation.failures


@pytest.mark.parametrize(
    ("call", "words"),
    [
        ("Conveyor(length=0.0)", "Conveyor(length)"),
        ("Conveyor(length=float('nan'))", "Conveyor(length)"),
        ("Conveyor(speed=1e9)", "Conveyor(speed)"),
        ("Conveyor(friction=-1)", "Conveyor(friction)"),
        ("Conveyor(length=1.0, turn=3.14)", "expected more than 0.35 m"),
        ("Conveyor(turn=float('inf'))", "Conveyor(turn)"),
        ("Conveyor(rails=[])", "Conveyor(rails)"),
        ("Turntable(diameter=0)", "Turntable(diameter)"),
        ("Turntable(speed='fast')", "Turntable(speed)"),
        ("Dispenser(stock=0)", "Dispenser(stock)"),
        ("Dispenser(stock=10**9)", "1 to 200 boxes"),
        ("Dispenser(size=(1, 1))", "three numbers"),
        ("Dispenser(size=1.0)", "Dispenser(size) takes several numbers"),
        ("Dispenser(mass=0)", "Dispenser(mass)"),
        ("Charger(rate=-1)", "Charger(rate)"),
        ("Charger(reach=float('nan'))", "Charger(reach)"),
    ],
)
def test_mistakes_are_named(tmp_path, call: str, words: str):
    with pytest.raises(Exception, match=re.escape(words)):
        morse.load(script(tmp_path, f'one = {call}\nenv = Environment("empty")')).close()


def test_services_refuse_wrong_values(load: Load):
    simulation = load(PLANT)
    for handle, name in ((simulation.belt, "set_speed"), (simulation.table, "turn_to"), (simulation.table, "run")):
        for value in (float("nan"), 1e300, "fast", None, [1.0]):
            with pytest.raises(Exception, match=r"expected|range|number|argument"):
                getattr(handle, name)(value).result()
    simulation.step(2)
    assert not simulation.failures


def test_properties_of_clients_change_no_shapes(load: Load):
    simulation = load(PLANT)
    with pytest.raises(Exception, match=r"'Radius' of curve is written by Conveyor\(length, turn="):
        simulation.curve.set_property("Radius", 0.001).result()
    simulation.step(100)
    state = simulation.save()
    simulation.restore(state)
    simulation.reset()
    simulation.step(10)
    assert not simulation.failures
