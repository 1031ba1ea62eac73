"""Publishes from a loop that sleeps for 0.195 s: on a busy machine, the rate is nearly 5 Hz."""

from five_hz import spin
from sleep_loop import SleepLoop

if __name__ == '__main__':
    spin(SleepLoop, period_sec=0.195)
