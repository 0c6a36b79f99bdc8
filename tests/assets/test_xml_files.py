"""XML that is not quite XML, which the programs that robots are written for accept."""

from pathlib import Path

import pytest

from morse.assets import load
from morse.assets.errors import AssetError
from morse.assets.xml_files import parse_xml

URDF = '<robot name="r"><link name="l"/>{}</robot>'
SDF = '<sdf version="1.6"><model name="r"><link name="l"/>{}</model></sdf>'
ODD = {
    "prefix": "<gazebo><sensor:camera name='c' a:b='1'><x>1</x></sensor:camera></gazebo>",
    "dashes": "<!-- a -- b -->",
    "latin": "<gazebo><about>Z\u00fcrich</about></gazebo>",
}


@pytest.mark.parametrize("text", [URDF, SDF])
@pytest.mark.parametrize("name", ODD)
def test_it_is_read_in_every_format(tmp_path: Path, text: str, name: str) -> None:
    file = tmp_path / ("r.urdf" if text == URDF else "r.sdf")
    file.write_bytes(text.format(ODD[name]).encode("latin-1"))
    assert {"r", "l"} <= {node.name for node in load(file).nodes()}


def test_a_zero_at_the_end_is_ignored() -> None:
    for text in ("<a>\u00e9</a>\r\n\0", "<a>\u00e9</a>\0\0"):
        assert parse_xml(text.encode(), Path("a")).text == "\u00e9"
    assert parse_xml("<a>\u00e9</a>".encode("utf-16"), Path("a")).text == "\u00e9"


def test_namespaces_and_text_are_kept() -> None:
    root = parse_xml(b'<a xmlns="urn:x"><b>1 &amp; 2</b></a>', Path("a"))
    assert root.find("{urn:x}b").text == "1 & 2"
    root = parse_xml(b"<a><k:b>1 &amp; 2</k:b> tail</a>", Path("a"))
    assert (root[0].tag, root[0].text, root[0].tail) == ("k:b", "1 & 2", " tail")


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (b"<a><b></a>", "not XML: mismatched tag: line 1"),
        (b'<!DOCTYPE a [<!ENTITY e "x">]><a><k:b>&e;</k:b></a>', "defines the entity 'e'"),
        (b"<k:a>" * 300, "nested more than"),
    ],
)
def test_what_is_broken_or_too_large_is_refused_with_the_reason(text: bytes, words: str) -> None:
    with pytest.raises(AssetError, match=words):
        parse_xml(text, Path("a"))
