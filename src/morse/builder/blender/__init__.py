"""Nodes of the scene under the names of Blender, for scripts that know them."""
