"""The editor of the page: adds, moves and deletes robots and objects, and saves the scene."""
