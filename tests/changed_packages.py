"""Packages that students hand in for lesson 12: ours with a change, right, wrong and hostile."""

from right_packages import RIGHT
from wrong_packages import HOSTILE, WRONG

ALL = (*RIGHT, *WRONG, *HOSTILE)
