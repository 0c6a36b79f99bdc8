"""The exception of a service that was cancelled says so, whatever the simulation answered."""

import pytest

from pymorse.errors import MorseServicePreempted


@pytest.mark.parametrize(("value", "text"), [(None, "cancelled, or interrupted"), ("too slow", "too slow")])
def test_the_message(value: object, text: str) -> None:
    assert text in str(MorseServicePreempted(value))
