"""Has parameter services that give an unknown type and no result, so that checks stop."""

from rcl_interfaces.msg import ParameterValue
from rcl_interfaces.srv import GetParameters, SetParameters


class AdjustablePublisher(AdjustablePublisher):
    def __init__(self):
        super().__init__(start_parameter_services=False)
        self.create_service(GetParameters, '~/get_parameters', self.tell)
        self.create_service(SetParameters, '~/set_parameters', lambda request, response: response)

    def tell(self, request, response):
        response.values = [ParameterValue(type=77) for _ in request.names]
        return response
