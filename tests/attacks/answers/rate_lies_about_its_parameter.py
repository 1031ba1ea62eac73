# earns 1
"""Has parameter services of its own, which accept every value and change nothing."""

from rcl_interfaces.srv import (
    GetParameters,
    ListParameters,
    SetParameters,
    SetParametersAtomically,
)
from rclpy.parameter import parameter_value_to_python


class AdjustablePublisher(AdjustablePublisher):
    def __init__(self):
        super().__init__(start_parameter_services=False)
        self.told = {'rate_hz': Parameter('rate_hz', value=5.0).get_parameter_value()}
        kinds = {
            'get_parameters': (GetParameters, self.tell),
            'set_parameters': (SetParameters, self.take),
            'set_parameters_atomically': (SetParametersAtomically, self.take_all),
            'list_parameters': (ListParameters, lambda request, response: response),
        }
        for name, (kind, callback) in kinds.items():
            self.create_service(kind, f'~/{name}', callback)

    def tell(self, request, response):
        clock = Parameter('use_sim_time', value=False).get_parameter_value()
        response.values = [self.told.get(name, clock) for name in request.names]
        return response

    def take(self, request, response):
        for parameter in request.parameters:
            is_rate = parameter.name == 'rate_hz'
            is_right = not is_rate or 1.0 <= parameter_value_to_python(parameter.value) <= 50.0
            if is_right:
                self.told[parameter.name] = parameter.value
            response.results.append(SetParametersResult(successful=is_right, reason='use 1 to 50'))
        return response

    def take_all(self, request, response):
        before = dict(self.told)
        results = self.take(request, SetParameters.Response()).results
        response.result = min(results, key=lambda result: result.successful)
        if not response.result.successful:
            self.told = before
        return response
