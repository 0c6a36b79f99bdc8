"""Values of clients at the limits of their ranges, and clients that repeat a mistake in every tick."""

import time

import pytest

from pymorse import MorseServiceFailed

SCENE = "robot = Quadrotor()\nrobot.translate(z=50.0)\nrotors = QuadrotorDynamicControl()\nrobot.append(rotors)"


@pytest.mark.parametrize("configuration", ["+", "x"])
def test_the_largest_thrust_deactivates_nothing(simulate, configuration):
    sim = simulate(SCENE, sockets=False)
    for name, most in (("ThrustFactor", 1.0), ("DragFactor", 1.0), ("Lever", 1e7)):
        with pytest.raises(MorseServiceFailed, match=name):
            sim.robot.rotors.set_property(name, 1e30).result()
        sim.robot.rotors.set_property(name, most).result()
    sim.robot.rotors.set_property("Configuration", configuration).result()
    sim.robot.rotors.publish({"engines": [1e5, -1e5, 1e5, 0.0]})
    sim.step(2)
    assert sim.context.component("robot.rotors").active
    assert sim.context.failed == set()
    # not stronger than the limit: after a tick not faster than 1e6 N make it
    mass = sim.world.mass_centres()[0][1]
    assert abs(sim.context.robots["robot"].bge_object.worldLinearVelocity[2]) < 2 * 1e6 / mass / 60.0 + 1.0


def test_a_long_colour_is_shortened_in_the_answer(simulate):
    sim = simulate("robot = ATRV()\nlight = Light()\nrobot.append(light)", sockets=False)
    with pytest.raises(MorseServiceFailed, match="three numbers") as failed:
        sim.robot.light.set_property("color", "x" * 1_000_000).result()
    assert len(str(failed.value)) < 500


def test_mistakes_in_every_tick_and_resets_are_logged_once(simulate, caplog):
    sim = simulate(
        "robot = ATRV()\nsound = Sound()\nrobot.append(sound)\nleds = LedArray()\nrobot.append(leds)\n"
        "eye = VideoCamera()\neye.properties(cam_width=32, cam_height=24)\nrobot.append(eye)\n"
        "env = Environment('empty', fastmode=True)",
        sockets=False,
    )
    now = time.monotonic()
    sim.context.complaints._now = lambda: now  # a slow machine needs longer than the ten seconds between two lines
    picture = sim.context.component("robot.leds").local_data["colours"]
    for number in range(60):
        sim.robot.sound.publish({"mode": "loud"})
        sim.robot.leds.publish({"colours": [[[0.5, 0.5, 0.5]]] if number % 2 else picture})
        sim.step()
        if number % 10 == 0:
            sim.restart(1)
    assert caplog.text.count("mode 'loud' is none of") == 1
    assert caplog.text.count("the last pattern stays") == 1
    assert caplog.text.count("captures no images") == 1
