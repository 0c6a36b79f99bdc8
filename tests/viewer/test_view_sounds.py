"""What loudspeakers of robots play, on the page."""

import io
import math
import wave
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from view_pages import fetch

import morse
from morse.viewer.feeds.sensors import SoundsFeed, read_sound
from morse.viewer.view_messages import SoundState
from tests.kit.waiting import wait_until

RATE = 8000


def sine(seconds: float = 0.5) -> bytes:
    """A WAV file with a tone of 500 Hz."""
    out = io.BytesIO()
    with wave.open(out, "wb") as file:
        file.setnchannels(1)
        file.setsampwidth(2)
        file.setframerate(RATE)
        times = np.arange(int(seconds * RATE)) / RATE
        file.writeframes((20000 * np.sin(2 * math.pi * 500 * times)).astype("<i2").tobytes())
    return out.getvalue()


class Server:
    """Takes what the feed sends and offers."""

    def __init__(self) -> None:
        self.sent: list[SoundState] = []
        self.offered: list[bytes] = []

    def send(self, message: Any) -> None:
        self.sent.append(message)

    def offer(self, folder: str, _mime: str, data: bytes) -> str:
        self.offered.append(data)
        return f"/{folder}/{len(self.offered)}"


@pytest.fixture
def scene(tmp_path: Path) -> Path:
    (tmp_path / "horn.wav").write_bytes(sine())
    script = tmp_path / "scene.py"
    script.write_text(
        "from morse.builder import *\nrobot = ATRV()\nhorn, beeper = Sound(), Sound()\n"
        f"horn.open({str(tmp_path / 'horn.wav')!r})\nrobot.append(horn)\nrobot.append(beeper)\nEnvironment('empty')\n"
    )
    return script


def test_pages_are_told_what_is_played_and_for_how_long(scene) -> None:
    server: Any = Server()
    with morse.load(scene) as sim:
        feed = SoundsFeed(sim.context, server)
        feed.update()
        assert [(s.component, s.mode, s.url) for s in server.sent] == [
            ("robot.horn", "stop", "/sounds/1"),
            ("robot.beeper", "stop", None),
        ]
        assert server.offered == [sine()]
        sim.robot.horn.publish({"mode": "play"})
        sim.step(30)
        feed.update()
        feed.update()
        assert len(server.sent) == 3
        assert server.sent[-1].played == pytest.approx(0.5, abs=0.03)
        assert server.sent[-1].time == pytest.approx(0.5)


def test_clients_cannot_have_files_read(scene, tmp_path, caplog) -> None:
    secret = tmp_path / "secret.wav"
    secret.write_bytes(sine(0.1))
    server: Any = Server()
    with morse.load(scene) as sim:
        feed = SoundsFeed(sim.context, server)
        sim.rpc("robot.horn", "set_property", "file", str(secret))
        feed.update()
        assert server.sent[0].url is None
        assert server.offered == []
    assert "the scene script does not name" in caplog.text


@pytest.mark.parametrize("content", [b"", b"root:x:0:0", b"\x7fELF" + b"0" * 100, b"RIFF0000AVI "])
def test_files_of_other_kinds_are_not_sent(tmp_path, content) -> None:
    file = tmp_path / "sound.wav"
    file.write_bytes(content)
    with pytest.raises(ValueError, match="is not WAV"):
        read_sound(file)


def test_what_is_no_file_is_not_read(tmp_path) -> None:
    with pytest.raises(ValueError, match="no such file"):
        read_sound(tmp_path)
    with pytest.raises(ValueError, match="no such file"):
        read_sound(tmp_path / "nothing.wav")


def test_sounds_need_the_token_like_everything_else(make_server) -> None:
    server, url = make_server(token="secret")
    address = server.offer("sounds", "audio/wav", sine())
    base, _, query = url.partition("?")
    wait_until(lambda: fetch(f"{base.rstrip('/')}{address}?{query}")[0] == 200)
    assert fetch(f"{base.rstrip('/')}{address}")[0] == 403
    assert fetch(f"{base.rstrip('/')}{address}?{query}")[2] == sine()


@pytest.mark.browser
class TestPage:
    """Loudspeakers on the page."""

    def test_a_sound_is_heard_after_a_click_until_it_is_muted(self, running, open_page) -> None:
        driver, url = running
        server = driver.server
        page = open_page(url, width=1200, height=700)
        button = page.get_by_role("button", name="Let robots be heard")
        assert not button.is_visible()  # no robot has a loudspeaker
        address = server.offer("sounds", "audio/wav", sine())
        server.send(SoundState("robot0", "play", address, 0.0, 0.0))
        wait_until(button.is_visible)
        assert page.evaluate("morse.panels.sounds.context === null")  # browsers demand a gesture
        button.click()
        wait_until(
            lambda: page.evaluate("morse.panels.sounds.audible && morse.panels.sounds.voices.get('robot0').playing")
        )
        ear = "(() => { const l = morse.panels.sounds.context.listener, p = morse.stage.view.position;"
        ear += " return Math.hypot(l.positionX.value - p.x, l.positionY.value - p.y, l.positionZ.value - p.z) })()"
        wait_until(lambda: page.evaluate(ear) < 1e-3)
        volume = "morse.panels.sounds.output.gain.value"
        wait_until(lambda: page.evaluate(volume) > 0.9)
        driver.running = False  # time stands still: so does the sound
        wait_until(lambda: page.evaluate(volume) < 0.1)
        driver.running = True
        wait_until(lambda: page.evaluate(volume) > 0.9)
        page.get_by_role("button", name="Mute").click()
        wait_until(lambda: page.evaluate(volume) < 0.1)
        server.send(SoundState("robot0", "stop", address, 0.0, 1.0))
        wait_until(lambda: not page.evaluate("morse.panels.sounds.voices.get('robot0').playing"))
        page.reload()
        wait_until(lambda: page.evaluate("!!window.morse?.world.value"))
        page.keyboard.press("c")
        assert page.evaluate("morse.panels.sounds.context === null")  # it stays muted

    def test_sound_pressure_falls_with_the_distance(self, running, open_page) -> None:
        driver, url = running
        driver.server.send(SoundState("robot0", "play", None, 0.0, 0.0))
        page = open_page(url)
        page.locator("main > canvas").click()
        wait_until(lambda: page.evaluate("morse.panels.sounds.voices.size") == 1)
        levels = [
            page.evaluate(
                """async (distance) => {
                const offline = new OfflineAudioContext(1, 8000, 16000);
                const voice = new (morse.panels.sounds.voices.get('robot0').constructor)(offline, offline.destination);
                voice.place(morse.stage.target.clone().set(0, 0, -distance));
                voice.playTone(0);
                const samples = (await offline.startRendering()).getChannelData(0).slice(2000);
                return Math.sqrt(samples.reduce((sum, x) => sum + x * x, 0) / samples.length) }""",
                distance,
            )
            for distance in (0.5, 1.0, 2.0, 8.0)
        ]
        # 1/r beyond a metre, and no louder nearer
        assert np.array(levels) / levels[1] == pytest.approx([1.0, 1.0, 0.5, 0.125], rel=0.02)
        assert levels[1] > 0.05
