"""Creates the scene for the tests of the reader, with any version of Blender.

``blender -b --factory-startup -noaudio --python make_scene.py -- scene.blend``, or with Python and the module
`bpy`: ``python make_scene.py -- scene.blend``. The latter created ``files/scene-4.2.blend`` (bpy 4.2.23), ``-4.5``
(4.5.15), ``-5.0`` (5.0.1) and ``-5.2`` (5.2.3). Every object has its world matrix, as computed by Blender, in
the custom property ``world`` (16 numbers, row by row).
"""

import sys
from math import pi, radians

import bpy

from mathutils import Matrix, Quaternion

ELL = [(0, 0, 0), (2, 0, 0), (2, 1, 0), (1, 1, 0), (1, 2, 0), (0, 2, 0)]
CUBE = [(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]
CUBE_FACES = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]


def main(path: str) -> None:
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    materials = make_materials()
    make_meshes(materials)
    make_poses()
    make_rig()
    make_properties()
    make_rigid_bodies()
    make_lights()
    make_collections()
    make_hidden()
    scene.gravity = (0, 0, -1.62)
    scene.world = bpy.data.worlds.new("moon")
    if bpy.app.version < (5, 0, 0):
        scene.world.use_nodes = True
    background = next(node for node in scene.world.node_tree.nodes if node.type == "BACKGROUND")
    background.inputs["Color"].default_value = (0.25, 0.5, 0.75, 1)
    background.inputs["Strength"].default_value = 0.5
    bpy.context.view_layer.update()
    for obj in bpy.data.objects:
        obj["world"] = [value for row in obj.matrix_world for value in row]
    hide()
    if bpy.app.background and bpy.app.binary_path:
        bpy.ops.wm.save_as_mainfile(filepath=path, compress=True)
    else:
        # only the scene, without the windows of the program
        bpy.data.libraries.write(path, {scene}, compress=True)


def add(name: str, data: object = None, **settings: object) -> bpy.types.Object:
    result = bpy.data.objects.new(name, data)
    bpy.context.scene.collection.objects.link(result)
    for key, value in settings.items():
        setattr(result, key, value)
    return result


def make_mesh(name: str, vertices: list, faces: list) -> bpy.types.Mesh:
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(vertices, [], faces)
    return mesh


def make_materials() -> dict[str, bpy.types.Material]:
    image = bpy.data.images.new("checker", 4, 4)
    image.pixels = [1.0, 0.0, 0.0, 1.0] * 16
    image.file_format = "PNG"
    image.pack()
    made = {}
    for name in ("red", "wood", "green", "glow"):
        made[name] = bpy.data.materials.new(name)
        if bpy.app.version < (5, 0, 0):
            made[name].use_nodes = True
    shader = principled(made["red"])
    shader.inputs["Base Color"].default_value = (0.5, 0.25, 0.125, 1)
    shader.inputs["Roughness"].default_value = 0.25
    shader.inputs["Metallic"].default_value = 0.75
    shader.inputs["Alpha"].default_value = 0.5
    tree = made["wood"].node_tree
    texture, adjust = tree.nodes.new("ShaderNodeTexImage"), tree.nodes.new("ShaderNodeHueSaturation")
    texture.image = image
    tree.links.new(texture.outputs["Color"], adjust.inputs["Color"])
    tree.links.new(adjust.outputs["Color"], principled(made["wood"]).inputs["Base Color"])
    principled(made["green"]).inputs["Base Color"].default_value = (0, 1, 0, 1)
    shader = principled(made["glow"])
    emission = "Emission Color" if "Emission Color" in shader.inputs else "Emission"
    shader.inputs[emission].default_value = (0.5, 0.25, 1, 1)
    shader.inputs["Emission Strength"].default_value = 2
    made["glow"].use_backface_culling = True
    return made


def principled(material: bpy.types.Material) -> bpy.types.Node:
    return next(node for node in material.node_tree.nodes if node.type == "BSDF_PRINCIPLED")


