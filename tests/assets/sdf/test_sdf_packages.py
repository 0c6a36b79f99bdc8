"""The SDF files of other packages load with every joint, and their links are where they should be."""

import importlib.util
from pathlib import Path
from xml.etree import ElementTree

import kinematics
import numpy as np
import pytest

from morse.assets.sdf import read_sdf

PACKAGES = ("pybullet_data", "pydrake", "gym_ignition_models")
SHARE = 0.95

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def files() -> list[Path]:
    found = []
    for name in PACKAGES:
        spec = importlib.util.find_spec(name)
        for folder in (spec.submodule_search_locations or ()) if spec is not None else ():
            found += sorted(path for path in Path(folder).rglob("*.sdf") if "test" not in path.parts)
    if not found:
        pytest.skip(f"none of the packages {', '.join(PACKAGES)} is installed")
    return found


def models_of(path):
    root = ElementTree.parse(path).getroot()
    return [*root.findall("model"), *root.findall("world/model")]


def joints_in(model) -> int:
    return len(model.findall("joint")) + sum(map(joints_in, model.findall("model")))


def test_they_load_with_every_joint(files) -> None:
    complete = []
    for path in files:
        try:
            nodes = read_sdf(path).nodes()
        except ValueError:
            continue
        joints = sum(not bone.name.endswith("_free") for node in nodes for bone in node.bones)
        if joints >= sum(map(joints_in, models_of(path))):
            complete.append(path)
    assert len(complete) >= SHARE * len(files), set(files) - set(complete)


def test_links_are_where_independent_kinematics_puts_them(files) -> None:
    compared = 0
    for path in files:
        models = models_of(path)
        library = read_sdf(path)
        for root, model in zip(library.roots, models, strict=False):
            nodes = {node.source_name: node for node in root.walk()}
            outer = kinematics.pose(model.find("pose"))
            for name, place in kinematics.link_poses(model).items():
                node = nodes.get(name) or nodes[f"{root.name}::{name}"]
                assert np.array(node.world_matrix()) == pytest.approx(outer @ place, abs=1e-12), (path, name)
                compared += 1
    assert compared >= len(files)
