"""The tutorial "A Journey to a New Simulation", chapter by chapter, as a user types it."""

import math
import subprocess
import sys
from pathlib import Path

import pexpect
import pytest
from eyes_in_pixels import eyes
from steps import block

import morse
import pymorse
from tests.kit.waiting import wait_until

pytestmark = [pytest.mark.browser, pytest.mark.blender]

CRATES = Path(morse.__file__).parent / "data" / "props" / "crates.blend"
#: true in the page once the world is loaded and moves
SHOWN = "!!(window.morse?.world.value && window.morse?.poses.value)"
FACING_THE_CAMERA = """
env.set_camera_location([4.0, 0.0, 0.9])
env.set_camera_rotation([1.5708, 0, 1.5708])
"""


@pytest.fixture(autouse=True)
def _nothing_keeps_running(person):
    yield
    person.leaves()


def client(person, name, file="keyboard_ctrl.py"):
    """Start a client program of the tutorial in a terminal."""
    script = person.project / "scripts" / file
    script.write_text(block(name))
    return pexpect.spawn(sys.executable, [str(script)], cwd=str(person.folder), encoding="utf-8", timeout=60)


def stands_still(simu):
    """Wait until the robot has not moved for a second of simulated time, and return its pose."""

    def still():
        before = simu.robot.pose.get()
        simu.sleep(1.0)
        after = simu.robot.pose.get()
        return math.hypot(after["x"] - before["x"], after["y"] - before["y"]) < 0.02 and after

    return wait_until(still, "the robot to stand still")


def press(terminal, keys, prompt):
    for key in keys:
        terminal.expect_exact(prompt)
        terminal.sendline(key)


def test_chapter_two_create_and_drive_morsy(person, page):
    said = person.types("create", "ranger_sim")
    assert "morse run ranger_sim" in said
    for name in ("default.py", "scripts/ranger_sim_client.py", "src/ranger_sim/__init__.py"):
        assert (person.project / name).is_file()
    simulation = person.runs("--view-port", "0", "--speed", "4", "ranger_sim")
    page.goto(simulation.url)
    with pymorse.Morse() as simu:
        start = simu.robot.pose.get()
        assert (start["x"], start["y"]) == pytest.approx((1.0, 0.0), abs=1e-3)
        wait_until(lambda: page.evaluate(SHOWN), "the world in the page")
        way = []
        simu.robot.pose.subscribe(way.append)
        page.keyboard.down("ArrowUp")
        before = wait_until(lambda: next((p for p in way if p["x"] < -7.0), None), "Morsy to reach the board")
        assert math.atan2(before["y"], before["x"] - 1.0) == pytest.approx(3.5 - 2 * math.pi, abs=0.1)
        wait_until(lambda: simu.robot.pose.get()["x"] < -8.2, "Morsy to touch the board")
        stopped = stands_still(simu)
        # the board begins at x = -9; Morsy (0.79 m x 1.12 m) touches it with a corner, whichever way it was turned
        reach = 0.393 * abs(math.cos(stopped["yaw"])) + 0.558 * abs(math.sin(stopped["yaw"]))
        assert stopped["x"] - reach == pytest.approx(-9.0, abs=0.05)
        page.keyboard.up("ArrowUp")
        page.keyboard.down("ArrowDown")
        wait_until(lambda: simu.robot.pose.get()["x"] > stopped["x"] + 0.5, "Morsy to drive back")
        page.keyboard.up("ArrowDown")
        stands_still(simu)  # as soon as the page has said so
    simulation.stop()


def test_chapter_two_a_robot_of_our_own(person):
    person.types("add", "robot", "ranger", "ranger_sim")
    for name in (
        "data/ranger_sim/robots/ranger.blend",
        "src/ranger_sim/robots/ranger.py",
        "src/ranger_sim/builder/robots/ranger.py",
    ):
        assert (person.project / name).is_file()
    (person.project / "default.py").write_text(block("default.py"))
    simulation = person.runs("--headless", "ranger_sim")
    with pymorse.Morse() as simu:
        assert simu.robots == ["robot"]
        assert {"motion", "pose"} <= set(simu.robot)
        # the same appearance as before
        objects = simu.rpc("simulation", "get_scene_objects")["robot"][0]
        assert any(name.startswith("morsy") for name in objects)
    simulation.stop()


