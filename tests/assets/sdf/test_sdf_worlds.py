"""Worlds from SDF files: includes, lights, terrain, materials, and that they stand still."""

import math
import os

import numpy as np
import pytest
import trimesh
from PIL import Image

import morse
from morse.assets import load
from morse.assets.errors import AssetError
from morse.scene import NodeKind, PhysicsType, ShapeKind

BOX = "<geometry><box><size>1 1 1</size></box></geometry>"
CRATE = f"""<sdf version="1.6"><model name="crate"><pose>0 0 0.5 0 0 0</pose><link name="link">
  <inertial><mass>10</mass><inertia><ixx>1.7</ixx><iyy>1.7</iyy><izz>1.7</izz></inertia></inertial>
  <collision name="c">{BOX}</collision><visual name="v">{BOX}</visual></link></model></sdf>"""
GROUND = """<model name="ground"><static>true</static><link name="link">
  <collision name="c"><geometry><plane><normal>0 0 1</normal><size>20 20</size></plane></geometry>
    <surface><friction><ode><mu>100</mu><mu2>50</mu2></ode></friction></surface></collision>
  <visual name="v"><geometry><plane><normal>0 0 1</normal><size>20 20</size></plane></geometry>
    <material><script><uri>file://media/materials/scripts/gazebo.material</uri><name>Gazebo/Red</name></script></material>
  </visual></link></model>"""


def model(folder, name, text, config=True):
    folder = folder / name
    folder.mkdir(parents=True)
    (folder / "model.sdf").write_text(text)
    if config:
        (folder / "model.config").write_text('<model><sdf version="1.6">model.sdf</sdf></model>')
    return folder


def world(tmp_path, content, version="1.9"):
    path = tmp_path / "worlds" / "world.sdf"
    path.parent.mkdir(exist_ok=True)
    path.write_text(f'<sdf version="{version}"><world name="w">{content}</world></sdf>')
    return path


def places(library):
    return {root.name: list(root.world_matrix().translation) for root in library.roots}


def test_models_are_included_from_folders_beside_the_world(tmp_path) -> None:
    model(tmp_path / "models", "crate", CRATE)
    path = world(
        tmp_path,
        """
      <include><uri>model://crate</uri></include>
      <include><uri>model://crate</uri><name>second</name><pose>3 0 0.5 0 0 1</pose></include>
      <include><uri>../models/crate</uri><name>third</name><pose>0 4 0.5 0 0 0</pose><static>true</static></include>
      <include><uri>https://fuel.gazebosim.org/1.0/someone/models/Tree</uri></include>""",
    )
    library = load(path)
    assert places(library) == {"crate": [0, 0, 0.5], "second": [3, 0, 0.5], "third": [0, 4, 0.5]}
    third = next(root for root in library.roots if root.name == "third")
    assert third.body.type is PhysicsType.STATIC
    assert len(library.warnings) == 1
    assert "Tree" in library.warnings[0]
    assert "GZ_SIM_RESOURCE_PATH" in library.warnings[0]


@pytest.mark.parametrize("variable", ["GZ_SIM_RESOURCE_PATH", "GAZEBO_MODEL_PATH", "SDF_PATH", "MORSE_RESOURCE_PATH"])
def test_models_are_found_in_the_folders_of_the_user(tmp_path, monkeypatch, variable) -> None:
    model(tmp_path / "elsewhere", "crate", CRATE, config=False)
    monkeypatch.setenv(variable, str(tmp_path / "elsewhere"))
    for uri in ("model://crate", "crate"):
        path = world(tmp_path, f"<include><uri>{uri}</uri></include>")
        assert load(path).warnings == []
        assert places(load(path)) == {"crate": [0, 0, 0.5]}


def test_the_newest_version_of_a_model_is_used(tmp_path) -> None:
    folder = model(tmp_path, "crate", CRATE)
    (folder / "model.config").write_text(
        '<model><sdf version="1.10">new.sdf</sdf><sdf version="1.9">model.sdf</sdf></model>'
    )
    (folder / "new.sdf").write_text(CRATE.replace('name="crate"', 'name="newer"'))
    assert list(places(load(world(tmp_path, "<include><uri>model://crate</uri></include>")))) == ["newer"]


