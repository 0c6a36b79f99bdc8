"""Shader nodes as metallic-roughness materials."""

from pathlib import Path

import pytest
from blender_program import run_blender

from morse.plugins.blend import read_blend
from morse.scene import Library, Material

pytestmark = pytest.mark.blender


@pytest.fixture(scope="module")
def library(tmp_path_factory: pytest.TempPathFactory) -> Library:
    path = tmp_path_factory.mktemp("materials") / "scene.blend"
    run_blender(Path(__file__).with_name("make_materials.py"), str(path))
    return read_blend(path)


@pytest.fixture
def materials(library: Library) -> dict[str, Material]:
    return {node.name: node.mesh.materials[0] for node in library.nodes()}


def test_emission_shines_by_itself(materials: dict[str, Material]) -> None:
    assert materials["emission"].emission == pytest.approx((1, 0.5, 2))
    assert materials["emission"].shadeless


def test_simple_shaders(materials: dict[str, Material]) -> None:
    assert materials["rgb node"].color == pytest.approx((0.25, 0.5, 0.75, 1))
    assert (materials["rgb node"].metallic, materials["rgb node"].roughness) == (0, 1)
    assert materials["metal"].color == pytest.approx((0.5, 0.5, 0.5, 1))
    assert (materials["metal"].metallic, materials["metal"].roughness) == (1, 0.25)


def test_mixed_shaders(materials: dict[str, Material]) -> None:
    # a quarter of the surface is opaque
    assert materials["translucent"].color == pytest.approx((1, 0, 0, 0.25))
    assert materials["mostly green"].color == pytest.approx((0, 1, 0, 1))
    assert materials["glowing"].color == pytest.approx((1, 0, 0, 1))
    assert materials["glowing"].emission == pytest.approx((0, 0, 3))
    assert not materials["glowing"].shadeless


def test_reroutes_and_muted_nodes_let_through(materials: dict[str, Material]) -> None:
    assert materials["rerouted"].color == pytest.approx((0.25, 0.5, 0.75, 1))


def test_images_are_found_behind_other_nodes(materials: dict[str, Material]) -> None:
    assert materials["external"].image.data.startswith(b"\x89PNG")
    assert materials["external"].color == (1, 1, 1, 1)


def test_images_that_exist_nowhere_are_named(library: Library, materials: dict[str, Material]) -> None:
    assert materials["generated"].image is None
    (warning,) = library.warnings
    assert "'generated'" in warning
    assert "pack it" in warning


@pytest.mark.parametrize(("name", "alpha"), [("no shader", 1), ("no nodes", 0.5)])
def test_without_nodes_the_viewport_colour_counts(materials: dict[str, Material], name: str, alpha: float) -> None:
    assert materials[name].color == pytest.approx((0.25, 0.5, 0.75, alpha))
    if name == "no shader":
        assert (materials[name].roughness, materials[name].metallic) == (0.125, 0.5)


def test_nodes_in_a_circle_end(materials: dict[str, Material]) -> None:
    assert materials["circle"].color == pytest.approx((0.8, 0.8, 0.8, 1))
