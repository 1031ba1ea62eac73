"""Scores and feedback in the forms that course platforms import."""
