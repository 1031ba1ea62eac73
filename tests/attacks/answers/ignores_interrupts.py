"""Ignores the signal of an interrupt and sleeps."""

import signal
import time

signal.signal(signal.SIGINT, signal.SIG_IGN)
time.sleep(86421)
