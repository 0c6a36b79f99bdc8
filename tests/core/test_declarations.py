"""Declarations of component classes, and what is derived from them."""

import pytest

from morse.core.declarations import add_data, add_level, add_property, data_fields, levels, properties


class Base:
    add_data("a", 1, "int", "first", unit="m")
    add_property("_p", 2.0, "P", "float", "a number")


class Derived(Base):
    add_data("b", "x", "string", "second", level=["raw"])
    add_data("a", 5, "int", "overridden")
    add_property("_q", True, "Q", "bool", "a switch")
    add_level("raw", None, "as it is", default=True)


def test_fields_of_bases_come_first_and_may_be_overridden():
    fields = data_fields(Derived)
    assert list(fields) == ["a", "b"]
    assert fields["a"].default == 5
    assert fields["b"].level == ("raw",)
    assert data_fields(Base)["a"].unit == "m"


def test_properties_and_levels():
    assert {p.name: p.default for p in properties(Derived).values()} == {"P": 2.0, "Q": True}
    assert levels(Derived)["raw"].default


def test_declarations_belong_in_a_class():
    with pytest.raises(SyntaxError, match="in the body of a component class"):
        add_data("lost", 0)
