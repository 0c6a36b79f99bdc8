"""Which messages carry which kind; each module is a part of the stream manager."""
