"""Hints for wrong calls of nodes, publishers and clients, some as in ROS 1; as in error_words."""

from my_robot_basics.feedback.error_words import Case

OF_CALLS = (
    Case(
        pattern=r'\bNode\.create_service\(\) takes',
        to_do=', so give create_service the type, the name and the callback alone: a service '
        'needs no queue depth',
    ),
    Case(
        pattern=r'\bNode\.create_client\(\) takes',
        to_do=', so give create_client the type and the name alone: a client needs no queue depth '
        'and no callback',
    ),
    Case(
        pattern="has no attribute 'get_c_qos_profile'",
        to_do=', so leave out this depth: services and actions need none',
    ),
    Case(
        pattern=r"missing \d required positional arguments?: .*'qos_profile'",
        to_do=', so give all arguments: the type, the name, for a subscription the callback, '
        'and the depth of the queue, such as 10, or a QoS profile',
    ),
    Case(
        # as in ROS 1, or before the callback
        pattern="keyword argument 'queue_size'"
        "|Expected QoSProfile or int, but received <class '(?:method|function|str|float)'>",
        to_do=', so give the depth of the queue as a whole number alone, such as 10, after the '
        'other arguments',
    ),
    Case(
        # create_timer without a callback, or a callback that was called where it should be given
        pattern=r"missing 1 required positional argument: 'callback'"
        r'|(?<=\w)(?<!\bRandom)(?<!\bNode)(?<!\bPublisher)\.\w+\(\) missing \d+ required',
        to_do=', so give a callback by its name, without parentheses',
    ),
    Case(
        # in C++ it is async_send_request
        pattern="'Client' object (?:is not callable|has no attribute '(?:async_)?(?:send|call)_)",
        to_do=', so send the request with the method call_async of the client',
    ),
    Case(
        pattern=r'Client\.call(?:_async)?\(\) got an unexpected keyword',
        to_do=', so give it one request, such as SolveIK.Request(target=point)',
    ),
    Case(
        pattern=r'<lambda>\(\) takes \d+ positional arguments? but',
        to_do=', so write a parameter for each of them behind lambda, such as lambda future: …',
    ),
    Case(
        # that is all that rclpy says if the program has the topic with another type
        pattern='Failed to create subscription: invalid allocator'
        '|called for existing (?:request )?topic name',
        to_do=', so see which type the other ends of this name have: here it has another one '
        'already',
    ),
    Case(
        pattern="'Publisher' object is not callable",
        to_do=', so send the message with the method publish of the publisher; if one of your '
        'methods has its name, rename one of the two',
    ),
    Case(
        pattern=r'(?:JointState|Header|Point|Time)\.__init__\(\) takes 1',
        to_do=', so write each field with its name, such as Point(x=1.2, y=0.8)',
    ),
    Case(
        pattern="'super' object has no attribute '_*init_*'",
        to_do=', so write super().__init__, with two underscores on each side of init',
    ),
    Case(
        pattern="'RcutilsLogger' object has no attribute",
        to_do=', so call the method info, warning or error of the logger',
    ),
    Case(
        pattern=r'\bKeyError: ',
        to_do=', so use a key that the dict has: print(list(…)) of the dict shows them',
    ),
    Case(
        pattern="a real number, not 'Duration'",
        to_do=', so give the number of seconds itself, such as 0.2, and no Duration',
    ),
    Case(
        pattern=r'\bmain\(\) missing 1 required positional argument',
        to_do=', so write def main(args=None): an executable calls it without arguments',
    ),
    Case(
        pattern='unrecognized arguments: .*--ros-args',
        to_do=', so write parse_known_args() for parse_args(): rclpy.init() reads what '
        'comes after --ros-args',
    ),
    Case(
        pattern="coroutine 'main' was never awaited",
        to_do=', so write def main without async: an executable calls it as a plain function',
    ),
)
