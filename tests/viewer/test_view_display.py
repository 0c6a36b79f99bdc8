"""The page shows what a script wants to be shown."""

import math

import pytest
from view_pages import toasts
from view_worlds import box, mesh_node, playground

from morse.scene import Material
from morse.viewer.page_messages import Reset
from morse.viewer.view_messages import FileMistake, Log, SavedFiles
from tests.kit.waiting import wait_until

pytestmark = pytest.mark.browser

FROM_ROBOT = "morse.stage.view.position.clone().sub(morse.world.value.find('robot1').frame.position).toArray()"


def test_what_a_script_shows_is_shown_unasked(running, open_page) -> None:
    driver, url = running
    scene, moving = playground()
    display = scene.settings.view.display
    display.rays, display.follow, display.select = ("robot0.lidar",), "robot1", "robot2.lidar"
    display.plots, display.overlays = ((("robot1.lidar", "x"), ("robot1.lidar", "y")),), ("trails",)
    display.images = ("robot1.lidar", "robot2.lidar")
    driver.server.set_scene(scene, moving)
    page = open_page(url, width=1200, height=700)
    wait_until(lambda: driver.server.wishes.images == {"robot1.lidar", "robot2.lidar"})
    # rays of the sensor that is named, and of the selected one
    wait_until(lambda: driver.server.wishes.overlays == {"robot0.lidar", "robot2.lidar"})
    wait_until(lambda: "robot1.lidar" in driver.server.wishes.values)
    assert page.evaluate("morse.panels.plots.plots.length") == 1
    assert page.evaluate("morse.panels.layers.list.filter((one) => one.on).map((one) => one.id)") == ["trails"]
    page.get_by_role("heading", name="robot2.lidar").wait_for()
    assert page.evaluate("morse.follow.mode.value") == "along"
    # the distance of the script from the robot, wherever it has driven
    begin = next(node for node in scene.roots if node.name == "robot1").location
    asked = [a - b for a, b in zip(scene.settings.view.camera_location, begin, strict=True)]
    wait_until(lambda: page.evaluate(FROM_ROBOT) == pytest.approx(asked, abs=0.3))
    # what a script shows is not the choice of the user: other scenes do not get it
    assert page.evaluate("localStorage.getItem('morse.layers')") is None
    assert page.evaluate("localStorage.getItem('morse.panels')") is None


def test_a_page_tells_that_it_has_drawn_the_world(running, open_page) -> None:
    driver, url = running
    open_page(url)
    wait_until(lambda: driver.server.drawn)


TRAIL = (
    "morse.panels.layers.list.find((one) => one.id === 'trails').trails.find((one) => one.node.name === 'robot1').count"
)
PLACE = "morse.world.value.find('robot1').frame.position.toArray()"
#: two frames later: what had been asked for before has been drawn
DRAWN = "new Promise((done) => { morse.stage.invalidate(); requestAnimationFrame(() => requestAnimationFrame(done)); })"


def test_robots_and_trails_stay_when_the_world_is_described_again(running, open_page) -> None:
    """Robots stand where they were, not where the scene begins, until the first poses of the new description."""
    driver, url = running
    scene, moving = playground()
    scene.settings.view.display.overlays = ("trails",)
    driver.server.set_scene(scene, moving)
    page = open_page(url)
    wait_until(lambda: page.evaluate(TRAIL) > 5)
    driver.running = False
    wait_until(lambda: page.evaluate(PLACE) == pytest.approx(driver.poses()[2, :3].tolist()))
    driver.shown = False  # no more poses
    page.evaluate(DRAWN)
    before, place = page.evaluate(TRAIL), page.evaluate(PLACE)
    page.evaluate("window.former = morse.world.value")
    driver.server.set_scene(scene, moving)
    wait_until(lambda: page.evaluate("morse.world.value !== former"))
    page.evaluate(DRAWN)
    assert page.evaluate(PLACE) == place
    assert page.evaluate(TRAIL) == before
    driver.running, driver.shown = True, True
    wait_until(lambda: page.evaluate(TRAIL) > before)


IN_PICTURE = "morse.world.value.find('robot1').frame.position.clone().project(morse.stage.view.camera).toArray()"


def test_a_followed_robot_outside_of_the_picture_is_brought_into_it(running, open_page) -> None:
    driver, url = running
    scene, moving = playground()
    view = scene.settings.view
    view.display.follow, view.camera_location, view.camera_rotation = "robot1", (0.0, -6.0, 4.0), (1.2, 0.0, 3.0)
    driver.server.set_scene(scene, moving)
    page = open_page(url)
    wait_until(lambda: page.evaluate("morse.follow.mode.value") == "along")
    wait_until(lambda: max(map(abs, page.evaluate(IN_PICTURE)[:2])) < 1.0)
    assert page.evaluate(IN_PICTURE)[2] < 1.0  # in front of the camera


