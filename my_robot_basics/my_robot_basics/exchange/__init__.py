"""Requests and replies between a notebook's kernel and the kernel of a check, and a probe."""
