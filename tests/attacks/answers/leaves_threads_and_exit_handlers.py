"""Leaves threads that never end, and handlers that run at the end."""  # earns 3

import atexit
import threading
import time

atexit.register(time.sleep, 86421)
threading.Thread(target=time.sleep, args=(86421,)).start()


def double(x):
    return x + x
