"""Sixty worlds in the manner of makers: short files, each with what the files of a maker have and others have not."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from PIL import Image

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence
    from pathlib import Path

Point = tuple[float, float, float]

# -- meshes ------------------------------------------------------------------------------------------------------------

_CORNERS = [(x, y, z) for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)]
_SIDES = ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3))


def mesh_of_boxes(boxes: Iterable[tuple[Point, Point]]) -> tuple[np.ndarray, np.ndarray]:
    """Vertices (V, 3) and quads (Q, 4) of boxes (centre, size) in one mesh."""
    points, quads = [], []
    for number, (centre, size) in enumerate(boxes):
        points += [[c + k * s for c, k, s in zip(centre, corner, size, strict=True)] for corner in _CORNERS]
        quads += [[8 * number + index for index in side] for side in _SIDES]
    return np.array(points, float), np.array(quads)


def mesh_of_heights(half: float, cells: int, height: Callable[[float, float], float]) -> tuple[np.ndarray, np.ndarray]:
    """Vertices and quads of a terrain that is open below."""
    steps = np.linspace(-half, half, cells + 1)
    points = [[x, y, height(x, y)] for x in steps for y in steps]
    row = cells + 1
    quads = [
        [i * row + j, (i + 1) * row + j, (i + 1) * row + j + 1, i * row + j + 1]
        for i in range(cells)
        for j in range(cells)
    ]
    return np.array(points), np.array(quads)


def obj(mesh: tuple[np.ndarray, np.ndarray], *, turned: bool = False) -> str:
    """The text of an OBJ file; ``turned`` lets the faces look inside."""
    points, quads = mesh
    faces = quads[:, ::-1] if turned else quads
    lines = [f"v {x:g} {y:g} {z:g}" for x, y, z in points]
    return "\n".join([*lines, *("f " + " ".join(str(i + 1) for i in face) for face in faces)]) + "\n"


def collada(mesh: tuple[np.ndarray, np.ndarray], *, unit: float = 1.0) -> str:
    """The text of a COLLADA file as Blender and SketchUp write it, in any unit."""
    points, quads = mesh
    points = points / unit
    triangles = [index for a, b, c, d in quads.tolist() for index in (a, b, c, a, c, d)]
    return f"""<?xml version="1.0" encoding="utf-8"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1"><asset>
