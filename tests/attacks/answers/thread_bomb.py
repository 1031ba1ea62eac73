"""Starts threads until there is no room for more."""

import threading
import time

while True:
    try:
        threading.Thread(target=time.sleep, args=(86421,)).start()
    except RuntimeError:
        pass