def test_models_stand_where_the_saved_state_has_them(tmp_path) -> None:
    model(tmp_path / "models", "crate", CRATE)
    box = "<link name='l'><collision name='c'><geometry><box><size>1 1 1</size></box></geometry></collision></link>"
    path = world(
        tmp_path,
        f"""
      <frame name="f"><pose>5 5 5 0 0 0</pose></frame>
      <model name="wall"><static>1</static><pose relative_to="f">3 0 0 0 0 0</pose>{box}</model>
      <model name="other"><static>1</static><pose>0 7 0 0 0 0</pose>{box}</model>
      <model name="broken"><static>1</static><pose>0 8 0 0 0 0</pose>{box}</model>
      <include><uri>model://crate</uri><name>second</name><pose>3 0 0.5 0 0 1</pose></include>
      <state world_name="w"><sim_time>1 0</sim_time>
        <model name="wall"><pose frame="">2.5 1 0 0 0 0</pose><scale>1 1 1</scale>
          <link name="l"><pose>2.5 1 0 0 0 0</pose></link></model>
        <model name="second"><pose>4 0 0.25 0 0 0</pose><scale>1 2 1</scale></model>
        <model name="broken"><pose>0 nan 0 0 0 0</pose></model>
        <model name="nobody"><pose>9 9 9 0 0 0</pose></model>
      </state>
      <state world_name="w"><model name="wall"><pose>0 0 0 0 0 0</pose></model></state>""",
        version="1.7",
    )
    library = load(path)
    assert places(library) == {
        "wall": [2.5, 1, 0],
        "other": [0, 7, 0],
        "broken": [0, 8, 0],
        "second": [4, 0, 0.25],
    }
    assert len(library.warnings) == 2
    assert "the scale of the model 'second' in <state> is left out" in library.warnings
    assert "'broken'" in library.warnings[1]


def test_a_floor_and_a_sun_need_not_be_installed(tmp_path) -> None:
    library = load(
        world(tmp_path, "<include><uri>model://sun</uri></include><include><uri>model://ground_plane</uri></include>")
    )
    assert {root.name: root.kind for root in library.roots} == {"ground_plane": NodeKind.EMPTY, "sun": NodeKind.LIGHT}
    assert library.warnings == []


def test_an_empty_world_is_a_world(tmp_path) -> None:
    assert load(world(tmp_path, "")).roots == []


def test_merged_models_give_their_links_to_the_one_around(tmp_path) -> None:
    model(tmp_path, "base", """<sdf version="1.9"><model name="base"><link name="base_link"/>
      <link name="arm"><pose>0 0 1 0 0 0</pose></link><frame name="f" attached_to="arm"><pose>1 0 0 0 0 0</pose></frame>
      <joint name="j" type="revolute"><parent>base_link</parent><child>arm</child><axis><xyz>0 1 0</xyz></axis></joint>
      </model></sdf>""")  # fmt: skip
    robot = model(
        tmp_path,
        "robot",
        """<sdf version="1.9"><model name="robot">
      <include merge="true"><uri>model://base</uri><pose>0 0 0.5 0 0 1.5707963267948966</pose></include>
      <link name="hand"><pose relative_to="f">0 0 0.1 0 0 0</pose></link>
      <joint name="wrist" type="fixed"><parent>arm</parent><child>hand</child></joint></model></sdf>""",
    )
    nodes = {node.name: node for node in load(robot / "model.sdf").nodes()}
    assert list(nodes["arm"].world_matrix().translation) == pytest.approx([0, 0, 1.5], abs=1e-12)
    assert list(nodes["hand"].world_matrix().translation) == pytest.approx([0, 1, 1.6], abs=1e-12)
    assert [bone.name for bone in nodes["robot_joints"].bones] == ["j", "wrist"]


def test_a_model_that_a_world_would_merge_stays_a_model(tmp_path) -> None:
    """A world has no links; Gazebo merges models into models only."""
    model(tmp_path / "models", "crate", CRATE)
    library = load(world(tmp_path, '<include merge="true"><uri>model://crate</uri><pose>1 2 3 0 0 0</pose></include>'))
    assert places(library) == {"crate": [1.0, 2.0, 3.0]}
    (warning,) = library.warnings
    assert "'model://crate' stays a model" in warning


SCENE = """from morse.builder import *
import math
for x in (0.0, 2.0):
    robot = FakeRobot(f"over_{{x:.0f}}")
    robot.translate(x, 0.1, 5)
    laser = RangeFinder("laser")
    laser.rotate(y=math.pi / 2)
    robot.append(laser)
env = Environment({path!r})
"""


