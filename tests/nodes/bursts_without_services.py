"""Five messages once a second, and nobody can switch its clock from outside."""

from bursts import Bursts
from five_hz import spin

if __name__ == '__main__':
    spin(Bursts, start_parameter_services=False)
