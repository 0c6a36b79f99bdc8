"""Starts simulations from scene scripts, optionally with a live view."""
