"""Why each program of the quizzes returns what it does: shown once somebody has guessed."""

TOPICS = {
    'late_subscription': 'A VOLATILE publisher keeps nothing for subscriptions that join later: '
    '1 was gone before the subscription existed (lesson 1).',
    'full_name': 'A name with a leading `/` is absolute, and the namespace does not change it. '
    '`pose` would become `/left_arm/pose` (lesson 1).',
    'joint_order': 'Names and positions are pairs: `joint1` is the second name, so its angle is '
    'the second position (lesson 2).',
    'timer_rate': 'The first argument of `create_timer` is the period in seconds. Five seconds '
    'are 0.2 Hz; for 5 Hz write 1 / 5 (lesson 3).',
    'not_spun': 'The messages had arrived, and waited in the queue. A callback is called only '
    'while the node is spun, and `spin_once` calls one (lesson 4).',
    'full_queue': 'A full queue drops its oldest message, RELIABLE or not. The newest three are '
    'left (lessons 3 and 6).',
    'four_threads': "Both timers are in the node's default callback group. It runs one callback "
    'at a time, however many threads there are (lesson 4).',
    'counted_ends': 'What is counted are publishers and subscriptions, not nodes: this node has '
    'two publishers. And `/Pose` is another topic than `/pose` (lessons 5 and 7).',
    'asks_for_more': 'RELIABLE is more than BEST_EFFORT. A subscription that requests more than '
    'is offered does not match; one that requests less does (lesson 6).',
    'kept_messages': 'A TRANSIENT_LOCAL publisher keeps its last messages, as many as its depth, '
    'for subscriptions that request TRANSIENT_LOCAL, too (lesson 6).',
}
SERVICES = {
    'early_request': 'A request that is sent before there is a server is lost, and its future is '
    'never done. Wait for the server first (lesson 8).',
    'no_return': 'The server did its work, and its callback ended without `return response`. '
    'Nothing is sent back, so `call` gives up and returns None (lesson 8).',
    'call_in_callback': 'The server answers, but only the executor could receive the response, '
    'and it waits inside the callback: a deadlock, until the time limit (lesson 8).',
    'nobody_agrees': 'Without a cancel callback, a server rejects each request to cancel, and the '
    'goal goes on to its end (lesson 9).',
    'forgotten_end': 'The execute callback returned without `succeed()`. rclpy assumes that the '
    'goal was aborted, wherever the arm is (lesson 9).',
    'never_looks': 'To accept a request to cancel does not stop anything. The execute callback '
    'has to look at `is_cancel_requested` and call `canceled()` (lesson 9).',
    'empty_response': 'A field that nobody fills in has its default value: False, an empty list, '
    'an empty text. A client cannot tell this from an answer (lessons 2 and 10).',
    'whole_number': 'The default value 20.0 is a double, so the parameter stays a double: the '
    'integer 36 is refused, and nothing changes (lesson 11).',
    'read_once': 'The parameter has changed, and the timer has not: its period was computed once, '
    'in the constructor (lesson 11).',
    'rule_without_effect': 'A relative name in a rule gets the namespace: this rule is about '
    '`/left/pose`. The code says `/pose`, so the rule changes nothing (lesson 11).',
}
EXPLANATIONS = TOPICS | SERVICES
"""By the name of the program."""
