"""People: crowds that walk, are seen by sensors and touch robots."""
