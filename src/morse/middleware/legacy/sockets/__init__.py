"""The class paths of MORSE 1.4 for image and point cloud streams over the socket."""
