"""What doors, gates and lifts tell."""
