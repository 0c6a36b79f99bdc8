"""Processes that render the images of cameras while the simulation continues."""
