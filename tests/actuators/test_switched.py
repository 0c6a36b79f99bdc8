"""Lamps, sounds, grippers, markers and LED arrays."""

import math

import numpy as np
import pytest

from morse.core.kinds.binding import bind
from pymorse import MorseServiceFailed


def test_a_light_shines_along_x_as_its_properties_say(simulate):
    sim = simulate(
        "robot = ATRV()\nlight = Light()\nlight.properties(distance=20, color='(1, 0.5, 0)', size=0.5, energy=2.0)\n"
        "robot.append(light)",
        sockets=False,
    )
    (lamp,) = sim.context.component("robot.light").bge_object.children
    light = lamp.node.light
    assert (light.type, light.distance, light.color, light.spot_size, light.energy) == (
        "SPOT",
        20.0,
        (1.0, 0.5, 0.0),
        0.5,
        2.0,
    )
    # lamps shine along their -Z axis
    assert [-row[2] for row in lamp.worldOrientation] == pytest.approx([1.0, 0.0, 0.0], abs=1e-6)


def test_a_light_is_switched_by_service_and_command(simulate):
    sim = simulate("robot = ATRV()\nlight = Light()\nrobot.append(light)", sockets=False)
    (lamp,) = sim.context.component("robot.light").bge_object.children
    sim.step()
    assert lamp.visible
    sim.robot.light.toggle().result()
    sim.step()
    assert not lamp.visible
    sim.robot.light.toggle(True).result()
    sim.step()
    assert lamp.visible
    sim.robot.light.publish({"emit": False})
    sim.step(2)
    assert not lamp.visible


def test_properties_of_a_light_change_while_it_shines(simulate):
    sim = simulate(
        "robot = ATRV()\nlight = Light()\nlight.rotate(y=0.4)\nlight.translate(z=1.0)\nrobot.append(light)\n"
        "eye = VideoCamera()\neye.translate(z=1.0)\neye.rotate(x=0.0, y=-0.4)\n"
        "eye.properties(cam_width=32, cam_height=24)\nrobot.append(eye)",
        sockets=False,
    )
    (lamp,) = sim.context.component("robot.light").bge_object.children

    def brightness():
        sim.step(6)
        return float(sim.robot.eye.data["image"][..., :3].mean())

    dim = brightness()
    at_first = lamp.node.light
    state = sim.save()
    for name, value in (("energy", 6.0), ("distance", 30.0), ("size", 2.0), ("color", "(1, 0, 0)")):
        sim.rpc("robot.light", "set_property", name, value)
    bright = brightness()
    light = lamp.node.light
    assert (light.energy, light.distance, light.spot_size, light.color) == (6.0, 30.0, 2.0, (1.0, 0.0, 0.0))
    assert bright > dim + 5.0
    red, green, _blue = sim.robot.eye.data["image"][..., :3].mean(axis=(0, 1))
    assert red > green + 5.0
    with pytest.raises(MorseServiceFailed, match=r"three numbers from 0 to 1, not 'red'"):
        sim.rpc("robot.light", "set_property", "color", "red")
    assert brightness() == pytest.approx(bright, abs=0.5)
    sim.restore(state)
    assert lamp.node.light == at_first


@pytest.mark.parametrize("color", ["red", "(1, 2)", "(1, 2, 3)"])
def test_a_color_that_is_none_is_refused(simulate, color):
    with pytest.raises(Exception, match="color"):
        simulate(
            f"robot = ATRV()\nlight = Light()\nlight.properties(color='{color}')\nrobot.append(light)", sockets=False
        )


def test_a_sound_plays_pauses_and_stops(simulate, tmp_path):
    file = tmp_path / "horn.wav"
    file.write_bytes(b"RIFF")
    sim = simulate(f"robot = ATRV()\nsound = Sound()\nsound.open({str(file)!r})\nrobot.append(sound)", sockets=False)
    sound = sim.context.component("robot.sound")
    assert sound.file == str(file)
    sim.step(10)
    assert (sound.mode, sound.played) == ("stop", 0.0)
    sim.robot.sound.publish({"mode": "play"})
    sim.step(30)
    assert sound.played == pytest.approx(0.5, abs=0.02)
    sim.robot.sound.publish({"mode": "pause"})
    sim.step(30)
    assert sound.played == pytest.approx(0.5, abs=0.02)
    sim.robot.sound.publish({"mode": "louder"})
    sim.step(2)
    assert sound.mode == "pause"
    sim.robot.sound.publish({"mode": "stop"})
    sim.step(2)
    assert sound.played == 0.0


def test_a_sound_that_is_not_there(simulate):
    with pytest.raises(Exception, match=r"no file 'nothing.wav'"):
        simulate("robot = ATRV()\nsound = Sound()\nsound.open('nothing.wav')\nrobot.append(sound)", sockets=False)


# -- gripper -------------------------------------------------------------------------------

