"""The path of this checkout."""

from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
"""The root folder of the checkout that this grader is part of."""
