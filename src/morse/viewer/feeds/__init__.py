"""Data for pages, in addition to the poses."""
