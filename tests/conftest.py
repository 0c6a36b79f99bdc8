from __future__ import annotations

import contextlib
import importlib.util
import os
import re
import signal
import tempfile
import threading
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from hypothesis import HealthCheck, Phase, find, settings
from hypothesis import strategies as st

if TYPE_CHECKING:
    from collections.abc import Generator, Iterator

    from playwright.sync_api import Browser

pytest_plugins = ["morse.testing.fixtures"]

CHROMIUM = os.environ.get("MORSE_CHROMIUM", "/usr/bin/chromium")
FLAGS = [
    "--no-sandbox",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    # without a graphics card, the page around the view is put together many times faster without OpenGL
    "--disable-gpu-compositing",
    "--disable-gpu-rasterization",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--no-first-run",
]

_MUST_RUN_IN_CI = ("browser", "blender")

#: folders of `pytest -m quick`: the parts of MORSE that need neither a network nor other programs
_QUICK_FOLDERS = (
    "actuators", "assets", "builder", "components", "core", "helpers", "mathutils", "modifiers", "physics", "rendering",
    "sensors",
)  # fmt: skip
#: what a file of tests contains that starts other programs
_OTHER_PROGRAMS = re.compile(r"\b(subprocess|Popen|pexpect|SimulationProcess)\b")
_NOT_QUICK = ("long", "slow", "soak", "browser", "blender")

#: the first port of the services of a worker's simulations, the distance to those of the next worker, and how many such
#: sets of ports there are below the ports that the system gives to clients
_FIRST_PORT, _PORTS, _SETS_OF_PORTS = 20_000, 200, 60

# other programs that take the processor are not a reason to fail; `pytest --hypothesis-profile nightly` tries all
settings.register_profile("everyday", deadline=None, max_examples=25)
settings.register_profile("nightly", deadline=None, max_examples=100)
if settings.get_current_profile_name() != "nightly":
    settings.load_profile("everyday")

# A shell starts its background jobs (`pytest &`) with SIGINT ignored, and child processes inherit this: tests that send
# Ctrl+C to a child would wait forever
if signal.getsignal(signal.SIGINT) == signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)

# Each worker of pytest-xdist has ports of its own, and so has each of several runs on one machine. A worker inherits
# the port of the process that has started it, and ignores it
_worker = os.environ.get("PYTEST_XDIST_WORKER", "")
if _worker or not os.environ.get("MORSE_SOCKET_PORT"):
    _run = int(os.environ["PYTEST_XDIST_TESTRUNUID"], 16) if _worker else os.getpid()
    _set = (_run + int(_worker.removeprefix("gw") or 0)) % _SETS_OF_PORTS
    os.environ["MORSE_SOCKET_PORT"] = str(_FIRST_PORT + _PORTS * _set)


def pytest_configure(config: pytest.Config) -> None:
    """Give all workers one cache of collision shapes, which is empty at first."""
    if not _worker:
        folder = tempfile.TemporaryDirectory(prefix="morse-tests-cache-", ignore_cleanup_errors=True)
        os.environ["MORSE_CACHE"] = folder.name
        config.add_cleanup(folder.cleanup)
    elif config.args == config.getini("testpaths"):
        config.args = _folders_of_this_worker(config)


def _folders_of_this_worker(config: pytest.Config) -> list[str]:
    """All folders of tests; each worker begins with another one.

    pytest compiles each file of tests when it is first imported, and keeps the result for the other workers: in a clean
    checkout, workers that begin with the same file would all compile all files.
    """
    folders = sorted(path for path in Path(__file__).parent.iterdir() if any(path.glob("**/test_*.py")))
    worker, count = int(_worker.removeprefix("gw")), int(os.environ["PYTEST_XDIST_WORKER_COUNT"])
    begin = len(folders) * worker // count
    return [str(path.relative_to(config.invocation_params.dir)) for path in folders[begin:] + folders[:begin]]