def test_a_world_stands_still(tmp_path) -> None:
    model(tmp_path, "crate", CRATE)
    stack = "".join(
        f"<include><uri>model://crate</uri><name>crate_{i}</name><pose>2 0 {0.5 + i} 0 0 0</pose></include>"
        for i in range(3)
    )
    path = world(
        tmp_path,
        GROUND
        + stack
        + """<gravity>0 0 -3.71</gravity><spherical_coordinates>
      <latitude_deg>47.5</latitude_deg><longitude_deg>8.5</longitude_deg><elevation>400</elevation>
      </spherical_coordinates>""",
    )
    (tmp_path / "scene.py").write_text(SCENE.format(path=str(path)))
    with morse.load(tmp_path / "scene.py") as simulation:
        simulation.step(300)
        # 5 m above the plane, and above a stack of three crates
        assert simulation.over_0.laser.get()["distance"] == pytest.approx(5.0, abs=1e-3)
        assert simulation.over_2.laser.get()["distance"] == pytest.approx(2.0, abs=2e-3)


def test_models_hang_from_the_world_by_its_joints(tmp_path) -> None:
    model(tmp_path, "crate", CRATE)
    crates = "".join(
        f"<include><uri>model://crate</uri><name>{name}</name><pose>{x} 0 4 0 0 0</pose></include>"
        for name, x in (("welded", 0), ("hinged", 4))
    )
    joints = """<joint name="weld" type="fixed"><parent>world</parent><child>welded</child></joint>
      <joint name="hinge" type="revolute"><pose>1 0 0 0 0 0</pose><parent>world</parent><child>hinged::link</child>
      <axis><xyz>0 1 0</xyz></axis></joint>"""
    path = world(tmp_path, crates + joints)
    assert load(path).warnings == []
    (tmp_path / "scene.py").write_text(f"from morse.builder import *\nEnvironment({str(path)!r})\n")
    with morse.load(tmp_path / "scene.py") as simulation:
        simulation.step(6)
        objects = simulation.world.objects_by_name
        welded, hinged = (objects[name].worldPosition for name in ("link", "hinged::link"))
    assert list(welded) == pytest.approx([0, 0, 4], abs=1e-9)
    # a compound pendulum from rest: its centre is 1 m beside the hinge
    assert 4 - hinged.z == pytest.approx(0.5 * 9.81 * 10 / (1.7 + 10) * 0.1**2, rel=0.05)


def test_colours_pictures_and_scripts(tmp_path) -> None:
    folder = model(
        tmp_path,
        "sign",
        """<sdf version="1.6"><model name="sign"><link name="l">
      <visual name="script"><geometry><box><size>1 1 1</size></box></geometry><material><script>
        <uri>model://sign/materials/scripts</uri><uri>model://sign/materials/textures</uri><name>Sign/Board</name>
      </script></material></visual>
      <visual name="pbr"><geometry><sphere><radius>1</radius></sphere></geometry><material><diffuse>1 0.5 0 1</diffuse>
        <pbr><metal><metalness>0.8</metalness><roughness>0.3</roughness></metal></pbr></material>
        <transparency>0.25</transparency></visual>
      <visual name="named"><geometry><sphere><radius>1</radius></sphere></geometry><material><script>
        <name>Gazebo/Blue</name></script></material></visual>
      </link></model></sdf>""",
    )
    (folder / "materials" / "scripts").mkdir(parents=True)
    (folder / "materials" / "textures").mkdir(parents=True)
    Image.new("RGB", (4, 4), (255, 0, 0)).save(folder / "materials" / "textures" / "board.png")
    (folder / "materials" / "scripts" / "sign.material").write_text(
        "material Sign/Base\n{\n technique\n {\n pass\n {\n diffuse 0.5 0.5 0.5 1\n texture_unit\n {\n"
        " texture board.png\n }\n }\n }\n}\nmaterial Sign/Board : Sign/Base\n{\n}\n"
    )
    library = load(folder / "model.sdf")
    assert library.warnings == []
    seen = {node.parent.name: node for node in library.nodes() if node.mesh is not None}
    board, ball, blue = (seen[f"l_{name}"].materials[0] for name in ("script", "pbr", "named"))
    assert board.image is not None
    assert board.image.mime == "image/png"
    assert seen["l_script"].mesh.uvs is not None
    # half of the light, in sRGB, is 0.2140 of the light, linearly (IEC 61966-2-1)
    assert ball.color == pytest.approx((1.0, 0.2140, 0.0, 0.75), abs=1e-4)
    assert (ball.metallic, ball.roughness) == (0.8, 0.3)
    assert blue.color == (0.0, 0.0, 1.0, 1.0)


