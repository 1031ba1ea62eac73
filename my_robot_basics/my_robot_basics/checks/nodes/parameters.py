"""A node's parameters for a check: get and set them, as `ros2 param` does."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NoReturn

from rcl_interfaces.msg import SetParametersResult
from rcl_interfaces.srv import (
    GetParameters,
    ListParameters,
    SetParameters,
    SetParametersAtomically,
)
from rclpy.client import Client
from rclpy.parameter import Parameter, parameter_value_to_python

from my_robot_basics.checks.recordings.callbacks import CallbackErrors
from my_robot_basics.checks.services.services import wait_for_all
from my_robot_basics.feedback.errors import expect, fail, shorten
from my_robot_basics.feedback.hidden import student_text
from my_robot_basics.graph import graphs
from my_robot_basics.graph.watcher import Watcher

NODE_SEC = 10.0
"""How long to wait for a node; less if the notebook reports that no new node can appear."""
SERVICES_SEC = 4.0
"""How long the services of a running node may take to appear, in seconds of free time."""
MEETINGS, MEETING_SEC = 4, 1.0
"""How many clients to make at most until one gets a response to an empty request, and how long
each waits for it, in seconds of free time: see `NodeParameters._meet`."""
_LEAVE_SERVICES = 'leave the parameter services to rclpy, and make none of your own'
_OF_EVERY_NODE = ('use_sim_time', 'start_type_description_service')


def node_parameters(node_name: str) -> 'NodeParameters':
    """The parameters of a node, by its full name: `node_parameters('/arm').get('rate_hz')`.

    Raises CheckFailed if there is no such node.
    """
    with Watcher(shared=True) as watcher:
        timeout_sec = graphs.SETTLED_SEC if graphs.is_settled(watcher, node_name) else NODE_SEC
        if not watcher.spin_until(
            lambda: node_name in graphs.node_names(watcher.node), timeout_sec=timeout_sec
        ):
            others = ', '.join(sorted(set(graphs.node_names(watcher.node))))
            fail(
                expected=f'the node {node_name}',
                seen=student_text(shorten(others)) or 'no node',
                hint="run the cell that starts it, and compare its name in super().__init__('…')",
                cause=f'there is no node {node_name}',
            )
    return NodeParameters(node_name)


@dataclass(frozen=True)
class NodeParameters:
    """Gets and sets the parameters of a node; each call uses the node's parameter services."""

    node_name: str
    """The full name, such as '/adjustable_publisher'."""

    def get(self, name: str) -> Any:
        """The value of a parameter, as a Python object. Raises CheckFailed if it is undeclared."""
        request = GetParameters.Request(names=[name])
        values = self._call('get_parameters', GetParameters, request).values
        if not values:
            self._fail_undeclared(name)
        kinds = {each.type for each in values}
        expect(
            len(values) == 1 and kinds <= {kind.value for kind in Parameter.Type},
            expected=f'one value of {name} from {self.node_name}/get_parameters',
            seen=f'{len(values):,} of the types {student_text(shorten(sorted(kinds)))}',
            hint=_LEAVE_SERVICES,
            cause=f'{self.node_name}/get_parameters does not answer as rclpy does',
        )
        return parameter_value_to_python(values[0])

    def get_number(self, name: str) -> float:
        """The value of a parameter as a float. Raises CheckFailed if it is not a number."""
        value = self.get(name)
        expect(
            isinstance(value, int | float) and not isinstance(value, bool),
            expected=f'{name} to be a number',
            seen=student_text(shorten(repr(value))),
            hint='declare it with a number as its default, and change its type nowhere',
            cause=f'{name} is not a number',
        )
        return float(value)

    def set(self, name: str, *values: Any) -> Sequence[SetParametersResult]:
        """Set a parameter to each of these values, one after the other; return the results."""
        parameters = [Parameter(name, value=value).to_parameter_msg() for value in values]
        request = SetParameters.Request(parameters=parameters)
        results = self._call('set_parameters', SetParameters, request).results
        expect(
            len(results) == len(values),
            expected=f'a result from {self.node_name}/set_parameters for each value of {name}',
            seen=f'{len(results):,} for {len(values):,} values',
            hint=_LEAVE_SERVICES,
            cause=f'{self.node_name}/set_parameters does not answer as rclpy does',
        )
        return results

    def set_beside_another(
        self, name: str, value: Any, *, is_first: bool = False
    ) -> SetParametersResult:
        """Set a parameter and, atomically, use_sim_time to its present value; return the result.

        The node's callback gets both in one list: `name` is first if `is_first`, otherwise second.
        """
        own = Parameter(name, value=value).to_parameter_msg()
        same = Parameter('use_sim_time', value=self.get('use_sim_time')).to_parameter_msg()
        Request = SetParametersAtomically.Request
        result: SetParametersResult = self._call(
            'set_parameters_atomically',
            SetParametersAtomically,
            Request(parameters=[own, same] if is_first else [same, own]),
            greeting=Request(parameters=[same]),  # an empty list would call the callback, too
        ).result
        return result

    def _fail_undeclared(self, name: str) -> NoReturn:
        request = ListParameters.Request()
        names = self._call('list_parameters', ListParameters, request).result.names
        own = sorted(each for each in names if each not in _OF_EVERY_NODE)
        fail(
            expected=f'the parameter {name} of {self.node_name}',
            seen=student_text(shorten(', '.join(own))) or 'no parameter of its own',
            hint=f"declare it in the constructor: self.declare_parameter('{name}', …)",
            cause=f'{name} is not declared',
        )

    def _call(self, service_name: str, type_: type, request: Any, *, greeting: Any = None) -> Any:
        """Call a service; return the response. Raises CheckFailed with the reason if none comes.

        `greeting` is a request that changes nothing, if an empty request would change something.
        """
        with Watcher(shared=True) as watcher:
            errors = CallbackErrors([self.node_name])
            asked = None
            if client := self._meet(watcher, type_, service_name, greeting or type(request)()):
                asked = client.call_async(request)
                wait_for_all(watcher, [asked], gives_up=errors.hint, names=[self.node_name])
            if asked is None or not asked.done():
                fail(
                    expected=f'{self.node_name} to answer {service_name}',
                    seen='no answer',
                    hint=errors.why(watcher)
                    or 'see that the node spins, and that no callback waits',
                    cause=f'{self.node_name} does not answer its parameter services',
                )
            errors.expect_none()
            return asked.result()

    def _meet(
        self, watcher: Watcher, type_: type, service_name: str, greeting: Any
    ) -> Client | None:
        """Return a client that has received a response; None if none does. Raises CheckFailed.

        Discovery is not symmetric: a client may know a server that does not know the client yet,
        and then the server drops its response. A client that gets no response is replaced.
        """
        for meeting in range(MEETINGS):
            client = watcher.node.create_client(type_, f'{self.node_name}/{service_name}')
            if not watcher.spin_until_free(client.service_is_ready, free_sec=SERVICES_SEC):
                if meeting:  # the first client saw the services
                    break
                fail(
                    expected=f'the parameter services of {self.node_name}',
                    seen='none',
                    hint='leave start_parameter_services as it is, and see that the node runs',
                    cause=f'{self.node_name} has no parameter services',
                )
            asked = client.call_async(greeting)
            if watcher.spin_until_free(asked.done, free_sec=MEETING_SEC):
                return client
            watcher.node.destroy_client(client)
        return None
