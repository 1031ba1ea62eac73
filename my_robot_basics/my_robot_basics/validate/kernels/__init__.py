"""Kernels on the student's machine, and what a cell prints, in bounds and in time."""
