"""Scenes with too many triangles are refused before they fill the memory."""

import pytest

from morse.builder import workspace
from morse.builder.script import ScriptError

HEAD = "from morse.builder import *\nfrom morse.builder.bpymorse import *\n"
END = "env = Environment('empty')\n"
BODY = "ball = Sphere('ball')\nbox = Cube('box')\n"


def count(scene):
    meshes = {id(n.mesh): n.mesh for root in scene.roots for n in root.walk() if n.mesh is not None}
    return sum(len(mesh.triangles) for mesh in meshes.values())


def test_the_message_names_the_largest_meshes_and_the_limit(load, monkeypatch):
    whole = count(load(HEAD + BODY + END))
    monkeypatch.setattr(workspace, "MOST_TRIANGLES", whole - 1)
    with pytest.raises(ScriptError) as refusal:
        load(HEAD + BODY + END)
    report = refusal.value.report()
    assert f"the scene has {whole:,} triangles, and the limit is {whole - 1:,}" in " ".join(report.split())
    assert "'ball' (" in report
    assert "Traceback" not in report
    monkeypatch.setattr(workspace, "MOST_TRIANGLES", whole)
    load(HEAD + BODY + END)


def test_robots_of_one_model_share_its_triangles(load, monkeypatch):
    one = count(load(HEAD + "robot = ATRV()\n" + END))
    monkeypatch.setattr(workspace, "MOST_TRIANGLES", one)
    load(HEAD + "robots = [ATRV(f'robot{n}') for n in range(5)]\n" + END)


def test_deleted_objects_do_not_count(load, monkeypatch):
    whole = count(load(HEAD + BODY + END))
    monkeypatch.setattr(workspace, "MOST_TRIANGLES", whole)
    text = HEAD + "gone = Sphere('gone')\nworkspace.current().delete(gone._bpy_object.node)\n" + BODY + END
    load("from morse.builder import workspace\n" + text)
