"""Chapter five in Blender: a room with four walls, a lamp, a sun and a ball.

Run by Blender on a new file; the argument is the file to save.
"""

import math
import sys
from pathlib import Path

import bpy

target = Path(sys.argv[sys.argv.index("--") + 1])

for old in list(bpy.data.objects):
    bpy.data.objects.remove(old, do_unlink=True)


def material(name, color):
    made = bpy.data.materials.new(name)
    made.use_nodes = True
    made.diffuse_color = (*color, 1)
    made.node_tree.nodes["Principled BSDF"].inputs["Base Color"].default_value = (*color, 1)
    return made


def named(name, color=None):
    made = bpy.context.object
    made.name = name
    if color is not None:
        made.data.materials.append(color)
    return made


# a floor of 10 m
bpy.ops.mesh.primitive_plane_add(size=2.0)
bpy.ops.transform.resize(value=(5.0, 5.0, 5.0))
bpy.ops.object.transform_apply(location=False, rotation=False, scale=True)
named("Floor", material("Wood", (0.55, 0.38, 0.22)))

# four walls
plaster = material("Plaster", (0.85, 0.85, 0.8))
for x, y, turn in ((5.0, 0.0, 0.0), (-5.0, 0.0, 0.0), (0.0, 5.0, 90.0), (0.0, -5.0, 90.0)):
    bpy.ops.mesh.primitive_cube_add(size=2.0, location=(x, y, 0.5), rotation=(0.0, 0.0, math.radians(turn)))
    named("Wall", plaster).dimensions = (0.2, 10.0, 1.0)

# light
bpy.ops.object.light_add(type="SUN", location=(0.0, 0.0, 6.0), rotation=(math.radians(30), math.radians(20), 0.0))
named("Sun").data.energy = 3.0
bpy.ops.object.light_add(type="POINT", location=(0.0, 0.0, 3.0))
named("Lamp").data.energy = 300.0

# the background: a bright sky
world = bpy.context.scene.world
world.color = (0.5, 0.7, 0.9)
world.use_nodes = True
world.node_tree.nodes["Background"].inputs["Color"].default_value = (0.5, 0.7, 0.9, 1.0)

# a ball that rolls
bpy.ops.mesh.primitive_uv_sphere_add(radius=0.25, location=(0.0, 0.0, 0.25))
ball = named("Ball", material("Red", (0.8, 0.05, 0.05)))
ball["physics_type"] = "RIGID_BODY"
ball["mass"] = 0.3
ball["collision"] = "sphere"

target.parent.mkdir(parents=True, exist_ok=True)
bpy.ops.wm.save_as_mainfile(filepath=str(target))
