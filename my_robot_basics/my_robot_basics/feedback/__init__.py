"""What a check tells: its exception, and what of it a student may read."""
