"""Changes of a scene that is open, written into its script."""
