"""Models that a page sends: stored, examined, added, and saved beside the script; and what is refused."""

from __future__ import annotations

import base64
import contextlib
import io
import json
import os
import random
import resource
import struct
import sys
import threading
import zipfile
import zlib
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path, PurePosixPath
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

import pytest
from editor_desk import MODELS, SCENE, Desk
from view_pages import Client, fetch, toasts

import morse
from morse.assets import collision
from morse.system.workers import Worker, WorkerError
from morse.viewer import examination, uploads
from morse.viewer.catalog import Catalog
from tests.kit.waiting import wait_until

if TYPE_CHECKING:
    from playwright.sync_api import Page

TETRAHEDRON = """v 0 0 0
v 1 0 0
v 0 1 0
v 0 0 1
f 1 3 2
f 1 2 4
f 2 3 4
f 3 1 4
"""
URDF = """<robot name="arm">
  <link name="base"><inertial><mass value="3"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
    <visual><geometry><mesh filename="package://arm/meshes/part.obj"/></geometry></visual>
    <collision><geometry><box size="1 1 1"/></geometry></collision></link>
  <link name="upper"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
    <visual><geometry><box size="0.2 0.2 1"/></geometry></visual></link>
  <joint name="lift" type="revolute"><parent link="base"/><child link="upper"/><origin xyz="0 0 1"/><axis xyz="0 1 0"/>
    <limit lower="-1" upper="1" effort="50" velocity="1"/></joint>
</robot>"""
MJCF = """<mujoco><worldbody><body name="cart"><freejoint/><geom type="box" size="0.2 0.2 0.1"/>
<body pos="0 0 0.2"><joint name="turn" axis="0 0 1"/><geom type="box" size="0.1 0.1 0.1"/></body></body></worldbody>
<actuator><motor joint="turn"/></actuator></mujoco>"""
ARM = {"urdf/arm.urdf": URDF, "meshes/part.obj": TETRAHEDRON, "package.xml": "<package><name>arm</name></package>"}


@pytest.fixture
def desk(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Desk]:
    monkeypatch.setattr(Catalog, "open", lambda catalog: catalog._take(MODELS))
    monkeypatch.chdir(tmp_path)
    script = tmp_path / "scene.py"
    script.write_text(SCENE)
    with morse.load(script, view="web") as simulation, Client(simulation.view.url) as client:
        simulation.step(1)
        yield Desk(simulation, client)


def encoded(text: str | bytes) -> str:
    return base64.b64encode(text.encode() if isinstance(text, str) else text).decode()


def send(desk: Desk, name: str, files: dict[str, Any]) -> int:
    upload: int = desk.do("begin_upload", name=name, files=[[path, len(text)] for path, text in files.items()])
    for number, text in enumerate(files.values()):
        middle = len(text) // 2
        for part in (text[:middle], text[middle:]):
            desk.do("upload_part", upload=upload, file=number, data=encoded(part))
    return upload


def report(desk: Desk, name: str, files: dict[str, Any]) -> list[dict[str, Any]]:
    examined: list[dict[str, Any]] = desk.do("examine_upload", upload=send(desk, name, files))
    return examined


def stored(desk: Desk) -> list[Path]:
    """The folders of uploads."""
    paths = [Path(path) for path in desk.simulation.scene.resource_paths if "morse-files-" in path]
    return [folder for path in paths for folder in path.iterdir()]


