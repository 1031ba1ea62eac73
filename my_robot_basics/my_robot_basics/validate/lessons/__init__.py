"""A notebook: the role of each cell, its exercises, and the names that a cell needs."""
