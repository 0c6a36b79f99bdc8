"""Files that clients create: a full disk, and thousands of recordings."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

import morse
from morse.builder import Environment
from morse.core.exceptions import MorseRPCInvokationError
from morse.recording.errors import RecordingError
from morse.services import recording_services
from morse.services.foreign_models import check_model
from morse.services.recording_services import RecordingServices
from morse.services.state_services import StateServices


class Simulation:
    """Creates empty files."""

    def record(self, path: Path) -> Any:
        path.touch()
        return SimpleNamespace(path=path, running=True, stop=lambda: None)

    def save(self, path: Path | None = None) -> Any:
        if path is not None:
            path.touch()

    def restore(self, state: Any) -> None:
        raise AssertionError


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_clients_do_not_fill_the_disk(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(recording_services.shutil, "disk_usage", lambda _: SimpleNamespace(free=100 << 20))
    with pytest.raises(MorseRPCInvokationError, match=r"run\.mcap is not written: only 100 MB are free"):
        RecordingServices(Simulation()).start_recording("run")
    states = StateServices(Simulation())
    with pytest.raises(MorseRPCInvokationError, match="only 100 MB are free"):
        states.save("start", True)
    assert states.save("start") == "start", "in memory"
    assert list(folder.iterdir()) == []


def test_a_deleted_folder_is_named(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    gone = folder / "gone"
    gone.mkdir()
    monkeypatch.chdir(gone)
    gone.rmdir()
    states = StateServices(Simulation())
    for call, name in (
        (lambda: RecordingServices(Simulation()).start_recording("run"), "run.mcap"),
        (lambda: states.save("start", True), "start.morse-state"),
        (lambda: states.restore("start", True), "start.morse-state"),
    ):
        with pytest.raises(MorseRPCInvokationError, match=rf"was started was deleted, .* {name}"):
            call()
    with pytest.raises(MorseRPCInvokationError, match="clients may spawn"):
        check_model("/elsewhere/model.obj", [])
    with morse.load(lambda: Environment("empty", fastmode=True)) as sim:
        with pytest.raises(RecordingError, match=r"run\.mcap cannot be written: the present folder .* was deleted"):
            sim.record("run.mcap")
        with sim.record(folder / "run.mcap"):
            sim.step()


def test_earlier_recordings_are_not_looked_for_again(monkeypatch: pytest.MonkeyPatch) -> None:
    services = RecordingServices(Simulation())
    asked: list[Path] = []
    exists = Path.exists

    def counted(path: Path) -> bool:
        asked.append(path)
        return exists(path)

    monkeypatch.setattr(Path, "exists", counted)
    names = []
    for _ in range(50):
        names.append(Path(services.start_recording("run")).name)
        services.stop_recording()
    assert names == ["run.mcap", *(f"run-{number}.mcap" for number in range(2, 51))]
    assert len(asked) < 200
    # the name is free again as soon as its file is moved
    Path("run.mcap").unlink()
    assert Path(services.start_recording("run")).name == "run.mcap"
