"""A recorded run as one file: a page that needs no server."""
