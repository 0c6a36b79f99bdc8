"""Text from outside can be quoted in any message."""

import difflib
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from morse.core.reports.quoting import closest, escaped, nearest, quoted, short, shown, spreadsheet_cell

anything = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text() | st.binary(),
    lambda inner: st.lists(inner) | st.dictionaries(st.text(), inner),
)


@given(anything)
def test_what_is_said_of_a_value_fits_on_a_line_of_a_terminal(value: Any) -> None:
    for text in (quoted(value), short(value), shown(value)):
        assert text.isprintable()
        assert len(text) < 1000
        text.encode()


@given(st.text(st.characters(categories=("Cc", "Cf", "Cs", "Zl", "Zp")), min_size=1))
def test_control_characters_are_written_as_escapes(text: str) -> None:
    assert escaped(f"a{text}b").startswith("a\\")
    assert escaped(f"a{text}b").isprintable()


def test_what_can_be_read_stays_as_it_is() -> None:
    assert escaped("Krähe 漢字 'x' \\n") == "Krähe 漢字 'x' \\n"
    assert quoted("v") == "'v'"
    assert short("x" * 100, 10) == "xxxxxxxxxx… (100 characters)"


def test_long_values_are_not_looked_at_to_their_end() -> None:
    class Item:
        def __repr__(self) -> str:
            looked.append(1)
            return "item"

    looked: list[int] = []
    shown([Item()] * 1_000_000)
    shown({n: Item() for n in range(1000)})
    assert len(looked) < 50
    assert len(shown(10**5000)) < 100


def test_a_name_of_megabytes_is_compared_with_none(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("difflib.get_close_matches", lambda *_a, **_k: pytest.fail("that takes seconds"))
    assert nearest("x" * 15_000_000, ["motion", "pose"]) == "; known: motion, pose"


def test_the_list_of_names_does_not_grow_without_end() -> None:
    assert len(nearest("xyz", [f"component{n}" for n in range(10_000)])) < 1000


def test_a_wrong_name_is_compared_with_few_of_many_names(monkeypatch: pytest.MonkeyPatch) -> None:
    """A client that sends wrong names must not use the time of the others."""
    names = [f"/robot{number}/front_camera/depth/image_raw" for number in range(2000)]
    compared: list[str] = []
    ratio = difflib.SequenceMatcher.ratio

    def counted(matcher: difflib.SequenceMatcher[str]) -> float:
        compared.append(str(matcher.a))
        return ratio(matcher)

    monkeypatch.setattr(difflib.SequenceMatcher, "ratio", counted)
    for number in (0, 17, 123):
        compared.clear()
        assert closest(f"/robot{number}/front_camra/depth/image_raw", names) == names[number]
        assert len(set(compared)) <= 40


@pytest.mark.parametrize(
    ("text", "cell"),
    [
        ('=cmd|" /C calc"!A0', '\'=cmd|" /C calc"!A0'),
        ("+1+1", "'+1+1"),
        ("-2+3", "'-2+3"),
        ("@SUM(A1)", "'@SUM(A1)"),
        ("\t=1+1", "'\t'=1+1"),
        ("\r\n =1+1", "'\r\n '=1+1"),
        ("\uff1d1+1", "'\uff1d1+1"),  # a wide equals sign
        # with a decimal comma, spreadsheets separate cells by ; or tabs
        ("a;=1+1", "a;'=1+1"),
        ('a;"=1+1', "a;\"'=1+1"),
        ("a\n@SUM(A1)\t-2+3", "a\n'@SUM(A1)\t'-2+3"),
        *((same, same) for same in ("", "a=b", "a; b", "a\nb", "map", "-1.5", "+3e8", "-inf", "'=1", "/robot/=x")),
        (-1.5, -1.5),
        (None, None),
    ],
)
def test_no_text_is_a_formula_for_a_spreadsheet(text: object, cell: object) -> None:
    assert spreadsheet_cell(text) == cell
