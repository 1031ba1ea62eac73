"""Judges a check and a whole exercise, in rooms that the caller opens."""
