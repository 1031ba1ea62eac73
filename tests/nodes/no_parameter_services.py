"""Has no parameter services, so a check cannot switch its clock."""

from five_hz import FiveHz, spin


class NoParameterServices(FiveHz):
    def __init__(self, **kwargs):
        super().__init__(start_parameter_services=False, **kwargs)


def main():
    spin(NoParameterServices)


if __name__ == '__main__':
    main()
