"""At 5.13 Hz: within the tolerance on the wall clock, but not 5 Hz."""

from five_hz import FiveHz, spin

if __name__ == '__main__':
    spin(FiveHz, period_sec=0.195)
