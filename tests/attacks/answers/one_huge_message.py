"""Sends one message larger than any limit."""

print('x' * 60_000_000)
