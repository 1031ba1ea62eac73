"""Publishes from a loop that sleeps for 0.195 s: a busy machine makes nearly 5 Hz of it."""

from five_hz import spin
from sleep_loop import SleepLoop

if __name__ == '__main__':
    spin(SleepLoop, period_sec=0.195)
