"""Robots: one class a file."""
