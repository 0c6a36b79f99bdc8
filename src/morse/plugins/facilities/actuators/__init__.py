"""What doors, gates and lifts are told."""