def test_a_urdf_with_its_folder_is_examined_added_saved_and_loaded_again(desk: Desk, tmp_path: Path) -> None:
    (entry,) = report(desk, "arm", ARM)
    assert entry["error"] == ""
    assert ["links", "2, together 4 kg"] in entry["contents"]
    assert entry["kinds"] == [["Robot('arm/urdf/arm.urdf')", "arm"]]
    assert desk.do("add_model", model=entry["kinds"][0][0], position=[4, 1, 0]) == "arm"
    assert "arm" in desk.simulation.context.robots
    # the tetrahedron is 1 m high, and its mesh was found
    assert any(node.mesh is not None and len(node.mesh.triangles) == 4 for node in desk.simulation.scene.nodes())
    assert desk.do("duplicate_object", node="arm") == "arm_2"
    saved = desk.do("save_scene", write=False)
    assert saved["folders"] == [str(tmp_path / "data" / "arm")]
    assert not (tmp_path / "data").exists()
    desk.do("save_scene", write=True)
    assert 'arm = Robot("arm/urdf/arm.urdf")' in (tmp_path / "scene.py").read_text()
    assert (tmp_path / "data/arm/meshes/part.obj").read_text() == TETRAHEDRON
    desk.do("delete_object", node="arm_2")
    desk.do("save_scene", write=True)  # the folder is there already, with these files
    with morse.load(tmp_path / "scene.py") as again:
        node = again.scene.find("arm")
        assert node is not None
        assert node.location[:2] == pytest.approx([4, 1])
        assert "arm" in again.context.robots


def test_uploads_of_other_formats_are_added(desk: Desk) -> None:
    (entry,) = report(desk, "cart", {"cart.xml": MJCF})
    assert desk.do("add_model", model=entry["kinds"][0][0], position=[4, 1, 0]) == "cart"
    (entry,) = report(desk, "rock", {"rock.obj": TETRAHEDRON})
    assert desk.do("add_model", model=entry["kinds"][0][0], position=[6, 1, 0]) == "rock"
    rock = desk.simulation.scene.find("rock")
    assert rock is not None
    assert rock.location[:2] == pytest.approx([6, 1])
    sdf = '<sdf version="1.9"><world name="w"><gravity>0 0 -1</gravity></world></sdf>'
    (entry,) = report(desk, "moon", {"moon.world": sdf})
    assert "Environment('moon/moon.world')" in entry["error"]
    assert entry["kinds"] == []


def test_a_restart_keeps_what_was_added_of_an_upload_and_undo_removes_it(desk: Desk) -> None:
    (entry,) = report(desk, "arm", ARM)
    desk.do("add_model", model=entry["kinds"][0][0], position=[4, 1, 0])
    desk.simulation.start_anew()
    desk.simulation.step(2)
    assert "arm" in desk.simulation.context.robots
    desk.do("undo_change")
    assert "arm" not in desk.simulation.context.robots


def test_the_files_are_gone_when_the_simulation_ends(tmp_path: Path) -> None:
    script = tmp_path / "scene.py"
    script.write_text(SCENE)
    with morse.load(script, view="web") as simulation, Client(simulation.view.url) as client:
        simulation.step(1)
        desk = Desk(simulation, client)
        report(desk, "arm", ARM)
        (folder,) = stored(desk)
        assert folder.is_dir()
    assert not folder.parent.exists()


@pytest.mark.parametrize(
    "path",
    [
        "../arm.urdf", "a/../../arm.urdf", "/etc/arm.urdf", "a//arm.urdf", "./arm.urdf", "a/", "", "a\\..\\arm.urdf",
        "C:arm.urdf", "arm\0.urdf", "arm\n.urdf", ".arm.urdf", "con/arm.urdf", "nul.urdf", "arm.urdf ",
        "arm\u202e.urdf", "x" * 120 + ".urdf", "\u4e2d" * 90 + ".urdf", "a/" * 20 + "arm.urdf",
        # programs and archives are no parts of a model
        "arm/__init__.py", "sitecustomize.py", "arm.xacro", "arm.so", "arm.zip", "arm.urdf.gz", "arm", "arm.sh",
        "x.pyc", "arm.pth",
    ],
)  # fmt: skip
def test_a_path_that_leads_elsewhere_or_is_no_part_of_a_model_is_refused(desk: Desk, path: str, tmp_path: Path) -> None:
    before = {*tmp_path.rglob("*")}
    answer = desk.ask("begin_upload", name="arm", files=[["arm.urdf", 5], [path, 3]])
    assert not answer["ok"]
    assert answer["error"]
    assert stored(desk) == []
    assert {*tmp_path.rglob("*")} == before


