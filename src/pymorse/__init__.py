"""Control a MORSE simulation from Python.

::

    from pymorse import Morse

    with Morse() as simu:
        simu.robot.motion.publish({"v": 1.0, "w": 0.0})
        print(simu.robot.pose.get())
"""

from pymorse.aio import AsyncComponent, AsyncMorse
from pymorse.component import Component, Robot
from pymorse.errors import (
    MorseServiceError,
    MorseServiceFailed,
    MorseServicePreempted,
    MorseTimeoutError,
    NoSuchComponentError,
)
from pymorse.future import MorseExecutor, MorseFuture
from pymorse.names import normalize_name
from pymorse.pymorse import Morse
from pymorse.requests import FAILURE, PREEMPTED, SUCCESS, parse_response
from pymorse.stream import TIMEOUT, PollThread, Stream, StreamJSON

__all__ = [
    "FAILURE",
    "PREEMPTED",
    "SUCCESS",
    "TIMEOUT",
    "AsyncComponent",
    "AsyncMorse",
    "Component",
    "Morse",
    "MorseExecutor",
    "MorseFuture",
    "MorseServiceError",
    "MorseServiceFailed",
    "MorseServicePreempted",
    "MorseTimeoutError",
    "NoSuchComponentError",
    "PollThread",
    "Robot",
    "Stream",
    "StreamJSON",
    "normalize_name",
    "parse_response",
]
