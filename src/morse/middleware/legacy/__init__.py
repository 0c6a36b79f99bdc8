"""The modules of streams and services under the paths that scripts and clients of MORSE 1.4 name."""
