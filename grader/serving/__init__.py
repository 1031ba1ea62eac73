"""The resident process: what is handed in is graded, and its feedback released, at once."""
