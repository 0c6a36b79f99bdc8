"""Errors of the test environment."""


class MorseTestingError(Exception):
    """The simulation of a test did not start, did not end, or failed."""
