"""Several simulation nodes share one world: each simulates some of the robots, and a server passes their poses on."""
