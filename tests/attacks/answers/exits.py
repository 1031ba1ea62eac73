"""Ends its kernel with success."""

import os

os._exit(0)
