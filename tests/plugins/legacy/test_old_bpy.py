"""``import bpy`` in a scene script stands for the scene that is being described."""

import importlib.util
import sys
from collections.abc import Callable

import pytest

from morse.builder.script import ScriptError
from morse.scene import Bounds, Node, NodeKind, PhysicsType, Scene

Load = Callable[..., Scene]

HEAD = "from morse.builder import *\nimport bpy\n"
END = "env = Environment('empty')\n"


def node_of(scene: Scene, name: str) -> Node:
    return next(node for root in scene.roots for node in root.walk() if node.name == name)


def warnings(caplog: pytest.LogCaptureFixture) -> list[str]:
    return [record.getMessage() for record in caplog.records if record.levelname == "WARNING"]


def test_a_wall_from_operators(load: Load, caplog: pytest.LogCaptureFixture) -> None:
    scene = load(
        HEAD
        + "bpy.ops.mesh.primitive_cube_add(location=(0, 5, 1), rotation=(0, 0, 0.5))\n"
        + "wall = bpy.context.object\n"
        + "wall.name = 'wall'\n"
        + "wall.scale = (5, 0.1, 1)\n"
        + "wall.game.use_collision_bounds = True\n"
        + "wall.game.collision_bounds_type = 'BOX'\n"
        + "paint = bpy.data.materials.new('paint')\n"
        + "wall.data.materials.append(paint)\n"
        + "paint.diffuse_color = (0.8, 0.1, 0.0)\n"
        + END
    )
    wall = node_of(scene, "wall")
    assert (wall.location, wall.rotation_euler, wall.scale) == ([0.0, 5.0, 1.0], [0.0, 0.0, 0.5], [5.0, 0.1, 1.0])
    assert (wall.body.type, wall.body.bounds) == (PhysicsType.STATIC, Bounds.BOX), "as new objects of Blender"
    assert wall.materials[-1] is not None
    assert wall.materials[-1].color == (0.8, 0.1, 0.0, 1.0), "a change after the assignment counts"
    assert not warnings(caplog)


@pytest.mark.parametrize(
    ("call", "name", "scale"),
    [
        ("primitive_cube_add(radius=0.5)", "Cube", [0.5, 0.5, 0.5]),
        ("primitive_cube_add(size=1)", "Cube", [0.5, 0.5, 0.5]),
        ("primitive_plane_add(radius=3)", "Plane", [3.0, 3.0, 1.0]),
        ("primitive_cylinder_add(radius=0.2, depth=3)", "Cylinder", [0.2, 0.2, 1.5]),
        ("primitive_cone_add(radius1=0.2, depth=3)", "Cone", [0.2, 0.2, 1.5]),
        ("primitive_uv_sphere_add(size=0.3)", "Sphere", [0.3, 0.3, 0.3]),
        ("primitive_ico_sphere_add(size=0.3)", "Icosphere", [0.3, 0.3, 0.3]),
        ("primitive_torus_add(major_radius=2)", "Torus", [2.0, 2.0, 1.0]),
    ],
)
def test_solids_have_the_sizes_of_blender(load: Load, call: str, name: str, scale: list[float]) -> None:
    scene = load(f"{HEAD}bpy.ops.mesh.{call}\n{END}")
    assert node_of(scene, name).scale == pytest.approx(scale)


def test_selected_objects_are_moved_copied_and_removed(load: Load) -> None:
    scene = load(
        HEAD
        + "for name in ('a', 'b', 'c'):\n"
        + "    bpy.ops.mesh.primitive_cube_add()\n"
        + "    bpy.context.active_object.name = name\n"
        + "bpy.ops.object.select_all(action='DESELECT')\n"
        + "bpy.data.objects['a'].select = True\n"
        + "bpy.ops.transform.translate(value=(1, 2, 3))\n"
        + "bpy.ops.transform.resize(value=(2, 2, 2))\n"
        + "bpy.ops.transform.rotate(value=0.5, axis=(0, 0, 1))\n"
        + "bpy.ops.object.duplicate()\n"
        + "bpy.context.selected_objects[0].name = 'twin'\n"
        + "bpy.ops.object.select_all(action='DESELECT')\n"
        + "bpy.data.objects['c'].select = True\n"
        + "bpy.ops.object.delete()\n"
        + END
    )
    names = {root.name for root in scene.roots}
    assert {"a", "b", "twin"} <= names
    assert "c" not in names
    for name in ("a", "twin"):
        node = node_of(scene, name)
        assert (node.location, node.scale) == ([1.0, 2.0, 3.0], [2.0, 2.0, 2.0])
        assert node.rotation_euler == pytest.approx([0.0, 0.0, 0.5])
    assert node_of(scene, "b").location == [0.0, 0.0, 0.0]


