"""Simulations for abuse."""

from collections.abc import Callable, Iterator

import pytest
from victims import SCENE, Victim

from morse.testing.process import SimulationProcess

try:
    import resource
except ImportError:  # a system without such limits
    resource = None  # type: ignore[assignment]


@pytest.fixture(scope="session", autouse=True)
def descriptors() -> int:
    """The number of files and connections that this process and its simulations may open.

    Many systems allow 1024 unless a process asks for more.
    """
    enough = 8192
    if resource is None:
        return enough
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    if soft != resource.RLIM_INFINITY and soft < enough:
        soft = enough if hard == resource.RLIM_INFINITY else min(enough, hard)
        resource.setrlimit(resource.RLIMIT_NOFILE, (soft, hard))
    return enough if soft == resource.RLIM_INFINITY else soft


@pytest.fixture
def start(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Callable[..., SimulationProcess]]:
    """Call it with the text of a scene and options of ``morse run``; processes that still run at the end are killed."""
    directory = tmp_path_factory.mktemp("abuse")
    started: list[SimulationProcess] = []

    def start_text(text: str, *options: str, port: int = 0, initialized: bool = True) -> SimulationProcess:
        script = directory / f"scene{len(started)}.py"
        script.write_text(text, encoding="utf-8")
        process = SimulationProcess(
            script, directory / f"log{len(started)}", port=port, options=options or ("--headless",)
        )
        started.append(process)
        if initialized:
            process.wait_initialized()
        return process

    yield start_text
    for process in started:
        process.kill()


@pytest.fixture(scope="module")
def victim(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Victim]:
    """One simulation for all tests of a file, at ten times real time: the first test must not harm the last one."""
    directory = tmp_path_factory.mktemp("victim")
    (directory / "scene.py").write_text(SCENE, encoding="utf-8")
    process = SimulationProcess(directory / "scene.py", directory / "log", options=("--headless", "--speed", "5"))
    process.wait_initialized()
    yield Victim(process)
    assert process.watch.error is None
    process.stop()
