"""Publishes at 5 Hz, and refuses to change any parameter, even `use_sim_time`."""

from five_hz import FiveHz, spin
from rcl_interfaces.msg import SetParametersResult


class RefusesParameters(FiveHz):
    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        refused = SetParametersResult(successful=False, reason='this node has no parameters')
        self.add_on_set_parameters_callback(lambda parameters: refused)


if __name__ == '__main__':
    spin(RefusesParameters)
