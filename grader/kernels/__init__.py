"""Jupyter kernels inside of sandboxes: started or forked, spoken to, and how each one ended."""
