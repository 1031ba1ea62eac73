"""Reports its rate as a text after a refusal: a check would format it as a number."""  # earns 2

from rcl_interfaces.srv import GetParameters, SetParameters, SetParametersAtomically
from rclpy.parameter import parameter_value_to_python


class AdjustablePublisher(AdjustablePublisher):
    def __init__(self):
        super().__init__(start_parameter_services=False)
        self.told = {'rate_hz': 5.0, 'use_sim_time': False}
        self.create_service(GetParameters, '~/get_parameters', self.tell)
        self.create_service(SetParameters, '~/set_parameters', self.take)
        self.create_service(SetParametersAtomically, '~/set_parameters_atomically', self.take_all)

    def tell(self, request, response):
        told = [Parameter(name, value=self.told[name]) for name in request.names]
        response.values = [each.get_parameter_value() for each in told]
        return response

    def take(self, request, response):
        for parameter in request.parameters:
            value = parameter_value_to_python(parameter.value)
            is_right = parameter.name != 'rate_hz' or 1.0 <= value <= 50.0
            self.told[parameter.name] = value if is_right else 'a text'
            if is_right and parameter.name == 'rate_hz':
                self.change(value)
            response.results.append(SetParametersResult(successful=is_right, reason='no'))
        return response

    def take_all(self, request, response):
        response.result = self.take(request, SetParameters.Response()).results[0]
        return response