@pytest.mark.parametrize("name", ["../../up", "/root", "", "..", "con", "a" * 500, "\0", "numpy/x", "data"])
def test_the_name_of_the_folder_is_made_by_the_server(desk: Desk, name: str) -> None:
    desk.do("begin_upload", name=name, files=[["arm.urdf", 5]])
    (folder,) = stored(desk)
    assert folder.name.isidentifier()
    assert len(folder.name) < 50
    assert folder.name.lower() != "con"


def test_folders_of_the_project_are_neither_hidden_nor_overwritten(desk: Desk, tmp_path: Path) -> None:
    (tmp_path / "arm").mkdir()
    (tmp_path / "arm" / "arm.urdf").write_text("mine")
    (entry,) = report(desk, "arm", {"arm.urdf": URDF, "meshes/part.obj": TETRAHEDRON})
    assert entry["kinds"][0][0] == "Robot('arm_2/arm.urdf')"
    desk.do("add_model", model="Robot('arm_2/arm.urdf')", position=[4, 1, 0])
    taken = tmp_path / "data" / "arm_2"
    taken.mkdir(parents=True)
    (taken / "arm.urdf").write_text("of somebody")
    answer = desk.ask("save_scene", write=True)
    assert not answer["ok"]
    assert "arm_2 is not written" in answer["error"]
    assert (taken / "arm.urdf").read_text() == "of somebody"
    assert (tmp_path / "scene.py").read_text() == SCENE


def test_too_much_is_refused_before_a_byte_is_sent(desk: Desk) -> None:
    for files in (
        [["a.stl", 200 << 20]],
        [[f"{n}.stl", 100 << 20] for n in range(3)],
        [["a.stl", 2**62]],
        [["a.stl", 5], ["A.STL", 5]],
        [["a.stl", 5], ["a.stl/b.stl", 5]],
    ):
        answer = desk.ask("begin_upload", name="a", files=files)
        assert not answer["ok"], files
    assert stored(desk) == []
    for number in range(4):
        desk.do("begin_upload", name="a", files=[[f"{number}.stl", 127 << 20]])
    assert "at most" in desk.ask("begin_upload", name="a", files=[["b.stl", 127 << 20]])["error"]


def test_uploads_of_a_run_are_counted(desk: Desk) -> None:
    for number in range(100):
        desk.do("begin_upload", name=f"m{number}", files=[["a.stl", 1]])
    assert not desk.ask("begin_upload", name="m", files=[["a.stl", 1]])["ok"]


def test_parts_that_were_not_announced_are_refused(desk: Desk) -> None:
    upload = desk.do("begin_upload", name="a", files=[["a.obj", 4], ["b.obj", 4]])
    for part in (
        {"file": 0, "data": encoded("12345")},
        {"file": 2, "data": encoded("1")},
        {"file": 2**62, "data": encoded("1")},
        {"file": 0, "data": "no base64!"},
        {"file": 0, "data": "AAA"},
        {"file": 0, "data": "é"},
    ):
        assert not desk.ask("upload_part", upload=upload, **part)["ok"], part
    assert not desk.ask("upload_part", upload=99, file=0, data="")["ok"]
    assert "not complete" in desk.ask("examine_upload", upload=upload)["error"]
    assert "no upload" in desk.ask("examine_upload", upload=-1)["error"]


def test_a_link_in_the_place_of_a_file_cannot_be_sent_and_one_in_a_model_is_not_followed_elsewhere(desk: Desk) -> None:
    secret = URDF.replace("package://arm/meshes/part.obj", "file:///etc/passwd")
    (entry,) = report(desk, "arm", {"arm.urdf": secret})
    assert "root:" not in str(entry)


@pytest.mark.parametrize("text", ["$(env HOME)", "&#36;(find arm)", "$(optenv HOME here)", "&#x24;(dirname)"])
@pytest.mark.parametrize("encoding", ["utf-8", "utf-16"])
def test_substitutions_are_refused_however_they_are_written(desk: Desk, text: str, encoding: str) -> None:
    urdf = f'<?xml version="1.0" encoding="{encoding}"?><robot name="arm"><link name="{text}"/></robot>'
    (entry,) = report(desk, "arm", {"arm.urdf": urdf.encode(encoding)})
    assert "substitutions" in entry["error"]
    assert entry["kinds"] == []


