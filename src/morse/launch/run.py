"""``morse run``: loads and runs a scene, and returns the exit status."""

from __future__ import annotations

import contextlib
import gc
import logging
import os
import platform
import signal
import sys
import threading
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from morse.core.classes.project_imports import ProjectImports
from morse.core.exceptions import MorseError
from morse.core.guard import by_part
from morse.core.reports.faults import describe
from morse.core.reports.log import endsection, section, set_level
from morse.core.requests import prepare
from morse.launch.ending_signals import ending_signals
from morse.launch.load import review_settings
from morse.launch.rereading import script_stamp, source_stamps
from morse.launch.stuck_ticks import StuckTicks
from morse.scene.scene_warnings import WarningCount, scene_warnings
from morse.simulation.ending import FAULTS
from morse.version import __version__

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from morse.core.context import Context
    from morse.core.guard import Failure
    from morse.launch.rereading import Rereading, Stamps
    from morse.scene import Scene
    from morse.simulation.options import RunOptions
    from morse.simulation.simulation import Simulation
    from morse.simulation.ticks.profile import Profile

    #: ends the process with a status, although a component cannot be interrupted
    Leave = Callable[[int], object] | None


# The summary that a simulation prints when it is ready.

_RULE = "-" * 36


def summary(context: Context, modifiers: list[str], datastreams: list[str], *, verbose: bool = False) -> list[str]:
    """Return the lines of the summary; the names of all services only if ``verbose``."""
    lines = [_RULE, "-        SIMULATION SUMMARY        -", _RULE, "Robots in the simulation:"]
    for name in context.robots:
        lines += _robot(context, name)
    if not context.robots:
        lines.append("\tNone: in a scene script, robot = Morsy() before the environment adds one")
    if context.external_robots:
        lines.append("External robots (from other simulation nodes):")
        lines += [f"\tROBOT: '{name}'" for name in context.external_robots]
    lines.append("Available services:")
    for classpath, manager in context.services.request_managers().items():
        lines.append(f"\t- Interface {classpath}")
        services_of = manager.services()
        if verbose:
            lines += [f"\t\t- {component}: {services}" for component, services in services_of.items()]
        else:
            count = sum(map(len, services_of.values()))
            lines.append(f"\t\t- {count} services of {len(services_of)} components; --verbose lists them")
    lines.append("Modifiers in use:")
    lines += [f"\t- '{classpath}'" for classpath in modifiers] or ["\tNone"]
    lines.append("Datastream interfaces configured:")
    lines += [f"\t- '{classpath}'" for classpath in datastreams] or ["\tNone"]
    lines.append(_RULE)
    return lines


def _robot(context: Context, name: str) -> list[str]:
    robot = context.robots[name]
    components = [n for n, c in context.components.items() if c.robot_parent is robot]
    return [f"\tROBOT: '{name}'", *(f"\t\t- Component: '{component}'" for component in components)]


logger = logging.getLogger("morse.main")

#: file to which `--profile` writes its trace
_TRACE = Path("morse-profile.json")


def run(
    options: RunOptions,
    ready: Callable[[Simulation], object] | None = None,
    leave: Leave = None,
) -> int:
    """Load a scene and run it until it ends.

    Args:
        ready: callback, called before the first tick.
        leave: ends the process with a status although a component cannot be interrupted; None to wait for it.

    Returns:
        The exit status: 0; 1 if the scene could not be loaded or the run failed; `FAULTS` if it has run to its end, but
        not all of its parts have, unless the options say ``keep_going``; 130 after Ctrl+C before it has begun.
    """
    course = _Course(options.keep_going)
    section("PRE-INITIALIZATION")
    logger.info("MORSE %s, Python %s", __version__, platform.python_version())
    logger.info("PID: %d", os.getpid())
    review_settings()
    try:
        if leave is not None:
            _leave_at_second_interruption(leave)
        _simulate(course, options, ready, leave)
    except KeyboardInterrupt:
        logger.info("interrupted")
        course.status = 130
    except SystemExit as leaving:
        course.status = 0
        _finish(course, leave)
        if leaving.code in (None, 0) and course.final_status():
            # a component may end the program, but this hides no fault
            raise SystemExit(course.final_status()) from leaving
        raise
    finally:
        _finish(course, leave)
    return course.final_status()


