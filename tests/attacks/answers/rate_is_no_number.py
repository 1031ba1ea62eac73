"""Returns another type of value each time a check asks for its rate."""

import itertools
import math

from rcl_interfaces.srv import GetParameters, SetParameters

TURNS = itertools.cycle(['5.0', 5.0, math.nan, [5.0], True, 10.0, 1e300, -0.0])


class AdjustablePublisher(AdjustablePublisher):
    def __init__(self):
        super().__init__(start_parameter_services=False)
        self.create_service(GetParameters, '~/get_parameters', self.tell)
        self.create_service(SetParameters, '~/set_parameters', self.take)

    def tell(self, request, response):
        response.values = [
            Parameter(name, value=next(TURNS)).get_parameter_value() for name in request.names
        ]
        return response

    def take(self, request, response):
        response.results = [SetParametersResult(successful=True) for _ in request.parameters]
        return response