def make_meshes(materials: dict[str, bpy.types.Material]) -> None:
    add("ell", make_mesh("ell", ELL, [(0, 1, 2, 3, 4, 5)]))
    cube = make_mesh("cube", CUBE, CUBE_FACES)
    cube.materials.append(materials["red"])
    cube.materials.append(materials["wood"])
    cube.polygons[5].material_index = 1
    for name, factor in (("first", 1.0), ("second", 2.0)):
        layer = cube.uv_layers.new(name=name)
        corners = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)] * 6
        layer.data.foreach_set("uv", [factor * value for corner in corners for value in corner])
    cube.uv_layers["second"].active_render = True
    add("cube", cube)
    other = add("painted", cube, location=(5, 0, 0))
    other.material_slots[0].link = "OBJECT"
    other.material_slots[0].material = materials["green"]
    sides = 16
    ring = [Quaternion((0, 0, 1), 2 * pi * k / sides) @ Matrix.Translation((1, 0, 0)).translation for k in range(sides)]
    rims = [(x, y, z) for z in (0.0, 2.0) for x, y, _ in ring]
    walls = [(k, (k + 1) % sides, sides + (k + 1) % sides, sides + k) for k in range(sides)]
    caps = [tuple(reversed(range(sides))), tuple(range(sides, 2 * sides))]
    can = make_mesh("can", rims, walls + caps)
    can.polygons.foreach_set("use_smooth", [True] * sides + [False, True])
    for edge in can.edges:
        # the rims: on them, the walls must not use the normals of the caps
        edge.use_edge_sharp = abs(edge.vertices[0] - edge.vertices[1]) != sides
    can.materials.append(materials["glow"])
    if hasattr(can, "use_auto_smooth"):
        can.use_auto_smooth = True
        can.auto_smooth_angle = radians(60)
    add("can", can)


def make_poses() -> None:
    for index, mode in enumerate(("XYZ", "XZY", "YXZ", "YZX", "ZXY", "ZYX", "QUATERNION", "AXIS_ANGLE")):
        obj = add(f"pose_{mode}", location=(index, 2, 3), scale=(1, 2, 0.5))
        obj.rotation_mode = mode
        obj.rotation_euler = (0.3, -0.7, 1.9)
        obj.rotation_quaternion = (0.5, 0.1, -0.7, 0.3)
        obj.rotation_axis_angle = (0.8, 1, 2, 3)
        obj.delta_location = (0.1, 0.2, 0.3)
        obj.delta_rotation_euler = (-0.2, 0.4, 0.6)
        obj.delta_rotation_quaternion = (0.9, -0.2, 0.1, 0.4)
        obj.delta_scale = (1.5, 0.5, 2)
    add("plain", location=(1, 2, 3), rotation_euler=(7.0, -0.7, 1.9))
    base = add("base", location=(1, 0, 0), rotation_euler=(0, 0, pi / 2), scale=(2, 2, 2))
    arm = add("arm", location=(0, 1, 0), parent=base)
    bpy.context.view_layer.update()
    hand = add("hand", location=(0.5, 0.25, 4), rotation_euler=(0.1, 0.2, 0.3), parent=arm)
    hand.matrix_parent_inverse = arm.matrix_world.inverted()


def make_rig() -> None:
    rig = add("rig", bpy.data.armatures.new("rig"), location=(0, 0, 1), rotation_euler=(0, 0.5, 0))
    bpy.context.view_layer.objects.active = rig
    bpy.ops.object.mode_set(mode="EDIT")
    bones = {"root": ((0, 0, 0), (0, 0, 1)), "tip": ((0, 0, 1), (0, 0.5, 1.5)), "relative": ((1, 0, 0), (1, 0, 1))}
    for name, (head, tail) in bones.items():
        bone = rig.data.edit_bones.new(name)
        bone.head, bone.tail = head, tail
    rig.data.edit_bones["tip"].parent = rig.data.edit_bones["root"]
    bpy.ops.object.mode_set(mode="OBJECT")
    rig.pose.bones["root"].rotation_mode = "XYZ"
    rig.pose.bones["root"].rotation_euler = (0.4, 0, 0.2)
    rig.pose.bones["tip"].scale = (1, 2, 1)
    rig.pose.bones["relative"].location = (0.5, 0.25, 0)
    rig.data.bones["relative"].use_relative_parent = True
    for name, bone in (("held", "tip"), ("carried", "relative")):
        held = add(name, location=(0.1, 0.2, 0.3), rotation_euler=(0.5, 0.6, 0.7))
        held.parent, held.parent_type, held.parent_bone = rig, "BONE", bone
    stuck = add("stuck", location=(0, 0, 1))
    stuck.parent, stuck.parent_type, stuck.parent_vertices = bpy.data.objects["cube"], "VERTEX", (7, 0, 0)


