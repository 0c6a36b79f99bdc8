"""A real simulation in a real browser."""

from __future__ import annotations

import math
import os
import re
import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from tests.kit.waiting import wait_until

if TYPE_CHECKING:
    from playwright.sync_api import Page

pytestmark = pytest.mark.browser

SCENE = """
from morse.builder import *

robot = Morsy()
robot.translate(1.0, 0.0, 0.0)
motion = MotionVW()
robot.append(motion)
keyboard = Keyboard()
keyboard.properties(ControlType='Position')
robot.append(keyboard)
pose = Pose()
robot.append(pose)
laser = Hokuyo()
laser.translate(0.0, 0.0, 0.4)
robot.append(laser)
robot.add_default_interface('socket')

env = Environment('indoors-1/boxes')
env.set_camera_location([-4.0, -4.0, 3.0])
env.set_camera_rotation([1.2, 0.0, -0.8])
"""
START = "import sys; from morse.cli import main; sys.exit(main())"


@pytest.fixture(scope="module")
def simulation(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """The address of the live view of a running simulation."""
    folder: Path = tmp_path_factory.mktemp("live")
    (folder / "scene.py").write_text(SCENE)
    log = folder / "log.txt"
    command = [sys.executable, "-u", "-c", START, "run", "--view-port", "0", str(folder / "scene.py")]
    environment = {name: value for name, value in os.environ.items() if name not in ("DISPLAY", "WAYLAND_DISPLAY")}
    with log.open("w") as out:
        process = subprocess.Popen(command, stdout=out, stderr=subprocess.STDOUT, cwd=folder, env=environment)
    try:
        wait_until(lambda: "live view is at" in log.read_text() or process.poll() is not None, limit=60)
        found = re.search(r"http://\S+", log.read_text())
        assert found is not None, log.read_text()
        yield found.group(0)
        assert process.poll() is None, log.read_text()
    finally:
        process.send_signal(signal.SIGINT)
        try:
            process.wait(60)
        finally:
            process.kill()


@pytest.fixture(scope="module")
def shown(simulation: str, open_shared_page: Any) -> Page:
    """The page of the simulation: it takes seconds to load and to draw for the first time."""
    page: Page = open_shared_page(simulation, width=900, height=420)
    wait_until(lambda: page.evaluate("morse.seat.drives.value && morse.poses.value !== null"))
    return page


@pytest.fixture
def page(shown: Page) -> Page:
    """The page after a restart of the simulation."""
    shown.get_by_role("button", name="Reset").click()
    shown.get_by_role("dialog").get_by_role("button", name="reset").click()
    wait_until(lambda: math.dist(place(shown)[:2], (1.0, 0.0)) < 0.1, "the robot where it began")
    return shown


def place(page: Page) -> list[float]:
    found: list[float] = page.evaluate("morse.world.value.find('robot').frame.position.toArray()")
    return found


def time_of(page: Page) -> float:
    return float(page.evaluate("morse.poses.value.time"))


def test_arrow_keys_drive_the_robot_of_the_script(page) -> None:
    start = place(page)
    page.keyboard.down("ArrowUp")
    wait_until(lambda: place(page)[0] > start[0] + 0.5, "driven forward, along X")
    page.keyboard.up("ArrowUp")
    last: list[list[float]] = []
    wait_until(
        lambda: last.append(place(page)) or (len(last) > 20 and math.dist(last[-1], last[-20]) < 0.01), "standing still"
    )
    assert abs(last[-1][1]) < 0.1
    page.keyboard.down("ArrowLeft")
    yaw = "(q => 2 * Math.atan2(q.z, q.w))(morse.world.value.find('robot').frame.quaternion)"
    wait_until(lambda: page.evaluate(yaw) > 0.3, "turned left")
    page.keyboard.up("ArrowLeft")


def test_pause_step_and_play(page) -> None:
    page.get_by_role("button", name="Pause").click()
    wait_until(lambda: not page.evaluate("morse.poses.value.running"))
    stopped = time_of(page)
    page.keyboard.press(".")
    wait_until(lambda: time_of(page) > stopped)
    assert time_of(page) == pytest.approx(stopped + 1 / 60, abs=1e-6)
    page.get_by_role("button", name="Play").click()
    wait_until(lambda: time_of(page) > stopped + 0.3)


def test_components_are_listed_with_live_values_and_services(page) -> None:
    page.locator('[data-name="robot.pose"]').click()
    x = page.locator("tr").filter(has=page.get_by_role("rowheader", name="x", exact=True)).locator(".value")
    wait_until(lambda: x.inner_text() != "–" and abs(float(x.inner_text()) - 1.0) < 0.2)
    page.evaluate("morse.components.selected.set('robot.motion')")
    form = page.get_by_role("form", name="set_speed", exact=True)
    form.locator("input").nth(0).fill("0.5")
    form.locator("input").nth(1).fill("0.0")
    form.get_by_role("button", name="call").click()
    wait_until(lambda: place(page)[0] > 1.4, "driven by the service")
    page.get_by_role("form", name="stop", exact=True).get_by_role("button", name="call").click()
    wait_until(lambda: page.get_by_role("form", name="stop", exact=True).locator(".result").is_visible())


def test_rays_of_the_laser_start_at_it(page) -> None:
    page.evaluate("morse.panels.layers.switch('rays', true)")
    rays = "morse.panels.layers.list.find(l => l.id === 'rays').drawn.get('robot.laser')"
    wait_until(lambda: page.evaluate(f"{rays}?.beams.geometry.attributes.position.count > 100"))
    start = page.evaluate(f"[...{rays}.beams.geometry.attributes.position.array.slice(0, 3)]")
    laser = page.evaluate(
        "morse.world.value.find('robot.laser').frame.getWorldPosition(morse.stage.target.clone()).toArray()"
    )
    assert start == pytest.approx(laser, abs=0.05)


def test_moving_the_robot_by_hand(page) -> None:
    answer = page.evaluate(
        "morse.connection.request({type: 'teleport', node: 'robot', position: [2, 1, 0.1], quaternion: [1, 0, 0, 0]})"
    )
    assert answer["ok"], answer
    wait_until(lambda: math.dist(place(page)[:2], (2.0, 1.0)) < 0.2)
    answer = page.evaluate(
        "morse.connection.request({type: 'teleport', node: 'nothing', position: [2, 1, 0], quaternion: [1, 0, 0, 0]})"
    )
    assert not answer["ok"]
    assert "nothing" in answer["error"]
