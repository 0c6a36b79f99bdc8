"""Converts exceptions of a scene script into a `ScriptError` with a clear message."""

from __future__ import annotations

import builtins
import importlib.util
import inspect
import pkgutil
import re
import sys
import traceback
from pathlib import Path
from typing import TYPE_CHECKING, Any

from morse.builder import compatibility
from morse.builder.errors import ScriptError, Step, checks
from morse.builder.names import frames
from morse.builder.names.catalog import KINDS
from morse.core.exceptions import MorseError
from morse.core.reports.faults import message as message_of
from morse.core.reports.faults import summary
from morse.middleware import registry
from morse.scene import SourceLine

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping
    from types import FrameType, TracebackType

#: components of 1.4 by kind; names that are available meanwhile have no effect here
_OF_1_4: Mapping[str, tuple[str, ...]] = {
    "sensor": (
        *("Accelerometer", "Airspeed", "ArmaturePose", "Attitude", "Barometer", "Battery", "Clock", "Collision"),
        *("CompoundSensor", "DepthCamera", "DepthCameraAggregator", "DepthCameraRotationZ", "DepthVideoCamera", "GPS"),
        *("Gyroscope", "HumanPosture", "IMU", "Kinect", "Magnetometer", "PTUPosture", "RawImage", "SearchAndRescue"),
        *("SemanticCamera", "StereoUnit", "Thermometer", "Velocity", "Velodyne", "VelodyneZB", "VideoCamera"),
    ),
    "actuator": (
        *("Arucomarker", "Armature", "Destination", "Drag", "ExternalForce", "ForceTorque", "Gripper", "KukaLWR"),
        *("Light", "MocapControl", "Orientation", "PA10", "PTU", "QuadrotorDynamicControl", "RotorcraftAttitude"),
        *("RotorcraftVelocity", "RotorcraftWaypoint", "Sound", "StabilizedQuadrotor", "SteerForce", "Waypoint"),
    ),
    "robot": ("BarePR2", "BasePR2", "Human", "LocalizedPR2", "NavPR2"),
}


def missing_component(name: str) -> tuple[str, str] | None:
    """Return the error and the correction for a component of 1.4 that this version does not have.

    Returns:
        None for any other name.
    """
    import morse.builder

    by_folded = {present.casefold(): (present, kind) for kind, names in _OF_1_4.items() for present in names}
    present, kind = by_folded.get(name.casefold(), ("", ""))
    if not present or hasattr(morse.builder, present):
        return None
    there = sorted(getattr(morse.builder, f"{kind}s").__all__)
    choices = ", ".join(other for other in there if not other.endswith("Creator"))
    return (
        f"MORSE has no {kind} {present} yet (it was in MORSE 1.4)",
        f"Available {kind}s: {choices}. To write one, use: morse add {kind} NAME ENVIRONMENT",
    )


_CALL = re.compile(r"^([\w.<>]+)\(\) (.*)$", re.DOTALL)
_KEYWORD = re.compile(r"unexpected keyword argument '(\w+)'")
_PARTIAL = re.compile(r"from partially initialized module '([^']+)'|^partially initialized module '([^']+)'")
_IMPORTED = re.compile(r"^cannot import name '([^']+)'")

#: exceptions of MORSE whose messages are complete
_OURS = (TypeError, ValueError, AttributeError, KeyError, OSError, SyntaxError, MorseError)


def explain(error: BaseException, script: str) -> ScriptError:
    """The error of a scene script, with the lines of the user's code that led to it."""
    trace = list(_frames(error.__traceback__))
    steps = [
        Step(SourceLine(frame.f_code.co_filename, line), frame.f_code.co_name)
        for frame, line in trace
        if frames.is_users(frame.f_code) and not frames.is_library(frame.f_code) and not _is_client(frame)
    ]
    if isinstance(error, SyntaxError) and error.lineno is not None:
        steps.append(Step(SourceLine(error.filename or script, error.lineno)))
    by_us = bool(trace) and not frames.is_users(trace[-1][0].f_code)
    frame = next((f for f, _ in reversed(trace) if frames.is_users(f.f_code)), None)
    message, mend = _circular_import(error, trace) or _describe(error, by_us, frame)
    if isinstance(error, ConnectionError) and any(_is_client(frame) for frame, _ in trace):
        mend = "This script is a client: start it with python3 while a scene runs, which morse run starts."
    return ScriptError(message, steps, mend, script)


def _is_client(frame: FrameType) -> bool:
    """Whether a frame belongs to the library of clients."""
    return str(frame.f_globals.get("__name__", "")).partition(".")[0] == "pymorse"


def _frames(trace: TracebackType | None) -> Iterator[tuple[FrameType, int]]:
    yield from traceback.walk_tb(trace)


def _circular_import(error: BaseException, trace: list[tuple[FrameType, int]]) -> tuple[str, str] | None:
    """The description of modules that import each other; None for any other error."""
    match = _PARTIAL.search(message_of(error)) if isinstance(error, (ImportError, AttributeError)) else None
    if match is None:
        return None
    first = match[1] or match[2]
    modules = [
        str(frame.f_globals.get("__name__"))
        for frame, _ in trace
        if frame.f_code.co_name == "<module>" and frames.is_users(frame.f_code)
    ]
    if first not in modules:
        return None
    chain = [*modules[modules.index(first) :], first]
    imported = _IMPORTED.match(message_of(error))
    name = imported[1] if imported is not None else getattr(error, "name", None)
    text = f"circular import: {chain[0]} imports {', which imports '.join(chain[1:])}, which has no '{name}' yet"
    mend = f"or write the import of '{chain[1]}' in the function of '{first}' that needs it."
    return text, f"Move what they share to another module, {mend}"


