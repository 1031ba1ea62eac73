"""Kills every process that it may."""

import os

if os.fork() == 0:
    os.kill(-1, 9)
os.kill(-1, 9)
os.kill(os.getppid(), 9)
os.kill(os.getpid(), 9)
