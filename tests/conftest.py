from __future__ import annotations

import contextlib
import importlib.util
import os
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

#: folders and files whose tests make up `pytest -m quick`, except those that take long or need more than Python
QUICK = (
    "assets", "builder", "core", "helpers", "mathutils", "modifiers", "physics", "sensors",
    "test_import_circles", "test_run_command", "test_primitives", "test_pymorse_futures", "test_recording_streams",
    "test_socket_protocol", "test_together", "test_view_protocol", "test_waypoint", "test_distortion",
    "test_lockstep_services",
)  # fmt: skip
_TOO_LONG_FOR_QUICK = (
    "test_blend_hostile", "test_blend_versions", "test_convex_parts", "test_camera_options", "test_cameras",
    "test_installed_packages", "test_libraries", "test_living_world", "test_many_bodies", "test_recovery",
    "test_saved_states", "test_star_import", "test_stubs", "test_rays",
)  # fmt: skip
_NOT_QUICK = ("slow", "soak", "browser", "blender")

#: the files that take longest, the longest first
_LONG = (
    "test_view_browser", "test_view_live", "test_view_truth", "test_view_panels", "test_contract", "test_view_page",
    "test_view_layout", "test_docs_code", "test_verify_command", "test_journey", "test_original_files",
    "test_view_lamps", "test_recording_commands", "test_view_many", "test_examples", "test_recovery", "test_assets",
    "test_view_cameras", "test_asset_build", "test_abuse_strangers", "test_determinism", "test_abuse_crashes",
    "test_component_library", "test_build", "test_libraries", "test_blend_evaluation", "test_sanitizers",
    "test_mavlink", "test_rosbridge", "test_testing_harness", "test_cameras", "test_convex_parts",
    "test_library_examples", "test_abuse_resets", "test_overlaps", "test_view_recording", "test_streams_and_locks",
)  # fmt: skip

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

    The order is the same in each worker, whichever folder it has collected first.
    """
    place = {name: number for number, name in enumerate(_LONG)}
    items.sort(key=lambda item: (place.get(item.path.stem, len(place)), item.path))
    quick: dict[Path, bool] = {}
    for item in items:
        if item.path not in quick:
            quick[item.path] = _is_quick(item.path)
        if quick[item.path] and not any(item.get_closest_marker(mark) for mark in _NOT_QUICK):
            item.add_marker("quick")


def _is_quick(path: Path) -> bool:
    here = Path(__file__).parent
    folder = path.relative_to(here).parts[0] if here in path.parents else ""
    return path.stem in QUICK or (folder in QUICK and path.stem not in _TOO_LONG_FOR_QUICK)


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
