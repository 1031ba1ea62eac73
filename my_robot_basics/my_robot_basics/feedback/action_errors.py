"""Hints for exceptions in coroutines and in the callbacks of action servers; as in error_words."""

from my_robot_basics.feedback.error_words import Case

OF_ACTIONS = (
    Case(
        # Python 3.12 names the class, too
        pattern=r"'(?:Goal|Cancel)Response' has no attribute"
        r'|AttributeError: (?i:accept|reject)\w*(?: \(|$)',
        to_do=', so write ACCEPT or REJECT: GoalResponse and CancelResponse have these two names',
    ),
    Case(
        pattern=r'\bActionServer\.__init__\(\) takes',
        to_do=', so write the names of all further arguments: goal_callback=…, cancel_callback=…',
    ),
    Case(
        pattern=r'\bActionServer\.__init__\(\) missing',
        to_do=', so give it the node, the type, the name and the execute callback: '
        "ActionServer(self, MoveArm, '/move_arm', self.execute)",
    ),
    Case(
        pattern=r'\bActionClient\.__init__\(\) (?:takes|missing)',
        to_do=', so give it the node, the type and the name alone: '
        "ActionClient(self, MoveArm, '/move_arm')",
    ),
    Case(
        pattern=r"'ActionClient' object has no attribute '(?:async_)?(?:cancel_goal|get_result)",
        to_do=', so call this method of the goal handle: it is the result of the future that '
        'send_goal_async returns',
    ),
    Case(
        pattern=r'\bServerGoalHandle\.(?:succeed|abort|canceled)\(\) takes',
        to_do=', so call it without an argument, and return the result: '
        'return MoveArm.Result(position=…)',
    ),
    Case(
        pattern=r"'ServerGoalHandle' object has no attribute '(?:set_)?(?:succe|cancel|abort)",
        to_do=', so end the goal with a method that it has: goal_handle.succeed(), '
        'goal_handle.canceled() or goal_handle.abort()',
    ),
    Case(
        pattern=r"'ServerGoalHandle' object has no attribute '(?:goal|position|speed)'",
        to_do=', so look into goal_handle.request, which has the fields of the goal',
    ),
    Case(
        pattern=r"'ServerGoalHandle' object has no attribute 'is_(?:preempt|cancell)",
        to_do=', so look at goal_handle.is_cancel_requested, which is True or False',
    ),
    Case(
        pattern=r"'ClientGoalHandle' object has no attribute '\w*accept",
        to_do=', so look at goal_handle.accepted, which is True or False',
    ),
    Case(
        pattern='built-in method publish_feedback of pybind11',
        to_do=', so give each field of the feedback what it holds: a list of numbers for '
        'position, and a single number for remaining',
    ),
    Case(
        pattern="'bool' object is not callable",
        to_do=', so write no parentheses behind what is True or False, such as '
        'goal_handle.is_cancel_requested',
    ),
    Case(
        pattern='no running event loop',
        to_do=', so wait without asyncio, whose event loop does not run here: await a Future of '
        'rclpy that a timer sets',
    ),
    Case(
        pattern='from state EXECUTING with event CANCELED',
        to_do=', so call canceled() in the execute callback, after the cancel callback has '
        'returned CancelResponse.ACCEPT',
    ),
    Case(
        pattern='from state (?:SUCCEEDED|CANCELED|ABORTED) with event',
        to_do=', so call only one of succeed(), canceled() and abort() for each goal, and call it '
        'once',
    ),
    Case(
        pattern=r"'\w+_Result' object has no attribute 'status'",
        to_do=', so leave .result out: the status is beside the result, future.result().status',
    ),
    Case(
        pattern="unhashable type: 'ClientGoalHandle'",
        to_do=', so keep goal handles in a list, or in a dict with '
        'bytes(goal_handle.goal_id.uuid) as the key',
    ),
    Case(
        pattern=r'KeyError: 0 \(.*\.status\b',
        to_do=', so look at goal_handle.accepted first: a rejected goal has no result, and its '
        'status is 0',
    ),
    Case(
        # the future of a result, too early, or after its cancel()
        pattern=r"'NoneType' object has no attribute 'status'.*\.result\(\)",
        to_do=', so let add_done_callback call this function, and cancel the goal with '
        'cancel_goal_async(), not its future: a future that was cancelled has no result',
    ),
)
