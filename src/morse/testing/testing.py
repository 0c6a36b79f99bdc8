"""The classes of this package under the module name of MORSE 1.4."""

from morse.testing.exceptions import MorseTestingError
from morse.testing.follow import follow
from morse.testing.testcase import (
    MorseBuilderFailureTestCase,
    MorseMoveTestCase,
    MorseSwitchTimeMode,
    MorseTestCase,
    MorseTestRunner,
    main,
    testlogger,
)

__all__ = [
    "MorseBuilderFailureTestCase",
    "MorseMoveTestCase",
    "MorseSwitchTimeMode",
    "MorseTestCase",
    "MorseTestRunner",
    "MorseTestingError",
    "follow",
    "main",
    "testlogger",
]