def test_lights(tmp_path) -> None:
    library = load(world(tmp_path, """<light type="directional" name="sun"><pose>0 0 10 0 0 0</pose>
      <direction>1 0 -1</direction><diffuse>1 1 1 1</diffuse></light>
      <light type="point" name="lamp"><pose>1 2 3 0 0 0</pose><attenuation><constant>1</constant><linear>0.5</linear>
      </attenuation></light><model name="m"><static>1</static><link name="l"/></model>"""))  # fmt: skip
    lights = {node.name: node for node in library.nodes() if node.kind is NodeKind.LIGHT}
    assert lights["sun"].light.type == "SUN"
    down = np.array(lights["sun"].world_matrix())[:3, :3] @ [0, 0, -1]
    assert down == pytest.approx([math.sqrt(0.5), 0, -math.sqrt(0.5)])
    assert lights["lamp"].light.type == "POINT"
    assert lights["lamp"].light.distance == pytest.approx(2.0)  # 1 / (1 + 0.5 d) = 1/2


def test_a_light_at_a_frame_that_does_not_exist_is_left_out(tmp_path) -> None:
    library = load(world(tmp_path, """<light type="point" name="lamp"><pose relative_to="nowhere"/></light>
      <light type="point" name="loop"><pose relative_to="turning"/></light>
      <frame name="turning"><pose relative_to="turning"/></frame>
      <light type="point" name="good"/><model name="m"><static>1</static><link name="l"/></model>"""))  # fmt: skip
    assert [node.name for node in library.nodes() if node.kind is NodeKind.LIGHT] == ["good"]
    assert [text.split(":")[0] for text in library.warnings] == [
        "the light 'lamp' is left out", "the light 'loop' is left out",
    ]  # fmt: skip
    assert any(node.name == "l" for node in library.nodes())


def test_a_height_map_has_its_highest_point_where_the_picture_is_brightest(tmp_path) -> None:
    pixels = np.zeros((5, 5), np.uint8)
    pixels[0, 4] = 200  # top right: +Y and +X
    (tmp_path / "worlds").mkdir()
    Image.fromarray(pixels).save(tmp_path / "worlds" / "hills.png")
    height = "<geometry><heightmap><uri>hills.png</uri><size>40 20 3</size><pos>0 0 1</pos></heightmap></geometry>"
    library = load(
        world(
            tmp_path,
            f"""<model name="m"><static>1</static><link name="l">
      <collision name="c">{height}</collision><visual name="v">{height}</visual></link></model>""",
        )
    )
    (solid,) = (node for node in library.nodes() if node.shapes)
    assert solid.shapes[0].kind is ShapeKind.HEIGHT_FIELD
    (seen,) = (node for node in library.nodes() if node.mesh is not None and node.visible)
    points = seen.mesh.vertices + np.array(seen.world_matrix())[:3, 3]
    assert points[points[:, 2].argmax()] == pytest.approx([20, 10, 4])


def test_a_polyline_is_a_prism(tmp_path) -> None:
    text = """<polyline><height>2</height><point>0 0</point><point>2 0</point><point>2 1</point><point>1 1</point>
      <point>1 2</point><point>0 2</point><point>0 0</point></polyline>"""
    library = load(
        world(
            tmp_path,
            f"""<model name="m"><static>1</static><link name="l">
      <visual name="v"><geometry>{text}</geometry></visual></link></model>""",
        )
    )
    (mesh,) = (node.mesh for node in library.nodes() if node.mesh is not None)
    a, b, c = (mesh.vertices[mesh.triangles[:, i]].astype(float) for i in range(3))
    volume = np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6.0
    assert volume == pytest.approx(6.0)  # an L of 3 m^2, 2 m high; positive: all faces look outwards