<created>2020-01-01T00:00:00</created>
<modified>2020-01-01T00:00:00</modified><unit name="unit" meter="{unit}"/><up_axis>Z_UP</up_axis></asset>
<library_geometries><geometry id="g"><mesh><source id="p"><float_array id="a" count="{points.size}">
{" ".join(f"{value:g}" for value in points.ravel())}</float_array><technique_common><accessor source="#a"
count="{len(points)}" stride="3"><param name="X" type="float"/><param name="Y" type="float"/>
<param name="Z" type="float"/></accessor></technique_common></source><vertices id="v">
<input semantic="POSITION" source="#p"/></vertices>
<triangles count="{len(triangles) // 3}"><input semantic="VERTEX" source="#v" offset="0"/><p>
{" ".join(map(str, triangles))}</p></triangles></mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s"><node id="n"><instance_geometry url="#g"/></node></visual_scene>
</library_visual_scenes><scene><instance_visual_scene url="#s"/></scene></COLLADA>"""


def stl(mesh: tuple[np.ndarray, np.ndarray]) -> bytes:
    """A binary STL file."""
    points, quads = mesh
    triangles = [[a, b, c] for a, b, c, _ in quads.tolist()] + [[a, c, d] for a, _, c, d in quads.tolist()]
    rows = np.zeros(len(triangles), np.dtype([("n", "<f4", 3), ("p", "<f4", (3, 3)), ("x", "<u2")]))
    rows["p"] = points[np.array(triangles)]
    return b"world".ljust(80) + np.uint32(len(rows)).tobytes() + rows.tobytes()


FLOOR: tuple[Point, Point] = ((0, 0, -0.05), (16, 16, 0.1))
WALLS: list[tuple[Point, Point]] = [
    ((8, 0, 1.25), (0.15, 16, 2.5)), ((-8, 0, 1.25), (0.15, 16, 2.5)),
    ((0, 8, 1.25), (16, 0.15, 2.5)), ((0, -8, 1.25), (16, 0.15, 2.5)),
]  # fmt: skip


def _dunes(x: float, y: float) -> float:
    return 0.15 * math.sin(0.4 * x) * math.cos(0.3 * y)


def _crater(x: float, y: float) -> float:
    return 0.4 * math.exp(-((math.hypot(x - 9, y - 9) - 4) ** 2))


# -- elements of SDF ---------------------------------------------------------------------------------------------------


def solid(geometry: str, name: str = "c", pose: str = "", more: str = "") -> str:
    """A collision and a visual with the same geometry."""
    place = f"<pose>{pose}</pose>" if pose else ""
    parts = (
        f'<{tag} name="{name}_{tag}">{place}<geometry>{geometry}</geometry>{extra}</{tag}>'
        for tag, extra in (("collision", more), ("visual", ""))
    )
    return "".join(parts)


def box(x: float, y: float, z: float) -> str:
    return f"<box><size>{x} {y} {z}</size></box>"


def cylinder(radius: float, length: float) -> str:
    return f"<cylinder><radius>{radius}</radius><length>{length}</length></cylinder>"


def mesh(uri: str, scale: str = "", more: str = "") -> str:
    return f"<mesh><uri>{uri}</uri>{f'<scale>{scale}</scale>' if scale else ''}{more}</mesh>"


def static(name: str, content: str, pose: str = "0 0 0 0 0 0", *, flag: str = "true") -> str:
    """A static model of one link."""
    return f'<model name="{name}"><static>{flag}</static><pose>{pose}</pose><link name="link">{content}</link></model>'


def moving(name: str, geometry: str, pose: str, mass: float = 2.0) -> str:
    """A model that falls."""
    inertia = "".join(f"<i{axis}>0.1</i{axis}>" for axis in ("xx", "yy", "zz"))
    inertial = f"<inertial><mass>{mass}</mass><inertia>{inertia}</inertia></inertial>"
    return f'<model name="{name}"><pose>{pose}</pose><link name="link">{inertial}{solid(geometry)}</link></model>'


def include(uri: str, pose: str = "", name: str = "", more: str = "", attributes: str = "") -> str:
    place, named = f"<pose>{pose}</pose>" if pose else "", f"<name>{name}</name>" if name else ""
    return f"<include{attributes}><uri>{uri}</uri>{named}{place}{more}</include>"


SUN, PLANE = include("model://sun"), include("model://ground_plane")
SLAB = static("slab", solid(box(30, 30, 0.1)), "0 0 -0.05 0 0 0")
LEVEL = "<plane><normal>0 0 1</normal><size>60 60</size></plane>"
GRASS = (
    "<surface><friction><ode><mu>100</mu><mu2>50</mu2><fdir1>0 0 0</fdir1></ode><bullet/><torsional><ode/></torsional>"
    "</friction><bounce/><contact><ode/></contact></surface>"
)


def ring(parts: Sequence[tuple[float, float]], geometry: str, height: float) -> str:
    """The same shape at several places, as one static model."""
    shapes = (solid(geometry, f"p{i}", f"{x} {y} {height} 0 0 0") for i, (x, y) in enumerate(parts))
    return static("ring", "".join(shapes))


def hexagon(radius: float) -> list[tuple[float, float]]:
    return [(radius * math.cos(k * math.pi / 3), radius * math.sin(k * math.pi / 3)) for k in range(6)]


def tiles(count: int, size: float) -> str:
    """A floor of many links."""
    half = size * (count - 1) / 2
    links = (
        f'<link name="tile_{i}_{j}"><pose>{i * size - half} {j * size - half} -0.1 0 0 0</pose>'
        f"{solid(box(size, size, 0.2))}</link>"
        for i in range(count)
        for j in range(count)
    )
    return f'<model name="city"><static>1</static>{"".join(links)}</model>'


def maze(cells: int) -> str:
    """Walls of a maze around an open middle."""
    walls = (
        solid(
            box(2, 0.1, 0.6) if (i + j) % 2 else box(0.1, 2, 0.6),
            f"w{i}_{j}",
            f"{2 * i - cells} {2 * j - cells} 0.3 0 0 0",
        )
        for i in range(cells)
        for j in range(cells)
        if abs(2 * i - cells) > 3 or abs(2 * j - cells) > 3
    )
    return static("maze", "".join(walls))


def heightmap(size: str, more: str = "", uri: str = "file://media/materials/textures/hills.png") -> str:
    return f"<heightmap><uri>{uri}</uri><size>{size}</size>{more}</heightmap>"


ACTOR = """<actor name="walker"><skin><filename>walk.dae</filename><scale>1.0</scale></skin><animation name="walking">
<filename>walk.dae</filename><interpolate_x>true</interpolate_x></animation><script><loop>true</loop><trajectory id="0"
type="walking"><waypoint><time>0</time><pose>6 5 1 0 0 0</pose></waypoint><waypoint><time>5</time>
<pose>6 -5 1 0 0 0</pose></waypoint></trajectory></script></actor>"""
SYSTEMS = "".join(
    f'<plugin filename="{prefix}-{name}-system" name="x::systems::{name}"/>'
    for prefix, name in (
        ("gz-sim", "physics"), ("ignition-gazebo", "user-commands"), ("libignition-gazebo", "sensors"),
        ("gz-sim", "scene-broadcaster"), ("gz-sim", "contact"), ("gz-sim", "wind-effects"),
    )
)  # fmt: skip
EARTH = """<spherical_coordinates><surface_model>EARTH_WGS84</surface_model><world_frame_orientation>ENU
</world_frame_orientation><latitude_deg>37.413534</latitude_deg><longitude_deg>-121.996561</longitude_deg>
<elevation>1.3</elevation><heading_deg>0</heading_deg></spherical_coordinates>"""
ODE = """<physics name="default" default="0" type="ode"><max_step_size>0.001</max_step_size><real_time_factor>1
</real_time_factor><real_time_update_rate>1000</real_time_update_rate><ode><solver><type>quick</type><iters>150</iters>
<sor>1.4</sor></solver><constraints><cfm>0</cfm><erp>0.2</erp></constraints></ode></physics>"""
GUI = """<gui fullscreen="0"><camera name="user_camera"><pose frame="">0 0 17 -1.57 1.57 0</pose><view_controller>orbit
</view_controller></camera></gui><scene><ambient>0.4 0.4 0.4 1</ambient><background>0.25 0.25 0.25 1</background>
<shadows>0</shadows><grid>false</grid><sky><clouds><speed>12</speed></clouds></sky></scene>"""
STATE = """<state world_name="default"><sim_time>10 0</sim_time><real_time>11 0</real_time><iterations>1</iterations>
<model name="slab"><pose>0 0 -0.05 0 0 0</pose><link name="link"><pose>0 0 -0.05 0 0 0</pose></link></model></state>"""
CART = (
    '<model name="cart"><pose>5 5 0.3 0 0 0</pose><link name="base"><inertial><mass>10</mass></inertial>'
    + solid(box(1, 0.6, 0.2)) + "</link>"
    + "".join(
        f'<link name="{side}"><pose>0 {y} -0.1 -1.5708 0 0</pose>{solid(cylinder(0.2, 0.1))}'
        f'</link><joint name="{side}_j" type="revolute"><parent>base</parent><child>{side}</child><axis>'
        "<xyz>0 0 1</xyz>"
        "<limit><lower>-1e+16</lower><upper>1e+16</upper></limit></axis></joint>"
        for side, y in (("left", 0.35), ("right", -0.35))
    )
    + '<plugin name="drive" filename="libgazebo_ros_diff_drive.so"><left_joint>left_j</left_joint><right_joint>right_j'
    "</right_joint></plugin></model>"
)  # fmt: skip


def worlds() -> dict[str, tuple[str, str]]:
    """Names to versions and contents; a robot drives in all but `WITHOUT_FLOOR`."""
    ground = "model://ground_mesh/meshes"
    return {
        # AWS RoboMaker: houses, shops, hospitals and warehouses of many included meshes
        "aws_small_house": ("1.6", GUI + ODE + include("model://house_floor") + include("model://house_walls") + SUN),
        "aws_bookstore": ("1.6", static("floor", solid(mesh("file://ground_mesh/meshes/floor.dae")))),
        "aws_hospital": (
            "1.6",
            SLAB + "".join(include("model://bed", f"{x} 4 0 0 0 {x}", f"bed_{x}") for x in range(-6, 7, 2)),
        ),
        "aws_warehouse": (
            "1.6",
            include("model://warehouse_ground", "0 0 -0.09 0 0 0") + include("model://shelf", "4 4 0 0 0 0"),
        ),
        "aws_racetrack": ("1.6", static("track", solid(mesh("model://ground_mesh/meshes/floor_mm.dae")))),
        "aws_roof": ("1.6", SLAB + static("roof", solid(box(30, 30, 0.1)), "0 0 3 0 0 0")),
        # Clearpath: one mesh for everything, and empty worlds with a sky
        "clearpath_inspection": ("1.6", static("site", solid(mesh(f"{ground}/site.dae")))),
        "clearpath_agriculture": ("1.6", SUN + static("field", solid(mesh(f"{ground}/dunes.stl")))),
        "clearpath_construction": (
            "1.6",
            SUN + include("model://ground_mesh") + moving("beam", box(2, 0.2, 0.2), "4 3 0.2 0 0 0"),
        ),
        "clearpath_office": ("1.6", PLANE + static("walls", solid(mesh(f"{ground}/walls.stl")))),
        "clearpath_empty_sky": (
            "1.4",
            PLANE + GUI + '<light name="user" type="directional"><direction>0.1 0.1 -0.9</direction></light>',
        ),
        "clearpath_jackal_race": ("1.5", static("race", solid(mesh(f"{ground}/site_cm.dae"), more=GRASS))),
        # PX4: systems of Gazebo, coordinates on the earth, wind, water
        "px4_default": ("1.9", SYSTEMS + EARTH + static("ground_plane", solid(LEVEL, more=GRASS))),
        "px4_windy": (
            "1.9",
            SYSTEMS + "<wind><linear_velocity>0 4 0</linear_velocity></wind>" + static("ground", solid("<plane/>")),
        ),
        "px4_baylands": (
            "1.9",
            EARTH
            + include("model://ground_mesh", "0 0 -0.2 0 0 0")
            + static("water", f'<visual name="v"><geometry>{LEVEL}</geometry></visual>', "0 0 -1 0 0 0"),
        ),
        "px4_walls": ("1.9", PLANE + static("wall", solid(box(0.2, 10, 3)), "6 0 1.5 0 0 0")),
        "px4_aruco": (
            "1.9",
            static("ground", solid(LEVEL))
            + static(
                "mark", f'<visual name="v"><geometry>{box(0.5, 0.5, 0.001)}</geometry></visual>', "2 0 0.001 0 0 0"
            ),
        ),
        "px4_lawn": (
            "1.9",
            "<magnetic_field>6e-06 2.3e-05 -4.2e-05</magnetic_field><atmosphere type='adiabatic'/>"
            + static("lawn", solid(box(500, 500, 1)), "0 0 -0.5 0 0 0"),
        ),
        "px4_rover": (
            "1.6",
            PLANE + ODE + static("hump", solid(cylinder(2, 0.1)), "6 6 0 0 0 0"),
        ),
        "px4_sonoma_raceway": ("1.6", static("race", solid(heightmap("60 60 0.4")))),
        # NASA: other gravities, craters, and no ground at all
        "nasa_mars": ("1.6", "<gravity>0 0 -3.711</gravity>" + static("mars", solid(mesh(f"{ground}/crater.obj")))),
        "nasa_moon": (
            "1.10",
            "<gravity>0 0 -1.62</gravity>" + static("moon", solid(heightmap("80 80 0.6", "<pos>0 0 0</pos>"))),
        ),
        "nasa_srcsim": (
            "1.5",
            SLAB
            + static(
                "stairs",
                "".join(solid(box(0.3, 2, 0.2), f"s{i}", f"{4 + 0.3 * i} 0 {0.1 + 0.2 * i} 0 0 0") for i in range(5)),
            ),
        ),
        "nasa_iss": (
            "1.6",
            "<gravity>0 0 0</gravity>" + static("module", solid(mesh(f"{ground}/walls.stl")), "0 0 30 0 0 0"),
        ),
        "nasa_rock_yard": (
            "1.8",
            static("yard", solid(mesh(f"{ground}/dunes.obj")))
            + "".join(
                static(f"rock_{i}", solid("<sphere><radius>0.4</radius></sphere>"), f"{6 + i} {5 - i} 0.3 0 0 0")
                for i in range(4)
            ),
        ),
        # ROBOTIS: stages for TurtleBot3
        "turtlebot3_world": (
            "1.4",
            SUN + PLANE + ring(hexagon(4.5), cylinder(0.3, 0.5), 0.25),
        ),
        "turtlebot3_house": (
            "1.6",
            PLANE
            + static(
                "house",
                "".join(solid(box(*size), f"w{i}", "{} {} {} 0 0 0".format(*at)) for i, (at, size) in enumerate(WALLS)),
            ),
        ),
        "turtlebot3_stage": (
            "1.4",
            PLANE
            + ODE
            + static(
                "boundary",
                "".join(solid(box(*size), f"w{i}", "{} {} {} 0 0 0".format(*at)) for i, (at, size) in enumerate(WALLS)),
            )
            + moving("obstacle", cylinder(0.15, 0.5), "3 3 0.25 0 0 0"),
        ),
        "turtlebot3_autorace": ("1.5", static("course", solid(mesh(f"{ground}/quad.obj")))),
        "turtlebot4_maze": ("1.8", PLANE + maze(6)),
        "turtlebot4_warehouse": ("1.8", SYSTEMS + static("depot", solid(mesh(f"{ground}/hall.obj")))),
        "create3_dock": ("1.8", PLANE + static("dock", solid(box(0.2, 0.3, 0.05)), "3 0 0.025 0 0 3.14")),
        # Unitree and others with legs: stairs, slopes, beams
        "unitree_earth": ("1.6", PLANE + "<physics type='ode'><max_step_size>0.0002</max_step_size></physics>"),
        "unitree_stairs": (
            "1.6",
            PLANE
            + static(
                "stairs",
                "".join(
                    solid(box(0.3, 3, 0.15 * (i + 1)), f"s{i}", f"{4 + 0.3 * i} 0 {0.075 * (i + 1)} 0 0 0")
                    for i in range(8)
                ),
            ),
        ),
        "anymal_slope": ("1.7", static("slope", solid(box(40, 40, 0.2)), "0 0 -0.1 0 0.08 0")),
        "spot_beams": (
            "1.7",
            SLAB + "".join(static(f"beam_{i}", solid(box(3, 0.1, 0.1)), f"5 {i} 0.05 0 0 0.2") for i in range(-3, 4)),
        ),
        # PAL Robotics, Fetch, Toyota, Husarion, Robotnik
        "pal_office": ("1.4", include("model://ground_mesh") + include("model://house_walls") + STATE),
        "pal_empty": ("1.3", PLANE + SUN),
        "fetch_test_zone": (
            "1.4",
            SUN
            + PLANE
            + include("model://table", "3 0 0 0 0 0")
            + moving("cube", box(0.06, 0.06, 0.06), "3 0 0.9 0 0 0", 0.1),
        ),
        "hsr_megaweb": (
            "1.6",
            SLAB + static("kitchen", solid(mesh(f"{ground}/shelf.stl", "0.001 0.001 0.001")), "4 3 0 0 0 0"),
        ),
        "husarion_world": (
            "1.7",
            SYSTEMS + static("floor", solid(mesh(f"{ground}/floor.dae"), pose="0 0 0 0 0 0")),
        ),
        "robotnik_two_floors": ("1.6", SLAB + static("upper", solid(box(6, 6, 0.2)), "9 9 3 0 0 0")),
        # Gazebo Classic
        "classic_cafe": ("1.6", SUN + PLANE + ACTOR + include("model://table", "4 3 0 0 0 0")),
        "classic_willowgarage": ("1.4", PLANE + static("willow", solid(mesh(f"{ground}/hall.dae")))),
        "classic_population": (
            "1.6",
            SUN
            + PLANE
            + f"<population name='p'>{moving('can', box(0.1, 0.1, 0.1), '0 0 0 0 0 0')}<pose>8 8 0 0 0 0</pose>"
            "<box><size>2 2 0.01</size></box><model_count>3</model_count><distribution><type>random</type>"
            "</distribution></population>",
        ),
        "classic_polyline": (
            "1.6",
            static(
                "plate",
                solid(
                    "<polyline><point>-9 -9</point><point>9 -9</point><point>9 9</point><point>-9 9</point>"
                    "<height>0.1</height></polyline>"
                ),
                "0 0 -0.1 0 0 0",
            ),
        ),
        "classic_road": (
            "1.5",
            PLANE + "<road name='r'><width>7</width><point>0 0 0.02</point><point>50 0 0.02</point></road>" + CART,
        ),
        "classic_friction": (
            "1.6",
            static(
                "ground",
                solid(LEVEL, more="<surface><friction><ode><mu>0.6</mu><mu2>0.6</mu2></ode></friction></surface>"),
            ),
        ),
        "classic_city": ("1.6", tiles(9, 2.0)),
        "classic_blank": ("1.6", SUN + ODE),
        # Gazebo Sim
        "sim_shapes": (
            "1.10",
            SYSTEMS
            + PLANE
            + moving("capsule", "<capsule><radius>0.2</radius><length>0.6</length></capsule>", "3 3 0.5 0 0 0")
            + moving("ellipsoid", "<ellipsoid><radii>0.2 0.3 0.5</radii></ellipsoid>", "-3 3 0.5 0 0 0")
            + moving("cone", "<cone><radius>0.3</radius><length>0.6</length></cone>", "3 -3 0.5 0 0 0"),
        ),
        "sim_frames": (
            "1.8",
            '<frame name="origin"><pose>1 0 0.2 0 0 0.5</pose></frame><model name="ground">'
            '<static>1</static><pose relative_to="origin"/><link name="l"><pose relative_to="low">0 0 0 0 0 0</pose>'
            + solid(box(30, 30, 0.2))
            + '</link><frame name="low"><pose>0 0 -0.3 0 0 0</pose></frame></model>',
        ),
        "sim_degrees": (
            "1.9",
            '<model name="g"><static>1</static><pose degrees="true">0 0 -0.1 0 0 45</pose><link name="l">'
            + solid(box(30, 30, 0.2))
            + "</link></model>",
        ),
        "sim_quaternions": (
            "1.9",
            '<model name="g"><static>1</static><pose rotation_format="quat_xyzw">0 0 -0.1 0 0 0.3827 '
            '0.9239</pose><link name="l">' + solid(box(30, 30, 0.2)) + "</link></model>",
        ),
        "sim_merged": ("1.9", include("model://ground_mesh", "0 0 -0.05 0 0 0", attributes=' merge="true"')),
        "sim_nested": (
            "1.8",
            '<model name="outer"><static>1</static><pose>0 0 0.3 0 0 0</pose><model name="inner">'
            '<pose>0 0 -0.35 0 0 0</pose><link name="l">' + solid(box(20, 20, 0.1)) + "</link></model></model>",
        ),
        "sim_submesh": (
            "1.9",
            static(
                "g",
                solid(mesh(f"{ground}/parts.obj", more="<submesh><name>floor</name><center>false</center></submesh>")),
            ),
        ),
        "sim_fixed_to_the_world": (
            "1.9",
            '<model name="g"><link name="l"><pose>0 0 -0.1 0 0 0</pose><inertial><mass>1000</mass></inertial>'
            + solid(box(40, 40, 0.2))
            + '</link><joint name="w" type="fixed"><parent>world</parent><child>l</child></joint></model>',
        ),
        "sim_tunnel": (
            "1.7",
            static(
                "tunnel",
                "".join(solid(box(30, 0.2, 3), f"w{y}", f"0 {y} 1.5 0 0 0") for y in (-3, 3))
                + solid(box(30, 6, 0.2), "f", "0 0 -0.1 0 0 0")
                + solid(box(30, 6, 0.2), "r", "0 0 3 0 0 0"),
            ),
        ),
        "sim_fuel": (
            "1.7",
            SLAB
            + include("https://fuel.gazebosim.org/1.0/OpenRobotics/models/Depot")
            + include("https://fuel.ignitionrobotics.org/1.0/openrobotics/models/Sun"),
        ),
        "sim_levels": (
            "1.10",
            SYSTEMS
            + PLANE
            + "<plugin name='gz::sim' filename='dummy'><level name='l1'><geometry><box><size>20 20 10</size></box>"
            "</geometry><ref>box</ref></level></plugin>" + moving("box", box(1, 1, 1), "6 6 0.5 0 0 0"),
        ),
    }


#: worlds in which nothing can drive, in Gazebo as well
WITHOUT_FLOOR = ("nasa_iss", "classic_blank")


def write(folder: Path) -> dict[str, Path]:
    """Write all worlds, and the models and pictures that they need; return their files by name."""
    meshes = {
        "floor.dae": collada(mesh_of_boxes([FLOOR])),
        "floor_mm.dae": collada(mesh_of_boxes([FLOOR]), unit=0.001),
        "site.dae": collada(mesh_of_boxes([FLOOR, *WALLS])),
        "site_cm.dae": collada(mesh_of_boxes([FLOOR, *WALLS]), unit=0.01),
        "hall.dae": collada(mesh_of_boxes(WALLS)),
        "hall.obj": obj(mesh_of_boxes([FLOOR, *WALLS])),
        "walls.stl": stl(mesh_of_boxes(WALLS)),
        "shelf.stl": stl(mesh_of_boxes([((0, 0, 500), (800, 300, 1000))])),
        "quad.obj": obj(mesh_of_heights(10, 1, lambda x, y: 0.0), turned=True),
        "dunes.obj": obj(mesh_of_heights(10, 24, _dunes)),
        "dunes.stl": stl(mesh_of_heights(10, 24, _dunes)),
        "crater.obj": obj(mesh_of_heights(14, 20, _crater)),
        "parts.obj": "o floor\n" + obj(mesh_of_boxes([FLOOR])) + "o lid\nv 0 0 5\nv 1 0 5\nv 0 1 5\nf 9 10 11\n",
    }
    models = {
        "ground_mesh": static("ground", solid(mesh("model://ground_mesh/meshes/floor.dae")), flag="1"),
        "house_floor": static(
            "floor", solid(mesh("model://ground_mesh/meshes/floor.dae", "1 1 1"), more=GRASS), flag="1"
        ),
        "house_walls": static("walls", solid(mesh("model://ground_mesh/meshes/walls.stl"))),
        "warehouse_ground": static("ground", solid(box(20, 20, 0.18))),
        "shelf": static("shelf", solid(mesh("model://ground_mesh/meshes/shelf.stl", "0.001 0.001 0.001"))),
        "bed": static("bed", solid(box(0.9, 2, 0.5), pose="0 0 0.25 0 0 0")),
        "table": static(
            "table",
            solid(box(1.5, 0.8, 0.03), "top", "0 0 0.8 0 0 0")
            + solid(box(0.05, 0.05, 0.8), "leg", "0.6 0.3 0.4 0 0 0"),
        ),
    }
    for name, content in models.items():
        place = folder / "models" / name
        (place / "meshes").mkdir(parents=True)
        (place / "model.sdf").write_text(f'<?xml version="1.0"?><sdf version="1.6">{content}</sdf>')
        config = f'<model><name>{name}</name><version>1.0</version><sdf version="1.6">model.sdf</sdf></model>'
        (place / "model.config").write_text(f'<?xml version="1.0"?>{config}')
    for name, content in meshes.items():
        data = content.encode() if isinstance(content, str) else content
        (folder / "models" / "ground_mesh" / "meshes" / name).write_bytes(data)
    pictures = folder / "media" / "materials" / "textures"
    pictures.mkdir(parents=True)
    at = np.linspace(0, 4 * math.pi, 65)
    hills = 127 + 60 * np.sin(at)[:, None] * np.cos(at)
    Image.fromarray(hills.astype(np.uint8)).save(pictures / "hills.png")
    (folder / "worlds").mkdir()
    files = {}
    for name, (version, content) in worlds().items():
        files[name] = folder / "worlds" / f"{name}.world"
        text = f'<?xml version="1.0" ?>\n<sdf version="{version}"><world name="default">{content}</world></sdf>'
        files[name].write_text(text)
    return files
