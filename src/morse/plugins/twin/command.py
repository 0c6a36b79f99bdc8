"""``morse twin``: how wrong the simulation is for a real robot, and with which parameters it is least wrong."""

from __future__ import annotations

import os
import sys
from pathlib import Path
from typing import Annotated

import typer

from morse.core.exceptions import MorseError
from morse.core.reports.faults import describe
from morse.core.reports.log import setup
from morse.core.reports.printing import echo, harmless_paragraph


class TwinCommandError(MorseError):
    """The command cannot do what it was asked."""


def command(
    log: Annotated[
        str,
        typer.Argument(
            metavar="LOG", help=".mcap, .bag, .ulg, .bin, .csv, or the folder of a bag.", show_default=False
        ),
    ],
    scene: Annotated[str, typer.Argument(metavar="SCENE.py", help="The scene with the robot.", show_default=False)],
    fit: Annotated[
        list[str] | None,
        typer.Option("--fit", metavar="NAME", help="Parameter to fit; several names, or several times."),
    ] = None,
    more: Annotated[list[str] | None, typer.Argument(metavar="[NAME]...", hidden=True, show_default=False)] = None,
    report: Annotated[
        Path | None, typer.Option("--report", metavar="FILE.html", help="Write a page with all that was found.")
    ] = None,
    preset: Annotated[
        Path | None, typer.Option("--preset", metavar="FILE.json", help="Write the values, for env.preset in a scene.")
    ] = None,
    test: Annotated[
        Path | None, typer.Option("--test", metavar="test_FILE.py", help="Write a test that the errors do not grow.")
    ] = None,
    table: Annotated[
        Path | None,
        typer.Option(
            "--map", metavar="FILE.toml", help="Which topic is which component; written if it does not exist."
        ),
    ] = None,
    start: Annotated[
        Path | None, typer.Option("--from", metavar="FILE.json", help="Begin with the values of an earlier preset.")
    ] = None,
    workers: Annotated[
        int | None,
        typer.Option("--workers", min=0, help="Number of processes; 0 for this process.", show_default=False),
    ] = None,
) -> int:
    """Compare a scene with a log of the real robot, and fit parameters of the scene.

    The recorded commands are replayed. Without --fit, the scene is compared as it is. Names of parameters, here of a
    robot with the actuator motion, the sensor imu, the joint elbow and the link upper; a wrong name lists those of the
    scene:

    * of robots: mass, friction, wheel_radius, track

    * of joints and links: elbow.gain, elbow.slowing, elbow.damping, elbow.friction, elbow.inertia, elbow.stiffness,
    upper.mass

    * of actuators: motion.lag, motion.delay, motion.gain.v, motion.bias.w

    * of sensors: imu.delay, imu.gain, imu.bias, imu.bias.angular_velocity.z

    * of all: place.x to place.z, m, and place.roll to place.yaw, rad; each property that is a number, such as
    motion.MaxAcceleration
    """
    # imported on demand, so that 'morse -h' does not load the simulator
    from morse.plugins.twin.twin import Twin

    for path in (report, preset, test):
        if path is not None and path.exists() and path.resolve() in (Path(log).resolve(), Path(scene).resolve()):
            raise TwinCommandError(f"{path} is an input: give another name for what is written")
        if path is not None:
            _check_place(path)
    setup(level="WARNING")
    names = [*(fit or []), *(more or [])]
    if test is not None and names and preset is None:
        raise TwinCommandError("--test needs --preset FILE.json: the test begins with the values of the fit")
    try:
        twin = Twin(log, scene, fit=names, table=table if table is not None and table.exists() else None, preset=start)
        for link in twin.links:
            echo(f"* {harmless_paragraph(str(link))}{' (commands)' if link.is_command else ''}")
        if table is not None and not table.exists():
            table.write_text(twin.table(), encoding="utf-8")
            echo(f"* {table} has this table: correct it, and give the same command again")
        fitted = twin.fit(workers=workers, progress=_progress)
        if sys.stderr.isatty():
            echo(err=True)
        for line in fitted.lines():
            echo(f"* {harmless_paragraph(line)}")
        if not twin.parameters:
            for name, error in fitted.errors.items():
                echo(f"* {harmless_paragraph(name)}: error {error:.4g}")
        fitted.write(report=report, preset=preset, test=test)
    except OSError as error:
        raise TwinCommandError(describe(error)) from None
    except (RuntimeError, TypeError, ValueError) as error:
        if isinstance(error, MorseError):
            raise
        raise TwinCommandError(describe(error)) from None
    for path in (report, preset, test):
        if path is not None:
            echo(f"* {path} is written")
    return 0


def _check_place(path: Path) -> None:
    """A fit takes minutes: that its result cannot be written is told before."""
    if path.is_dir():
        raise TwinCommandError(f"{path} is a folder: give the name of a file")
    if not path.parent.is_dir():
        raise TwinCommandError(f"{path} cannot be written: there is no folder {path.parent}")
    if not os.access(path.parent, os.W_OK | os.X_OK):
        raise TwinCommandError(f"{path} cannot be written: you may not write in the folder {path.parent}")


def _progress(text: str) -> None:
    if sys.stderr.isatty():
        echo(text, err=True, end="", over=True)
