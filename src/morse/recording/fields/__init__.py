"""The data fields of components in a recording: what a tick keeps, how a file holds them, and how they are read."""