GRIPPER = """
robot = ATRV()
motion = MotionVW()
robot.append(motion)
gripper = Gripper()
gripper.translate(0.8, 0.0, 0.4)
gripper.rotate(0.0, 1.5707963, 0.0)
robot.append(gripper)
def thing(name, x, y):
    ball = Sphere(name)
    ball.scale = (0.05, 0.05, 0.05)
    ball.translate(x, y, 0.4)
    ball._bpy_object.game.physics_type = 'RIGID_BODY'
    ball._bpy_object.game.mass = 0.1
    ball.properties(Graspable=True)
    return ball
near = thing('near', 1.15, 0.0)
far = thing('far', 1.25, 0.05)
aside = thing('aside', 0.85, 0.2)
"""


def test_it_takes_the_nearest_in_the_cone_carries_it_and_lets_it_go(simulate):
    sim = simulate(GRIPPER, sockets=False)
    assert sim.robot.gripper.release().result() is False
    assert sim.robot.gripper.grab().result() == "near"
    assert sim.robot.gripper.grab().result() == "near"
    near = sim.context.world.game_object("near")
    hand = sim.context.component("robot.gripper").bge_object
    before = hand.getDistanceTo(near)
    sim.robot.motion.publish({"v": 1.0, "w": 1.0})
    sim.step(120)
    assert hand.getDistanceTo(near) == pytest.approx(before, abs=1e-3)
    sim.robot.motion.publish({"v": 0.0, "w": 0.0})
    sim.step(30)
    height = near.worldPosition[2]
    assert sim.robot.gripper.release().result() is True
    sim.step(60)
    assert near.worldPosition[2] < height - 0.2


def test_nothing_in_the_cone_is_nothing_to_take(simulate):
    sim = simulate(
        GRIPPER.replace("gripper.rotate(0.0, 1.5707963, 0.0)", "gripper.rotate(0.0, 3.1415926, 0.0)"), sockets=False
    )
    assert sim.robot.gripper.grab().result() is None
    sim.step(5)
    assert sim.context.component("robot.gripper").held is None


def test_it_obeys_commands_as_well(simulate):
    sim = simulate(GRIPPER, sockets=False)
    gripper = sim.context.component("robot.gripper")
    sim.robot.gripper.publish({"grab": True})
    sim.step(2)
    assert gripper.held.name == "near"
    sim.robot.gripper.publish({"grab": False})
    sim.step(2)
    assert gripper.held is None


def test_a_reset_of_the_world_empties_the_hand(simulate):
    sim = simulate(GRIPPER, sockets=False)
    sim.robot.gripper.grab().result()
    sim.reset()
    assert sim.context.component("robot.gripper").held is None
    assert sim.robot.gripper.release().result() is False


def test_held_things_are_held_after_a_restore(simulate):
    sim = simulate(GRIPPER, sockets=False)
    sim.robot.gripper.grab().result()
    sim.step(2)
    state = sim.save()
    sim.robot.gripper.release().result()
    sim.step(2)
    sim.restore(state)
    sim.step(2)
    assert sim.context.component("robot.gripper").held.name == "near"


# -- marker --------------------------------------------------------------------------------


def test_a_marker_is_put_where_a_camera_sees_it(simulate):
    sim = simulate(
        "robot = ATRV()\nrobot.translate(1, 2, 0)\nmarker = Arucomarker()\n"
        "marker.properties(xoffset=0.5, zoffset=1.0)\nrobot.append(marker)",
        sockets=False,
    )
    sim.robot.marker.publish({"x": 0.1, "y": 0.2, "z": 3.0, "yaw": 0.7})
    sim.step(30)
    z = sim.context.component("robot").bge_object.worldPosition[2]
    place = sim.robot.marker.get_world_position().result()
    assert place == pytest.approx([1.0 + 3.0 + 0.5, 2.0 + 0.1, z - 0.2 + 1.0], abs=5e-3)
    assert sim.robot.marker.get_world_orientation().result() == pytest.approx([0.0, 0.0, 0.7], abs=1e-6)
    assert sim.robot.marker.get_local_position().result() == pytest.approx([3.5, 0.1, 0.8], abs=5e-3)


def test_the_angles_of_a_marker_turn_in_the_order_y_z_x(simulate):
    sim = simulate("robot = ATRV()\nmarker = Arucomarker()\nrobot.append(marker)", sockets=False)
    sim.robot.marker.publish({"roll": 0.3, "pitch": 0.4, "yaw": 0.5})
    sim.step(2)

    def turn(axis, angle):
        c, s = math.cos(angle), math.sin(angle)
        i, j = (axis + 1) % 3, (axis + 2) % 3
        m = np.eye(3)
        m[i, i], m[i, j], m[j, i], m[j, j] = c, -s, s, c
        return m

    expected = turn(0, 0.3) @ turn(2, 0.5) @ turn(1, 0.4)
    found = np.array([list(row) for row in sim.context.component("robot.marker").bge_object.worldOrientation])
    assert found == pytest.approx(expected, abs=1e-6)


# -- LED arrays ----------------------------------------------------------------------------

LEDS = "robot = ATRV()\nleds = LedArray(rows=2, columns=3)\nrobot.append(leds)"