@pytest.mark.parametrize("content", [b"", b"\0" * 500, b"<robot", b"<!DOCTYPE a [<!ENTITY b 'c'>]><robot>&b;</robot>"])
def test_a_damaged_model_is_named_and_the_simulation_goes_on(desk: Desk, content: bytes) -> None:
    (entry,) = report(desk, "arm", {"arm.urdf": content})
    assert entry["error"]
    assert str(stored(desk)[0].parent) not in entry["error"]
    assert entry["kinds"] == []
    before = desk.simulation.clock.time
    desk.simulation.step(2)
    assert desk.simulation.clock.time > before


def test_a_model_for_which_the_simulation_would_wait_long_is_not_added(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(examination, "_MOST_TRIANGLES", 3)
    (tmp_path / "rock.obj").write_text(TETRAHEDRON)
    examined = examination.examine(tmp_path, [PurePosixPath("rock.obj")])
    assert "4 triangles" in str(examined.report[0]["error"])
    assert examined.models == []
    assert examined.contents == []


def test_a_model_that_ends_the_process_that_reads_it_is_named(desk: Desk, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(uploads, "_PROGRAM", "this")  # a program that ends without an answer
    (entry,) = report(desk, "rock", {"rock.obj": TETRAHEDRON})
    assert "the process that reads it has ended" in entry["error"]
    assert entry["kinds"] == []
    monkeypatch.undo()
    assert report(desk, "rock", {"rock.obj": TETRAHEDRON})[0]["kinds"]


@pytest.mark.parametrize("limit", ["MOST_SECONDS", "MOST_MEMORY"])
def test_a_model_that_takes_too_much_is_named(tmp_path: Path, limit: str) -> None:
    few = {"MOST_SECONDS": 0.0, "MOST_MEMORY": 1 << 30}[limit]
    hungry = {"MOST_SECONDS": "while True: pass", "MOST_MEMORY": "[bytes(1 << 26) for _ in range(100)]"}[limit]
    program = f"""
from morse.system.workers import Server, limit_resources, serve_program
from morse.viewer import examination
def examine(*_):
    {hungry}
examination.examine = examine
limit_resources({few if limit == "MOST_SECONDS" else 60.0}, {few if limit == "MOST_MEMORY" else 8 << 30})
serve_program(examination.Examination)
"""
    (tmp_path / "reader_of_models.py").write_text(program)
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(tmp_path), *filter(os.path.isabs, sys.path)])}
    worker = Worker.program("reader_of_models", environment, is_silent=True)
    try:
        with pytest.raises(WorkerError):
            worker.ask(b'["/", []]', 60.0)
    finally:
        worker.kill()
        worker.close()


