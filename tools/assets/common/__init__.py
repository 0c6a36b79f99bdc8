"""What the model scripts share. Runs inside Blender; needs bpy and numpy only."""