def seen(sim):
    """(rows, columns, 3) colours as sent to the view."""
    leds = sim.context.component("robot.leds")
    picture = np.zeros((leds.rows, leds.columns, 3))
    for part in leds.bge_object.children:
        picture[part["LedRow"], part["LedColumn"]] = part.node.color[:3]
    return picture


def test_lights_show_pictures_and_the_view_is_told(simulate):
    sim = simulate(LEDS, sockets=False)
    sim.step()
    assert not seen(sim).any()
    picture = np.linspace(0.0, 1.0, 18).reshape(2, 3, 3)
    sim.context.world.repainted.clear()
    sim.robot.leds.publish({"colours": picture.tolist()})
    sim.step(2)
    assert seen(sim) == pytest.approx(picture)
    assert len(sim.context.world.repainted) == 6
    sim.context.world.repainted.clear()
    sim.step(10)
    assert not sim.context.world.repainted
    sim.robot.leds.set_led(1, 2, 0.0, 1.0, 0.0).result()
    sim.step()
    assert seen(sim)[1, 2].tolist() == [0.0, 1.0, 0.0]
    assert seen(sim)[0] == pytest.approx(picture[0])
    sim.robot.leds.set_all(0.5, 0.0, 0.0).result()
    sim.step()
    assert (seen(sim) == (0.5, 0.0, 0.0)).all()
    sim.robot.leds.off().result()
    sim.step()
    assert not seen(sim).any()


def test_the_first_light_is_at_the_top_left_of_who_looks_at_it(simulate):
    sim = simulate(LEDS, sockets=False)
    place = {
        (p["LedRow"], p["LedColumn"]): p.localPosition for p in sim.context.component("robot.leds").bge_object.children
    }
    # a view from the front along -X, with Y to the right
    assert place[0, 0][2] > place[1, 0][2]
    assert place[0, 0][1] < place[0, 2][1]


def test_lights_blink_in_simulated_time(simulate):
    sim = simulate(LEDS, sockets=False)
    sim.robot.leds.set_all(1.0, 1.0, 1.0).result()
    sim.robot.leds.blink(1.0).result()
    lit = 0
    changes = 0
    before = None
    for _ in range(240):
        sim.step()
        now = bool(seen(sim).any())
        lit += now
        changes += before is not None and now != before
        before = now
    assert lit == pytest.approx(120, abs=2)
    assert changes in (7, 8)
    sim.robot.leds.blink(0.0).result()
    sim.step(2)
    assert seen(sim).all()


def test_wrong_pictures_change_nothing(simulate):
    sim = simulate(LEDS, sockets=False)
    sim.robot.leds.set_all(1.0, 0.0, 0.0).result()
    sim.step()
    for wrong in ([[[1.0, 1.0, 1.0]]], [[["red"] * 3]], [[[2.0] * 3] * 3] * 2, "red"):
        with pytest.raises(MorseServiceFailed):
            sim.robot.leds.set_pattern(wrong).result()
    with pytest.raises(MorseServiceFailed, match="no light in row 2"):
        sim.robot.leds.set_led(2, 0, 1.0, 1.0, 1.0).result()
    sim.robot.leds.publish({"colours": [[[0.0, 1.0, 0.0]]]})
    sim.step(3)
    assert (seen(sim) == (1.0, 0.0, 0.0)).all()


def test_any_image_drives_them(simulate):
    sim = simulate(LEDS, sockets=False)
    (image,) = bind(sim.context.component("robot.leds"))
    picture = np.arange(18, dtype=np.uint8).reshape(2, 3, 3) * 15
    fields, remark = image.scatter({"pixels": picture})
    assert remark is None
    sim.robot.leds.publish(fields)
    sim.step(2)
    assert seen(sim) == pytest.approx(picture / 255.0)


def test_restored_lights_shine_as_they_did(simulate):
    sim = simulate(LEDS, sockets=False)
    sim.robot.leds.set_all(0.0, 0.0, 1.0).result()
    sim.step()
    state = sim.save()
    sim.robot.leds.off().result()
    sim.step()
    sim.restore(state)
    sim.step()
    assert (seen(sim) == (0.0, 0.0, 1.0)).all()


def test_cameras_see_the_lights(simulate):
    sim = simulate(
        "robot = ATRV()\nleds = LedArray(rows=2, columns=2, pitch=0.5)\nleds.translate(4.0, 0.0, 1.0)\n"
        "leds.rotate(0, 0, 3.14159265)\nrobot.append(leds)\neye = VideoCamera()\n"
        "eye.properties(cam_width=64, cam_height=64)\neye.translate(2.0, 0.0, 1.0)\nrobot.append(eye)",
        sockets=False,
    )
    for color in ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0)):
        sim.robot.leds.set_all(*color).result()
        sim.step(10)
        image = np.frombuffer(sim.context.component("robot.eye").local_data["image"], np.uint8).reshape(64, 64, 4)
        channel = color.index(1.0)
        others = [other for other in (0, 1, 2) if other != channel]
        lit = (image[..., channel] > 150) & (image[..., others] < 60).all(axis=-1)
        assert lit.sum() > 40
