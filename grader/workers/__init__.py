"""Processes that grade, on this machine or on a Dask cluster, and how many at a time."""
