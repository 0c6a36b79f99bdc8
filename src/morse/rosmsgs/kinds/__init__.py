"""The messages of each kind; each module is a part of the stream manager."""
