from __future__ import annotations

import contextlib
import importlib.util
import logging
import os
import re
import shutil
import signal
import socket
import sys
import tempfile
import threading
from collections.abc import Generator, Iterator
from functools import partial
from importlib.abc import MetaPathFinder
from importlib.machinery import ModuleSpec, PathFinder
from pathlib import Path
from typing import IO, TYPE_CHECKING

import pytest
from hypothesis import HealthCheck, Phase, find, settings
from hypothesis import strategies as st
from hypothesis.configuration import set_hypothesis_home_dir

try:
    import fcntl
except ImportError:  # Windows
    fcntl = None  # type: ignore[assignment]

if TYPE_CHECKING:
    from playwright.sync_api import Browser

pytest_plugins = ["morse.testing.fixtures", "tests.kit.scenes"]

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
_OTHER_PROGRAMS = re.compile(r"\b(subprocess|Popen|pexpect|SimulationProcess|kit\.programs)\b")
_NOT_QUICK = ("long", "slow", "soak", "browser", "blender")

#: domains of ROS with ports below the ephemeral ports of the system; 0 is that of the person
_ROS_DOMAINS = range(1, 100)
#: the first port of the services of a worker's simulations, the distance to those of the next worker, and how many such
#: sets of ports there are below the ports that the system gives to clients
_FIRST_PORT, _PORTS, _SETS_OF_PORTS = 20_000, 200, 60

#: the variables that tests see: where the programs and libraries of this machine are, how it reaches the network, and
#: those of pytest itself. All others belong to the person who runs the tests: languages, settings of MORSE and Python
_KEPT_VARIABLES = re.compile(
    r"PATH|LD_LIBRARY_PATH|DYLD_\w+|TMPDIR|TEMP|TMP|SYSTEMROOT|SYSTEMDRIVE|WINDIR|COMSPEC|PATHEXT|NUMBER_OF_PROCESSORS"
    r"|PROCESSOR_\w+|https?_proxy|no_proxy|all_proxy|SSL_CERT_\w+|PIP_\w+|UV_\w+|NPM_CONFIG_\w+|CI|GITHUB_ACTIONS"
    r"|PYTEST_\w+|HYPOTHESIS_\w+|MORSE_TEST_\w+|MORSE_CHROMIUM",
    re.IGNORECASE,
)

# other programs that take the processor are not a reason to fail; `pytest --hypothesis-profile nightly` tries all
settings.register_profile("everyday", deadline=None, max_examples=25)
settings.register_profile("nightly", deadline=None, max_examples=100)
if settings.get_current_profile_name() != "nightly":
    settings.load_profile("everyday")

# A shell starts its background jobs (`pytest &`) with SIGINT ignored, and child processes inherit this: tests that send
# Ctrl+C to a child would wait forever
if signal.getsignal(signal.SIGINT) == signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)

_worker = os.environ.get("PYTEST_XDIST_WORKER", "")


def _forget_the_person() -> None:
    """Give this process and its children an empty home directory, and no settings of the person who runs the tests.

    A locale that Python has adopted stays that of this process, but workers and other children start without it. What
    ``PYTHONPATH`` adds is removed, except for the folders from which pytest and MORSE itself come.
    """
    own = {Path(found.origin).parents[1] for name in ("pytest", "morse") if (found := importlib.util.find_spec(name))}
    added = [entry for entry in os.environ.get("PYTHONPATH", "").split(os.pathsep) if entry]
    kept = [entry for entry in added if Path(entry).absolute() in own]
    sys.path[:] = [entry for entry in sys.path if entry in kept or entry not in added]
    for name in [name for name in os.environ if not _KEPT_VARIABLES.fullmatch(name)]:
        del os.environ[name]
    session = tempfile.mkdtemp(prefix="morse-tests-")
    (home := Path(session) / "home").mkdir()
    homes = dict.fromkeys(("HOME", "USERPROFILE", "APPDATA", "LOCALAPPDATA"), str(home))
    paths = {"PYTHONPATH": os.pathsep.join(kept)} if kept else {}
    # the cache of collision shapes is shared by all workers, and by tests with homes of their own
    os.environ.update(homes, **paths, MORSE_CACHE=str(Path(session) / "cache"), MORSE_TEST_SESSION=session)
    os.umask(0o022)