def test_chapter_two_a_crate_with_eyes(person):
    person.edits("edit_ranger.py", person.project / "data/ranger_sim/robots/ranger.blend", str(CRATES))
    simulation = person.runs("--headless", "ranger_sim")
    with pymorse.Morse() as simu:
        parts = simu.rpc("simulation", "get_scene_objects")["robot"][0]
        assert {"left_eye", "right_eye"} <= set(parts)
        assert any("small_crate" in name for name in parts)
        assert not any(name.startswith("morsy") for name in parts)
        # the crate is on the floor and does not move by itself
        start = simu.robot.pose.get()
        simu.sleep(1.0)
        assert math.dist(*[(p["x"], p["y"], p["z"]) for p in (start, simu.robot.pose.get())]) < 0.02
    simulation.stop()


def test_chapter_three_drive_from_a_program(person):
    simulation = person.runs("--headless", "ranger_sim")
    terminal = client(person, "keyboard_first.py")
    press(terminal, "wwww", "WASD?")
    with pymorse.Morse() as simu:

        def speeds():
            """Along X, to the side, and about Z, in half a second of simulated time."""
            start = simu.robot.pose.get()
            simu.sleep(0.5)
            end = simu.robot.pose.get()
            seconds = end["timestamp"] - start["timestamp"]
            turn = math.remainder(end["yaw"] - start["yaw"], math.tau)
            return [(end["x"] - start["x"]) / seconds, (end["y"] - start["y"]) / seconds, turn / seconds]

        # four times 0.1 m/s forward, along X; the client reads its keys when it gets around to it
        wait_until(lambda: speeds() == pytest.approx([0.4, 0.0, 0.0], abs=0.05), "0.4 m/s")
        press(terminal, "ssss" + "aaaaa", "WASD?")
        wait_until(lambda: speeds() == pytest.approx([0.0, 0.0, 0.5], abs=0.04), "0.5 rad/s on the spot")
    terminal.sendintr()
    terminal.expect(pexpect.EOF)
    terminal.close()
    assert simulation.process.poll() is None
    simulation.stop()


def test_chapter_three_read_the_pose(person):
    simulation = person.runs("--headless", "ranger_sim")
    terminal = client(person, "keyboard_second.py")
    terminal.expect(r"The Ranger is currently at \{[^}]*'x': (-?[\d.]+)")
    first = float(terminal.match.group(1))
    terminal.sendline("w")
    terminal.sendline("w")

    def moved():
        terminal.expect(r"The Ranger is currently at \{[^}]*'x': (-?[\d.]+)")
        return float(terminal.match.group(1)) > first + 0.05

    wait_until(moved, "the printed position to change")
    terminal.sendintr()
    terminal.expect(pexpect.EOF)
    terminal.close()
    simulation.stop()


def inserted(text, after, lines):
    """A text with lines inserted below the line that contains ``after``, with the same indentation."""
    found = text.splitlines()
    last = max(i for i, line in enumerate(found) if after in line)
    indent = " " * (len(found[last]) - len(found[last].lstrip()))
    found[last + 1 : last + 1] = [indent + line for line in lines.splitlines()]
    return "\n".join(found) + "\n"


