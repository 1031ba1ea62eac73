"""Five messages once a second; a check cannot switch its clock, without parameter services."""

from bursts import Bursts
from five_hz import spin

if __name__ == '__main__':
    spin(Bursts, start_parameter_services=False)
