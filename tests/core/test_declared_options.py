"""Options that contradict themselves are refused where they are declared."""

from typing import Any

import pytest

from morse.core.declarations import Option
from morse.core.exceptions import MorseDeclarationError


@pytest.mark.parametrize(
    ("declared", "text"),
    [
        ({"low": 10.0, "high": 1.0}, "low=10 is greater than high=1"),
        ({"unit": "furlong"}, "the unit 'furlong' is unknown"),
        ({"low": 10.0}, "the default 5.0 is outside 10..inf"),
        ({"high": float("nan")}, "high is a number, not nan"),
        ({"choices": (1.0, 2.0)}, "the default 5.0 is not one of the choices"),
        ({"choices": [5.0]}, "choices are given in a tuple"),
        ({"allow": ("ninf",)}, "did you mean"),
        ({"type": "float"}, "type is a class such as float"),
    ],
)
def test_contradictions(declared: dict[str, Any], text: str) -> None:
    with pytest.raises(MorseDeclarationError, match="option 'how much'") as caught:
        Option(**{"type": float, "default": 5.0, "doc": "how much", **declared})
    assert text in str(caught.value)
    assert str(caught.value).startswith(f"{__file__}:")


def test_a_valid_option() -> None:
    option = Option(float, 5.0, "how much", low=0.0, high=10.0, unit="m")
    assert option.default == 5.0
    assert option._replace(default=6.0).high == 10.0
