"""The data of sensors as text files."""