def test_a_submesh_is_cut_out_and_centred(tmp_path) -> None:
    folder = model(
        tmp_path,
        "pair",
        """<sdf version="1.6"><model name="pair"><link name="l"><visual name="v"><geometry>
      <mesh><uri>model://pair/meshes/pair.glb</uri><submesh><name>right</name><center>true</center></submesh>
      <scale>2 2 2</scale></mesh></geometry></visual></link></model></sdf>""",
    )
    (folder / "meshes").mkdir()
    scene = trimesh.Scene()
    for name, x in (("left", 0.5), ("right", 5.5)):
        box = trimesh.creation.box((1.0, 1.0, 1.0))
        box.apply_translation((x, 2.0, 3.0))
        scene.add_geometry(box, node_name=name, geom_name=name)
    scene.export(folder / "meshes" / "pair.glb")
    library = load(folder / "model.sdf")
    assert library.warnings == []
    (node,) = (node for node in library.nodes() if node.mesh is not None)
    matrix = np.array(node.world_matrix())
    points = node.mesh.vertices @ matrix[:3, :3].T + matrix[:3, 3]
    assert points.min(axis=0) == pytest.approx([-1, -1, -1])
    assert points.max(axis=0) == pytest.approx([1, 1, 1])


def test_pictures_of_meshes_are_found_in_the_folder_of_textures(tmp_path) -> None:
    folder = model(
        tmp_path,
        "panel",
        """<sdf version="1.6"><model name="panel"><link name="l"><visual name="v"><geometry>
      <mesh><uri>model://panel/meshes/panel.obj</uri></mesh></geometry></visual></link></model></sdf>""",
    )
    (folder / "meshes").mkdir()
    (folder / "materials" / "textures").mkdir(parents=True)
    Image.new("RGB", (2, 2), (0, 255, 0)).save(folder / "materials" / "textures" / "green.png")
    (folder / "meshes" / "panel.mtl").write_text("newmtl m\nmap_Kd green.png\n")
    (folder / "meshes" / "panel.obj").write_text(
        "mtllib panel.mtl\nusemtl m\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n"
    )
    library = load(folder / "model.sdf")
    assert library.warnings == []
    (node,) = (node for node in library.nodes() if node.mesh is not None)
    image = node.materials[0].image
    assert image is not None
    assert (folder / "materials" / "textures" / "green.png").read_bytes() == image.data


def test_rays_hit_an_actor_where_it_walks(tmp_path) -> None:
    (tmp_path / "w.sdf").write_text(
        """<sdf version="1.9"><world name="w"><actor name="walker"><script><loop>false</loop>
        <trajectory id="0" type="walk"><waypoint><time>0</time><pose>2 0 1 0 0 0</pose></waypoint>
        <waypoint><time>4</time><pose>6 0 1 0 0 0</pose></waypoint></trajectory></script></actor></world></sdf>""",
        "utf-8",
    )
    scene = tmp_path / "scene.py"
    scene.write_text(
        "from morse.builder import *\nrobot = FakeRobot('robot')\nscan = Hokuyo('scan')\nscan.translate(z=0.3)\n"
        "robot.append(scan)\nEnvironment('w.sdf')\n",
        "utf-8",
    )
    with morse.load(scene) as simulation:
        for _ in range(4):
            simulation.step(40)
            x = simulation.context.world.objects_by_name["walker"].world_pose()[0][0]
            assert min(simulation.robot.scan.get()["range_list"]) == pytest.approx(x - 0.25, abs=0.12)


def test_an_actor_walks(tmp_path, simulate) -> None:
    path = world(
        tmp_path,
        """<actor name="walker"><skin><filename>missing.dae</filename></skin><script><loop>true</loop>
      <delay_start>0</delay_start><auto_start>true</auto_start><trajectory id="0" type="walking">
      <waypoint><time>0</time><pose>0 0 1 0 0 0</pose></waypoint>
      <waypoint><time>2</time><pose>4 0 1 0 0 0</pose></waypoint>
      <waypoint><time>3</time><pose>4 0 1 0 0 1.57</pose></waypoint></trajectory></script></actor>""",
    )
    (actor,) = load(path).walkers
    text = dict(actor.properties)["Points"]
    simulation = simulate(
        f"""other = FakeRobot()
walk = TimedPath()
walk.properties(Points={text!r})
other.append(walk)
pose = Pose()
other.append(pose)
env = Environment({str(path)!r})
""",
        sockets=False,
    )
    # 2 m/s along X, then a turn in a second, then again from the beginning
    for time, x, yaw in ((1.0, 2.0, 0.0), (2.5, 4.0, 0.785), (4.0, 2.0, 0.0)):
        simulation.step(round((time - simulation.time()) * 60))
        data = simulation.other.pose.get()
        late = data["timestamp"] - time
        assert late < 0.2
        assert data["x"] == pytest.approx(x + (2.0 * late if x < 4.0 else 0.0), abs=0.04)
        assert data["yaw"] == pytest.approx(yaw + (1.57 * late if x == 4.0 else 0.0), abs=0.03)
        assert data["z"] == pytest.approx(1.0)
    # the actor of the world is there, with its path
    assert simulation.walker.path is not None


