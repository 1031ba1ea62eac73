"""Where this grader lies."""

from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
"""The checkout that this grader belongs to."""
