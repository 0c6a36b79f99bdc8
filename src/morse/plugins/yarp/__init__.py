"""The data and the services of components on ports of YARP, by a protocol implementation of our own."""