# -- files of others that mean harm ---------------------------------------------------------------


def test_entities_are_refused(tmp_path) -> None:
    path = tmp_path / "bomb.sdf"
    path.write_text('<!DOCTYPE a [<!ENTITY x "y"><!ENTITY z "&x;&x;">]><sdf version="1.6"><model name="&z;"/></sdf>')
    with pytest.raises(AssetError, match="it defines the entity 'x'"):
        load(path)


def test_a_circle_of_includes_is_refused(tmp_path) -> None:
    for one, other in (("a", "b"), ("b", "a")):
        model(
            tmp_path,
            one,
            f"""<sdf version="1.6"><model name="{one}"><link name="l"/>
          <include><uri>model://{other}</uri></include></model></sdf>""",
        )
    with pytest.raises(AssetError, match="includes itself"):
        load(tmp_path / "a" / "model.sdf")


def test_includes_that_double_at_each_level_are_refused(tmp_path) -> None:
    for level in range(18):
        inner = f"<include><uri>model://m{level + 1}</uri></include>" * 2 if level < 17 else ""
        model(tmp_path, f"m{level}", f'<sdf version="1.6"><model name="m"><link name="l"/>{inner}</model></sdf>')
    with pytest.raises(AssetError, match="includes more than 2000 models"):
        load(tmp_path / "m0" / "model.sdf")


def test_one_large_file_that_is_included_often_is_refused(tmp_path) -> None:
    links = "".join(f'<link name="l{i}"/>' for i in range(500))
    model(tmp_path, "large", f'<sdf version="1.6"><model name="m">{links}</model></sdf>')
    path = world(tmp_path, "<include><uri>model://large</uri></include>" * 100)
    with pytest.raises(AssetError, match="at most 20000 can be read"):
        load(path)


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ('<model name="m"><link name="a"><pose relative_to="b"/></link>'
         '<link name="b"><pose relative_to="a"/></link></model>', "depends on itself"),
        ('<model name="m"><link name="a"><pose relative_to="nowhere"/></link></model>', "no link, joint, frame"),
        ('<model name="m">' + "".join(f'<frame name="f{i}" attached_to="f{i + 1}"/>' for i in range(5000))
         + '<link name="f5000"/><link name="z"><pose relative_to="f0"/></link></model>', "chain that is too long"),
        ('<model name="m">' * 40 + '<link name="a"/>' + "</model>" * 40, "nested more than 20 deep"),
    ],
)  # fmt: skip
def test_contradictions_are_one_line(tmp_path, content, message) -> None:
    with pytest.raises(AssetError, match=message) as caught:
        load(world(tmp_path, content))
    assert "world.sdf" in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("links", "message"), [(1100, "1099 joints that move, at most 800"), (300, "more than 200 joints in a chain")]
)
def test_robots_that_are_too_large_are_refused(tmp_path, links, message) -> None:
    parts = "".join(f'<link name="l{i}"/>' for i in range(links))
    joints = "".join(
        f'<joint name="j{i}" type="revolute"><parent>l{i if links < 500 else 0}</parent><child>l{i + 1}</child></joint>'
        for i in range(links - 1)
    )
    with pytest.raises(AssetError, match=message):
        load(world(tmp_path, f'<model name="m">{parts}{joints}</model>'))


def test_wrong_numbers_are_named_and_the_rest_is_loaded(tmp_path) -> None:
    library = load(
        world(
            tmp_path,
            """<model name="m"><link name="a"><pose>1 2 x 0 0 0</pose>
      <inertial><mass>-1</mass></inertial><collision name="c"><geometry><sphere><radius>nan</radius></sphere></geometry>
      </collision></link><joint name="j" type="revolute"><parent>a</parent><child>gone</child></joint></model>""",
        )
    )
    text = "\n".join(library.warnings)
    for part in ("<pose> is '1 2 x 0 0 0'", "its mass is -1 kg", "<radius> is 'nan'", "the joint 'j' is left out"):
        assert part in text


