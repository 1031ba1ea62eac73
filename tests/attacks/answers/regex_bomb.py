"""Keeps C code busy, which no interrupt can stop."""

import re

re.match('(a*)*b', 'a' * 60)
