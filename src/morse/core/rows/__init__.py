"""Components of one class that act in the same ticks: one row for each."""
