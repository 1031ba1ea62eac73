"""Leaves a daemon behind that outlives its kernel, and answers honestly."""  # earns 3

import os

if os.fork() == 0:
    os.setsid()
    if os.fork() == 0:
        os.execvp('sleep', ['sleep', '86421'])
    os._exit(0)


def double(x):
    return x + x
