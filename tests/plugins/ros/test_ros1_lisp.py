"""Recognised objects in the format of Lisp."""

import pytest

from morse.core.mathutils import Quaternion
from morse.plugins.ros.variants import as_lisp, class_path


def _seen(name, description="", position=(1.0, 2.0, 0.5)):
    return {
        "name": name,
        "description": description,
        "type": "",
        "position": list(position),
        "orientation": Quaternion((0.5, -0.5, 0.5, -0.5)),
    }


def test_the_class_path_of_1_4_is_known():
    path = class_path("morse.middleware.ros.semantic_camera.SemanticCameraPublisherLisp", "robot.camera")
    assert path == "morse.plugins.ros.variants.SemanticCameraPublisherLisp"


def test_an_object_is_a_list_of_name_description_position_and_quaternion():
    assert as_lisp([_seen("RedBox", "crate")]) == "((RedBox crate 1.0 2.0 0.5 -0.5 0.5 -0.5 0.5))"


def test_an_object_without_a_description_and_an_empty_list():
    assert as_lisp([_seen("RedBox"), _seen("B")]).count(" - ") == 2
    assert as_lisp([]) == "()"


@pytest.mark.parametrize(
    ("name", "atom"),
    [
        ("Red Box", '"Red Box"'),
        ('a "b" (c)', '"a \\"b\\" (c)"'),
        ("back\\slash", '"back\\\\slash"'),
        ("12", '"12"'),
        ("Box.001", "Box.001"),
    ],
)
def test_names_that_are_no_symbols_are_quoted(name, atom):
    assert as_lisp([_seen(name)]).startswith(f"(({atom} - ")