def _own_ports() -> tuple[int, socket.socket]:
    """The first port of a set that no program uses, and the socket that keeps other tests from it."""
    begin = int(os.environ["PYTEST_XDIST_TESTRUNUID"], 16) if _worker else os.getpid()
    begin += int(_worker.removeprefix("gw") or 0)
    for i in range(_SETS_OF_PORTS):
        first = _FIRST_PORT + _PORTS * ((begin + i) % _SETS_OF_PORTS)
        guard = socket.socket()
        try:
            guard.bind(("127.0.0.1", first + _PORTS - 1))
            for port in range(first, first + _PORTS - 1):
                with socket.socket() as probe:
                    probe.bind(("127.0.0.1", port))
        except OSError:
            guard.close()
            continue
        return first, guard
    raise RuntimeError(f"all ports from {_FIRST_PORT} to {first + _PORTS - 1} are in use")


def _own_ros_domain() -> tuple[int, IO[str] | None]:
    """A ROS domain that no other tests on this machine use, and the locked file that keeps others from it."""
    if fcntl is None:
        return _ROS_DOMAINS[0], None  # the middleware is not tested there
    for domain in _ROS_DOMAINS:
        try:
            file = open(Path(tempfile.gettempdir()) / f"morse-test-ros-domain-{domain}", "w")  # noqa: SIM115
        except OSError:
            continue  # it belongs to another user
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            file.close()
            continue
        return domain, file
    raise RuntimeError("all ROS domains are in use by other tests")


class _Beside(MetaPathFinder):
    """Finds the packages beside the tests that are not installed, and nothing else there, such as projects."""

    def find_spec(self, name: str, path: object = None, target: object = None) -> ModuleSpec | None:
        found = PathFinder.find_spec(name, [str(_ROOT)]) if name in ("benchmarks", "tests", "tools") else None
        if found is not None and found.loader is None:
            # the path of a package without __init__.py follows sys.path, which does not have this folder
            found.submodule_search_locations = [str(_ROOT / name)]
        return found


_ROOT = Path(__file__).resolve().parents[1]
# before `tests`, which has a folder `benchmarks` as well
sys.meta_path.insert(0, _Beside())
# `python -m pytest` adds the present folder
sys.path[:] = [entry for entry in sys.path if Path(entry).resolve() != _ROOT]

# workers, and tests of tests, have the home directory of the run that has started them
_begins = "MORSE_TEST_SESSION" not in os.environ
if _begins:
    _forget_the_person()
_port, _guard = _own_ports()
_domain, _lock = _own_ros_domain()
os.environ.update(MORSE_SOCKET_PORT=str(_port), ROS_DOMAIN_ID=str(_domain))
# examples that have failed are tried first the next time
set_hypothesis_home_dir(os.environ.get("HYPOTHESIS_STORAGE_DIRECTORY") or _ROOT / ".hypothesis")


def pytest_configure(config: pytest.Config) -> None:
    """Delete the home directory at the end; begin with other folders than other workers."""
    if _begins:
        config.add_cleanup(partial(shutil.rmtree, os.environ["MORSE_TEST_SESSION"], ignore_errors=True))
    elif _worker and config.args == config.getini("testpaths"):
        config.args = _folders_of_this_worker(config)


@pytest.fixture(scope="session", autouse=True)
def _empty_working_folder(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """Programs look for scenes and models in the working folder: that of a person may have any."""
    with contextlib.chdir(tmp_path_factory.mktemp("working-folder")):
        yield


@pytest.fixture(autouse=True)
def _log_as_before() -> Iterator[None]:
    """A test that is ended within a block with another log does not silence the tests after it."""
    log = logging.getLogger("morse")
    before = log.level, log.propagate, log.handlers[:], logging.root.manager.disable
    yield
    log.propagate, log.handlers[:], logging.root.manager.disable = before[1:]
    log.setLevel(before[0])


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
        late = threading.Timer(5.0, _end_drivers)
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
