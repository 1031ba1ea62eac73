"""Has a period of 0.205 s and no parameter services, so a check cannot switch its clock."""

from five_hz import FiveHz, spin

if __name__ == '__main__':
    spin(FiveHz, period_sec=0.205, start_parameter_services=False)