@pytest.mark.parametrize(("width", "hides"), [(8.0, True), (0.15, False)], ids=["wall", "pole"])
def test_a_camera_that_follows_stays_in_front_of_walls(running, open_page, width: float, hides: bool) -> None:
    driver, url = running
    driver.running = False
    scene, moving = playground()
    x, y, _, *turn = driver.poses()[2]
    heading = 2 * math.atan2(turn[3], turn[0])
    behind = 2.0
    place = (x - behind * math.cos(heading), y - behind * math.sin(heading), 0.0)
    wall = mesh_node("wall", box("wall", Material("grey")), place, rotation_euler=[0.0, 0.0, heading])
    wall.scale[:] = 0.1, width, 8.0
    scene.roots.append(wall)
    driver.server.set_scene(scene, moving)
    page = open_page(url)
    wait_until(lambda: page.evaluate("!!morse.world.value?.find('wall')"))
    page.evaluate("morse.follow.start('third', morse.world.value.find('robot1'))")
    distance = "Math.hypot(...morse.stage.view.position.clone().sub(morse.stage.target).toArray().slice(0, 2))"
    # without a wall, it is farther behind the robot than the wall
    wait_until(
        lambda: page.evaluate(
            "morse.follow.sight[0].length() < Infinity && !morse.follow.hasToLook(morse.stage.target)"
        )
    )
    wait_until(lambda: (page.evaluate(distance) < behind) == hides)
    assert max(map(abs, page.evaluate(IN_PICTURE)[:2])) < 1.0


def test_no_lines_look_like_a_floor_where_a_world_has_none(running, open_page) -> None:
    driver, url = running
    scene, moving = playground()
    scene.roots[:] = [root for root in scene.roots if root.name != "floor"]
    driver.server.set_scene(scene, moving)
    page = open_page(url)
    wait_until(lambda: page.evaluate("!!morse.world.value && !morse.world.value.find('floor')"))
    wait_until(lambda: page.evaluate("morse.stage.ground.mesh.material.visible") is False)


def test_messages_have_the_room_of_plots_that_are_not_there(running, open_page) -> None:
    _, url = running
    page = open_page(url, width=1200, height=700)
    page.evaluate("morse.shell.show('bottom')")
    widths = "['.plots', '.log'].map((name) => document.querySelector(name).clientWidth)"
    wait_until(lambda: page.evaluate(widths)[0] > 0)
    plots, log = page.evaluate(widths)
    assert log > 2 * plots


def test_what_the_user_has_closed_stays_closed(running, open_page) -> None:
    driver, url = running
    scene, moving = playground()
    scene.settings.view.display.plots = ((("robot1.lidar", "x"),),)
    driver.server.set_scene(scene, moving)
    page = open_page(url, width=1200, height=700)
    wait_until(lambda: page.evaluate("morse.panels.plots.plots.length") == 1)
    page.evaluate("morse.panels.plots.plots[0].onEmpty()")
    page.reload()
    wait_until(lambda: page.evaluate("!!window.morse?.world.value"))
    assert page.evaluate("morse.panels.plots.plots.length") == 0


def test_a_layout_opens_these_panels_alone(running, open_page) -> None:
    driver, url = running
    scene, moving = playground()
    scene.settings.view.display.panels = ("plots",)
    driver.server.set_scene(scene, moving)
    page = open_page(url, width=1200, height=700)
    wait_until(lambda: page.locator("section.bottom").is_visible())
    assert page.locator("aside.left").is_hidden()
    assert page.locator("aside.right").is_hidden()


def test_a_mistake_in_a_saved_file_stays_on_the_page_and_opens_the_log(running, open_page) -> None:
    driver, url = running
    driver.server.send(Log("error", "eyes.py was saved, but ...: SyntaxError: expected ':'", "", 1.0, 0))
    driver.server.send(SavedFiles([FileMistake("eyes.py", 24, "SyntaxError: expected ':'")], []))
    page = open_page(url, width=1200, height=700)
    mistake = page.get_by_role("button", name="eyes.py, line 24")
    mistake.wait_for()
    mistake.click()
    wait_until(lambda: page.locator(".log p.found").is_visible())
    driver.server.send(SavedFiles([], ["default.py"]))
    wait_until(lambda: mistake.count() == 0)
    driver.events.clear()
    page.get_by_role("button", name="reload").click()
    wait_until(lambda: any(isinstance(event, Reset) for event in driver.events))
    # the dialogue of F11 says the same
    page.keyboard.press("F11")
    wait_until(lambda: "default.py was saved" in page.locator("dialog.ask").inner_text())


def test_an_error_of_a_component_names_its_line(running, open_page) -> None:
    driver, url = running
    page = open_page(url, width=1200, height=700)
    wait_until(lambda: page.evaluate("morse.seat.drives.value"))
    text = "robot0.lidar: KeyError: 'lefft'\n  File \"/home/me/src/eyes.py\", line 24, in default_action"
    driver.server.send(Log("error", text, "", 1.0, 0))
    wait_until(lambda: any("'lefft' (eyes.py, line 24)" in told for told in toasts(page)))


@pytest.mark.parametrize("step", [1e-9, 1e-5, 0.002, 0.5, 20.0, 5e7])
def test_ticks_of_a_plot_differ_and_have_units(shown, step) -> None:
    _, page = shown
    page.evaluate("morse.panels.plots.plot('robot0.lidar', 'x')")
    wait_until(lambda: page.evaluate("morse.panels.plots.plots[0].curves.length") == 1)
    unit = page.evaluate("morse.panels.plots.plots[0].curves[0].unit")
    ticks = page.evaluate(f"morse.panels.plots.plots[0].ticks({[n * step for n in range(-3, 4)]})")
    assert len(set(ticks)) == 7
    assert unit != ""
    assert all(tick.endswith(f" {unit}") for tick in ticks)
    assert [float(tick.split()[0]) for tick in ticks] == pytest.approx([n * step for n in range(-3, 4)])