def pytest_xdist_auto_num_workers() -> int | None:
    """Three workers for two processors: many tests wait for other processes, or for time to pass."""
    if os.environ.get("PYTEST_XDIST_AUTO_NUM_WORKERS"):
        return None
    return len(os.sched_getaffinity(0)) * 3 // 2 if hasattr(os, "sched_getaffinity") else os.cpu_count()


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Mark quick tests, and put long files first: no worker begins one when the others have ended.

    A test is quick if it is marked so, or if it is in one of the folders above, in a file that starts no other program,
    and has none of the marks of longer tests. The order is the same in each worker, whichever folder it has collected
    first: pages in a browser, files marked as long, files that start other programs, all others; large files first.
    """
    texts: dict[Path, str] = {}
    places: dict[Path, tuple[int, int]] = {}
    for item in items:
        if item.path not in texts:
            text = texts[item.path] = item.path.read_text(encoding="utf-8")
            kind = 2 if _OTHER_PROGRAMS.search(text) else 3
            places[item.path] = (kind, -len(text))
        if item.get_closest_marker("browser") or item.get_closest_marker("long"):
            kind = 0 if item.get_closest_marker("browser") else 1
            places[item.path] = min(places[item.path], (kind, -len(texts[item.path])))
        if _is_quick(item, texts[item.path]):
            item.add_marker("quick")
    items.sort(key=lambda item: (places[item.path], item.path))


def _is_quick(item: pytest.Item, text: str) -> bool:
    here = Path(__file__).parent
    folder = item.path.relative_to(here).parts[0] if here in item.path.parents else ""
    is_in_one_process = folder in _QUICK_FOLDERS and not _OTHER_PROGRAMS.search(text)
    return is_in_one_process and not any(item.get_closest_marker(mark) for mark in _NOT_QUICK)


def pytest_collection_finish(session: pytest.Session) -> None:
    """Let hypothesis create its table of characters before the first test, which would otherwise take too long."""
    if any(getattr(getattr(item, "function", None), "is_hypothesis_test", False) for item in session.items):
        unchecked = settings(
            database=None, suppress_health_check=list(HealthCheck), deadline=None, phases=[Phase.generate]
        )
        find(st.text(min_size=1), lambda _: True, settings=unchecked)


def pytest_sessionstart() -> None:
    """In an editable installation, the C files may have changed: the tests must not run with old libraries."""
    from morse.kernel import build, targets

    host = targets.host()
    if host is not None and importlib.util.find_spec("ziglang") and os.access(targets.FOLDER.parent, os.W_OK):
        build.build(host)


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(item: pytest.Item) -> Generator[None, pytest.TestReport, pytest.TestReport]:
    """If CI is set, Chromium and Blender are installed: a test that is skipped without them has failed."""
    report = yield
    marks = [mark for mark in _MUST_RUN_IN_CI if item.get_closest_marker(mark)]
    if report.skipped and marks and os.environ.get("CI") and not hasattr(report, "wasxfail"):
        reason = report.longrepr[2] if isinstance(report.longrepr, tuple) else report.longrepr
        report.outcome = "failed"
        report.longrepr = f"{item.nodeid}: a test marked {', '.join(marks)} must not be skipped in CI ({reason})"
    return report


@pytest.fixture(scope="session")
def browser() -> Iterator[Browser]:
    """Debian's Chromium with software GL: one for all tests, because Playwright does not allow a second one."""
    from morse.viewer.site import STATIC

    missing = [str(path) for path in (Path(CHROMIUM), STATIC / "index.html") if not path.exists()]
    if missing:
        message = f"needed for the tests in a browser: {', '.join(missing)}"
        if os.environ.get("CI"):
            pytest.fail(message)
        pytest.skip(message)
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        made = playwright.chromium.launch(executable_path=CHROMIUM, args=FLAGS)
        yield made
        made.close()
        # Playwright waits without a timeout for the end of its driver, which sometimes does not end
        late = threading.Timer(20.0, _end_drivers)
        late.daemon = True
        late.start()
    late.cancel()


def _end_drivers() -> None:
    """Kill the programs that Playwright has started in this process."""
    for folder in Path("/proc").glob("[0-9]*"):
        with contextlib.suppress(OSError, ValueError):
            parent = int((folder / "stat").read_text().rpartition(")")[2].split()[1])
            if parent == os.getpid() and "playwright" in (folder / "cmdline").read_text():
                os.kill(int(folder.name), signal.SIGKILL)
