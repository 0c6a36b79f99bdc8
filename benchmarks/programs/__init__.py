"""Programs that measure MORSE; each ends with one line of JSON."""
