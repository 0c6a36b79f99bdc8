"""Floating, sinking, drag and current, against Archimedes and closed forms."""

import math
from typing import Any

import numpy as np
import pytest

from morse.helpers.waves import Sea

SCENE = """
robot = Submarine()
robot.translate({at})
robot.set_mass({mass})
water = Hydrodynamics()
water.properties({properties})
robot.append(water)
push = ExternalForce()
robot.append(push)
pose = Pose()
robot.append(pose)
velocity = Velocity()
robot.append(velocity)
"""
#: of the model: m, and kg
LENGTH, WIDTH, HEIGHT, MIDDLE, MASS = 6.05, 1.2, 1.31, -0.071, 1.0
DENSITY, G = 1025.0, 9.81
SEA = "env = Environment('water-1/deep_water', fastmode=True)"


def load(
    simulate: Any,
    at: str = "0, 0, -5",
    properties: str = "Density=1025",
    world: str = SEA,
    mass: float = MASS,
    **options: Any,
) -> Any:
    return simulate(SCENE.format(at=at, properties=properties, mass=mass) + world, sockets=False, **options)


def test_a_submarine_stays_at_its_depth(simulate: Any) -> None:
    sim = load(simulate)
    sim.step(300)
    pose = sim.robot.pose.get()
    assert pose["z"] == pytest.approx(-5.0, abs=1e-3)
    assert (pose["x"], pose["y"], pose["roll"], pose["pitch"]) == pytest.approx((0, 0, 0, 0), abs=1e-6)


def test_out_of_the_water_it_falls(simulate: Any) -> None:
    sim = load(simulate, "0, 0, 20")
    sim.step(60)
    first = sim.robot.pose.get()["z"]
    sim.step(30)
    second = sim.robot.pose.get()["z"]
    assert first < 20.0 - 0.4 * G
    assert second < first - 0.4 * G


def test_a_light_hull_floats_at_the_depth_of_archimedes(simulate: Any) -> None:
    # a volume for which 40 % of the box support the weight
    sim = load(simulate, "0, 0, 1", f"Volume={MASS / DENSITY / 0.4}")
    sim.step(1800)
    pose = sim.robot.pose.get()
    below = 0.4 * HEIGHT
    assert pose["z"] + MIDDLE - HEIGHT / 2.0 == pytest.approx(-below, abs=0.02)
    assert (pose["roll"], pose["pitch"]) == pytest.approx((0.0, 0.0), abs=1e-3)


def test_a_hull_that_is_too_heavy_sinks_at_its_terminal_speed(simulate: Any) -> None:
    mass = 4000.0
    sim = load(simulate, "0, 0, -10", f"Volume={0.5 * mass / DENSITY}", mass=mass)
    sim.step(1200)
    drag = 0.5 * DENSITY * 1.1 * LENGTH * WIDTH
    wanted = math.sqrt(mass * G * 0.5 / drag)
    assert -sim.robot.velocity.get()["world_linear_velocity"][2] == pytest.approx(wanted, rel=0.02)


def test_the_terminal_speed_of_a_push_ahead(simulate: Any) -> None:
    sim = load(simulate)
    sim.robot.push.publish({"force": [4.0, 0.0, 0.0]})
    sim.step(1200)
    drag = 0.5 * DENSITY * 0.2 * WIDTH * HEIGHT
    assert sim.robot.velocity.get()["world_linear_velocity"][0] == pytest.approx(math.sqrt(4.0 / drag), rel=0.02)


def test_a_current_takes_it_away(simulate: Any) -> None:
    sim = load(simulate)
    sim.robot.water.publish({"current": [0.5, -0.2, 0.0]})
    sim.step(3000)
    speed = sim.robot.velocity.get()["world_linear_velocity"]
    assert (speed[0], speed[1]) == pytest.approx((0.5, -0.2), abs=0.02)


def test_at_the_surface_it_rights_itself(simulate: Any) -> None:
    # the surface intersects the middle of a hull that is wider than high
    sim = simulate(
        SCENE.format(
            mass=MASS, at="0, 0, 0.071", properties=f"Volume={2.0 * MASS / DENSITY}, Width=4.0, Height=1.0"
        ).replace("water = ", "robot.rotate(x=0.2)\nwater = ")
        + SEA,
        sockets=False,
    )
    sim.step(1800)
    assert sim.robot.pose.get()["roll"] == pytest.approx(0.0, abs=0.02)


def test_turning_is_damped(simulate: Any) -> None:
    sim = load(simulate)
    sim.robot.push.publish({"torque": [0.0, 0.0, 2.0]})
    sim.step(60)
    sim.robot.push.publish({"torque": [0.0, 0.0, 0.0]})
    turning = abs(sim.robot.velocity.get()["angular_velocity"][2])
    sim.step(600)
    assert abs(sim.robot.velocity.get()["angular_velocity"][2]) < 0.25 * turning


def test_without_a_surface_water_is_everywhere(simulate: Any) -> None:
    sim = load(simulate, "0, 0, 30", "Density=1000", "env = Environment('empty', fastmode=True)")
    sim.step(120)
    assert sim.robot.pose.get()["z"] == pytest.approx(30.0, abs=1e-3)


def test_a_saved_run_goes_on_as_it_did(simulate: Any) -> None:
    sim = load(simulate, "0, 0, 1")
    sim.step(50)
    kept = sim.save()
    sim.step(50)
    wanted = sim.state_hash()
    sim.restore(kept)
    sim.step(50)
    assert sim.state_hash() == wanted


