"""Publishes at 5 Hz; takes 3 s to switch back from the robot's clock to wall time."""

import time

from five_hz import FiveHz, spin
from rcl_interfaces.msg import SetParametersResult


class SlowToReturn(FiveHz):
    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.returned = False
        self.add_on_set_parameters_callback(self.take_time)

    def take_time(self, parameters):
        if any(p.name == 'use_sim_time' and not p.value for p in parameters):
            time.sleep(3.0)
            self.returned = True
        return SetParametersResult(successful=True)


def main():
    spin(SlowToReturn)


if __name__ == '__main__':
    main()