def test_a_disk_is_not_filled(desk: Desk, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(uploads.shutil, "disk_usage", lambda _: SimpleNamespace(free=1 << 20))
    answer = desk.ask("begin_upload", name="arm", files=[["arm.urdf", 5]])
    assert "free on the disk" in answer["error"]
    assert stored(desk) == []


def test_what_was_not_sent_cannot_be_named_as_a_robot_of_a_file(desk: Desk, tmp_path_factory: Any) -> None:
    elsewhere = tmp_path_factory.mktemp("elsewhere") / "secret.urdf"
    elsewhere.write_text(URDF)
    for kind in (f"Robot('{elsewhere}')", f"Robot('../{elsewhere.parent.name}/secret.urdf')", "Robot('~/secret.urdf')"):
        answer = desk.ask("add_model", model=kind, position=[0, 0, 0])
        assert "no model" in answer["error"]
        # the same for clients, who name kinds themselves
        answer = desk.ask("call_service", component="simulation", service="spawn", arguments=["spy", kind])
        assert "clients may spawn" in answer["error"]


def test_ticks_go_on_while_a_model_is_read(desk: Desk, monkeypatch: pytest.MonkeyPatch) -> None:
    may_go_on = threading.Event()
    ask = Worker.ask

    def slow(*arguments: Any) -> bytes:
        assert may_go_on.wait(60)
        return ask(*arguments)

    monkeypatch.setattr(Worker, "ask", slow)
    upload = send(desk, "rock", {"rock.obj": TETRAHEDRON})
    desk._client.send("examine_upload", request=1000, upload=upload)
    before = desk.simulation.clock.time
    wait_until(lambda: "wait until" in desk.ask("examine_upload", upload=upload)["error"], "a busy thread")
    assert desk.simulation.clock.time > before
    may_go_on.set()
    assert desk._wait("answer", request=1000)["value"][0]["kinds"] == [["rock/rock.obj", "rock"]]


def png(width: int, height: int, data: bytes) -> bytes:
    """A PNG file of 8-bit RGB; the data are compressed."""
    head = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    chunks = [(b"IHDR", head), (b"IDAT", data), (b"IEND", b"")]
    parts = [
        struct.pack(">I", len(one)) + name + one + struct.pack(">I", zlib.crc32(name + one)) for name, one in chunks
    ]
    return b"\x89PNG\r\n\x1a\n" + b"".join(parts)


ZEROS = zlib.compress(bytes(30_000_000), 9)
PICTURES = {
    "bomb.png": png(60_000, 60_000, ZEROS),
    "wide.png": png(2**31 - 1, 1, ZEROS),
    "more_than_declared.png": png(4, 4, ZEROS),
    "less_than_declared.png": png(512, 512, zlib.compress(b"")),
    "no_size.png": png(0, 0, zlib.compress(b"")),
    "damaged.png": png(8, 8, b"this is not compressed"),
    "cut.png": png(64, 64, zlib.compress(bytes(64 * 193)))[:60],
    "empty.png": b"",
    "text.png": b"no picture at all",
    "cut.jpg": bytes.fromhex("ffd8ffe000104a46494600010100000100010000ffc0001108ffffffff03"),
    "bomb.tga": struct.pack("<BBBHHBHHHHBB", 0, 0, 10, 0, 0, 0, 0, 0, 65535, 65535, 24, 0) + b"\xff\x00\x00\x00" * 100,
}


@pytest.mark.parametrize("name", PICTURES)
def test_a_picture_that_is_damaged_or_too_large_does_no_harm(desk: Desk, name: str) -> None:
    files = {
        "rock.obj": "mtllib rock.mtl\nusemtl stone\n"
        + TETRAHEDRON.replace("f 1 3 2", "vt 0 0\nvt 1 0\nvt 0 1\nf 1/1 3/2 2/3"),
        "rock.mtl": f"newmtl stone\nKd 1 1 1\nmap_Kd {name}\n",
        name: PICTURES[name],
    }
    before = desk.simulation.clock.time
    (entry,) = report(desk, "rock", files)
    assert desk.simulation.clock.time > before
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    if not entry["error"]:  # then it is drawn without the picture
        assert desk.do("add_model", model=entry["kinds"][0][0], position=[4, 1, 0]) == "rock"
        status, _, _ = fetch(desk.simulation.view.url)
        assert status == 200
    # 60,000 x 60,000 pixels are 14 GB
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - memory < 400_000
    desk.simulation.step(2)
    assert desk.simulation.failures == ()


def gltf(points: list[float]) -> str:
    """A triangle on a node with a scale, below one that is turned and scaled, and beside another root."""
    uri = "data:application/octet-stream;base64," + encoded(struct.pack("<9f", *points))
    return json.dumps(
        {
            "asset": {"version": "2.0"},
            "buffers": [{"uri": uri, "byteLength": 36}],
            "bufferViews": [{"buffer": 0, "byteLength": 36}],
            "accessors": [
                {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 1]}
            ],
            "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
            "nodes": [
                {"name": "top", "rotation": [0, 0, 0.6, 0.8], "scale": [2, 3, 4], "children": [1], "mesh": 0},
                {"name": "part", "rotation": [0, 0.6, 0, 0.8], "scale": [1, 5, 1], "mesh": 0},
                {"name": "other", "scale": [7, 1, 1], "mesh": 0},
            ],
            "scenes": [{"nodes": [0, 2]}],
            "scene": 0,
        }
    )


