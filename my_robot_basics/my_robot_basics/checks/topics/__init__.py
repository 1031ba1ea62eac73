"""A topic: its endpoints, recordings on either clock, messages to it, a node's count."""
