"""Recording a run from the page."""

from pathlib import Path
from typing import Any

import pytest
from view_pages import toasts

from morse.recording.recording import Recording
from morse.viewer.page_messages import CallService
from morse.viewer.view_messages import Answer, RecordingDescription, Recordings
from tests.kit.waiting import wait_until

WIDE = {"width": 1200, "height": 700}
SIZE = WIDE  # of the page that tests share


@pytest.mark.browser
class TestPage:
    """The button, and what the page says of recordings."""

    def call(self, driver: Any, count: int) -> CallService:
        """Wait for so many calls of services, and return the last one."""
        calls = wait_until(
            lambda: (found := [e for e in driver.events if isinstance(e, CallService)])[count - 1 :] and found,
            f"{count} calls",
        )
        assert len(calls) == count
        last: CallService = calls[-1]
        assert last.component == "simulation"
        return last

    def test_the_button_starts_and_stops_a_recording(self, shown) -> None:
        driver, page = shown
        server = driver.server
        server.send(Recordings([]))
        page.get_by_role("button", name="Record the run").click()
        call = self.call(driver, 1)
        assert call.service == "start_recording"
        path = "/somewhere/recording.mcap"
        server.send(Recordings([RecordingDescription(path, 61.5, 1_250_000, stoppable=True)]))
        server.send(Answer(call.request, True, path))
        line = page.locator(".recording.on")
        wait_until(lambda: line.is_visible() and "1:01.50 · 1.3 MB" in line.inner_text())
        assert "recording.mcap" in line.inner_text()
        line.get_by_role("button", name="Stop recording").focus()
        server.send(Recordings([RecordingDescription(path, 62.0, 2_500_000_000, stoppable=True)]))
        wait_until(lambda: "1:02.00 · 2.5 GB" in line.inner_text())
        page.keyboard.press("Enter")  # the button keeps the focus while the numbers change
        call = self.call(driver, 2)
        assert call.service == "stop_recording"
        server.send(Answer(call.request, True, path))
        server.send(Recordings([]))
        wait_until(lambda: path in page.locator(".recordings").inner_text() and not line.is_visible())
        asked = []
        page.on("request", lambda request: asked.append(request.url))
        page.get_by_role("button", name="open in Foxglove").click()
        dialog = page.get_by_role("dialog", name="Open in Foxglove")
        told = dialog.inner_text()
        assert path in told
        assert f"morse export {path} --foxglove-layout" in told
        assert dialog.locator("a").count() == 0
        assert asked == []  # nothing leaves the machine
        dialog.get_by_role("button", name="close").click()
        page.locator(".recordings").get_by_role("button", name="Close").click()
        assert page.locator(".recording").count() == 0

    def test_a_refusal_is_shown(self, shown) -> None:
        driver, page = shown
        driver.server.send(Recordings([]))
        page.get_by_role("button", name="Record the run").click()
        refusal = "/full/recording.mcap cannot be written: No space left on device"
        driver.server.send(Answer(self.call(driver, 1).request, False, error=refusal))
        wait_until(lambda: refusal in "".join(toasts(page, "error")))

    def test_a_recording_of_the_command_line_has_no_button_to_stop_it(self, shown) -> None:
        driver, page = shown
        driver.server.send(Recordings([RecordingDescription("/a/run.mcap", 1.0, 500, stoppable=False)]))
        wait_until(lambda: "run.mcap" in page.locator(".recording.on").inner_text())
        assert "500 B" in page.locator(".recording.on").inner_text()
        assert not page.get_by_role("button", name="Stop recording").is_visible()
        driver.server.send(Recordings([], possible=False))  # a replay
        wait_until(lambda: not page.get_by_role("button", name="Record the run").is_visible())
        driver.server.send(Recordings([]))
        page.locator(".recordings").get_by_role("button", name="Close").click()


def test_pages_are_told_of_a_recording(tmp_path, monkeypatch) -> None:
    import morse
    from morse.viewer.feeds.log import RecordingsFeed

    def scene() -> None:
        from morse.builder import ATRV, Environment, Pose

        robot = ATRV()
        pose = Pose()
        robot.append(pose)
        Environment("empty")

    monkeypatch.chdir(tmp_path)
    sent: list[Recordings] = []
    server: Any = type("Server", (), {"send": staticmethod(sent.append)})()
    with morse.load(scene) as sim:
        feed = RecordingsFeed(sim, server)
        feed.update()
        with sim.record(tmp_path / "own.mcap"):
            path = Path(sim.rpc("simulation", "start_recording"))
            sim.step(30)
            feed.update()
            own, other = sent[-1].recordings
            assert (own.path, own.stoppable) == (str(tmp_path / "own.mcap"), False)
            assert (other.path, other.stoppable) == (str(path), True)
            assert other.seconds == pytest.approx(0.5)
            sim.rpc("simulation", "stop_recording")
            feed.update()
            assert [one.path for one in sent[-1].recordings] == [own.path]
        feed.update()
        assert sent[-1] == sent[0] == Recordings([])
    with Recording(path) as recording:
        assert recording.length() == 30
