"""The class paths of MORSE 1.4 for streams of images and point clouds over the socket."""
