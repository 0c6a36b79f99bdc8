"""Modifiers: noise, frames and units between components and streams."""
