"""Forklifts: they lift and carry by contacts and friction, steer at the rear, and refuse what is too heavy."""

import math

import numpy as np
import pytest

from pymorse import MorseServiceFailed
from tests.kit.scenes import Load

SCENE = """
truck = Forklift({arguments})
pose = Pose()
truck.append(pose)
pallet = PassiveObject("props/pallet")
pallet.name = "pallet"
pallet.translate(x=1.08)
for number, (x, y) in enumerate([(0.78, 0.2), (0.78, -0.2), (1.38, 0.0)]):
    box = Cube(f"box {{number}}")
    box.scale = (0.2, 0.18, 0.2)
    box.translate(x, y, 0.345)
    box.set_rigid_body()
    box.set_mass({mass})
env = Environment("empty")
"""
ALONE = "truck = Forklift()\npose = Pose()\ntruck.append(pose)\nenv = Environment('empty')\n"
GOODS = ("pallet", "box 0", "box 1", "box 2")


def scene(arguments: str = "", mass: float = 100.0) -> str:
    return SCENE.format(arguments=arguments, mass=mass)


def places(simulation) -> np.ndarray:
    """Where the goods are in the frame of the truck, m."""
    objects = simulation.context.world.objects_by_name
    position, rotation = objects["truck"].world_pose()
    here = np.array([objects[name].world_pose()[0] for name in GOODS]) - position
    return here @ np.reshape(rotation, (3, 3))


def drive(simulation, v: float, w: float, seconds: float) -> None:
    simulation.truck.motion.publish({"v": v, "w": w})
    simulation.step(round(60 * seconds))


def test_it_lifts_a_pallet_with_boxes_and_carries_them_over_five_metres(load: Load):
    """By contacts alone: nothing is attached. The boxes stay within 2 cm, also in a turn and when it brakes."""
    simulation = load(scene())
    truck = simulation.truck
    simulation.step(30)
    before = places(simulation)
    truck.lift(0.6).result()
    assert truck.data["height"] == pytest.approx(0.6, abs=0.005)
    # the fork has a way of 0.122 - 0.09 m to the deck
    assert places(simulation)[:, 2] - before[:, 2] == pytest.approx(0.6 - 0.032, abs=0.005)
    assert truck.objects() == ["pallet"]
    simulation.step(60)
    assert truck.data["load"] == pytest.approx(325.0, rel=0.01)
    lifted, start = places(simulation), truck.pose.get()
    drive(simulation, -1.0, 0.0, 3.0)
    drive(simulation, -1.0, 0.3, 3.0)
    drive(simulation, 0.0, 0.0, 2.0)
    end = truck.pose.get()
    assert math.dist((start["x"], start["y"]), (end["x"], end["y"])) > 5.0
    assert all(simulation.context.world.objects_by_name[name].parent is None for name in GOODS)
    assert np.abs(places(simulation) - lifted).max() < 0.02
    truck.lift(0.0).result()
    simulation.step(60)
    assert places(simulation)[0, 2] == pytest.approx(0.0, abs=0.005)
    assert truck.data["load"] < 3.0


def test_a_load_above_the_capacity_is_refused(load: Load):
    """1,225 kg for a capacity of 1,000 kg: the fork goes down again, and the pallet with it."""
    simulation = load(scene(mass=400.0))
    simulation.step(30)
    with pytest.raises(MorseServiceFailed, match="truck: the load is above its capacity of 1000 kg"):
        simulation.truck.lift(1.0).result()
    assert simulation.truck.data["height"] < 0.3
    simulation.step(180)
    assert simulation.truck.data["height"] == pytest.approx(0.0, abs=0.005)
    assert places(simulation)[0, 2] == pytest.approx(0.0, abs=0.005)


def test_the_same_load_is_lifted_with_a_greater_capacity(load: Load):
    simulation = load(scene("capacity=1300.0", mass=400.0))
    simulation.step(30)
    simulation.truck.lift(0.5).result()
    simulation.step(60)
    assert simulation.truck.data["load"] == pytest.approx(1225.0, rel=0.01)
    assert simulation.truck.data["height"] == pytest.approx(0.5, abs=0.005)


