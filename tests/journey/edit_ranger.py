"""Chapter two in Blender: the crate becomes the body, two cylinders become eyes.

Run by Blender: the open file is the model of the robot, the argument the file of the crates.
"""

import math
import sys
from pathlib import Path

import bpy

crates = Path(sys.argv[sys.argv.index("--") + 1])

# select all objects and delete them
for old in list(bpy.data.objects):
    bpy.data.objects.remove(old, do_unlink=True)

# File > Append > small_crate
bpy.ops.wm.append(directory=str(crates / "Collection") + "/", filename="small_crate")


def material(name, color):
    made = bpy.data.materials.new(name)
    made.use_nodes = True
    made.diffuse_color = (*color, 1)
    made.node_tree.nodes["Principled BSDF"].inputs["Base Color"].default_value = (*color, 1)
    return made


EYE, PUPIL = material("Eye", (0.9, 0.9, 0.9)), material("Pupil", (0, 0, 0))


def eye(name, side):
    """A flat cylinder that faces +X, with a pupil above its centre."""
    bpy.ops.mesh.primitive_cylinder_add(radius=0.16, depth=0.06, location=(0.54, side, 0.7))
    made = bpy.context.object
    made.name = name
    made.data.materials.append(EYE)
    made.data.materials.append(PUPIL)
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.primitive_cylinder_add(radius=0.06, depth=0.08, location=made.location)
    bpy.ops.object.mode_set(mode="OBJECT")
    mesh = made.data
    for polygon in mesh.polygons[len(mesh.polygons) // 2 :]:
        polygon.material_index = 1
    for vertex in mesh.vertices[len(mesh.vertices) // 2 :]:
        vertex.co.x -= 0.08
    # the rotation is applied to the mesh, so that the angle of the object is the angle of the eye
    made.rotation_euler = (0, math.radians(90), 0)
    bpy.ops.object.transform_apply(location=False, rotation=True, scale=True)
    return made


eye("right_eye", -0.22)
eye("left_eye", 0.22)
bpy.ops.wm.save_mainfile()
