"""Colours for data that are no colours: ids, depths, directions."""
