"""A submitted notebook: read it, and put it back into the shape of its source."""
