"""Keeps C code busy that no interrupt reaches."""

import re

re.match('(a*)*b', 'a' * 60)