class _Course:
    """The simulations of a run: one, and those that replace it when its script was edited.

    Attributes:
        simulation: the present one, or None.
        status: the exit status if no part fails.

    Args:
        keep_going: whether the exit status is that of a run in which no part fails.
    """

    def __init__(self, keep_going: bool) -> None:
        self.simulation: Simulation | None = None
        self.status = 1
        self._keep_going = keep_going
        self._before: list[Failure] = []
        self._warnings = WarningCount()
        logging.getLogger("morse").addHandler(self._warnings)

    def replace(self) -> None:
        """The simulation has ended, and another one follows: its failures remain those of the run."""
        self._before, self.simulation = self._failures(), None

    def _failures(self) -> list[Failure]:
        return [*self._before, *(() if self.simulation is None else self.simulation.failures)]

    def final_status(self) -> int:
        """The exit status."""
        has_failed = any(failure.kind == "fault" for failure in self._failures())
        return FAULTS if has_failed and not self.status and not self._keep_going else self.status

    def report(self) -> None:
        """Log the number of warnings, and one line for each part that has failed and each robot that left the world."""
        logger.info("%s", self._warnings)
        logging.getLogger("morse").removeHandler(self._warnings)
        failures = self._failures()
        faults = [failure for failure in failures if failure.kind == "fault"]
        fallen = [failure for failure in failures if failure.kind == "fallen"]
        if faults:
            logger.error("[ERROR][MORSE] switched off by faults in this run:\n%s", by_part(faults))
        if fallen:
            title = "robots that have left the world in this run:"
            if self.status == FAULTS:
                logger.error("[ERROR][MORSE] %s\n%s", title, by_part(fallen))
            else:
                logger.warning("%s\n%s", title, by_part(fallen))

    def leave(self, leave: Callable[[int], object]) -> None:
        """End the process, although a part does not end."""
        self.report()
        leave(self.final_status())


def _simulate(course: _Course, options: RunOptions, ready: Callable[[Simulation], object] | None, leave: Leave) -> None:
    stamps = script_stamp(options)
    scene: Scene | None = None
    while True:
        with scene_warnings(refused=options.on_warning == "raise"):
            if scene is None:
                scene = _load_scene(options)
                stamps |= {} if scene is None else source_stamps(scene)
            simulation = None if scene is None else _start(course, scene, options, leave)
        if simulation is None:
            course.status = 1
            return
        course.simulation = simulation
        if ready is not None:
            ready(simulation)
            ready = None
        rereading = _follow(simulation, options, stamps)
        course.status = _loop(simulation, leave)
        if rereading is None or rereading.successor is None:
            return
        _finish(course, leave, for_another=True)
        course.replace()
        scene, options, stamps = rereading.successor


def _error(text: str) -> None:
    first, _, rest = text.partition("\n")
    logger.error("[ERROR][MORSE] %s", first)
    if rest:
        logger.error("%s", rest)


def _load_scene(options: RunOptions) -> Scene | None:
    from morse.builder.script import ScriptError, load_scene

    try:
        scene = load_scene(options)
    except ScriptError as error:
        _error(error.report())
    except MorseError as error:
        _error(str(error))
    else:
        if isinstance(scene.project, ProjectImports):
            # this process runs only this simulation
            scene.project.stay()
        return scene
    return None


@contextlib.contextmanager
def _interruption_held_back() -> Iterator[list[int]]:
    """Only record Ctrl+C in the list: loading compiled modules and starting event loops must not be interrupted."""
    signals: list[int] = []

    def note(number: int, _frame: object) -> None:
        signals.append(number)

    before = signal.signal(signal.SIGINT, note)
    try:
        yield signals
    finally:
        signal.signal(signal.SIGINT, before)


def _start(course: _Course, scene: Scene, options: RunOptions, leave: Leave = None) -> Simulation | None:
    with _interruption_held_back() as signals:
        from morse.launch.load import complete, resolve
        from morse.simulation.simulation import Simulation
    if signals:
        raise KeyboardInterrupt
    _set_levels(scene, warns=options.on_warning == "raise")
    try:
        section("SUPERVISION SERVICES INITIALIZATION")
        resolve(scene)
        with _interruption_held_back() as signals:
            simulation = Simulation(scene, options)
    except (MorseError, ValueError, OSError) as error:
        _failed(error)
        return None
    stuck = _stop_at_signals(simulation, leave)
    if signals:
        simulation.stop()
    endsection("SUPERVISION SERVICES INITIALIZED")
    try:
        section("SCENE INITIALIZATION")
        complete(simulation)
        _set_levels(scene)
    except (MorseError, ValueError, OSError) as error:
        _failed(error)
        course.simulation = simulation
        _finish(course)
        return None
    finally:
        stuck.close()
    context = simulation.context
    # an error is reported in the first tick, with the component
    context.guard.run(lambda: prepare(context.components.values()), lambda _: None)
    if simulation.view is not None:
        simulation.view.announce()
    managers = list(context.stream_managers)
    for line in summary(context, simulation.loaded.modifiers, managers, verbose=options.verbose):
        logger.info("%s", line)
    for recorder in simulation.recorders:
        logger.info("the run is recorded in %s", recorder.path)
    endsection("SCENE INITIALIZED")
    return simulation


def _set_levels(scene: Scene, *, warns: bool = False) -> None:
    """Set the levels of the script; if it ``warns``, none that hides warnings."""
    for name, level in scene.log_levels.items():
        set_level(name, "WARNING" if warns and level in ("ERROR", "CRITICAL") else level)