def test_what_is_left_out_is_one_line_for_each_kind(tmp_path) -> None:
    library = load(
        world(
            tmp_path,
            """<wind/><plugin name="gz::sim::systems::Physics" filename="p"/>
      <plugin name="Weather" filename="libweather.so"/><model name="m"><link name="a"><projector name="p"/>
      <projector name="q"/></link><link name="b"/><joint name="j" type="fixed"><parent>a</parent><child>b</child>
      <sensor name="radio" type="wireless_receiver"/></joint></model>""",
        )
    )
    assert library.warnings == [
        "elements of world.sdf that MORSE does not have are left out: 2 <projector>, 1 <wind>",
        "sensors that MORSE does not have are left out: 'radio' (wireless_receiver)",
        "plugins of the world are left out: Weather",
    ]


def test_files_outside_of_the_model_are_not_read(tmp_path) -> None:
    (tmp_path / "secret.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    folder = model(
        tmp_path / "deep" / "models",
        "m",
        """<sdf version="1.6"><model name="m"><link name="l"><visual name="v">
      <geometry><mesh><uri>../../../secret.obj</uri></mesh></geometry></visual></link></model></sdf>""",
    )
    library = load(folder / "model.sdf")
    assert [node for node in library.nodes() if node.mesh is not None] == []
    assert "outside of the package of the model" in library.warnings[0]


TABLE = """<model name="table"><static>1</static><link name="l"><collision name="c"><geometry><mesh><uri>{}</uri></mesh>
</geometry></collision></link></model>"""
BOX = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"


def has_mesh(library) -> bool:
    return any(node.mesh is not None for node in library.nodes())


@pytest.mark.parametrize(
    "place", ["beside", "above", "GZ_SIM_RESOURCE_PATH", "IGN_GAZEBO_RESOURCE_PATH", "GAZEBO_MODEL_PATH"]
)
@pytest.mark.parametrize("inside", ["models/table/meshes/a.obj", "table/meshes/a.obj"])
def test_files_below_the_resource_paths_of_gazebo_are_found(tmp_path, monkeypatch, place, inside) -> None:
    folder = tmp_path / "ws" / "worlds"
    folder.mkdir(parents=True)
    base = {"beside": folder, "above": tmp_path / "ws"}.get(place, tmp_path / "resources")
    if place.isupper():
        monkeypatch.setenv(place, f"{tmp_path / 'nothing'}{os.pathsep}{base}")
    (base / inside).parent.mkdir(parents=True)
    (base / inside).write_text(BOX)
    monkeypatch.chdir(tmp_path)
    library = load(world(folder, TABLE.format(f"file://{inside}")))
    assert library.warnings == []
    assert has_mesh(library)


def test_files_with_a_scheme_are_read_from_nowhere_else(tmp_path, monkeypatch) -> None:
    (tmp_path / "secret").mkdir()
    (tmp_path / "secret" / "a.obj").write_text(BOX)
    folder = tmp_path / "a" / "ws" / "worlds"
    folder.mkdir(parents=True)
    monkeypatch.chdir(tmp_path)
    for uri in ("file://../../../secret/a.obj", f"file://{tmp_path}/secret/a.obj"):
        assert not has_mesh(load(world(folder, TABLE.format(uri))))


@pytest.mark.parametrize("cache", [".gz/fuel", ".ignition/fuel"])
def test_what_gazebo_has_downloaded_is_read_from_its_cache(tmp_path, monkeypatch, cache) -> None:
    monkeypatch.setenv("HOME", str(tmp_path / "home"))
    monkeypatch.setenv("USERPROFILE", str(tmp_path / "home"))
    address = "https://fuel.gazebosim.org/1.0/OpenRobotics/models/Old Table"
    for version, size in ((2, 1), (10, 3)):
        mesh = tmp_path / "home" / cache / f"fuel.gazebosim.org/openrobotics/models/old table/{version}/meshes/a.obj"
        mesh.parent.mkdir(parents=True)
        mesh.write_text(BOX.replace("1", str(size), 1).replace("v 1", f"v {size}", 1))
    (tmp_path / "home" / cache / "secret.obj").write_text(BOX)
    folder = tmp_path / "worlds"
    folder.mkdir()
    for uri in (f"{address}/2/files/meshes/a.obj", f"{address.replace(' ', '%20')}/tip/files/meshes/a.obj"):
        library = load(world(folder, TABLE.format(uri)))
        assert library.warnings == []
        assert has_mesh(library)
    for up in ("..", "%2e%2e"):
        uri = f"{address}/2/files/{'/'.join([up] * 5)}/secret.obj"
        assert not has_mesh(load(world(folder, TABLE.format(uri))))
    tree = "https://fuel.gazebosim.org/1.0/a/models/Old%20Tree"
    twice = "".join(TABLE.format(f"{tree}/1/files/meshes/{i}.obj") for i in range(2))
    (warning,) = load(world(folder, twice.replace('name="table"', 'name="other"', 1))).warnings
    assert f"gz fuel download -u {tree}`" in warning


