"""A node that republishes: which message comes out for which, and what it leaves out."""
