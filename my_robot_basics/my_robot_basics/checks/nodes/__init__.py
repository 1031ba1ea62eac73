"""A node's name, log and parameters, and a node that a command line starts."""