def test_extreme_values_break_nothing(simulate: Any) -> None:
    sim = load(simulate, properties="Density=1e5, Volume=1e9, Height=1e-3", on_failure="deactivate")
    sim.robot.water.publish({"current": [1e4, -1e4, 1e4]})
    sim.step(120)
    assert all(math.isfinite(value) for value in sim.robot.pose.get().values())
    assert sim.context.component("robot.water").active


RAFT = "Density=1000.0, Volume=8.0, Length=4.0, Width=2.0, Height=1.0, Surface=0.0"
#: DNV-RP-N103: a plate of 4 x 2 m; half of it at the surface
ADDED = 0.5 * 0.757 * math.pi / 4.0 * 2.0**2 * 4.0 * 1000.0


def heights(simulate: Any, properties: str = RAFT, seconds: float = 12.0) -> list[float]:
    """Heights of a raft of 2 t, which begins 0.1 m above its draught, m."""
    sim = load(simulate, f"0, 0, {0.25 - MIDDLE + 0.1}", properties, mass=2000.0)
    values = []
    for _ in range(round(60 * seconds)):
        sim.step(1)
        values.append(sim.world.game_object("robot").world_pose()[0][2] + MIDDLE - 0.25)
    return values


def test_heave_has_the_period_of_its_mass_with_that_of_the_water_and_decays(simulate: Any) -> None:
    values = heights(simulate)
    rate = math.sqrt(1000.0 * G * 8.0 / (2000.0 + ADDED)) * math.sqrt(1.0 - 0.3**2)
    crossings = [k for k in range(1, len(values)) if values[k - 1] > 0.0 >= values[k]]
    assert (crossings[1] - crossings[0]) / 60.0 == pytest.approx(2.0 * math.pi / rate, rel=0.08)
    # exp(-2 pi zeta / sqrt(1 - zeta^2)) = 0.14 for each period; quadratic drag takes some more
    assert 0.0 < max(values[crossings[0] :]) < 0.14 * 0.1 + 0.005
    assert max(map(abs, values[-60:])) < 1e-3


def test_roll_decays(simulate: Any) -> None:
    text = SCENE.format(mass=2000.0, at=f"0, 0, {0.25 - MIDDLE}", properties=RAFT)
    sim = simulate(text.replace("water = ", "robot.rotate(x=0.2)\nwater = ") + SEA, sockets=False)
    sim.step(600)
    assert sim.robot.pose.get()["roll"] == pytest.approx(0.0, abs=0.004)


def test_a_push_moves_the_water_that_clings_to_a_hull(simulate: Any) -> None:
    accelerations = []
    for factor in (0.0, 1.0):
        sim = load(simulate, properties=f"Density=1000, AddedMass={factor}, Length=4, Width=2, Height=1", mass=8000.0)
        sim.robot.push.publish({"force": [0.0, 0.0, 100.0]})
        sim.step(10)
        body = sim.world.game_object("robot")
        before = body.velocity()[0][2]
        sim.step(30)
        accelerations.append(2.0 * (body.velocity()[0][2] - before))
    assert accelerations[0] == pytest.approx(100.0 / 8000.0, rel=0.02)
    assert accelerations[1] == pytest.approx(100.0 / (8000.0 + 2.0 * ADDED), rel=0.02)


def test_without_the_water_that_moves_along_the_period_is_that_of_archimedes(simulate: Any) -> None:
    values = heights(simulate, RAFT + ", AddedMass=0.0, WaveDamping=0.0", 4.0)
    crossings = [k for k in range(1, len(values)) if values[k - 1] > 0.0 >= values[k]]
    period = 2.0 * math.pi * math.sqrt(2000.0 / (1000.0 * G * 8.0))
    assert (crossings[2] - crossings[0]) / 120.0 == pytest.approx(period, rel=0.03)


def test_waves_have_their_height_period_and_spectrum() -> None:
    sea = Sea(2.0, 8.0, 0.3, G, np.random.default_rng(3))
    surface = np.array([sea.at(5.0, -3.0, 0.25 * k)[0] for k in range(4 * 3600)])
    # significant height: four standard deviations
    assert 4.0 * surface.std() == pytest.approx(2.0, rel=0.05)
    assert abs(surface.mean()) < 0.02
    power = np.abs(np.fft.rfft(surface)) ** 2
    assert 1.0 / np.fft.rfftfreq(len(surface), 0.25)[power.argmax()] == pytest.approx(8.0, rel=0.12)
    height, rise = sea.at(1.0, 2.0, 3.0)
    assert (sea.at(1.0, 2.0, 3.0 + 1e-6)[0] - height) / 1e-6 == pytest.approx(rise, abs=1e-4)


def test_a_raft_rides_on_waves_that_are_the_same_for_all(simulate: Any) -> None:
    waves = "\nenv.properties(WaveHeight=1.0, WavePeriod=8.0)"
    sim = simulate(SCENE.format(mass=2000.0, at=f"0, 0, {0.25 - MIDDLE}", properties=RAFT) + SEA + waves, sockets=False)
    body, sea = sim.world.game_object("robot"), sim.context.component("robot.water")._sea
    ridden, surface = [], []
    for _ in range(60 * 60):
        sim.step(1)
        x, y, z = body.world_pose()[0]
        ridden.append(z + MIDDLE - 0.25)
        surface.append(sea.at(x, y, sim.context.clock.time)[0])
    assert np.std(surface) > 0.15
    assert np.corrcoef(ridden[600:], surface[600:])[0, 1] > 0.95
    assert np.std(np.subtract(ridden, surface)[600:]) < 0.35 * np.std(surface)
    other = Sea.of(sim.scene.properties, G, sim.context.random("waves"))
    assert other is not None
    assert other.at(1.0, 2.0, 3.0) == sea.at(1.0, 2.0, 3.0)
