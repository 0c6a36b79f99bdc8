"""Cars in a run."""