def test_chapter_four_a_new_actuator(person):
    said = person.types("add", "actuator", "eyes", "ranger_sim", answer="Controls the eyes of the EPFL Ranger robot\n")
    assert "from ranger_sim.builder.actuators import Eyes" in said
    builder = person.project / "src/ranger_sim/builder/robots/ranger.py"
    added = inserted(builder.read_text(), "self.append(self.motion)", block("builder_lines.py"))
    builder.write_text(block("builder_import.py") + added)
    simulation = person.runs("--headless", "ranger_sim")
    summary = "\n".join(simulation.lines)
    assert "ROBOT: 'robot'" in summary
    for component in ("robot.pose", "robot.keyboard", "robot.eyes", "robot.motion"):
        assert f"\t\t- Component: '{component}'" in summary
    simulation.stop()


def angle_of(simu, eye):
    """Rotation of an eye about the X axis of the robot, which is upright, except for a small oscillation."""
    robot = simu.rpc("simulation", "get_scene_objects")["robot"]
    return turned_about_x(robot[0][eye][2]) - turned_about_x(robot[2])


def turned_about_x(quaternion):
    x, _, _, w = quaternion
    return 2 * math.atan2(x, w)


def test_chapter_four_the_eyes_move(person, page, tmp_path):
    (person.project / "src/ranger_sim/actuators/eyes.py").write_text(block("eyes.py"))
    (person.project / "default.py").write_text(block("default.py") + FACING_THE_CAMERA)
    simulation = person.runs("--view-port", "0", "ranger_sim")
    page.goto(simulation.url)
    wait_until(lambda: page.evaluate(SHOWN), "the world in the page")
    with pymorse.Morse() as simu:
        # the defaults of the actuator
        wait_until(lambda: abs(angle_of(simu, "left_eye") - 0.1) < 1e-3, "the left eye")
        wait_until(lambda: abs(angle_of(simu, "right_eye") + 0.1) < 1e-3, "the right eye")
        before = wait_until(lambda: look(page, tmp_path / "before.png"), "two eyes in the picture", 60)
        terminal = client(person, "keyboard_third.py")
        press(terminal, "r" * 15 + "t" * 8, "WASD (eyes:RFTG)?")
        wait_until(lambda: abs(angle_of(simu, "left_eye") - 1.5) < 1e-3, "the left eye to turn")
        wait_until(lambda: abs(angle_of(simu, "right_eye") - 0.8) < 1e-3, "the right eye to turn")
        # from the front +Y is to the right: a turn about +X takes a pupil from above to the left
        # the page may be some frames behind the simulation
        wanted = {1: 1.5 - 0.1, 0: 0.8 + 0.1}

        def turned():
            seen = look(page, tmp_path / "after.png")
            return seen and all(abs(turn_of(seen[i]) - turn_of(before[i]) - wanted[i]) < 0.25 for i in wanted)

        wait_until(turned, "the pupils to turn by 1.4 and 0.9 rad in the picture", 60)
    terminal.sendintr()
    terminal.expect(pexpect.EOF)
    terminal.close()
    simulation.stop()


def look(page, picture):
    page.screenshot(path=str(picture))
    found = eyes(picture)
    return found if len(found) == 2 else None


def turn_of(eye):
    """Angle of the pupil about the viewing direction, from straight up, turning to the left."""
    _, right, up = eye
    return math.atan2(-right, up)


def where(simu, name):
    """The position of an object, metres."""
    return simu.rpc("simulation", "get_scene_objects")[name][1]