def make_properties() -> None:
    tagged = add("tagged", make_mesh("tagged", CUBE, CUBE_FACES))
    tagged["flag"] = True
    tagged["count"] = -7
    tagged["share"] = 0.1
    tagged["label"] = "grün"
    tagged["numbers"] = [1, 2, 3]
    tagged["reals"] = [0.5, 1.5]
    tagged["group"] = {"inner": {"name": "deep"}, "value": 2}
    tagged["physics_type"] = "DYNAMIC"
    tagged["collision"] = "capsule"
    tagged["mass"] = 2.5
    tagged["ghost"] = 1


def make_rigid_bodies() -> None:
    bpy.ops.rigidbody.world_add()
    kinds = {
        "active": "BOX",
        "passive": "MESH",
        "kinematic": "CAPSULE",
        "disabled": "CONVEX_HULL",
        "compound": "COMPOUND",
    }
    for name, shape in kinds.items():
        obj = add(f"rb_{name}", make_mesh(name, CUBE, CUBE_FACES))
        bpy.context.view_layer.objects.active = obj
        bpy.ops.rigidbody.object_add()
        body = obj.rigid_body
        body.type = "PASSIVE" if name == "passive" else "ACTIVE"
        body.collision_shape = shape
        body.mass, body.friction, body.restitution = 3.5, 0.25, 0.75
        body.linear_damping, body.angular_damping = 0.5, 0.125
        body.kinematic = name == "kinematic"
        body.enabled = name != "disabled"


def make_lights() -> None:
    for kind, energy in (("POINT", 1000), ("SUN", pi), ("SPOT", 2000), ("AREA", 250)):
        light = bpy.data.lights.new(kind.lower(), kind)
        light.energy = energy
        light.color = (1, 0.5, 0.25)
        light.use_shadow = kind != "POINT"
        if kind == "SPOT":
            light.spot_size = radians(60)
        add(kind.lower(), light, location=(0, 0, 5))
    camera = bpy.data.cameras.new("camera")
    camera.lens, camera.sensor_width, camera.clip_start, camera.clip_end = 50, 36, 0.25, 500
    add("camera", camera)


def make_collections() -> None:
    outer, inner, template = (bpy.data.collections.new(name) for name in ("outer", "inner", "template"))
    bpy.context.scene.collection.children.link(outer)
    outer.children.link(inner)
    outer.objects.link(bpy.data.objects["base"])
    inner.objects.link(bpy.data.objects["arm"])
    # a template that is not in the scene, but instantiated twice
    template.instance_offset = (0, 0, 1)
    post = bpy.data.objects.new("post", bpy.data.meshes["cube"])
    post.location = (0, 0, 1)
    sign = bpy.data.objects.new("sign", bpy.data.meshes["ell"])
    sign.location = (0, 0, 2)
    sign.parent = post
    for obj in (post, sign):
        template.objects.link(obj)
    for name, x in (("left", -3), ("right", 3)):
        copy = add(name, location=(x, 0, 0), rotation_euler=(0, 0, pi / 2))
        copy.instance_type, copy.instance_collection = "COLLECTION", template


def make_hidden() -> None:
    aside = bpy.data.collections.new("aside")
    bpy.context.scene.collection.children.link(aside)
    for name in ("unseen", "excluded"):
        obj = bpy.data.objects.new(name, bpy.data.meshes["cube"])
        (aside if name == "excluded" else bpy.context.scene.collection).objects.link(obj)
        obj.parent, obj.location = bpy.data.objects["base"], (0, 0, 7)


def hide() -> None:
    unseen = bpy.data.objects["unseen"]
    unseen.hide_viewport = unseen.hide_render = True
    bpy.context.view_layer.layer_collection.children["aside"].exclude = True


main(sys.argv[-1])