def _describe(error: BaseException, by_us: bool, frame: FrameType | None) -> tuple[str, str]:
    """Return the description of the error, and the correction."""
    match error:
        case SyntaxError() if error.lineno is not None:
            return f"{type(error).__name__}: {error.msg}", compatibility.first("mend_of_syntax", error)
        case SystemExit():
            return (
                f"the script ended with sys.exit({error.code!r})"
            ), "Let the script run to its end: then the simulation starts."
        case RecursionError():
            return "infinite recursion: a function of the script calls itself", ""
        case NameError() if error.name is not None:
            return _name_error(error.name, frame)
        case ModuleNotFoundError() if error.name is not None:
            return _no_module(error.name)
        case ImportError() if (match := _IMPORTED.match(message_of(error))) is not None:
            return _no_member(match[1], error)
        case AttributeError() if not by_us and error.name is not None and error.obj is not None:
            near = checks.closest(error.name, dir(error.obj))
            return message_of(error), f"Did you mean '{near}'?" if near and near != error.name else ""
        case TypeError() if (call := _CALL.match(message_of(error))) is not None:
            return _bad_call(call[1], call[2])
        case KeyError() if by_us and error.args:
            return str(error.args[0]), ""
        case _ if by_us and isinstance(error, _OURS):
            return str(error), ""
        case MorseError():
            return message_of(error), ""
    return summary(error), ""


def _name_error(name: str, frame: FrameType | None) -> tuple[str, str]:
    import morse.builder

    if (hint := missing_component(name)) is not None:
        return hint
    ours = morse.builder.__all__
    if name in ours:
        return f"the name '{name}' is not defined", "Write at the beginning of the script: from morse.builder import *"
    names = set(ours) | set(dir(builtins))
    if frame is not None:
        names |= set(frame.f_locals) | set(frame.f_globals)
    if mend := compatibility.first("mend_of_name", name):
        return f"the name '{name}' is not defined", mend
    near = checks.closest(name, names)
    return f"the name '{name}' is not defined", f"Did you mean '{near}'?" if near else ""


def _no_module(name: str) -> tuple[str, str]:
    if (middleware := registry.middleware_of_module(name)) is not None:
        return f"there is no module '{name}'", f"{middleware.mend}."
    parent, _, last = name.rpartition(".")
    try:
        spec = importlib.util.find_spec(parent) if parent else None
    except (ImportError, ValueError):
        spec = None
    paths = list(spec.submodule_search_locations or ()) if spec is not None else [] if parent else sys.path
    candidates = KINDS if parent.endswith(".builder") else ()
    near = checks.closest(last, [*candidates, *(info.name for info in pkgutil.iter_modules(paths))])
    if near is not None:
        return f"there is no module '{name}'", f"Did you mean '{f'{parent}.{near}' if parent else near}'?"
    if (project := _project_of(name)) is not None:
        return (
            f"there is no module '{name}'",
            f"It belongs to the project {project}: only scripts in this folder find it.",
        )
    if spec is not None:
        # a project imports the components that were added to it
        return f"there is no module '{name}'", f"If '{last}' was deleted or renamed, delete or change this line."
    return (
        f"there is no module '{name}'",
        "The packages of a project are in its folder 'src'; others have to be installed.",
    )


def _project_of(module: str) -> Path | None:
    """The folder of a project beside the script that contains the module, found as a package of its folder's name."""
    first, *_ = parts = module.split(".")
    places = (Path(folder) / first for folder in sys.path)
    return next((place for place in places if place.joinpath("src", *parts).exists()), None)


def _no_member(name: str, error: ImportError) -> tuple[str, str]:
    if (error.name or "").startswith("morse.builder") and (hint := missing_component(name)) is not None:
        return hint
    if (error.name or "").startswith("morse.") and (mend := compatibility.first("mend_of_name", name)):
        return f"there is no '{name}' in '{error.name}'", mend
    module = sys.modules.get(error.name or "")
    near = checks.closest(name, dir(module)) if module is not None else None
    return f"there is no '{name}' in '{error.name}'", f"Did you mean '{near}'?" if near else ""


def _bad_call(qualified: str, problem: str) -> tuple[str, str]:
    """Describe a call with arguments that a function does not accept."""
    name = qualified.removesuffix(".__init__")
    function = _function(qualified)
    if function is None:
        return f"{name}() {problem}", ""
    parameters = [p for p in inspect.signature(function).parameters.values() if p.name != "self"]
    usage = f"{name}({', '.join(_shown(p) for p in parameters)})"
    keyword = _KEYWORD.search(problem)
    near = checks.closest(keyword[1], [p.name for p in parameters]) if keyword is not None else None
    hint = f"Did you mean '{near}'? " if near else ""
    return f"{name}() {problem}", f"{hint}Expected: {usage}"


def _function(qualified: str) -> Any:
    """The function of a class or module of the builder, or None."""
    for module_name in [name for name in sys.modules if name.startswith("morse.builder")]:
        target: Any = sys.modules[module_name]
        for part in qualified.split("."):
            target = getattr(target, part, None) if target is not None else None
        if inspect.isfunction(target):
            return target
    return None


def _shown(parameter: inspect.Parameter) -> str:
    return str(parameter.replace(annotation=inspect.Parameter.empty))
