"""Shared code of the model scripts. Runs inside Blender; needs only bpy and numpy."""