def test_the_fork_moves_with_its_speed_and_acceleration(load: Load):
    """1 m with 0.3 m/s and 0.3 m/s²: 1 / 0.3 + 0.3 / 0.3 s."""
    simulation = load(ALONE)
    simulation.step(1)
    begin = simulation.time()
    simulation.truck.lift(1.0).result()
    assert simulation.time() - begin == pytest.approx(1.0 / 0.3 + 1.0, abs=0.2)


def test_it_steers_at_the_rear(load: Load):
    """The middle of the front axle, its origin, goes around a circle of the radius v / w; the rear swings out."""
    simulation = load(ALONE)
    world = simulation.context.world
    drive(simulation, 0.6, 0.3, 4.0)
    yaw = simulation.truck.pose.get()["yaw"]
    rear = world.objects_by_name["left_steering"]
    turned = np.reshape(world.objects_by_name["truck"].world_pose()[1], (3, 3)).T @ np.reshape(
        rear.world_pose()[1], (3, 3)
    )
    # its own circle: tan(angle) = -1.3 / (2.0 - 0.42)
    assert math.atan2(turned[1, 0], turned[0, 0]) == pytest.approx(-math.atan(1.3 / 1.58), abs=0.02)
    drive(simulation, 0.6, 0.3, 2.0)
    assert simulation.truck.pose.get()["yaw"] - yaw == pytest.approx(0.6, rel=0.05)


def test_a_call_replaces_another_one_and_stops_smoothly(load: Load):
    simulation = load(ALONE)
    first = simulation.truck.lift(1.5)
    simulation.step(120)
    simulation.truck.lift(0.0).result()
    assert first.done()
    assert simulation.truck.data["height"] == pytest.approx(0.0, abs=0.006)


def test_a_fork_that_is_held_says_so(load: Load):
    """A beam above the fork: its force counts as a load, or stops the fork."""
    beam = 'beam = Cube("beam")\nbeam.scale = (0.3, 0.6, 0.05)\nbeam.translate(1.2, 0.0, 0.6)\nbeam.static()\n'
    simulation = load(beam + ALONE)
    with pytest.raises(MorseServiceFailed, match=r"truck: (something holds the fork|the load is above its capacity)"):
        simulation.truck.lift(1.0).result()
    assert simulation.truck.data["height"] < 0.5


@pytest.mark.parametrize("height", [-0.1, 1.8, math.nan, math.inf, "high", None, [0.5]])
def test_heights_out_of_reach_are_refused(load: Load, height: object):
    simulation = load(ALONE)
    with pytest.raises(Exception, match="height"):
        simulation.truck.lift(height).result()
    simulation.step(10)
    assert simulation.truck.data["height"] == pytest.approx(0.0, abs=0.005)
    assert not simulation.failures


@pytest.mark.parametrize(
    "arguments", ["capacity=-1.0", "capacity=9999.0", "capacity='much'", "speed=0.0", "speed=float('nan')"]
)
def test_wrong_arguments_are_refused(load: Load, arguments: str):
    with pytest.raises(Exception, match=arguments.partition("=")[0]):
        load(f"truck = Forklift({arguments})\nenv = Environment('empty')\n")


@pytest.mark.parametrize(
    ("name", "value"), [("Capacity", -1.0), ("Capacity", math.nan), ("Speed", 50.0), ("Speed", "x")]
)
def test_wrong_properties_are_refused(load: Load, name: str, value: object):
    simulation = load(ALONE)
    with pytest.raises(Exception, match=name):
        simulation.rpc("truck", "set_property", name, value)
    assert not simulation.failures


def test_a_saved_state_goes_on_with_the_same_bits(load: Load):
    simulation = load(scene())
    simulation.truck.lift(0.5)
    simulation.step(60)
    state = simulation.save()
    simulation.step(90)
    once = simulation.state_hash()
    simulation.restore(state)
    simulation.step(90)
    assert simulation.state_hash() == once