def _failed(error: Exception) -> None:
    logger.error("[ERROR][MORSE] INITIALIZATION ERROR: %s", error if isinstance(error, MorseError) else describe(error))
    logger.critical("INITIALIZATION FAILED!")


def _stop_at_signals(simulation: Simulation, leave: Leave = None) -> StuckTicks:
    """Install signal handlers: Ctrl+C, SIGTERM and a terminal that is closed end the simulation after its tick."""
    stuck = StuckTicks(simulation, leave=None if leave is None else partial(leave, 130))
    for number in ending_signals():
        signal.signal(number, stuck.end)
    return stuck


def _leave_at_second_interruption(leave: Callable[[int], object]) -> None:
    """Ctrl+C ends the script of a scene; a second one ends the process, because the script has caught the first."""
    signals: list[int] = []

    def interrupt(number: int, _frame: object) -> None:
        signals.append(number)
        if len(signals) > 1:
            leave(130)
        raise KeyboardInterrupt

    if threading.current_thread() is threading.main_thread():
        signal.signal(signal.SIGINT, interrupt)


def _hurry_at_signals(simulation: Simulation) -> None:
    """Ctrl+C while the simulation ends: parts that do not end are left at once."""
    if threading.current_thread() is not threading.main_thread():
        return

    def hurry(_number: int, frame: object) -> None:
        if not simulation.ending.interrupts:
            simulation.ending.hurry()

    for number in ending_signals():
        signal.signal(number, hurry)


def _follow(simulation: Simulation, options: RunOptions, stamps: Stamps) -> Rereading | None:
    """Let an edited scene replace the simulation, if the run watches its files."""
    if not options.watch:
        return None
    from morse.launch.rereading import Rereading

    rereading = Rereading(options, simulation.scene, stamps)
    simulation.reread = lambda: rereading.start_anew(simulation)
    return rereading


def _loop(simulation: Simulation, leave: Leave = None) -> int:
    from morse.physics import UnstableError
    from morse.simulation.reviews import FallenError

    live = None
    if simulation.profile is not None:
        # rich is needed for the table only: a project may have a file of this name
        from morse.simulation.ticks.profile_table import LiveProfile

        live = LiveProfile(simulation.profile)
    # present objects live until the end, so they are excluded from garbage collection
    gc.collect()
    gc.freeze()
    stuck = _stop_at_signals(simulation, leave)
    try:
        ticks = simulation.options.ticks
        simulation.run(simulation.options.duration if ticks is None else ticks / simulation.clock.frequency)
    except UnstableError as error:
        failure = f"tick {simulation.clock.tick + 1}: {error}"
        _error(failure)
        _keep_last(simulation, failure)
        return 1
    except FallenError as error:
        _error(str(error))
        if simulation.flight_recorder is not None:
            simulation.flight_recorder.write(str(error), simulation.ticks)
        return FAULTS
    except SystemExit as leaving:
        logger.warning("the program ends the simulation: %s", describe(leaving))
        raise
    except Exception:
        logger.error("[ERROR][MORSE] Uncaught exception, quit.", exc_info=True)
        _keep_last(simulation, "uncaught exception")
        return 1
    finally:
        stuck.close()
        if live is not None and simulation.profile is not None:
            live.close()
            _write_trace(simulation.profile)
    return 1 if simulation.failed else 0


def _keep_last(simulation: Simulation, failure: str) -> None:
    """Write the data that lead to a failure in an incomplete tick."""
    if simulation.flight_recorder is not None:
        simulation.flight_recorder.write(failure, simulation.ticks + 1)


def _write_trace(profile: Profile) -> None:
    path = _TRACE.absolute()
    try:
        profile.write_trace(path)
    except OSError as error:
        logger.warning("the profile cannot be written to %s: %s", path, error.strerror or error)
    else:
        logger.info("the time of each part in each tick is in %s: open it with a trace viewer", path)


def _finish(course: _Course, leave: Leave = None, *, for_another: bool = False) -> None:
    simulation = course.simulation
    if simulation is None or simulation.finished:
        if simulation is None and not for_another:
            course.report()
        return
    if leave is not None:
        simulation.ending.leave = partial(course.leave, leave)
    _hurry_at_signals(simulation)
    simulation.end_recordings()
    section("COMPONENTS FINALIZATION")
    simulation.finalize_components()
    section("CLOSING REQUEST MANAGERS...")
    simulation.finalize_services()
    section("CLOSING DATASTREAMS...")
    simulation.finalize_observers()
    section("CLOSING OVERLAYS...")
    simulation.end()
    if for_another:
        gc.unfreeze()
        return
    course.report()
    section("EXITING SIMULATION")
    with contextlib.suppress(OSError, ValueError, AttributeError):  # a script may have put anything there, or closed it
        sys.stdout.flush()