@pytest.mark.parametrize("file", ["rock.obj", "rock.gltf"])
def test_the_collision_shapes_of_a_model_are_computed_before_it_is_added(
    desk: Desk, monkeypatch: pytest.MonkeyPatch, file: str
) -> None:
    computed = []
    monkeypatch.setattr(collision, "few_parts", lambda *arguments: computed.append(arguments))
    size = random.SystemRandom().uniform(1.0, 2.0)  # no shapes of it are kept from an earlier run
    content = (
        TETRAHEDRON.replace("1 0 0", f"{size} 0 0") if file == "rock.obj" else gltf([0, 0, 0, size, 0, 0, 0, 1, 0])
    )
    (entry,) = report(desk, "rock", {file: content})
    for kind, _ in entry["kinds"]:
        desk.do("add_model", model=kind, position=[4, 1, 0])
    assert entry["kinds"]
    assert not computed, "the process that has read the model has stored its shapes"


def test_nothing_is_saved_through_a_link_in_the_place_of_the_folder_of_models(
    desk: Desk, tmp_path: Path, tmp_path_factory: pytest.TempPathFactory
) -> None:
    elsewhere = tmp_path_factory.mktemp("elsewhere")
    (tmp_path / "data").symlink_to(elsewhere, target_is_directory=True)
    (entry,) = report(desk, "rock", {"rock.obj": TETRAHEDRON})
    desk.do("add_model", model=entry["kinds"][0][0], position=[4, 1, 0])
    answer = desk.ask("save_scene", write=True)
    assert "link to another folder" in answer["error"]
    assert [*elsewhere.iterdir()] == []
    assert (tmp_path / "scene.py").read_text() == SCENE


def test_only_the_page_that_drives_sends_files(desk: Desk) -> None:
    with Client(desk.simulation.view.url) as other:
        wait_until(lambda: (desk.simulation.step(1), desk.simulation.view._server._hub.wishes)[0] is None)
        other.send("begin_upload", request=1, name="arm", files=[["arm.urdf", 5]])
        answer = other.expect("answer", request=1)
    assert "another page drives" in answer["error"]
    assert stored(desk) == []


DROP = """(files) => {
    const dataTransfer = new DataTransfer();
    for (const [name, text] of Object.entries(files)) dataTransfer.items.add(new File([text], name));
    const canvas = morse.stage.renderer.domElement, frame = canvas.getBoundingClientRect();
    const place = { clientX: frame.left + frame.width / 2, clientY: frame.top + frame.height * 0.7 };
    for (const kind of ["dragenter", "dragover", "drop"])
        canvas.dispatchEvent(new DragEvent(kind, { dataTransfer, bubbles: true, cancelable: true, ...place }));
}"""


@contextlib.contextmanager
def page_of_scene(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, open_page: Callable[..., Page]
) -> Iterator[tuple[Page, Path]]:
    """A page of a scene that runs, and the script."""
    monkeypatch.setattr(Catalog, "open", lambda catalog: catalog._take(MODELS))
    monkeypatch.chdir(tmp_path)
    script = tmp_path / "scene.py"
    script.write_text(SCENE)
    with morse.load(script, view="web") as simulation:
        end = threading.Event()

        def run() -> None:
            while not end.is_set():
                simulation.step(1)
                end.wait(0.01)

        thread = threading.Thread(target=run)
        thread.start()
        try:
            yield open_page(simulation.view.url, width=1000, height=700), script
        finally:
            end.set()
            thread.join()


