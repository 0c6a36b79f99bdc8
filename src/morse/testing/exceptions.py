"""What can go wrong with a test, apart from the test itself."""


class MorseTestingError(Exception):
    """The simulation of a test did not start, did not end, or broke down."""
