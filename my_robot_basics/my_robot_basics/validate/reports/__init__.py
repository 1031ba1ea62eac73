"""The results for each exercise and check, and how they read."""