def test_a_file_is_dropped_on_the_page_and_a_folder_is_chosen(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, open_page: Callable[..., Page]
) -> None:
    folder = tmp_path / "mine" / "arm"
    for name, text in ARM.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text)
    (folder / "README.md").write_text("no part of it")
    with page_of_scene(tmp_path, monkeypatch, open_page) as (page, script):
        page.evaluate(DROP, {"cart.xml": MJCF})
        dialog = page.locator("dialog.examined")
        dialog.wait_for()
        assert "cart is in the scene" in dialog.inner_text()
        assert "joints" in dialog.inner_text()
        dialog.get_by_role("button", name="close").click()
        wait_until(lambda: page.evaluate("!!morse.world.value.find('cart')"), "the cart on the page")
        page.get_by_role("button", name="add", exact=True).click()
        page.locator(".upload input").nth(1).set_input_files(str(folder))
        dialog.wait_for()
        assert "arm is in the scene" in dialog.inner_text()
        assert "1 other file is no part" in dialog.inner_text()
        dialog.get_by_role("button", name="close").click()
        wait_until(lambda: page.evaluate("!!morse.world.value.find('arm')"), "the arm on the page")
        page.keyboard.press("Control+s")
        page.locator("dialog.save").get_by_text(str(tmp_path / "data" / "arm")).wait_for()
        page.get_by_role("button", name="save", exact=True).click()
        wait_until(lambda: (tmp_path / "data/arm/urdf/arm.urdf").is_file(), "the files beside the script")
        wait_until(lambda: "Robot(" in script.read_text(), "the script")
        # nothing that can be added: named, and nothing happens
        page.evaluate(DROP, {"arm.urdf": "<robot"})
        dialog.wait_for()
        assert "cannot be added" in dialog.inner_text()


DROP_BYTES = """([name, encoded]) => {
    const bytes = Uint8Array.from(atob(encoded), (one) => one.charCodeAt(0));
    const dataTransfer = new DataTransfer();
    dataTransfer.items.add(new File([bytes], name));
    document.body.dispatchEvent(new DragEvent("drop", { dataTransfer, bubbles: true, cancelable: true }));
}"""


def zipped(files: Mapping[str, str | bytes], method: int = zipfile.ZIP_DEFLATED) -> bytes:
    """A ZIP archive with a comment at its end."""
    content = io.BytesIO()
    with zipfile.ZipFile(content, "w", method) as archive:
        for name, data in files.items():
            archive.writestr(name, data)
        archive.comment = b"made by anybody"
    return content.getvalue()


def with_password(archive: bytes) -> bytes:
    """The archive, whose list says that its first file is encrypted."""
    at = archive.index(b"PK\x01\x02") + 8
    return archive[:at] + b"\x01" + archive[at + 1 :]


def test_an_archive_is_dropped_on_the_page_as_its_folder_would_be_and_a_damaged_one_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, open_page: Callable[..., Page]
) -> None:
    # with what a Mac adds, and with a folder that is written as on Windows
    arm = {f"arm/{name}": text for name, text in ARM.items() if name != "meshes/part.obj"}
    good = zipped(arm | {"arm\\meshes\\part.obj": TETRAHEDRON, "__MACOSX/arm/._arm.urdf": b"\0", "arm/README.md": "-"})
    bad = {
        "empty": b"",
        "text": b"PK, but no archive",
        "cut": good[: len(good) // 2],
        "list": good[: -len("made by anybody") - 60] + good[-len("made by anybody") - 22 :],
        "content": good.replace(good[60:90], bytes(30)),
        "locked": with_password(good),
        "bzip2": zipped(arm, zipfile.ZIP_BZIP2),
        "letter": zipped({"letter.txt": "no model"}, zipfile.ZIP_STORED),
        "bomb": zipped({"arm.stl": bytes(129 << 20)}),
    }
    with page_of_scene(tmp_path, monkeypatch, open_page) as (page, _):
        dialog = page.locator("dialog.examined")
        for name, archive in bad.items():
            page.evaluate(DROP_BYTES, [f"{name}.zip", encoded(archive)])
            said = wait_until(lambda name=name: [one for one in toasts(page) if f"{name}.zip" in one], name)
            assert any(why in said[0] for why in ("cannot be read: ", "no model in")), said
        assert dialog.count() == 0
        page.evaluate(DROP_BYTES, ["download (1).zip", encoded(good)])
        dialog.wait_for()
        assert "arm is in the scene" in dialog.inner_text()
        assert "1 other file is no part" in dialog.inner_text()
        assert "left out" not in dialog.inner_text()
        wait_until(lambda: page.evaluate("!!morse.world.value.find('arm')"), "the arm on the page")
