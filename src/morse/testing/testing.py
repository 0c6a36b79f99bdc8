"""The names under which test files know the classes of this package."""

from morse.testing.exceptions import MorseTestingError
from morse.testing.follow import follow
from morse.testing.runner import MorseSwitchTimeMode, MorseTestRunner, main
from morse.testing.testcase import MorseBuilderFailureTestCase, MorseMoveTestCase, MorseTestCase, testlogger

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
