"""What MORSE takes from the operating system with care: files that may be anything, environment variables."""
