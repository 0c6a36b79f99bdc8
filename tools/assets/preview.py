"""Render a picture of a model file with Cycles. Runs inside Blender:

    blender ... --python tools/assets/preview.py -- MODEL.blend PICTURE.png [azimuth elevation [distance [x y z]]]

Degrees; azimuth 0 shows the front (+X) of the model. Without a distance, the picture shows the whole model.
"""

from __future__ import annotations

import sys

import bpy

from mathutils import Euler, Vector


def main() -> None:
    model, picture, *view = sys.argv[sys.argv.index("--") + 1 :]
    bpy.ops.wm.open_mainfile(filepath=model)
    azimuth, elevation, distance, *centre = [float(v) for v in view] + [35.0, 18.0, 0.0][len(view) :]
    scene = bpy.context.scene
    if scene.world is None:
        scene.world = bpy.data.worlds.new("Preview")
        scene.world.color = (0.6, 0.7, 0.8)
    if not any(o.type == "LIGHT" for o in bpy.data.objects):
        sun = bpy.data.objects.new("Preview", bpy.data.lights.new("Preview", "SUN"))
        sun.data.energy, sun.rotation_euler = 3.0, (0.6, 0.25, 0.5)
        scene.collection.objects.link(sun)
    camera = bpy.data.objects.new("Preview", bpy.data.cameras.new("Preview"))
    scene.collection.objects.link(camera)
    bpy.context.view_layer.update()
    shown = [o for o in bpy.data.objects if o.type == "MESH" and not o.hide_render]
    corners = [o.matrix_world @ Vector(c) for o in shown for c in o.bound_box]
    low, high = (Vector([f(c[i] for c in corners) for i in range(3)]) for f in (min, max))
    target = Vector(centre) if centre else (low + high) / 2
    camera.rotation_euler = Euler(((90.0 - elevation) * 0.0174533, 0.0, (90.0 + azimuth) * 0.0174533))
    away = camera.rotation_euler.to_matrix() @ Vector((0.0, 0.0, 1.0))
    camera.location = target + away * (distance or 1.9 * (high - low).length)
    camera.data.lens = 50.0
    camera.data.clip_end = 1000.0
    scene.camera = camera
    scene.render.engine = "CYCLES"
    scene.cycles.samples, scene.cycles.use_denoising = 48, False
    scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = 720, 540, 100
    scene.render.filepath = picture
    bpy.ops.render.render(write_still=True)


main()
