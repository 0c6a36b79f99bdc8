"""Cars on lanes."""