#: a bar of 1 kg that hangs on a post by a joint of the world, horizontal at the start
BAR = """<model name="bar"><pose>0.1 0 1.5 0 0 0</pose><link name="link"><inertial><pose>0.5 0 0 0 0 0</pose>
  <mass>1</mass><inertia><ixx>0.001</ixx><iyy>0.083333</iyy><izz>0.083333</izz></inertia></inertial><collision name="c">
  <pose>0.5 0 0 0 0 0</pose><geometry><box><size>1 0.04 0.04</size></box></geometry></collision></link></model>"""
POST = """<model name="post"><static>true</static><pose>0 0 0.5 0 0 0</pose><link name="link"><collision name="c">
  <geometry><box><size>0.04 0.04 1</size></box></geometry></collision></link></model>"""
HINGE = """<joint name="hinge" type="revolute"><parent>{parent}</parent><child>bar::link</child>
  <axis><xyz>0 1 0</xyz></axis></joint>"""


@pytest.mark.parametrize("parent", ["post::link", "mark"])
def test_joints_of_a_world_connect_its_models(tmp_path, parent) -> None:
    frame = '<frame name="mark" attached_to="post"><pose>0 1 0 0 0 0</pose></frame>'
    path = world(tmp_path, GROUND + POST + BAR + frame + HINGE.format(parent=parent))
    library = load(path)
    assert library.warnings == []
    assert {"post::link", "bar::link"} <= {node.name for root in library.roots for node in root.walk()}

    def script() -> None:
        from morse.builder import Environment

        Environment(str(path), fastmode=True)

    with morse.load(script) as sim:
        bar, post = (sim.world.game_object(name) for name in ("bar::link", "post::link"))
        # a quarter of the period of a bar that starts at 90 degrees: K(sin 45) / sqrt(3 g / 2 l) = 0.4833 s
        sim.step(29)
        assert bar.world_pose()[0] == pytest.approx((0.1, 0.0, 1.5), abs=1e-3)
        assert bar.world_pose()[1][0] == pytest.approx(0.0, abs=0.05)
        assert bar.world_pose()[1][6] == pytest.approx(-1.0, abs=0.05)
        assert post.world_pose()[0] == pytest.approx((0.0, 0.0, 0.5), abs=1e-9)


def test_two_models_that_a_joint_connects_fall_together(tmp_path) -> None:
    other = CRATE.partition(">")[2].replace("</sdf>", "").replace('"crate"', '"crate2"').replace("0 0 0.5", "2 0 0.5")
    joint = '<joint name="weld" type="fixed"><parent>crate</parent><child>crate2</child></joint>'
    path = world(tmp_path, CRATE.partition(">")[2].replace("</sdf>", "").replace("0 0 0.5", "0 0 3") + other + joint)

    def script() -> None:
        from morse.builder import Environment

        Environment(str(path), fastmode=True)

    with morse.load(script) as sim:
        before = [sim.world.game_object(name).world_pose()[0][2] for name in ("crate::link", "crate2::link")]
        sim.step(20)
        after = [sim.world.game_object(name).world_pose()[0][2] for name in ("crate::link", "crate2::link")]
        falls = [one - other for one, other in zip(before, after, strict=True)]
        assert falls[0] == pytest.approx(falls[1], abs=5e-3)
        assert falls[0] > 0.3


def test_joints_to_nothing_are_left_out(tmp_path) -> None:
    library = load(world(tmp_path, GROUND + POST + BAR + HINGE.format(parent="nothing")))
    (warning,) = library.warnings
    assert warning.endswith("joints between the models of the world are left out: hinge")