def test_chapter_five_a_world(person):
    world = person.project / "data/ranger_sim/environments/playroom.blend"
    person.edits("draw_playroom.py", None, str(world))
    (person.project / "default.py").write_text(block("playroom.py"))
    simulation = person.runs("--headless", "--speed", "2", "ranger_sim")
    with pymorse.Morse() as simu:
        assert {"battery", "motion", "pose", "eyes"} <= set(simu.robot)
        assert where(simu, "Ball")[:2] == pytest.approx([0.0, 0.0], abs=0.02)
        # the ball is on the floor, next to the basket
        assert where(simu, "Ball")[2] == pytest.approx(0.25, abs=0.02)
        assert where(simu, "basket")[:2] == pytest.approx([3.0, 3.0], abs=0.1)
        # on the station the charge does not fall
        assert simu.robot.battery.get()["charge"] == 100.0
        terminal = client(person, "play.py", "play.py")
        terminal.expect(r"(\w+), (\d+) %", timeout=60)
        assert terminal.match.group(1) == "Charging"
        # at 1 m/s it takes 3.7 s out of the zone to x = 1.5 and back, at 2 % per second
        assert 60 < int(terminal.match.group(2)) <= 100 - 2 * 2 * 3.5
        terminal.expect(pexpect.EOF)
        terminal.close()
        # it ran into the ball, which rolls
        assert math.hypot(*where(simu, "Ball")[:2]) > 0.5
        assert abs(simu.robot.pose.get()["x"] + 3.0) < 1.2
        # the inner side of the walls is 0.1 m from their centre
        simu.robot.motion.publish({"v": -2.0, "w": 0.0})
        simu.sleep(4.0)
        assert -5.0 < simu.robot.pose.get()["x"] < -4.0
    simulation.stop()


def test_chapter_six_lights_and_sound(person):
    person.types("add", "actuator", "mood", "ranger_sim", answer="Shows the mood of the Ranger\n")
    source = person.project / "src/ranger_sim"
    (source / "actuators/mood.py").write_text(block("mood.py"))
    (source / "builder/actuators/mood.py").write_text(block("mood_builder.py"))
    robot = source / "builder/robots/ranger.py"
    text = robot.read_text().replace(block("builder_import.py"), block("mood_import.py"))
    robot.write_text(inserted(text, "self.append(self.eyes)", block("mood_lines.py")))
    beep = person.project / "scripts" / "beep.py"
    beep.write_text(block("beep.py"))
    subprocess.run([sys.executable, str(beep)], cwd=person.folder, check=True, timeout=60)
    scene = person.project / "default.py"
    scene.write_text(inserted(scene.read_text(), "robot.append(battery)", "\n" + block("voice_lines.py")))
    simulation = person.runs("--headless", "--speed", "2", "ranger_sim")
    with pymorse.Morse() as simu:
        start = simu.time()
        terminal = client(person, "moods.py", "moods.py")
        terminal.expect_exact("The moods of the Ranger are over", timeout=60)
        # two moods of 2 s
        assert simu.time() - start >= 4.0
        terminal.expect(pexpect.EOF)
        terminal.close()
        with pytest.raises(pymorse.MorseServiceFailed, match="'mood' is one of 'happy', 'sad', not 'angry'"):
            simu.robot.mood.show("angry").result()
    simulation.stop()


def test_chapter_six_the_lights_are_seen(person, monkeypatch):
    monkeypatch.chdir(person.folder)
    with morse.load(person.project / "default.py") as simulation:

        def green():
            """Pixels of a picture of the front of the robot that are green."""
            view = {"location": (-1.2, 0.0, 0.5), "rotation": (math.pi / 2, 0.0, math.pi / 2)}
            red, green, blue = simulation.picture(160, 100, **view).astype(int).transpose(2, 0, 1)
            return int(((green > 120) & (green > 1.5 * red) & (green > 1.5 * blue)).sum())

        simulation.step(60)
        assert green() == 0
        shown = simulation.robot.mood.show("happy")
        simulation.step(2)
        assert green() > 10
        begun = simulation.clock.time
        shown.result()
        assert simulation.clock.time - begun == pytest.approx(2.0, abs=0.05)
        simulation.step()
        assert green() == 0
        simulation.robot.voice.publish({"mode": "play"})
        simulation.step(30)
        assert simulation.context.component("robot.voice").played == pytest.approx(0.5, abs=0.02)


def test_chapter_six_the_actuator_keeps_the_contract(person):
    said = person.types(
        "check",
        "component",
        "ranger_sim/src/ranger_sim/actuators/mood.py",
        "--robot",
        "ranger_sim.builder.robots.Ranger",
    )
    assert "Mood satisfies the contract" in said
