"""At a period of 0.205 s, and nobody can switch its clock from outside."""

from five_hz import FiveHz, spin

if __name__ == '__main__':
    spin(FiveHz, period_sec=0.205, start_parameter_services=False)
