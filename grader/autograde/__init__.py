"""What `nbgrader autograde` calls of this package, instead of its own preprocessors."""
