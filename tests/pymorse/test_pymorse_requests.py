import json

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pymorse.names import normalize_name, series
from pymorse.requests import format_request, parse_response

json_values = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False) | st.text(),
    lambda inner: st.lists(inner) | st.dictionaries(st.text(), inner),
    max_leaves=10,
)
words = st.text(st.characters(exclude_categories=("Z", "C")), min_size=1)


@given(st.integers(0, 10**9), words, words, st.lists(json_values))
def test_a_request_is_one_line_of_four_parts(
    number: int, component: str, service: str, arguments: list[object]
) -> None:
    line = format_request(number, component, service, arguments)
    assert "\n" not in line
    first, second, third, rest = line.split(maxsplit=3)
    assert (int(first), second, third) == (number, component, service)
    assert json.loads(rest) == arguments


@pytest.mark.parametrize("name", ["", " ", "two words", "line\nbreak", " lead", "tab\t"])
def test_a_name_that_would_change_the_meaning_of_the_line_is_refused(name: str) -> None:
    with pytest.raises(ValueError, match="not the name of a component or service"):
        format_request(0, name, "service", [])
    with pytest.raises(ValueError, match="not the name of a component or service"):
        format_request(0, "component", name, [])


def test_an_argument_that_json_cannot_carry_is_named() -> None:
    with pytest.raises(TypeError, match=r"object at .* cannot be sent"):
        format_request(0, "robot.motion", "goto", [object()])


@given(st.integers(0, 10**9), st.sampled_from(["SUCCESS", "FAILED", "PREEMPTED"]), json_values)
def test_an_answer_is_read_back(number: int, status: str, value: object) -> None:
    text = f"{number} {status} {json.dumps(value)}" if value else f"{number} {status}"
    assert parse_response(text) == (number, status, value or None)


@pytest.mark.parametrize(
    "line",
    ["", "0", "SUCCESS", "x SUCCESS", "0 success", "0 DONE", "0 SUCCESS {", "-1 SUCCESS", "0 SUCCESS " + "[" * 10**5],
)
def test_what_is_no_answer_is_refused(line: str) -> None:
    with pytest.raises(ValueError, match=r"."):
        parse_response(line)


@given(st.text())
def test_any_line_is_read_or_refused(line: str) -> None:
    try:
        response = parse_response(line)
    except ValueError:
        return
    assert response.request >= 0


@pytest.mark.parametrize(("name", "attribute"), [("a.b", "a_b"), ("a-b", "a_b"), ("a~b", "a_b"), ("m_001", "m_001")])
def test_names_become_attributes(name: str, attribute: str) -> None:
    assert normalize_name(name) == attribute


def test_robots_of_a_loop_come_in_a_list_in_their_order() -> None:
    names = ["m_002", "cat", "m", "m_001", "cat_2", "dog_001", "m_010"]
    assert series(names) == {"ms": ["m", "m_001", "m_002", "m_010"]}