def test_world_game_settings_and_viewpoint(load: Load) -> None:
    settings = load(
        HEAD
        + END
        + "bpy.context.scene.game_settings.physics_gravity = 1.62\n"
        + "bpy.context.scene.game_settings.fps = 120\n"
        + "bpy.data.scenes[0].game_settings.physics_step_sub = 5\n"
        + "bpy.data.worlds['World'].horizon_color = (0.1, 0.2, 0.3)\n"
        + "mist = bpy.context.scene.world.mist_settings\n"
        + "mist.use_mist = True\n"
        + "mist.depth = 40\n"
        + "bpy.data.objects['CameraFP'].location = (1, 2, 3)\n"
        + "bpy.data.objects['CameraFP'].location.z += 4\n"
        + "bpy.data.objects['CameraFP'].data.clip_end = 700\n"
    ).settings
    assert (settings.gravity, settings.frequency, settings.physics_steps) == (1.62, 120.0, 5)
    assert settings.view.horizon_color == (0.1, 0.2, 0.3)
    assert settings.view.mist is not None
    assert (settings.view.mist.enabled, settings.view.mist.depth) == (True, 40.0)
    assert settings.view.camera_location == (1.0, 2.0, 7.0)
    assert settings.view.camera_clip[1] == 700.0


def test_lamps_cameras_and_meshes_of_a_script(load: Load) -> None:
    scene = load(
        HEAD
        + "lamp = bpy.data.objects.new('lamp', bpy.data.lamps.new('lamp', 'SPOT'))\n"
        + "bpy.context.scene.objects.link(lamp)\n"
        + "lamp.data.energy = 0.5\n"
        + "mesh = bpy.data.meshes.new('roof')\n"
        + "mesh.from_pydata([(0, 0, 2), (4, 0, 2), (0, 3, 2)], [], [(0, 1, 2)])\n"
        + "roof = bpy.data.objects.new('roof', mesh)\n"
        + "assert list(roof.dimensions) == [4.0, 3.0, 0.0]\n"
        + "robot = ATRV()\n"
        + "eye = VideoCamera()\n"
        + "robot.append(eye)\n"
        + "eye._bpy_object.data.clip_end = 300\n"
        + "view = Camera('view')\n"
        + "view._bpy_object.data.lens = 20\n"
        + END
    )
    light = node_of(scene, "lamp").light
    assert light is not None
    assert (light.type, light.energy) == ("SPOT", 0.5)
    assert node_of(scene, "roof").kind is NodeKind.MESH
    assert node_of(scene, "robot.eye").properties["cam_far"] == 300.0
    camera = node_of(scene, "view").camera
    assert camera is not None
    assert camera.focal_length == 20.0


def test_what_is_not_there_is_one_line_of_the_log(load: Load, caplog: pytest.LogCaptureFixture) -> None:
    load(
        HEAD
        + "bpy.context.user_preferences.system.use_mipmaps = False\n"
        + "for i in range(9):\n"
        + "    bpy.ops.logic.sensor_add(type='ALWAYS', object='x')\n"
        + "with bpy.data.libraries.load('x.blend') as (source, target):\n"
        + "    target.objects = [name for name in source.objects]\n"
        + "bpy.context.scene.render.resolution_x = 640\n"
        + "Cube('box')._bpy_object.draw_type = 'WIRE'\n"
        + END
    )
    said = warnings(caplog)
    for line, name in (
        (3, "bpy.context.user_preferences"),
        (5, "bpy.ops.logic"),
        (6, "bpy.data.libraries"),
        (8, "bpy.context.scene.render.resolution_x"),
        (9, "object.draw_type"),
    ):
        assert len([text for text in said if f"scene.py:{line}: {name}" in text]) == 1
    assert len(said) == 5


def test_errors_of_blender_stay_errors(load: Load) -> None:
    with pytest.raises(ScriptError, match="no object 'Tabel'; did you mean 'Table'"):
        load(HEAD + "Cube('Table')\nbpy.data.objects['Tabel'].location.x = 1\n" + END)


def test_the_stand_in_stays_in_the_script(load: Load) -> None:
    load(
        HEAD
        + "import bpy.props, bgl\nfrom bpy_extras import io_utils\nfrom bpy import data\nassert data.objects\n"
        + END
    )
    assert not [name for name in sys.modules if name.partition(".")[0] in ("bpy", "bgl", "bpy_extras")]
    if importlib.util.find_spec("bpy") is None:
        with pytest.raises(ModuleNotFoundError):
            importlib.import_module("bpy")


