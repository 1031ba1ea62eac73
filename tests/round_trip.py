"""Load arm_interfaces and send each of its types back and forth; runs by itself on any Python.

It imports nothing of the course, so it also runs in an environment without it. It prints the types
that came back; it ends with a traceback if one did not.
"""

import importlib

import rclpy
from action_msgs.msg import GoalStatus
from rclpy.action import ActionClient, ActionServer, CancelResponse
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node
from rclpy.serialization import deserialize_message, serialize_message
from rosidl_parser import definition

from arm_interfaces.action import MoveArm
from arm_interfaces.srv import SolveIK

TIMEOUT_SEC = 30.0
POSE = [0.25, -1.5]
PARTS = (SolveIK, MoveArm.Impl.SendGoalService, MoveArm.Impl.GetResultService)
MESSAGES = (
    *(kind for part in PARTS for kind in (part.Request, part.Response, part.Event)),
    *(MoveArm.Goal, MoveArm.Result, MoveArm.Feedback, MoveArm.Impl.FeedbackMessage),
)
OURS = {kind.__name__: kind for kind in MESSAGES}


def filled(kind):
    """Return a message in which no field is empty or 0."""
    fields = zip(kind.get_fields_and_field_types(), kind.SLOT_TYPES, strict=True)
    return kind(**{name: value_of(slot) for name, slot in fields})


def value_of(slot):
    match slot:
        case definition.Array():
            return [value_of(slot.value_type)] * slot.size
        case definition.AbstractSequence():
            count = 1 if isinstance(slot, definition.BoundedSequence) else 3
            return [value_of(slot.value_type) for _ in range(count)]
        case definition.AbstractString():
            return 'außer Reichweite'
        case definition.NamespacedType():
            if slot.name in OURS:
                return filled(OURS[slot.name])
            return filled(getattr(importlib.import_module('.'.join(slot.namespaces)), slot.name))
        case definition.BasicType(typename='boolean'):
            return True
        case definition.BasicType(typename='double'):
            return -1.25
    return 7  # integers


class Arm(Node):
    """Offers both interfaces, echoes requests, and is its own client."""

    def __init__(self):
        super().__init__('arm')
        self.create_service(SolveIK, '/solve_ik', self.solve)
        self.server = ActionServer(
            self, MoveArm, '/move_arm', self.move, cancel_callback=lambda _: CancelResponse.ACCEPT
        )
        self.solver = self.create_client(SolveIK, '/solve_ik')
        self.mover = ActionClient(self, MoveArm, '/move_arm')

    def solve(self, request, response):
        response.reachable, response.message = True, f'{request.target.x}'
        response.elbow_up, response.elbow_down = POSE, [-angle for angle in POSE]
        return response

    def move(self, goal):
        goal.publish_feedback(MoveArm.Feedback(position=goal.request.position, remaining=0.5))
        goal.succeed()
        return MoveArm.Result(position=goal.request.position)


def main():
    rclpy.init()
    node, executor = Arm(), MultiThreadedExecutor(2)
    executor.add_node(node)

    def wait_for(future):
        executor.spin_until_future_complete(future, timeout_sec=TIMEOUT_SEC)
        assert future.done(), f'no answer in {TIMEOUT_SEC:g} s'
        return future.result()

    for kind in MESSAGES:
        sent, received = filled(kind), rclpy.task.Future()
        assert deserialize_message(serialize_message(sent), kind) == sent, kind
        node.create_subscription(kind, f'/{kind.__name__.lower()}', received.set_result, 1)
        publisher = node.create_publisher(kind, f'/{kind.__name__.lower()}', 1)
        publisher.publish(sent)
        assert wait_for(received) == sent, kind
        print(kind.__name__)

    assert node.solver.wait_for_service(TIMEOUT_SEC)
    assert node.mover.wait_for_server(TIMEOUT_SEC)
    request = SolveIK.Request()
    request.target.x = 1.5
    response = wait_for(node.solver.call_async(request))
    assert (response.message, list(response.elbow_up)) == ('1.5', POSE)
    print('SolveIK')
    feedback = []
    goal = MoveArm.Goal(position=POSE, speed=0.5)
    handle = wait_for(node.mover.send_goal_async(goal, feedback_callback=feedback.append))
    assert handle.accepted
    result = wait_for(handle.get_result_async())
    assert result.status == GoalStatus.STATUS_SUCCEEDED
    assert list(result.result.position) == list(feedback[0].feedback.position) == POSE
    print('MoveArm')
    executor.shutdown()
    node.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
