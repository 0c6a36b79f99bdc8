"""Creates objects that only Blender can evaluate: ``blender -b ... --python make_unevaluated.py -- scene.blend``."""

import sys

import bpy

SQUARE = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]
CUBE = [(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]
CUBE_FACES = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]


def add(name: str, data: object = None, **settings: object) -> bpy.types.Object:
    result = bpy.data.objects.new(name, data)
    bpy.context.scene.collection.objects.link(result)
    for key, value in settings.items():
        setattr(result, key, value)
    return result


def make_mesh(name: str, vertices: list, faces: list) -> bpy.types.Mesh:
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(vertices, [], faces)
    mesh.materials.append(bpy.data.materials.new(name))
    return mesh


def make_curve(name: str, depth: float) -> bpy.types.Curve:
    curve = bpy.data.curves.new(name, "CURVE")
    curve.dimensions = "3D"
    curve.bevel_depth = depth
    spline = curve.splines.new("POLY")
    spline.points.add(1)
    spline.points[1].co = (0, 0, 3, 1)
    return curve


bpy.ops.wm.read_factory_settings(use_empty=True)
mirrored = add("mirrored", make_mesh("square", SQUARE, [(0, 1, 2, 3)]))
mirrored.modifiers.new("mirror", "MIRROR")
switched_off = add("switched off", mirrored.data)
switched_off.modifiers.new("mirror", "MIRROR").show_viewport = False
cube = make_mesh("cube", CUBE, CUBE_FACES)
for name in ("row", "twin", "hidden row"):
    row = add(name, cube, location=(0, 0, 4))
    modifier = row.modifiers.new("array", "ARRAY")
    modifier.count = 3
dense = add("dense", cube)
modifier = dense.modifiers.new("subdivision", "SUBSURF")
modifier.levels = 9
add("tube", make_curve("tube", 0.25))
add("path", make_curve("path", 0.0))
add("text", bpy.data.curves.new("text", "FONT")).data.body = "MORSE"
keyed = add("keyed", make_mesh("keyed", SQUARE, [(0, 1, 2, 3)]))
keyed.shape_key_add(name="Basis")
raised = keyed.shape_key_add(name="raised")
for point in raised.data:
    point.co.z = 2
raised.value = 0.5
goal = add("goal", location=(7, 8, 9))
follower = add("follower")
follower.constraints.new("COPY_LOCATION").target = goal
add("passenger", location=(1, 0, 0), parent=follower)
chaser = add("chaser", parent=goal, location=(1, 1, 1))
chaser.constraints.new("COPY_ROTATION").target = add("turned", rotation_euler=(0, 0, 1))
bpy.context.view_layer.update()
for obj in bpy.data.objects:
    obj["world"] = [value for matrix_row in obj.matrix_world for value in matrix_row]
row.hide_viewport = True
bpy.ops.wm.save_as_mainfile(filepath=sys.argv[-1], compress=True)
