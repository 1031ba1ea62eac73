"""The exception of a failed check, and which part of it a student may read."""
