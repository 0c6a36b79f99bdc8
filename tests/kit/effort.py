"""How many examples a test of properties tries: a few each time, all of them at night."""

from hypothesis import settings

#: examples of a test that says nothing, in the profile `nightly` of conftest.py
_ALL = 100
_FEWEST = 5


def examples(most: int, each_time: int | None = None) -> int:
    """The number of examples for a test that tries ``most`` of them at night.

    Args:
        each_time: the number by day, for a test whose examples take long; a quarter of ``most`` by default.
    """
    if each_time is not None and settings.default.max_examples < _ALL:
        return each_time
    return max(min(_FEWEST, most), most * settings.default.max_examples // _ALL)
