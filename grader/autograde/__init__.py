"""What `nbgrader autograde` runs of ours, in place of its own reading and execution."""
