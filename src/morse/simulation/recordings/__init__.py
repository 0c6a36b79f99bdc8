"""What a simulation keeps of its run, and runs that are played again."""
