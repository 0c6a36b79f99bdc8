"""From what a script has made to the scene that is simulated."""
