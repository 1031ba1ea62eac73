"""At a period of 0.195 s, and nobody can switch its clock from outside."""

from five_hz import FiveHz, spin

if __name__ == '__main__':
    spin(FiveHz, period_sec=0.195, start_parameter_services=False)
