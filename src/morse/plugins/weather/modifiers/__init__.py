"""What the weather changes in measurements."""