def test_an_installed_bpy_is_not_hidden(load: Load, tmp_path: object, monkeypatch: pytest.MonkeyPatch) -> None:
    folder = tmp_path / "site"  # type: ignore[operator]
    folder.mkdir()
    (folder / "bpy.py").write_text("real = True\n")
    monkeypatch.syspath_prepend(str(folder))
    load("from morse.builder import *\nimport bpy\nassert bpy.real\n" + END)


def test_copies_of_objects(load: Load) -> None:
    scene = load(
        HEAD
        + "bpy.ops.mesh.primitive_cube_add(location=(1, 2, 3))\n"
        + "first = bpy.context.object\n"
        + "first.name = 'first'\n"
        + "second = first.copy()\n"
        + "second.data = first.data.copy()\n"
        + "bpy.context.scene.objects.link(second)\n"
        + "second.name = 'second'\n"
        + "second.location = (4, 5, 6)\n"
        + "second.game.mass = 7\n"
        + "assert sorted(tuple(corner) for corner in second.bound_box)[0] == (-1.0, -1.0, -1.0)\n"
        + END
    )
    first, second = node_of(scene, "first"), node_of(scene, "second")
    assert (first.location, second.location) == ([1.0, 2.0, 3.0], [4.0, 5.0, 6.0])
    assert (first.body.mass, second.body.mass) == (1.0, 7.0), "copies do not share their physics"


def test_functions_of_bpymorse_that_pass_calls_on(load: Load, caplog: pytest.LogCaptureFixture) -> None:
    scene = load(
        "from morse.builder import *\n"
        "bpymorse.deselect_all()\n"
        "bpymorse.add_mesh_cube(location=(1, 0, 0))\n"
        "box = bpymorse.get_context_object()\n"
        "box.name = 'box'\n"
        "paint = bpymorse.new_material()\n"
        "paint.diffuse_color = (1, 0, 0)\n"
        "box.active_material = paint\n"
        "assert box in bpymorse.get_selected_objects()\n"
        "bpymorse.get_context_scene().game_settings.physics_gravity = 3\n"
        "bpymorse.add_sensor(type='ALWAYS')\n" + END.replace("\n", "; env.set_gravity(3)\n")
    )
    box = node_of(scene, "box")
    assert box.location == [1.0, 0.0, 0.0]
    assert [material.color for material in box.materials if material] == [(1.0, 0.0, 0.0, 1.0)]
    (said,) = warnings(caplog)
    assert "scene.py:11: bpymorse.add_sensor" in said


def test_misspelt_functions_of_bpymorse(load: Load) -> None:
    with pytest.raises(ScriptError, match="did you mean 'get_object'"):
        load(HEAD + "bpymorse.get_objct('x')\n" + END)


def test_ignored_values_can_be_used_in_any_way(load: Load) -> None:
    load(
        HEAD
        + "x = bpy.context.tool_settings.grid\n"
        + "assert not x and x + 2 == 2 and 3 * x == 3 and not x > 1 and float(x) == 0.0 and list(x) == []\n"
        + "x.a.b['c'](1).d = 5\n"
        + END
    )


def test_materials_without_a_name_and_copies_of_materials(load: Load) -> None:
    scene = load(
        "import bpy\n"
        f"{HEAD}"
        "first = bpy.data.materials.new(name='')\n"
        "first.diffuse_color = (0.25, 0.5, 0.75)\n"
        "second = first.copy()\n"
        "second.diffuse_color = (1.0, 0.0, 0.0)\n"
        "third = first.copy()\n"
        "assert [first.name, second.name, third.name] == ['Material', 'Material.001', 'Material.002']\n"
        "assert tuple(third.diffuse_color) == tuple(first.diffuse_color) == (0.25, 0.5, 0.75)\n"
        "assert len(bpy.data.materials) == 3\n"
        "box, other = Cube('box'), Cube('other')\n"
        "box._bpy_object.active_material = first\n"
        "other._bpy_object.active_material = box._bpy_object.active_material.copy()\n"
        "other._bpy_object.active_material.diffuse_color = (0.0, 1.0, 0.0)\n"
        f"{END}"
    )
    colors = {node.name: node.materials[0].color for node in scene.nodes() if node.name in ("box", "other")}
    assert colors == {"box": (0.25, 0.5, 0.75, 1.0), "other": (0.0, 1.0, 0.0, 1.0)}
