"""The ports of YARP with the data as JSON text."""
